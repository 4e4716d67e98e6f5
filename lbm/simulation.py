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
from lbm.lattice import Lattice
from lbm.observers import DivergenceGuard, Observer
from lbm.progress import Progress
from lbm.rates import Rates
from lbm.stencil import Q

_SMALLEST = 4
_CELLS_WORTH_A_THREAD = 16_384  # fewer are done before another thread has woken
_TILE_BYTES = 4 * 2**20
"""What three planes of a strip of rows may take when two steps are made in one sweep."""

Force = Sequence[float] | Callable[[float], Sequence[float]]
Pass = Callable[[Lattice, int, tuple | None], None]
"""Changes populations between steps: called with the lattice, the number of steps made, and the force."""


class Simulation:
    """Fluid of rest density 1 in a box of ``shape`` = (nx, ny, nz) cells, in lattice units.

    Parameters
    ----------
    shape : cells along x, y, z, at least 4 each.
    rates : relaxation rates, which set the viscosity; see :class:`lbm.rates.Rates`.
    faces : boundary by face ("x-", "x+", ...) or axis ("x", "y", "z"): one of "periodic" (default),
        "no-slip", "free-slip", "outlet", or a record of :mod:`lbm.faces`.
    force : force density, 3 components, or a function of time giving them (called half-way between steps).
    dtype : float64 or float32; populations are stored as deviations from rest.
    threads : default all that the size of the box is worth; results do not depend on it.

    Cell (i, j, k) has its centre at (i + 1/2, j + 1/2, k + 1/2); walls lie on the faces of the box.
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
        self.rates = rates
        self.dtype = np.dtype(dtype)
        if self.dtype not in (np.dtype(np.float64), np.dtype(np.float32)):
            raise InputError(f"dtype {self.dtype}: use float64 or float32")
        self.threads = _checked_threads(threads, int(np.prod(self.shape)))
        self.faces = _resolve(faces)
        self.given_force = force
        self.steps = 0
        self.lattice = Lattice(self.shape, tuple(f.kind for f in self.faces), self.dtype)
        self.passes: list[Pass] = _passes(self.faces, self.lattice.grid)
        self._rates = rates.scaled(self.dtype)
        self._force_at(0.0)  # refuses a malformed force now

    @property
    def force(self) -> tuple[float, float, float] | None:
        """Force density of the last step (of the first, before it)."""
        return self._force_at(max(self.steps - 0.5, 0.5))

    def _force_at(self, when: float) -> tuple[float, float, float] | None:
        if self.given_force is None:
            return None
        force = self.given_force(when) if callable(self.given_force) else self.given_force
        value = np.asarray(force, dtype=float)
        if value.shape != (3,) or not np.isfinite(value).all():
            raise InputError(f"force = {force!r}: give 3 finite components")
        return tuple(float(v) for v in value)

    def set_flow(self, density=1.0, velocity=(0.0, 0.0, 0.0)) -> None:
        """Start from ``density`` (nx, ny, nz) and ``velocity`` (3, nx, ny, nz), or what broadcasts to them.

        Resets the count of steps. Velocity gradients enter the non-equilibrium, so the start is smooth.
        """
        rho = _field("density", density, self.shape)
        u = np.asarray(velocity, dtype=float)
        u = _field("velocity", u.reshape(3, 1, 1, 1) if u.shape == (3,) else u, (3, *self.shape))
        if np.any(rho <= 0):
            raise InputError(f"density: {rho.min():g} at its lowest, must be positive; rest density is 1")
        periodic = tuple(isinstance(self.faces[2 * axis], faces.Periodic) for axis in range(3))
        self.steps = 0
        fields.write(self.lattice, rho, u, self._force_at(0.0), self.rates.viscosity, periodic)

    def fields(self) -> tuple[np.ndarray, np.ndarray]:
        """Density (nx, ny, nz) and velocity (3, nx, ny, nz)."""
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
        checkpoint.save(self, path)

    def restore(self, path: Path | str) -> None:
        """Continue from a checkpoint of a simulation set up like this one; see :mod:`lbm.checkpoint`."""
        checkpoint.restore(self, path)

    def compile(self) -> float:
        """Compile, or load from the cache, the kernels this simulation needs; seconds taken."""
        start = time.perf_counter()
        lattice, force = self.lattice, self._typed(self._force_at(0.0))
        kernels.sweep(lattice.populations, lattice.grid, lattice.rows, 0, self._rates, force, 0)
        kernels.sweep_two(lattice.populations, lattice.grid, lattice.rows, self._rates, force, 1, 1, 0)
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

        Each observer is called when the count of steps is a multiple of its ``every``, at the start of the
        very first run too; the guard, by default every 100 steps and at the end, before all others.
        """
        steps = _checked_count("steps", steps)
        watchers = ([] if guard is None else [guard]) + list(observers)
        threads_before = numba.get_num_threads()
        numba.set_num_threads(self.threads)
        try:
            with Progress(progress, steps, int(np.prod(self.shape))) as shown:
                if cache.is_empty():
                    shown.compiling()
                compiled_before = cache.compiled_count()
                seconds = self.compile()
                if cache.compiled_count() > compiled_before:
                    shown.compiled(seconds)
                if self.steps == 0:
                    _call(watchers, self)
                end = self.steps + steps
                while self.steps < end:
                    before = self.steps
                    due = (before + w.every - before % w.every for w in watchers)
                    self._advance(min([end, *due, *shown.stop(before)]))
                    _call(watchers, self)
                    shown.advance(self.steps - before)
                if guard is not None:
                    guard(self)
        finally:
            numba.set_num_threads(threads_before)

    def _typed(self, force):
        return None if force is None else tuple(self.dtype.type(v) for v in force)

    def _advance(self, until: int) -> None:
        lattice = self.lattice
        plain = not self.passes and not callable(self.given_force)
        force = self._force_at(self.steps + 0.5)
        typed = self._typed(force)
        planes = self.shape[2]
        blocks = max(1, min(self.threads, planes // _SMALLEST))
        row_bytes = 3 * Q * lattice.grid.row * lattice.dtype.itemsize
        tile = max(8, _TILE_BYTES // row_bytes)
        while self.steps < until:
            if plain and lattice.parity == 0 and until - self.steps >= 2:
                kernels.sweep_two(
                    lattice.populations, lattice.grid, lattice.rows, self._rates, typed, blocks, tile, planes
                )
                self.steps += 2
                continue
            if callable(self.given_force):
                force = self._force_at(self.steps + 0.5)
                typed = self._typed(force)
            kernels.sweep(
                lattice.populations, lattice.grid, lattice.rows, lattice.parity, self._rates, typed, planes
            )
            lattice.parity ^= 1
            for change in self.passes:
                change(lattice, self.steps, force)
            self.steps += 1


def _call(observers: list[Observer], simulation: Simulation) -> None:
    for observer in observers:
        if simulation.steps % observer.every == 0:
            observer(simulation)


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


def _field(name: str, value, shape: tuple[int, ...]) -> np.ndarray:
    value = np.asarray(value, dtype=float)
    try:
        field = np.broadcast_to(value, shape)
    except ValueError:
        raise InputError(f"{name}: shape {value.shape} does not fit the grid, which needs {shape}") from None
    if not np.isfinite(field).all():
        cell = tuple(int(i) for i in np.argwhere(~np.isfinite(field))[0])
        raise InputError(f"{name}: not finite, first at index {cell}")
    return field
