"""The dimensionless numbers of a case, in every convention of the Stokes number.

With the speed v that the case refers to, excess weight and terminal speed u_t of the default drag law::

    Re = rho_f v d/mu,   s = rho_p/rho_f,   Ga = sqrt((s - 1) g d) d rho_f/mu,   Ar = Ga^2,   t* = t sqrt(g/d)

The impact speed of a run is a result, somewhat below the speed of a drive; so are Re and St at impact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.cases.case import Case
from restitution.laws.drag import terminal_speed
from restitution.stokes import CONVENTIONS


@dataclass(frozen=True)
class Numbers:
    """Of one case; ``speed`` in m/s is that of Re and ``stokes``, by convention; ``time_unit`` sqrt(d/g) in s."""

    speed: float
    of_what: str
    reynolds: float
    stokes: dict[str, float]
    density_ratio: float
    galileo: float
    archimedes: float
    terminal_speed: float
    terminal_reynolds: float
    time_unit: float


def numbers_of(case: Case) -> Numbers:
    """The numbers at the speed the case refers to, or, where it names none, at the terminal speed."""
    conditions, d = case.conditions, case.sphere.diameter
    viscosity, ratio = case.fluid.viscosity / case.fluid.density, case.sphere.density / case.fluid.density
    terminal = terminal_speed(conditions)
    given = case.reference_speed
    speed, of_what = (terminal, "terminal speed") if given is None else (given, "reference speed")
    if given is not None and given == case.release.speed:
        of_what = "speed of the drive"
    archimedes = (ratio - 1) * case.gravity * d**3 / viscosity**2
    return Numbers(
        speed=speed,
        of_what=of_what,
        reynolds=speed * d / viscosity,
        stokes={key: speed * c.per_speed(conditions) for key, c in CONVENTIONS.items()},
        density_ratio=ratio,
        galileo=math.sqrt(archimedes),
        archimedes=archimedes,
        terminal_speed=terminal,
        terminal_reynolds=terminal * d / viscosity,
        time_unit=math.sqrt(d / case.gravity),
    )
