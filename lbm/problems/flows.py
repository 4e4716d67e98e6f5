"""Flows with exact solutions of the Navier-Stokes equations, for verification and as examples.

Each problem is set up at any number of cells N across its length by diffusive scaling: viscosity in lattice
units fixed, velocity proportional to 1/N, time to N^2, so that the compressibility error (of order Ma^2)
falls as the discretisation error does, as 1/N^2. A problem starts from its exact solution.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lbm.bodies.fixed_body import FixedBody
from lbm.faces.records import Inlet, NoSlip, Outlet
from lbm.fluid.stencil import C, Q
from lbm.rates import Rates
from lbm.simulation import Simulation

__all__ = ["PROBLEMS", "Case", "Problem", "measured_viscosity", "observed_order"]

_THIN = 4  # cells along an axis on which nothing depends
_SPEED_AT_16 = 0.02  # lattice speed at 16 cells

Preset = Callable[[float], Rates]


@dataclass(frozen=True)
class Case:
    """A problem at one resolution: run ``simulation`` for ``steps``, compare with ``exact(step)``."""

    simulation: Simulation
    steps: int
    exact: Callable[[float], np.ndarray]
    fluid: np.ndarray | None = None
    """Where there is fluid, if not everywhere."""

    def error(self) -> float:
        """Relative L2 error of the velocity at the present step."""
        u, v = self.simulation.velocity.astype(float), self.exact(self.simulation.steps)
        if self.fluid is not None:
            u, v = u[:, self.fluid], v[:, self.fluid]
        return float(np.sqrt(np.sum((u - v) ** 2) / np.sum(v**2)))


@dataclass(frozen=True)
class Problem:
    """``case(cells, preset, dtype)`` sets the flow up; ``viscosity`` in lattice units."""

    name: str
    solution: str
    viscosity: float
    build: Callable[..., Case]

    def case(self, cells: int, preset: Preset = Rates.two_relaxation_times, dtype=np.float64, **options) -> Case:
        """The flow at ``cells`` across its length."""
        return self.build(cells, preset(self.viscosity), dtype, self.viscosity, **options)


def _speed(cells: int) -> float:
    return _SPEED_AT_16 * 16 / cells


def _centres(n: int) -> np.ndarray:
    return np.arange(n) + 0.5


def _along(profile: np.ndarray, axis: int, direction: int, shape: tuple[int, int, int]) -> np.ndarray:
    """Velocity field in ``direction`` whose values vary along ``axis`` only."""
    field = np.zeros((3, *shape))
    field[direction] = profile.reshape([-1 if a == axis else 1 for a in range(3)])
    return field


def _thin(cells: int, axis: int) -> tuple[int, int, int]:
    return tuple(cells if a == axis else _THIN for a in range(3))


def _unit(direction: int, value: float) -> tuple[float, float, float]:
    return tuple(value if a == direction else 0.0 for a in range(3))


def _taylor_green(n, rates, dtype, nu, axis=2) -> Case:
    """Vortices in the plane normal to ``axis``."""
    u0, k = _speed(n), 2 * np.pi / n
    a, b = [other for other in range(3) if other != axis]
    shape = tuple(_THIN if d == axis else n for d in range(3))
    grid = np.meshgrid(*(k * _centres(m) for m in shape), indexing="ij")
    flow = np.zeros((3, *shape))
    flow[a] = u0 * np.cos(grid[a]) * np.sin(grid[b])
    flow[b] = -u0 * np.sin(grid[a]) * np.cos(grid[b])
    density = 1 - 0.75 * u0**2 * (np.cos(2 * grid[a]) + np.cos(2 * grid[b]))
    simulation = Simulation(shape, rates, dtype=dtype)
    simulation.set_flow(density, flow)
    return Case(simulation, round(0.5 / (2 * nu * k * k)), lambda t: flow * np.exp(-2 * nu * k * k * t))


def _shear_wave(n, rates, dtype, nu, axis=1, direction=0) -> Case:
    """Velocity in ``direction`` varying as a sine along ``axis``."""
    k = 2 * np.pi / n
    shape = _thin(n, axis)
    flow = _along(_speed(n) * np.sin(k * _centres(n)), axis, direction, shape)
    simulation = Simulation(shape, rates, dtype=dtype)
    simulation.set_flow(1.0, flow)
    return Case(simulation, round(0.5 / (nu * k * k)), lambda t: flow * np.exp(-nu * k * k * t))


def _poiseuille(n, rates, dtype, nu, axis=2, direction=0) -> Case:
    u0, y = _speed(n), _centres(n)
    shape = _thin(n, axis)
    flow = _along(4 * u0 * y * (n - y) / n**2, axis, direction, shape)
    simulation = Simulation(
        shape, rates, faces={"xyz"[axis]: "no-slip"}, force=_unit(direction, 8 * nu * u0 / n**2), dtype=dtype
    )
    simulation.set_flow(1.0, flow)
    return Case(simulation, round(1.0 * n * n / nu), lambda t: flow)


def _couette(n, rates, dtype, nu, axis=2, direction=0) -> Case:
    u0 = _speed(n)
    shape = _thin(n, axis)
    flow = _along(u0 * _centres(n) / n, axis, direction, shape)
    name = "xyz"[axis]
    walls = {name + "-": NoSlip(), name + "+": NoSlip(_unit(direction, u0))}
    simulation = Simulation(shape, rates, faces=walls, dtype=dtype)
    return Case(simulation, round(1.5 * n * n / nu), lambda t: flow)


def _oscillating_wall(n, rates, dtype, nu, axis=2, direction=0, womersley=3.0) -> Case:
    """Wall at 0 oscillating in its plane, wall at n at rest; ``womersley`` = n sqrt(omega/nu)."""
    u0, y = _speed(n), _centres(n)
    omega = womersley**2 * nu / n**2
    root = np.sqrt(1j * omega / nu)
    shape = _thin(n, axis)

    def exact(t: float) -> np.ndarray:
        profile = np.real(u0 * np.exp(1j * omega * t) * np.sinh(root * (n - y)) / np.sinh(root * n))
        return _along(profile, axis, direction, shape)

    name = "xyz"[axis]
    wall = NoSlip(lambda t: _unit(direction, u0 * np.cos(omega * t)))
    simulation = Simulation(shape, rates, faces={name + "-": wall, name + "+": NoSlip()}, dtype=dtype)
    simulation.set_flow(1.0, exact(0))
    return Case(simulation, round(2 * np.pi / omega * 1.1), exact)


def _womersley(n, rates, dtype, nu, axis=2, direction=0, womersley=3.0) -> Case:
    """Force oscillating between walls at rest; ``womersley`` = n sqrt(omega/nu)."""
    u0, y = _speed(n), _centres(n)
    omega = womersley**2 * nu / n**2
    root = np.sqrt(1j * omega / nu)
    amplitude = u0 * omega
    shape = _thin(n, axis)

    def exact(t: float) -> np.ndarray:
        shape_of_y = 1 - np.cosh(root * (y - n / 2)) / np.cosh(root * n / 2)
        return _along(
            np.real(amplitude / (1j * omega) * np.exp(1j * omega * t) * shape_of_y), axis, direction, shape
        )

    def force(t: float) -> tuple[float, float, float]:
        return _unit(direction, amplitude * np.cos(omega * t))

    simulation = Simulation(shape, rates, faces={"xyz"[axis]: "no-slip"}, force=force, dtype=dtype)
    simulation.set_flow(1.0, exact(0))
    return Case(simulation, round(2 * np.pi / omega * 1.1), exact)


def _entering_poiseuille(n, rates, dtype, nu, axis=2, direction=0) -> Case:
    """Between still walls normal to ``axis``: a parabola at the inlet, density 1 at the outlet 2 n further on."""
    u0, y = _speed(n), _centres(n)
    shape = tuple({axis: n, direction: 2 * n}.get(a, _THIN) for a in range(3))
    flow = _along(4 * u0 * y * (n - y) / n**2, axis, direction, shape)
    entering = np.moveaxis(flow, 0, -1).take(0, direction)
    drop = 3 * 8 * nu * u0 / n**2  # of density, per cell
    upstream = _along(drop * (2 * n - _centres(2 * n)), direction, 0, shape)[0]
    own = "xyz"[direction]
    faces = {own + "-": Inlet(entering), own + "+": Outlet(), "xyz"[axis]: "no-slip"}
    simulation = Simulation(shape, rates, faces=faces, dtype=dtype)
    simulation.set_flow(1 + upstream, flow)
    return Case(simulation, round(0.5 * n * n / nu), lambda t: flow)


def _entering_couette(n, rates, dtype, nu, axis=2, direction=0) -> Case:
    """Between a still and a moving wall: a linear profile at the inlet, an outlet 2 n further on."""
    u0 = _speed(n)
    shape = tuple({axis: n, direction: 2 * n}.get(a, _THIN) for a in range(3))
    flow = _along(u0 * _centres(n) / n, axis, direction, shape)
    own, across = "xyz"[direction], "xyz"[axis]
    faces = {
        own + "-": Inlet(np.moveaxis(flow, 0, -1).take(0, direction)),
        own + "+": Outlet(),
        across + "-": NoSlip(),
        across + "+": NoSlip(_unit(direction, u0)),
    }
    simulation = Simulation(shape, rates, faces=faces, dtype=dtype)
    simulation.set_flow(1.0, flow)
    return Case(simulation, round(0.5 * n * n / nu), lambda t: flow)


def _duct(n, rates, dtype, nu, direction=0) -> Case:
    """Square duct along ``direction``."""
    a, b = [d for d in range(3) if d != direction]
    s = 2 * _centres(n) / n - 1  # -1 to 1 from wall to wall
    m = np.arange(1, 200, 2)[:, None]
    # cosh(m pi s/2) / cosh(m pi/2), written with decaying exponentials, which do not overflow
    cosh_ratio = np.exp(-m * np.pi / 2 * (1 - np.abs(s))) + np.exp(-m * np.pi / 2 * (1 + np.abs(s)))
    cosh_ratio /= 1 + np.exp(-m * np.pi)
    waves = (-1.0) ** ((m - 1) // 2) * np.cos(m * np.pi / 2 * s) / m**3
    section = np.einsum("mi,mj->ij", waves, 1 - cosh_ratio)
    top = _speed(n)
    scale = top / section.max()
    section = section * scale
    # -grad p: u = (16 G h^2 / (nu pi^3)) * sum, with h the half width
    force = scale * nu * np.pi**3 / (16 * (n / 2) ** 2)
    shape = tuple(_THIN if d == direction else n for d in range(3))
    flow = np.zeros((3, *shape))
    flow[direction] = np.expand_dims(section, direction)
    walls = {"xyz"[a]: "no-slip", "xyz"[b]: "no-slip"}
    simulation = Simulation(shape, rates, faces=walls, force=_unit(direction, force), dtype=dtype)
    simulation.set_flow(1.0, flow)
    return Case(simulation, round(0.5 * n * n / nu), lambda t: flow)


def _inclined_poiseuille(n, rates, dtype, nu) -> Case:
    """Channel along (2, 1, 0) between plane walls that cut the cells; n cells across, along its normal."""
    length = round(n * np.sqrt(5) / 2 / 0.7)  # the channel takes 0.7 of the box, the rest is wall
    shape = (2 * length, length, _THIN)
    x, y, _ = np.meshgrid(*(_centres(m) for m in shape), indexing="ij")
    # 2 y - x is constant along the channel and periodic with 2 length; walls at irrational places
    period, low = 2.0 * length, np.sqrt(2) - 1
    high = low + 0.7 * period
    level = np.mod(2 * y - x - low, period) + low
    solid = level > high
    fraction = np.zeros((Q, *shape))
    for k in range(1, Q):
        rise = 2 * C[k, 1] - C[k, 0]
        if rise != 0:
            fraction[k] = ((high if rise > 0 else low) - level) / rise
    width, distance = (high - low) / np.sqrt(5), (level - low) / np.sqrt(5)
    top, along = _speed(n), np.array([2.0, 1.0, 0.0]) / np.sqrt(5)
    profile = np.where(solid, 0.0, 4 * top * distance * (width - distance) / width**2)
    flow = along.reshape(3, 1, 1, 1) * profile
    simulation = Simulation(shape, rates, force=tuple(8 * nu * top / width**2 * along), dtype=dtype)
    simulation.add(FixedBody(solid, fraction))
    simulation.set_flow(1.0, flow)
    return Case(simulation, round(0.5 * n * n / nu), lambda t: flow, ~solid)


def measured_viscosity(name: str, cells: int, preset: Preset = Rates.two_relaxation_times, **options) -> float:
    """Viscosity of a decaying flow over the one set, from its energy between a third of the run and its end."""
    problem = PROBLEMS[name]
    case = problem.case(cells, preset, **options)
    k2 = (2 * np.pi / cells) ** 2 * (2 if name == "taylor-green" else 1)
    first = case.steps // 3
    case.simulation.run(first)
    early = np.sum(case.simulation.velocity**2)
    case.simulation.run(case.steps - first)
    late = np.sum(case.simulation.velocity**2)
    return float(np.log(early / late) / (2 * k2 * (case.steps - first)) / problem.viscosity)


def observed_order(name: str, coarse: int, preset: Preset = Rates.two_relaxation_times, **options) -> float:
    """Order in space: log2 of the error at ``coarse`` cells over that at twice as many."""
    errors = []
    for cells in (coarse, 2 * coarse):
        case = PROBLEMS[name].case(cells, preset, **options)
        case.simulation.run(case.steps)
        errors.append(case.error())
    return float(np.log2(errors[0] / errors[1]))


_WHITE = "White, Viscous Fluid Flow, 3rd ed. (2006)"

PROBLEMS = {
    problem.name: problem
    for problem in (
        Problem("taylor-green", "Taylor & Green, Proc. R. Soc. A 158 (1937) 499", 0.05, _taylor_green),
        Problem("shear-wave", "u exp(-nu k^2 t) solves the Navier-Stokes equations", 0.05, _shear_wave),
        Problem("poiseuille", f"{_WHITE}, sec. 3-3", 0.05, _poiseuille),
        Problem("inclined-poiseuille", f"{_WHITE}, sec. 3-3", 0.05, _inclined_poiseuille),
        Problem("couette", f"{_WHITE}, sec. 3-2", 0.05, _couette),
        Problem("entering-poiseuille", f"{_WHITE}, sec. 3-3", 0.05, _entering_poiseuille),
        Problem("entering-couette", f"{_WHITE}, sec. 3-2", 0.05, _entering_couette),
        Problem(
            "oscillating-wall",
            f"Stokes' second problem in a gap; {_WHITE}, sec. 3-5",
            0.05,
            _oscillating_wall,
        ),
        Problem("womersley", "plane form of Womersley, J. Physiol. 127 (1955) 553", 0.05, _womersley),
        Problem("square-duct", f"{_WHITE}, Eq. (3-48)", 0.05, _duct),
    )
}
"""All problems by name."""
