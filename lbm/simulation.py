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
        rates: Rates | RatesByPlace,
        *,
        faces: dict[str, Face | str] | None = None,
        force: Force | None = None,
        dtype: str | type | np.dtype = np.float64,
        threads: int | None = None,
    ):
        super().__init__(shape, rates, faces=faces, force=force, dtype=dtype)
        self.threads = arguments.threads(threads, math.prod(self.shape))
        self._face_passes = passes.passes(self.faces, self.lattice.grid)
        walls = [isinstance(face, NoSlip) for face in self.faces]
        table = np.array([layer.scaled(self.dtype) for layer in rates.layers()], self.dtype)
        self._places = places(table, walls, self.shape)

    def compile(self) -> float:
        """Compile, or load from the cache, the kernels this simulation needs; seconds taken."""
        start = time.perf_counter()
        lattice, force = self.lattice, self._typed(self._force_at(0.0))
        kernels.sweep(lattice.populations, lattice.grid, lattice.rows, 0, self._places, force, 0)
        kernels.sweep_two(lattice.populations, lattice.grid, lattice.rows, self._places, force, 1, 1, 0)
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
        lattice = self.lattice
        corrections = (*self._face_passes, *self.bodies)
        plain = not corrections and not callable(self.given_force)
        force = self._force_at(float(self.steps))
        typed = self._typed(force)
        planes = self.shape[2]
        blocks = max(1, min(self.threads, planes // arguments.SMALLEST))
        tile = max(8, _TILE_BYTES // (3 * Q * lattice.grid.row * lattice.dtype.itemsize))
        grid, rows, where = lattice.grid, lattice.rows, self._places
        with interrupts_deferred() as held:
            while self.steps < until and not held:
                if plain and lattice.parity == 0 and until - self.steps >= 2:
                    with self._changing():
                        kernels.sweep_two(lattice.populations, grid, rows, where, typed, blocks, tile, planes)
                        self._steps += 2
                    continue
                if callable(self.given_force):
                    force = self._force_at(float(self.steps))
                    typed = self._typed(force)
                for change in corrections:
                    change.prepare(lattice, self.steps)
                with self._changing():
                    kernels.sweep(lattice.populations, grid, rows, lattice.parity, where, typed, planes)
                    lattice.parity ^= 1
                    for change in corrections:
                        change(lattice, self.steps, force)
                    self._steps += 1
