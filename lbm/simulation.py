"""A flow in a box, advanced in time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numba
import numpy as np

from lbm import arguments
from lbm.bodies import body as bodies
from lbm.bodies.body import Body
from lbm.errors import InputError
from lbm.faces import passes
from lbm.faces.records import Face, Periodic, resolve
from lbm.fluid import cache, fields, kernels
from lbm.fluid.lattice import Lattice
from lbm.fluid.stencil import Q
from lbm.io import checkpoint
from lbm.io.interrupt import interrupts_deferred
from lbm.io.progress import Progress
from lbm.observers import DivergenceGuard, Observer, checked
from lbm.rates import Rates

__all__ = ["Force", "Simulation"]

_TILE_BYTES = 4 * 2**20
"""What three planes of a strip of rows may take when two steps are made in one sweep."""

Force = Sequence[float] | Callable[[float], Sequence[float]]


class Simulation:
    """Fluid of rest density 1 in a box of ``shape`` = (nx, ny, nz) cells, in lattice units.

    Parameters
    ----------
    shape : cells along x, y, z, at least 4 each.
    rates : relaxation rates, which set the viscosity; see :class:`lbm.rates.Rates`.
    faces : boundary by face ("x-", "x+", ...) or axis ("x", "y", "z"): one of "periodic" (default),
        "no-slip", "free-slip", "outlet", or a record of :mod:`lbm.faces`.
    force : force density, 3 components, or a function of time giving them (called at whole steps).
    dtype : float64 or float32; populations are stored as deviations from rest.
    threads : default all that the size of the box is worth; results do not depend on it. Processes started
        after a run must be spawned: a forked one would wait for ever for the threads it has not inherited.

    Cell (i, j, k) has its centre at (i + 1/2, j + 1/2, k + 1/2); walls lie on the faces of the box.

    A new simulation is fluid at rest. Collision n applies the force of time n, half of which velocities at time
    n already hold (Guo, Zheng & Shi, Phys. Rev. E 65 (2002) 046308): momentum gains the trapezoidal sum.

    The stencil is not quite Galilean invariant: a shear wave in a mean flow U along its wave vector decays with
    (1 - 3 U^2) times the viscosity set.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        rates: Rates,
        *,
        faces: dict[str, Face | str] | None = None,
        force: Force | None = None,
        dtype: str | type | np.dtype = np.float64,
        threads: int | None = None,
    ):
        self._dtype = arguments.precision(dtype)
        self._shape = arguments.box(shape, self._dtype.itemsize)
        if not isinstance(rates, Rates):
            hint = "; call the preset, as Rates.bgk(viscosity)" if callable(rates) else ""
            raise InputError(f"rates = {arguments.shown(rates)}: give lbm.Rates{hint}")
        self.threads = arguments.threads(threads, math.prod(self._shape))
        self._faces = resolve(faces)
        self.given_force = force
        self._steps = 0
        try:
            self.lattice = Lattice(self._shape, tuple(f.kind for f in self._faces), self._dtype)
        except MemoryError:
            raise arguments.too_large(self._shape, self._dtype.itemsize) from None
        self._face_passes = passes.passes(self._faces, self.lattice.grid)
        self._bodies: list[Body] = []
        self._rates, self._scaled_rates = rates, rates.scaled(self.dtype)
        self._running = self._half_done = False
        self._seen_start: list[Observer] = []
        if any(self._force_at(0.0) or ()):
            self.set_flow()  # without a force, the populations of a new lattice are those of rest

    @property
    def shape(self) -> tuple[int, int, int]:
        """Cells along x, y, z."""
        return self._shape

    @property
    def dtype(self) -> np.dtype:
        """Precision of the populations."""
        return self._dtype

    @property
    def faces(self) -> tuple[Face, ...]:
        """Boundaries in the order x-, x+, y-, y+, z-, z+."""
        return self._faces

    @property
    def steps(self) -> int:
        """Steps made since the start of the flow: the time."""
        return self._steps

    @property
    def rates(self) -> Rates:
        """Relaxation rates, fixed for the life of the simulation."""
        return self._rates

    @property
    def force(self) -> tuple[float, float, float] | None:
        """Force density now."""
        return self._force_at(float(self.steps))

    def _force_at(self, when: float) -> tuple[float, float, float] | None:
        return arguments.force(self.given_force, when)

    @property
    def bodies(self) -> tuple[Body, ...]:
        """What :meth:`add` has put into the fluid."""
        return tuple(self._bodies)

    def add(self, body: Body) -> None:
        """Put ``body`` into the fluid: :class:`lbm.FixedBody`, or what keeps to :class:`lbm.bodies.Body`.

        After every step bodies act in the order in which they were added. A checkpoint holds their states and
        is refused by a simulation with other ones.
        """
        self._refuse_within_run("add")
        if any(body is other for other in self._bodies):
            raise InputError(f"{arguments.shown(body)}: is in this simulation already")
        bodies.attach(body, self.lattice, self.steps)
        self._bodies.append(body)

    def set_flow(self, density=1.0, velocity=(0.0, 0.0, 0.0)) -> None:
        """Start from ``density``, a number or (nx, ny, nz), and ``velocity``, (3,) or (3, nx, ny, nz).

        Resets the count of steps; bodies stay as they are. Velocity gradients enter the non-equilibrium, so the
        start is smooth.
        """
        self._refuse_within_run("set_flow")
        rho = arguments.field("density", density, (), self.shape)
        u = arguments.field("velocity", velocity, (3,), (3, *self.shape))
        arguments.density("density", rho)
        arguments.speed("velocity", u, 0)
        periodic = tuple(isinstance(self.faces[2 * axis], Periodic) for axis in range(3))
        force = self._force_at(0.0)
        with interrupts_deferred():
            self._half_done = True
            fields.write(self.lattice, rho, u, force, self.rates.viscosity, periodic)
            self._steps = 0
            self._seen_start = []
            self._half_done = False

    def fields(self) -> tuple[np.ndarray, np.ndarray]:
        """Density (nx, ny, nz) and velocity (3, nx, ny, nz)."""
        self._refuse_half_done()
        return fields.read(self.lattice, self.force)

    @property
    def density(self) -> np.ndarray:
        """Density, shape (nx, ny, nz)."""
        return self.fields()[0]

    @property
    def velocity(self) -> np.ndarray:
        """Velocity, shape (3, nx, ny, nz)."""
        return self.fields()[1]

    @property
    def bytes_per_cell(self) -> float:
        """Memory of the populations, pads included."""
        return self.lattice.populations.nbytes / math.prod(self.shape)

    def save(self, path: Path | str) -> None:
        """Write a checkpoint; see :mod:`lbm.io.checkpoint`."""
        self._refuse_half_done()
        checkpoint.save(self, path)

    def restore(self, path: Path | str) -> None:
        """Continue from a checkpoint of a simulation set up like this one; see :mod:`lbm.io.checkpoint`."""
        self._refuse_within_run("restore")
        with interrupts_deferred():
            saved = checkpoint.read(self, path)  # refuses the file before anything is changed
            self._half_done = True
            self.lattice.slots()[...] = saved.slots
            self.lattice.parity, self._steps = saved.parity, saved.steps
            for body, state in zip(self._bodies, saved.states, strict=True):
                bodies.set_state(body, state)
            self._half_done = False
            self._seen_start = []

    def compile(self) -> float:
        """Compile, or load from the cache, the kernels this simulation needs; seconds taken."""
        start = time.perf_counter()
        lattice, force = self.lattice, self._typed(self._force_at(0.0))
        kernels.sweep(lattice.populations, lattice.grid, lattice.rows, 0, self._scaled_rates, force, 0)
        kernels.sweep_two(lattice.populations, lattice.grid, lattice.rows, self._scaled_rates, force, 1, 1, 0)
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

        Each observer is called when the count of steps is a multiple of its ``every``, and once at the start of
        a flow; the guard, by default every 100 steps and at the end, before all others. Ctrl-C takes effect
        between steps, so that the simulation can be read, saved and continued after it.

        Raises :class:`InputError` if an observer starts another run, sets the flow or restores one.
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
            if not any(watcher is seen for seen in self._seen_start):
                watcher(self)
                self._seen_start.append(watcher)

    def _refuse_within_run(self, name: str) -> None:
        if self._running:
            raise InputError(f"{name}: called during a run of the same simulation; call it between runs")

    def _refuse_half_done(self) -> None:
        if self._half_done:
            raise InputError(f"stopped amid a change after step {self.steps}; set_flow or restore it first")

    def _typed(self, force):
        return None if force is None else tuple(self.dtype.type(v) for v in force)

    def _advance(self, until: int) -> None:
        """Step to ``until``, or to the first whole step after Ctrl-C."""
        lattice = self.lattice
        corrections = [*self._face_passes, *self._bodies]
        prepare = [change.prepare for change in corrections if hasattr(change, "prepare")]
        plain = not corrections and not callable(self.given_force)
        force = self._force_at(float(self.steps))
        typed = self._typed(force)
        planes = self.shape[2]
        blocks = max(1, min(self.threads, planes // arguments.SMALLEST))
        tile = max(8, _TILE_BYTES // (3 * Q * lattice.grid.row * lattice.dtype.itemsize))
        grid, rows, rates = lattice.grid, lattice.rows, self._scaled_rates
        with interrupts_deferred() as held:
            while self.steps < until and not held:
                if plain and lattice.parity == 0 and until - self.steps >= 2:
                    self._half_done = True
                    kernels.sweep_two(lattice.populations, grid, rows, rates, typed, blocks, tile, planes)
                    self._steps += 2
                    self._half_done = False
                    continue
                if callable(self.given_force):
                    force = self._force_at(float(self.steps))
                    typed = self._typed(force)
                for ready in prepare:
                    ready(lattice, self._steps)
                self._half_done = True
                kernels.sweep(lattice.populations, grid, rows, lattice.parity, rates, typed, planes)
                lattice.parity ^= 1
                for change in corrections:
                    change(lattice, self._steps, force)
                self._steps += 1
                self._half_done = False
