"""A flow in a box, advanced in time."""

from __future__ import annotations

import operator
import os
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numba
import numpy as np

from lbm import cache, checkpoint, faces, fields, kernels
from lbm.errors import InputError
from lbm.interrupt import interrupts_deferred
from lbm.lattice import Lattice
from lbm.observers import DivergenceGuard, Observer, checked
from lbm.progress import Progress
from lbm.rates import Rates
from lbm.stencil import Q

_SMALLEST = 4
_CELLS_WORTH_A_THREAD = 16_384  # fewer are done before another thread has woken
_TILE_BYTES = 4 * 2**20
"""What three planes of a strip of rows may take when two steps are made in one sweep."""

Force = Sequence[float] | Callable[[float], Sequence[float]]
Pass = Callable[[Lattice, int, tuple | None], None]
"""Changes populations after a step: called with the lattice, the steps made before it, and its force."""


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
    threads : default all that the size of the box is worth; results do not depend on it.

    Cell (i, j, k) has its centre at (i + 1/2, j + 1/2, k + 1/2); walls lie on the faces of the box.

    A new simulation is fluid at rest. Collision n applies the force of time n, half of which velocities at time
    n already hold (Guo, Zheng & Shi, Phys. Rev. E 65 (2002) 046308): momentum gains the trapezoidal sum.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        rates: Rates,
        *,
        faces: dict[str, faces.Face | str] | None = None,
        force: Force | None = None,
        dtype: str | type | np.dtype = np.float64,
        threads: int | None = None,
    ):
        self.shape = _checked_shape(shape)
        self.dtype = np.dtype(dtype)
        if self.dtype not in (np.dtype(np.float64), np.dtype(np.float32)):
            raise InputError(f"dtype {self.dtype}: use float64 or float32")
        self.threads = _checked_threads(threads, int(np.prod(self.shape)))
        self.faces = _resolve(faces)
        self.given_force = force
        self.steps = 0
        self.lattice = Lattice(self.shape, tuple(f.kind for f in self.faces), self.dtype)
        self.passes: list[Pass] = _passes(self.faces, self.lattice.grid)
        self._rates, self._scaled_rates = rates, rates.scaled(self.dtype)
        self._running = self._half_done = False
        self._seen_start: list[Observer] = []
        if any(self._force_at(0.0) or ()):
            self.set_flow()  # without a force, the populations of a new lattice are those of rest

    @property
    def rates(self) -> Rates:
        """Relaxation rates, fixed for the life of the simulation."""
        return self._rates

    @property
    def force(self) -> tuple[float, float, float] | None:
        """Force density now."""
        return self._force_at(float(self.steps))

    def _force_at(self, when: float) -> tuple[float, float, float] | None:
        if self.given_force is None:
            return None
        force = self.given_force(when) if callable(self.given_force) else self.given_force
        try:
            value = np.asarray(force, dtype=float)
        except (TypeError, ValueError):
            value = np.empty(0)
        if value.shape != (3,) or not np.isfinite(value).all():
            at = f" at time {when:g}" if callable(self.given_force) else ""
            raise InputError(f"force = {force!r}{at}: give 3 finite components")
        return tuple(float(v) for v in value)

    def set_flow(self, density=1.0, velocity=(0.0, 0.0, 0.0)) -> None:
        """Start from ``density``, a number or (nx, ny, nz), and ``velocity``, (3,) or (3, nx, ny, nz).

        Resets the count of steps. Velocity gradients enter the non-equilibrium, so the start is smooth.
        """
        self._refuse_within_run("set_flow")
        rho = _field("density", density, (), self.shape)
        u = _field("velocity", velocity, (3,), (3, *self.shape))
        if np.any(rho <= 0):
            raise InputError(f"density: {rho.min():g} at its lowest, must be positive; rest density is 1")
        periodic = tuple(isinstance(self.faces[2 * axis], faces.Periodic) for axis in range(3))
        force = self._force_at(0.0)
        with interrupts_deferred():
            self._half_done = True
            fields.write(self.lattice, rho, u, force, self.rates.viscosity, periodic)
            self.steps = 0
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
        return self.lattice.populations.nbytes / np.prod(self.shape)

    def save(self, path: Path | str) -> None:
        """Write a checkpoint; see :mod:`lbm.checkpoint`."""
        self._refuse_half_done()
        checkpoint.save(self, path)

    def restore(self, path: Path | str) -> None:
        """Continue from a checkpoint of a simulation set up like this one; see :mod:`lbm.checkpoint`."""
        self._refuse_within_run("restore")
        with interrupts_deferred():
            checkpoint.restore(self, path)  # refuses the file before it changes anything
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
        steps = _checked_count("steps", steps)
        watchers = ([] if guard is None else checked([guard])) + checked(observers)
        threads_before = numba.get_num_threads()
        numba.set_num_threads(self.threads)
        try:
            self._running = True
            with Progress(progress, steps, int(np.prod(self.shape))) as shown:
                if cache.is_empty():
                    shown.compiling()
                compiled_before = cache.compiled_count()
                seconds = self.compile()
                if cache.compiled_count() > compiled_before:
                    shown.compiled(seconds)
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
            raise InputError(
                f"the simulation was stopped amid a change of its populations, after step {self.steps}; "
                "set_flow or restore it first"
            )

    def _typed(self, force):
        return None if force is None else tuple(self.dtype.type(v) for v in force)

    def _advance(self, until: int) -> None:
        """Step to ``until``, or to the first whole step after Ctrl-C."""
        lattice = self.lattice
        plain = not self.passes and not callable(self.given_force)
        force = self._force_at(float(self.steps))
        typed = self._typed(force)
        planes = self.shape[2]
        blocks = max(1, min(self.threads, planes // _SMALLEST))
        row_bytes = 3 * Q * lattice.grid.row * lattice.dtype.itemsize
        tile = max(8, _TILE_BYTES // row_bytes)
        grid, rows, rates = lattice.grid, lattice.rows, self._scaled_rates
        with interrupts_deferred() as held:
            while self.steps < until and not held:
                if plain and lattice.parity == 0 and until - self.steps >= 2:
                    self._half_done = True
                    kernels.sweep_two(lattice.populations, grid, rows, rates, typed, blocks, tile, planes)
                    self.steps += 2
                    self._half_done = False
                    continue
                if callable(self.given_force):
                    force = self._force_at(float(self.steps))
                    typed = self._typed(force)
                self._half_done = True
                kernels.sweep(lattice.populations, grid, rows, lattice.parity, rates, typed, planes)
                lattice.parity ^= 1
                for change in self.passes:
                    change(lattice, self.steps, force)
                self.steps += 1
                self._half_done = False


# The keyword ``faces`` of Simulation hides the module of that name in its constructor.
_resolve = faces.resolve
_passes = faces.passes


def _checked_shape(shape) -> tuple[int, int, int]:
    try:
        nx, ny, nz = (operator.index(n) for n in shape)
    except (TypeError, ValueError):
        raise InputError(f"shape = {shape!r}: give three whole numbers of cells (nx, ny, nz)") from None
    if min(nx, ny, nz) < _SMALLEST:
        raise InputError(f"shape = {(nx, ny, nz)}: at least {_SMALLEST} cells along each axis, also periodic ones")
    return nx, ny, nz


def _checked_threads(threads: int | None, cells: int) -> int:
    available = numba.config.NUMBA_NUM_THREADS
    if threads is None:
        return max(1, min(available, cells // _CELLS_WORTH_A_THREAD))
    threads = _checked_count("threads", threads)
    if not 1 <= threads <= available:
        raise InputError(
            f"threads = {threads}: between 1 and {available} "
            f"(of {os.cpu_count()} cores; NUMBA_NUM_THREADS raises it)"
        )
    return threads


def _checked_count(name: str, value) -> int:
    try:
        count = operator.index(value)
    except TypeError:
        raise InputError(f"{name} = {value!r}: must be a whole number") from None
    if count < 0:
        raise InputError(f"{name} = {count}: must not be negative")
    return count


def _field(name: str, value, uniform: tuple[int, ...], shape: tuple[int, ...]) -> np.ndarray:
    """``value`` as a field of ``shape``; nothing but that shape and the ``uniform`` one is taken for a field."""
    value = np.asarray(value, dtype=float)
    if value.shape not in (uniform, shape):
        raise InputError(f"{name}: shape {value.shape} given, {uniform} or {shape} needed")
    if value.shape == uniform:
        value = value.reshape(uniform + (1,) * (len(shape) - len(uniform)))
    field = np.broadcast_to(value, shape)
    if not np.isfinite(field).all():
        cell = tuple(int(i) for i in np.argwhere(~np.isfinite(field))[0])
        raise InputError(f"{name}: not finite, first at index {cell}")
    return field
