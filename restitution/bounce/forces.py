"""The closures under given conditions as the numbers and tables that the compiled kernel reads."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache, lru_cache

import numpy as np

from restitution.bounce import history
from restitution.bounce.added_mass import added_mass, added_mass_slope
from restitution.bounce.closures import Closures
from restitution.bounce.kernel import Forces
from restitution.bounce.tables import Table, constant, scaled, tabulate
from restitution.conditions import Conditions
from restitution.laws.cavitation import film_edge
from restitution.laws.drag import DragLaw, excess_weight, terminal_speed
from restitution.laws.history import FiniteReynolds, HistoryLaw
from restitution.laws.resistance import ResistanceLaw

GREATEST_RE = 2e5
"""Beyond the drag crisis no drag law here holds; a sphere in a liquid tank is far below."""
_LN_RE = (-14.0, 13.0, 0.1)


@cache
def drag_table(law: DragLaw | None) -> Table:
    """C_D Re/24 against Re; error below 1e-6 for smooth laws, next to the kinks of piecewise ones 1e-2."""
    if law is None:
        return constant(0.0)

    def factor(Re: np.ndarray) -> np.ndarray:
        return law(Re, out_of_range="ignore") * Re / 24

    def slope(Re: np.ndarray) -> np.ndarray:
        return factor(Re) + law.derivative(Re, out_of_range="ignore") * Re**2 / 24

    return tabulate(factor, 1e-8, 1e7, 0.05, slope)


@cache
def wall_table(law: ResistanceLaw | None) -> Table:
    """eps (lambda - 1) against eps, relative error below 1e-7."""
    if law is None:
        return constant(0.0)

    def excess(eps: np.ndarray) -> np.ndarray:
        return eps * (law(eps, out_of_range="ignore") - 1)

    def slope(eps: np.ndarray) -> np.ndarray:
        return excess(eps) + eps**2 * law.derivative(eps, out_of_range="ignore")

    return tabulate(excess, 1e-8, 1e4, 0.05, slope)


@cache
def added_mass_table(kind: str | None) -> Table:
    """C_M against eps, error below 1e-8."""
    if kind == "wall":
        return tabulate(added_mass, 1e-9, 1e3, 0.05, lambda eps: eps * added_mass_slope(eps))
    return constant(0.5 if kind == "free" else 0.0)


@lru_cache(maxsize=64)
def _force_numbers(conditions: Conditions, closures: Closures, end: float) -> Forces:
    c, fluid, sphere = conditions, conditions.fluid, conditions.sphere
    r, nu = sphere.radius, fluid.viscosity / fluid.density
    stokes = 6 * math.pi * fluid.viscosity * r
    free_fall = math.sqrt(c.gravity * sphere.diameter)
    terms = history.modes(r, nu, slowest=0.01 / end, fastest=1e6 * free_fall / r)
    share, slope = _memory(closures.history, r, nu, 0.01 / end, 1e6 * free_fall / r)
    on = closures.history is not None
    memory = stokes * closures.history_factor if on else 0.0
    keep = slice(None) if on else slice(0)
    return Forces(
        mass=sphere.mass,
        tail=memory * terms.tail * history.BASSET,
        fluid_mass=fluid.density * math.pi * sphere.diameter**3 / 6,
        weight=excess_weight(c),
        radius=r,
        stokes=stokes,
        history=memory,
        reynolds_per_speed=sphere.diameter / nu,
        floor=closures.contact_gap(c) if closures.lubrication else closures.film * sphere.diameter,
        drag=scaled(drag_table(closures.drag), closures.drag_factor),
        wall=wall_table(closures.wall),
        tear=film_edge(fluid.viscosity, 1.0, r, closures.tension) ** 2 if closures.wall is not None else 0.0,
        added_mass=added_mass_table(closures.added_mass),
        memory=np.ascontiguousarray(share[:, keep]),
        memory_slope=np.ascontiguousarray(slope[:, keep]),
        memory_start=_LN_RE[0],
        memory_per_step=1 / _LN_RE[2],
        rates=terms.rates[keep],
        weights=terms.weights[keep],
    )


@lru_cache(maxsize=64)
def _memory(
    law: HistoryLaw | None, r: float, nu: float, slowest: float, fastest: float
) -> tuple[np.ndarray, np.ndarray]:
    """G of every term and its slope, on the grid of ln(Re)."""
    terms, ln_Re = history.modes(r, nu, slowest, fastest), np.arange(*_LN_RE)
    if not isinstance(law, FiniteReynolds):
        return np.full((len(ln_Re), len(terms.rates)), history.BASSET), np.zeros((len(ln_Re), len(terms.rates)))
    ln_beta = np.log(terms.rates) + np.log(law.crossover(np.exp(ln_Re)) * r**2 / nu)[:, None]
    share = history.shape(ln_beta, law.c_1)
    return share, np.gradient(share, _LN_RE[2], axis=0, edge_order=2)


def forces(conditions: Conditions, closures: Closures, end: float) -> Forces:
    """What the kernel reads for flights that last up to ``end`` seconds."""
    return _force_numbers(conditions, _in_flight(closures), end)


def _in_flight(closures: Closures) -> Closures:
    """The closures without the numbers of the contact, on which no force depends: a search for e varies those."""
    given = () if closures.black_box else None
    return replace(closures, rebound=None, measured=given, e_dry=None, wake=None)


def expected_reynolds(conditions: Conditions, speed: float) -> float:
    """The greatest Re to be expected: of the release or of the terminal speed."""
    fastest = max(abs(speed), terminal_speed(conditions))
    return fastest * conditions.sphere.diameter * conditions.fluid.density / conditions.fluid.viscosity
