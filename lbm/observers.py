"""What may look at a flow while it runs: objects with ``every`` (steps) and a call."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np

from lbm import arguments
from lbm.errors import DivergenceError, InputError, OutsideRangeWarning
from lbm.faces.records import AXES, NoSlip
from lbm.flow import Flow
from lbm.fluid import fields
from lbm.fluid.stencil import CS2
from lbm.io.vtkhdf import write_image
from lbm.rates import Rates
from lbm.rates_by_place import FASTER, RatesByPlace
from lbm.scales import Scales

__all__ = ["Average", "Checkpoint", "DivergenceGuard", "FieldOutput", "Observer", "Probe", "Sums", "checked"]


class Observer(Protocol):
    """Called with the flow whenever its count of steps is a multiple of ``every``, and at the start of a flow.

    It may look, not change: a run, ``set_flow`` and ``restore`` from within are refused.
    """

    every: int

    def __call__(self, flow: Flow) -> None:
        """Look at ``flow``."""


def checked(observers: Iterable[Observer]) -> list[Observer]:
    """``observers`` as a list; :class:`InputError` for what is no list or holds what cannot observe."""
    if not isinstance(observers, Iterable):
        raise InputError(f"observers = {arguments.shown(observers)}: give a list of observers, also of one")
    found = list(observers)
    for observer in found:
        if isinstance(observer, type) or not callable(observer) or not hasattr(observer, "every"):
            raise InputError(
                f"{arguments.shown(observer)}: no observer; give an object with ``every`` (steps) and a call"
            )
        arguments.count("every", observer.every, least=1)
    return found


_STABLE = 0.51
"""Relaxation time below which it, not the lattice speed, is what makes a flow diverge."""


@dataclass(frozen=True)
class DivergenceGuard:
    """Stops a run whose density or speed goes out of range or is NaN.

    It also warns, once a flow, of a grid Reynolds number (speed times cell over viscosity) beyond that at which
    the flow's rates were shown to be stable.

    Parameters
    ----------
    every : steps from one check to the next.
    density : lowest and highest allowed, over the rest density.
    top_speed : highest allowed, in cells a step.
    """

    every: int = 100
    density: tuple[float, float] = (0.5, 2.0)
    top_speed: float = 0.5

    def __post_init__(self) -> None:
        arguments.count("every", self.every, least=1)
        limits = arguments.array("density", self.density)
        if limits.shape != (2,) or not 0 <= limits[0] < limits[1]:
            raise InputError(f"density = {arguments.shown(self.density)}: give the lowest and the highest allowed")
        arguments.positive("top_speed", self.top_speed)

    def __call__(self, flow: Flow) -> None:
        """Raise :class:`lbm.errors.DivergenceError` naming step, cell and value."""
        sums = fields.plane_sums(flow.lattice, flow.force, self.density, self.top_speed)
        outside = sums[:, fields.SUMS.index("outside")]
        if not outside.any():
            _warn_of_grid_reynolds(flow, math.sqrt(sums[:, fields.SUMS.index("top_speed_squared")].max()))
            return
        rho, u = flow.fields()
        speed = np.sqrt(np.sum(u.astype(float) ** 2, axis=0))
        low, high = self.density
        bad_density = ~((rho >= low) & (rho <= high))
        bad = bad_density | ~(speed <= self.top_speed)
        cell = tuple(int(i) for i in np.argwhere(bad)[0])
        quantity, value = ("density", rho[cell]) if bad_density[cell] else ("speed", speed[cell])
        raise DivergenceError(
            flow.steps,
            cell,
            quantity,
            float(value),
            f" (allowed: density {low:g} to {high:g}, speed up to {self.top_speed:g}); take more cells"
            + (
                f": the relaxation time, {tau:.4f}, is close to 1/2"
                if (tau := 0.5 + 3 * flow.rates.viscosity) < _STABLE
                else ", or a lower lattice speed"
            ),
        )


def _warn_of_grid_reynolds(flow: Flow, speed: float) -> None:
    shown = _shown_stable(flow, flow.rates)
    nu = flow.rates.viscosity
    found = speed / nu
    if found > shown and not flow.warned_of_grid_reynolds:
        flow.warned_of_grid_reynolds = True
        better = next((f" or {n}" for n, made in FASTER.items() if _shown_stable(flow, made(nu)) >= found), "")
        warnings.warn(
            f"grid Reynolds number {found:.3g} by step {flow.steps} (speed {speed:.3g}, viscosity "
            f"{nu:.3g}): with these rates flows were shown to be stable up to {shown:g}; "
            f"take more cells{better}",
            OutsideRangeWarning,
            stacklevel=4,
        )


def _shown_stable(flow: Flow, rates: Rates | RatesByPlace) -> float:
    moving = any(isinstance(face, NoSlip) and face.moves for face in flow.faces)
    return min(
        rates.grid_reynolds_at_moving_walls if moving else rates.grid_reynolds,
        rates.grid_reynolds_at_bodies if flow.bodies else rates.grid_reynolds,
    )


@dataclass
class Sums:
    """Total mass, momentum and kinetic energy against time, in lattice units.

    Parameters
    ----------
    every : steps from one row to the next.

    Attributes
    ----------
    steps, rows : when, and mass, px, py, pz, energy then.

    Notes
    -----
    Mass is counted as excess over the fluid at rest, which keeps its round-off small.
    """

    every: int
    steps: list[int] = field(default_factory=list)
    rows: list[np.ndarray] = field(default_factory=list)

    def __post_init__(self) -> None:
        arguments.count("every", self.every, least=1)

    def __call__(self, flow: Flow) -> None:
        """Append one row."""
        sums = fields.plane_sums(flow.lattice, flow.force)
        self.steps.append(flow.steps)
        self.rows.append(np.array([math.fsum(column) for column in sums[:, :5].T]))


@dataclass
class Probe:
    """Density and velocity at one cell against time.

    Parameters
    ----------
    every : steps from one row to the next.
    cell : (i, j, k), from 0.

    Attributes
    ----------
    steps, rows : when, and rho, ux, uy, uz then.
    """

    every: int
    cell: tuple[int, int, int]
    steps: list[int] = field(default_factory=list)
    rows: list[tuple[float, ...]] = field(default_factory=list)

    def __post_init__(self) -> None:
        arguments.count("every", self.every, least=1)
        if isinstance(self.cell, str) or not isinstance(self.cell, Iterable) or len(tuple(self.cell)) != 3:
            raise InputError(f"cell = {arguments.shown(self.cell)}: give three whole numbers (i, j, k)")
        self.cell = tuple(arguments.count("cell", i) for i in self.cell)

    def __call__(self, flow: Flow) -> None:
        """Append one row."""
        if not all(0 <= i < n for i, n in zip(self.cell, flow.shape, strict=True)):
            raise InputError(f"probe cell {self.cell}: outside the grid {flow.shape}")
        rho, u = fields.read_cell(flow.lattice, self.cell, flow.force)
        self.steps.append(flow.steps)
        self.rows.append((rho, *u))


@dataclass
class Average:
    """Mean of density and velocity over the calls.

    Parameters
    ----------
    every : steps from one call to the next.

    Attributes
    ----------
    count : calls so far.
    density, velocity : (nx, ny, nz) and (3, nx, ny, nz), None before the first call.
    """

    every: int
    count: int = 0
    density: np.ndarray | None = None
    velocity: np.ndarray | None = None

    def __post_init__(self) -> None:
        arguments.count("every", self.every, least=1)

    def __call__(self, flow: Flow) -> None:
        """Take the present fields into the mean."""
        rho, u = (f.astype(float) for f in flow.fields())
        self.count += 1
        if self.density is None or self.velocity is None:
            self.density, self.velocity = rho, u
        else:
            self.density += (rho - self.density) / self.count
            self.velocity += (u - self.velocity) / self.count


@dataclass
class FieldOutput:
    """Writes ``directory/stem_STEP.vtkhdf`` for ParaView.

    Parameters
    ----------
    every : steps from one file to the next.
    directory, stem : where, and the beginning of the files' names.
    scales : to write in SI; None for lattice units.
    mirrors : axes such as "xy" at whose low faces, planes of symmetry, the other half is to be shown too.

    Attributes
    ----------
    written : paths of the files so far.

    Notes
    -----
    Cell data ``density``, ``velocity`` and ``pressure``, c_s^2 (rho - 1) over that of the fluid at rest; field
    data ``step`` and ``TimeValue``. The origin is the low corner of the box, with or without mirror images.
    """

    every: int
    directory: Path | str
    stem: str = "flow"
    scales: Scales | None = None
    mirrors: str = ""
    written: list[Path] = field(default_factory=list)

    def __post_init__(self) -> None:
        arguments.count("every", self.every, least=1)
        arguments.path("directory", self.directory)
        if not isinstance(self.stem, str) or not self.stem or "/" in self.stem or "\0" in self.stem:
            raise InputError(f"stem = {arguments.shown(self.stem)}: give the beginning of a file's name")
        if not isinstance(self.scales, Scales | None):
            raise InputError(
                f"scales = {arguments.shown(self.scales)}: give lbm.Scales, or None for lattice units"
            )
        if not isinstance(self.mirrors, str) or len(set(self.mirrors) & set(AXES)) != len(self.mirrors):
            raise InputError(f"mirrors = {arguments.shown(self.mirrors)}: give axes, such as 'xy'")

    def __call__(self, flow: Flow) -> None:
        """Write one file."""
        path = Path(self.directory) / f"{self.stem}_{flow.steps:08d}.vtkhdf"
        rho, u = flow.fields()
        scales = self.scales or Scales(1.0, 1.0)
        origin = np.zeros(3)
        for axis in map(AXES.index, self.mirrors):
            rho, u = fields.with_image(rho, axis), fields.with_image(u, axis)
            origin[axis] = -flow.shape[axis] * scales.cell_m
        written = {
            "density": scales.si(rho, "density"),
            "velocity": scales.si(u, "velocity"),
            "pressure": scales.si(CS2 * (rho - 1), "pressure"),
        }
        now = scales.si(float(flow.steps), "time")
        write_image(path, written, scales.cell_m, origin, step=flow.steps, TimeValue=now)
        self.written.append(path)


@dataclass
class Checkpoint:
    """Saves the flow to ``path``; only a complete file of a sound state replaces the previous one.

    Parameters
    ----------
    every : steps from one checkpoint to the next.
    path : of the file.
    guard : what must hold for the state to be saved; None saves unchecked.
    """

    every: int
    path: Path | str
    guard: DivergenceGuard | None = DivergenceGuard()

    def __post_init__(self) -> None:
        arguments.count("every", self.every, least=1)
        arguments.path("path", self.path)
        if not isinstance(self.guard, DivergenceGuard | None):
            raise InputError(
                f"guard = {arguments.shown(self.guard)}: give a DivergenceGuard, or None for no check"
            )

    def __call__(self, flow: Flow) -> None:
        """Check and save."""
        if self.guard is not None:
            self.guard(flow)
        flow.save(self.path)
