"""A flow advanced in time."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable

import numba
import numpy as np

from lbm import arguments
from lbm.faces import passes
from lbm.faces.records import Face, NoSlip
from lbm.flow import Flow, Force
from lbm.fluid import cache, kernels
from lbm.fluid.places import places
from lbm.fluid.stencil import Q
from lbm.io.interrupt import interrupts_deferred
from lbm.io.progress import Progress
from lbm.observers import DivergenceGuard, Observer, checked
from lbm.rates import Rates
from lbm.rates_by_place import RatesByPlace

__all__ = ["Simulation"]

_TILE_BYTES = 4 * 2**20
"""What three planes of a strip of rows may take when two steps are made in one sweep."""


class Simulation(Flow):
    """Fluid of rest density 1 in a box of ``shape`` = (nx, ny, nz) cells, in lattice units.

    Parameters
    ----------
    shape : cells along x, y, z, at least 4 each.
    rates : relaxation rates, which set the viscosity: the same everywhere (:class:`lbm.Rates`) or other ones near
        no-slip walls (:class:`lbm.RatesByPlace`).
    faces : boundary by face ("x-", "x+", ...) or axis ("x", "y", "z"): one of "periodic" (default),
        "no-slip", "free-slip", "outlet", or a record of :mod:`lbm.faces`.
    force : force density, 3 components, or a function of time giving them (called at whole steps).
    dtype : float64 or float32; populations are stored as deviations from rest.
    threads : default all that the size of the box is worth; results do not depend on it. Processes started
        after a run must be spawned: a forked one would wait for ever for the threads it has not inherited.
    viscosity : in cells^2 a step, in place of ``rates``, which then are :meth:`lbm.Rates.balanced`: quiet in fast
        flow, and they leave walls in their place.

    Raises
    ------
    InputError
        For arguments that cannot be used.

    Notes
    -----
    Cell (i, j, k) has its centre at (i + 1/2, j + 1/2, k + 1/2); walls lie on the faces of the box.

    A new simulation is fluid at rest. Collision n applies the force of time n, half of which velocities at time
    n already hold (Guo, Zheng & Shi, Phys. Rev. E 65 (2002) 046308): momentum gains the trapezoidal sum.

    The stencil is not quite Galilean invariant: a shear wave in a mean flow U along its wave vector decays with
    (1 - 3 U^2) times the viscosity set.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        rates: Rates | RatesByPlace | None = None,
        *,
        faces: dict[str, Face | str] | None = None,
        force: Force | None = None,
        dtype: str | type | np.dtype = np.float64,
        threads: int | None = None,
        viscosity: float | None = None,
    ):
        super().__init__(shape, rates, faces=faces, force=force, dtype=dtype, viscosity=viscosity)
        self.threads = arguments.threads(threads, math.prod(self.shape))
        self._face_passes = passes.passes(self.faces, self.lattice.grid)
        walls = [isinstance(face, NoSlip) for face in self.faces]
        table = np.array([layer.scaled(self.dtype) for layer in self.rates.layers()], self.dtype)
        self._places = places(table, walls, self.shape)
        self._planes = np.arange(self.shape[2])

    def compile(self) -> float:
        """Compile, or load from the cache, the kernels this simulation needs; seconds taken."""
        start = time.perf_counter()
        lattice, force = self.lattice, self._force_at(0.0)
        self._sweep(self._planes[:0], force)
        kernels.sweep_two(
            lattice.populations, lattice.grid, lattice.rows, self._places, self._typed(force),
            1, 1, 0, np.zeros(0, np.bool_),
        )  # fmt: skip
        return time.perf_counter() - start

    def run(
        self,
        steps: int,
        observers: Iterable[Observer] = (),
        *,
        guard: DivergenceGuard | None = DivergenceGuard(),  # noqa: B008 - immutable
        progress: bool = False,
    ) -> None:
        """Advance ``steps`` steps.

        Ctrl-C takes effect between steps, so that the simulation can be read, saved and continued after it.

        Parameters
        ----------
        steps : int
            How many, at least 0.
        observers : iterable of observers
            Each is called when the count of steps is a multiple of its ``every``, and once at the start of a flow.
        guard : DivergenceGuard or None
            Called before all others, by default every 100 steps, and at the end; None for no check.
        progress : bool
            Show steps, speed and the time left.

        Raises
        ------
        DivergenceError
            From the guard, at the first step at which it finds the flow out of range.
        InputError
            If an observer starts another run, sets the flow or restores one, or a function of time goes bad; what
            was made until then can be read, saved and continued.
        """
        self._refuse_within_run("run")
        self._refuse_half_done()
        steps = arguments.count("steps", steps)
        watchers = ([] if guard is None else checked([guard])) + checked(observers)
        threads_before = numba.get_num_threads()
        numba.set_num_threads(self.threads)
        try:
            self._running = True
            with Progress(progress, steps, math.prod(self.shape)) as shown:
                if cache.is_empty():
                    shown.compiling()
                compiled_before = cache.compiled_count()
                seconds = self.compile()
                if cache.compiled_count() > compiled_before:
                    shown.compiled(seconds, cache.keeps())
                if self.steps == 0:
                    self._show_start(watchers)
                end = self.steps + steps
                while self.steps < end:
                    before = self.steps
                    due = (before + w.every - before % w.every for w in watchers)
                    try:
                        self._advance(min([end, *due, *shown.stop(before)]))
                    finally:
                        shown.advance(self.steps - before)
                    for watcher in watchers:
                        if self.steps % watcher.every == 0:
                            watcher(self)
                if guard is not None:
                    guard(self)
        finally:
            self._running = False
            numba.set_num_threads(threads_before)

    def _show_start(self, watchers: list[Observer]) -> None:
        for watcher in watchers:
            if not any(watcher is seen for seen in self._saw_start):
                watcher(self)
                self._saw_start.append(watcher)

    def _typed(self, force):
        return None if force is None else tuple(self.dtype.type(v) for v in force)

    def _advance(self, until: int) -> None:
        """Step to ``until``, or to the first whole step after Ctrl-C."""
        with interrupts_deferred() as held:
            while self.steps < until and not held:
                near = self._near_bodies() if self.lattice.parity == 0 and until - self.steps >= 2 else None
                if near is None:
                    self._step()
                else:
                    self._step_twice(near)

    def _near_bodies(self) -> np.ndarray | None:
        """Numbers of the planes that bodies reach; None where two steps cannot be made at once."""
        reached = [body.reach(self.lattice) for body in self.bodies]
        if self._face_passes or callable(self.given_force) or any(planes is None for planes in reached):
            return None
        return np.unique(np.concatenate([self._planes[:0], *reached]))

    def _step(self) -> None:
        """One step of the fluid, then faces and bodies."""
        lattice, force = self.lattice, self._force_at(float(self.steps))
        corrections = (*self._face_passes, *self.bodies)
        for change in corrections:
            change.prepare(lattice, self.steps)
        with self._changing():
            self._sweep(self._planes, force)
            lattice.parity ^= 1
            for change in corrections:
                change(lattice, self.steps, force)
            self._steps += 1

    def _step_twice(self, near: np.ndarray) -> None:
        """Two steps from parity 0 in one pass over memory, ahead of which go the planes ``near`` bodies."""
        lattice, force = self.lattice, self._force_at(float(self.steps))
        blocks = max(1, min(self.threads, self.shape[2] // arguments.SMALLEST))
        tile = max(8, _TILE_BYTES // (3 * Q * lattice.grid.row * lattice.dtype.itemsize))
        made = np.zeros(self.shape[2], np.bool_)
        made[near] = True
        for body in self.bodies:
            body.prepare(lattice, self.steps)
            body.prepare(lattice, self.steps + 1)
        with self._changing():
            self._sweep(near, force)
            lattice.parity = 1
            for body in self.bodies:
                body(lattice, self.steps, force)
            kernels.sweep_two(
                lattice.populations, lattice.grid, lattice.rows, self._places, self._typed(force),
                blocks, tile, self.shape[2], made,
            )  # fmt: skip
            lattice.parity = 0
            for body in self.bodies:
                body(lattice, self.steps + 1, force)
            self._steps += 2

    def _sweep(self, planes: np.ndarray, force) -> None:
        """Collide and stream ``planes``."""
        lattice = self.lattice
        kernels.sweep(
            lattice.populations, lattice.grid, lattice.rows, lattice.parity, self._places,
            self._typed(force), planes,
        )  # fmt: skip
