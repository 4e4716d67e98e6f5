"""What may look at a simulation while it runs: objects with ``every`` (steps) and a call."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from lbm import fields
from lbm.errors import DivergenceError, InputError
from lbm.scales import Scales
from lbm.vtkhdf import write_image

if TYPE_CHECKING:
    from lbm.simulation import Simulation


class Observer(Protocol):
    """Called with the simulation whenever its count of steps is a multiple of ``every``."""

    every: int

    def __call__(self, simulation: Simulation) -> None:
        """Look at ``simulation``."""


def checked(observers: Iterable[Observer]) -> list[Observer]:
    """``observers`` as a list; :class:`InputError` for what is no list or holds what cannot observe."""
    if not isinstance(observers, Iterable):
        raise InputError(f"observers = {observers!r}: give a list of observers, also of one")
    found = list(observers)
    for observer in found:
        if isinstance(observer, type) or not callable(observer) or not hasattr(observer, "every"):
            raise InputError(f"{observer!r}: no observer; give an object with ``every`` (steps) and a call")
        _check_every(observer.every)
    return found


def _check_every(every: int) -> None:
    try:
        if operator.index(every) >= 1:
            return
    except TypeError:
        pass
    raise InputError(f"every = {every!r}: must be a whole number of steps, at least 1")


@dataclass(frozen=True)
class DivergenceGuard:
    """Stops a run whose density or speed leaves ``density`` or ``top_speed`` (lattice units), or is NaN."""

    every: int = 100
    density: tuple[float, float] = (0.5, 2.0)
    top_speed: float = 0.5

    def __post_init__(self) -> None:
        _check_every(self.every)

    def __call__(self, simulation: Simulation) -> None:
        """Raise :class:`lbm.errors.DivergenceError` naming step, cell and value."""
        sums = fields.plane_sums(simulation.lattice, simulation.force, self.density, self.top_speed)
        outside = sums[:, fields.SUMS.index("outside")]
        if not outside.any():
            return
        rho, u = simulation.fields()
        speed = np.sqrt(np.sum(u.astype(float) ** 2, axis=0))
        low, high = self.density
        bad_density = ~((rho >= low) & (rho <= high))
        bad = bad_density | ~(speed <= self.top_speed)
        cell = tuple(int(i) for i in np.argwhere(bad)[0])
        quantity, value = ("density", rho[cell]) if bad_density[cell] else ("speed", speed[cell])
        raise DivergenceError(
            simulation.steps,
            cell,
            quantity,
            float(value),
            f" (allowed: density {low:g} to {high:g}, speed up to {self.top_speed:g}); "
            "lower the lattice speed, "
            f"or raise the viscosity (now {simulation.rates.viscosity:.3g}) by more cells",
        )


@dataclass
class Sums:
    """Total mass, momentum and kinetic energy against time: ``steps``, ``rows`` (mass, px, py, pz, energy).

    Mass is counted as excess over the fluid at rest, which keeps its round-off small.
    """

    every: int
    steps: list[int] = field(default_factory=list)
    rows: list[np.ndarray] = field(default_factory=list)

    def __post_init__(self) -> None:
        _check_every(self.every)

    def __call__(self, simulation: Simulation) -> None:
        """Append one row."""
        sums = fields.plane_sums(simulation.lattice, simulation.force)
        self.steps.append(simulation.steps)
        self.rows.append(np.array([math.fsum(column) for column in sums[:, :5].T]))


@dataclass
class Probe:
    """Density and velocity at one ``cell`` against time: ``steps`` and ``rows`` (rho, ux, uy, uz)."""

    every: int
    cell: tuple[int, int, int]
    steps: list[int] = field(default_factory=list)
    rows: list[tuple[float, ...]] = field(default_factory=list)

    def __post_init__(self) -> None:
        _check_every(self.every)

    def __call__(self, simulation: Simulation) -> None:
        """Append one row."""
        if not all(0 <= i < n for i, n in zip(self.cell, simulation.shape, strict=True)):
            raise InputError(f"probe cell {self.cell}: outside the grid {simulation.shape}")
        rho, u = fields.read_cell(simulation.lattice, self.cell, simulation.force)
        self.steps.append(simulation.steps)
        self.rows.append((rho, *u))


@dataclass
class Average:
    """Mean of density and velocity over the calls: ``density`` and ``velocity``."""

    every: int
    count: int = 0
    density: np.ndarray | None = None
    velocity: np.ndarray | None = None

    def __post_init__(self) -> None:
        _check_every(self.every)

    def __call__(self, simulation: Simulation) -> None:
        """Take the present fields into the mean."""
        rho, u = (f.astype(float) for f in simulation.fields())
        self.count += 1
        if self.density is None or self.velocity is None:
            self.density, self.velocity = rho, u
        else:
            self.density += (rho - self.density) / self.count
            self.velocity += (u - self.velocity) / self.count


@dataclass
class FieldOutput:
    """Writes ``directory/stem_STEP.vtkhdf`` for ParaView, in SI if ``scales`` are given."""

    every: int
    directory: Path | str
    stem: str = "flow"
    scales: Scales | None = None
    written: list[Path] = field(default_factory=list)

    def __post_init__(self) -> None:
        _check_every(self.every)

    def __call__(self, simulation: Simulation) -> None:
        """Write one file."""
        path = Path(self.directory) / f"{self.stem}_{simulation.steps:08d}.vtkhdf"
        rho, u = simulation.fields()
        scales = self.scales or Scales(1.0, 1.0)
        written = {"density": scales.si(rho, "density"), "velocity": scales.si(u, "velocity")}
        write_image(path, written, spacing=scales.cell_m)
        self.written.append(path)


@dataclass
class Checkpoint:
    """Saves the simulation to ``path``; only a complete file of a sound state replaces the previous one."""

    every: int
    path: Path | str
    guard: DivergenceGuard = DivergenceGuard()

    def __post_init__(self) -> None:
        _check_every(self.every)

    def __call__(self, simulation: Simulation) -> None:
        """Check and save."""
        self.guard(simulation)
        simulation.save(self.path)
