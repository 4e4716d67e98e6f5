"""Drag on an unbounded sphere in steady motion: C_D(Re), Re = v d/nu, the force being C_D rho_f v^2/2 pi d^2/4.

All tend to Stokes' 24/Re at small Re. What a wall adds is in the resistance laws, what acceleration adds in the
history laws. Where nobody chooses one it is :data:`STANDARD`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np

from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.laws.base import CheckValue, Law, Status

_FLUIDS = "public package 'fluids' 1.x, fluids.drag, evaluated independently"
_STANDARD = (
    "standard drag curve, Clift, Grace & Weber 1978 as in 'fluids'; tolerance is the difference of the fits"
)


@dataclass(frozen=True)
class DragLaw(Law):
    """The drag coefficient C_D as a function of Re = v d/nu."""

    family: ClassVar[str] = "drag"
    symbol: ClassVar[str] = "C_D"
    variables: ClassVar[tuple[str, ...]] = ("Re",)


@dataclass(frozen=True)
class Stokes1851(DragLaw):
    """C_D = 24/Re: creeping flow, F = 6 pi mu r v."""

    name: ClassVar = "stokes_1851"
    title: ClassVar = "Stokes' drag"
    formula: ClassVar = "24/Re"
    validity: ClassVar = (0.0, 0.5)
    validity_source: ClassVar = "within 10 % of the standard drag curve"
    reference: ClassVar = "Stokes, Trans. Camb. Philos. Soc. 9, 8 (1851)"
    status: ClassVar = Status.VERIFIED
    evidence: ClassVar = "exact solution of the Stokes equations"
    checks: ClassVar = (CheckValue({"Re": 0.1}, 240.0, 1e-9, "6 pi mu r v over rho v^2/2 pi r^2, by hand"),)


@dataclass(frozen=True)
class SchillerNaumann1935(DragLaw):
    """C_D = 24/Re (1 + 0.15 Re^0.687), and 0.44 where that is less (Re above about 1000)."""

    name: ClassVar = "schiller_naumann_1935"
    title: ClassVar = "Schiller & Naumann 1935"
    formula: ClassVar = "Max(24/Re*(1 + 0.15*Re**0.687), 0.44)"
    validity: ClassVar = (0.0, 2e5)
    validity_source: ClassVar = "up to the drag crisis; fitted below 800 to 1000, a constant above"
    reference: ClassVar = "Schiller & Naumann, Z. Ver. Deutsch. Ing. 77, 318 (1935)"
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in public codes (waLBerla, OpenFOAM); the paper was not opened"
    checks: ClassVar = (
        CheckValue({"Re": 1.0}, 27.6, 1e-9, "24 * 1.15, by hand"),
        CheckValue({"Re": 164.0}, 0.8519, 0.03, _STANDARD),
        CheckValue({"Re": 5e4}, 0.44, 1e-12, "the constant, by definition"),
    )


@dataclass(frozen=True)
class BrownLawler2003(DragLaw):
    """C_D = 24/Re (1 + 0.15 Re^0.681) + 0.407/(1 + 8710/Re): refit to data corrected for tank walls."""

    name: ClassVar = "brown_lawler_2003"
    title: ClassVar = "Brown & Lawler 2003"
    formula: ClassVar = "24/Re*(1 + 0.15*Re**0.681) + 0.407/(1 + 8710/Re)"
    validity: ClassVar = (0.0, 2e5)
    validity_source: ClassVar = "up to the drag crisis"
    reference: ClassVar = (
        "Brown & Lawler, J. Environ. Eng. 129, 222 (2003), doi:10.1061/(ASCE)0733-9372(2003)129:3(222)"
    )
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = (
        "widely quoted; the paper was not opened; within 3 % of the standard drag curve where checked"
    )
    checks: ClassVar = (
        CheckValue({"Re": 164.0}, 0.8519, 0.02, _STANDARD),
        CheckValue({"Re": 1000.0}, 0.4711, 0.01, _STANDARD),
        CheckValue({"Re": 5000.0}, 0.3873, 0.01, _STANDARD),
    )


@dataclass(frozen=True)
class CliftGraceWeber1978(DragLaw):
    """The recommended standard drag curve, piecewise in w = log10(Re), up to the drag crisis:

    24/Re + 3/16                               Re < 0.01
    24/Re (1 + 0.1315 Re^(0.82 - 0.05 w))      Re < 20
    24/Re (1 + 0.1935 Re^0.6305)               Re < 260
    10^(1.6435 - 1.1242 w + 0.1558 w^2)        Re < 1500
    10^(-2.4571 + 2.5558 w - 0.9295 w^2 + 0.1049 w^3)    Re < 1.2e4
    10^(-1.9181 + 0.6370 w - 0.0636 w^2)       Re < 4.4e4
    10^(-4.3390 + 1.5809 w - 0.1546 w^2)

    The pieces meet within 1 %, not exactly.
    """

    name: ClassVar = "clift_grace_weber_1978"
    title: ClassVar = "Clift, Grace & Weber 1978, standard drag curve"
    formula: ClassVar = (
        "Piecewise((24/Re + 3/16, Re < 0.01),"
        "(24/Re*(1 + 0.1315*Re**(0.82 - 0.05*log(Re, 10))), Re < 20),"
        "(24/Re*(1 + 0.1935*Re**0.6305), Re < 260),"
        "(10**(1.6435 - 1.1242*log(Re, 10) + 0.1558*log(Re, 10)**2), Re < 1500),"
        "(10**(-2.4571 + 2.5558*log(Re, 10) - 0.9295*log(Re, 10)**2 + 0.1049*log(Re, 10)**3), Re < 12000),"
        "(10**(-1.9181 + 0.6370*log(Re, 10) - 0.0636*log(Re, 10)**2), Re < 44000),"
        "(10**(-4.3390 + 1.5809*log(Re, 10) - 0.1546*log(Re, 10)**2), True))"
    )
    validity: ClassVar = (0.0, 3.38e5)
    validity_source: ClassVar = "up to the drag crisis; the pieces beyond it are left out"
    reference: ClassVar = "Clift, Grace & Weber, Bubbles, Drops, and Particles, Academic Press (1978), table 5.2"
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in the public package 'fluids', which cites it; the book was not opened"
    checks: ClassVar = tuple(
        CheckValue({"Re": Re}, C_D, 1e-9 * C_D, _FLUIDS)
        for Re, C_D in (
            (0.005, 4800.1875), (1.0, 27.156), (10.0, 4.258390576302238), (200.0, 0.7756342422322543),
            (1000.0, 0.4710857854203698), (5000.0, 0.3872751525869864), (2e4, 0.4417012958058001),
            (2e5, 0.49773277623027434),
        )
    )  # fmt: skip


@dataclass(frozen=True)
class Abraham1970(DragLaw):
    """C_D = 24/9.06^2 (1 + 9.06/sqrt(Re))^2: a boundary-layer argument; 7 % high at Re = 1.5."""

    name: ClassVar = "abraham_1970"
    title: ClassVar = "Abraham 1970"
    formula: ClassVar = "24/9.06**2*(1 + 9.06/sqrt(Re))**2"
    validity: ClassVar = (0.0, 5000.0)
    validity_source: ClassVar = "as commonly quoted"
    reference: ClassVar = "Abraham, Phys. Fluids 13, 2194 (1970)"
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = (
        "widely quoted; gives the terminal speeds that ten Cate et al. 2002 state for their fluids"
    )
    checks: ClassVar = (
        CheckValue({"Re": 1.5}, 20.58, 0.6, "ten Cate et al. 2002, Table I: the weight at the stated 0.038 m/s"),
        CheckValue({"Re": 11.6}, 3.90, 0.12, "ten Cate et al. 2002, Table I: the weight at the stated 0.091 m/s"),
    )


STANDARD = CliftGraceWeber1978
"""The drag where nobody chooses one: nearest to what Roos & Willmarth measured, at Re 5 to 1000 within their
scatter (:mod:`restitution.bounce.unbounded` has the comparison)."""


_GREATEST_RE = 1e6
"""From where on C_D is taken to be constant: the form of the laws drops to zero out there."""


def steady(law: DragLaw, weight: float, diameter: float, density: float, viscosity: float) -> float:
    """The speed in m/s at which the drag balances ``weight`` (gravity less buoyancy, N): the terminal speed."""
    from scipy.optimize import brentq

    def excess(log_v: float) -> float:
        v = np.exp(log_v)
        C_D = law(min(v * diameter * density / viscosity, _GREATEST_RE), out_of_range="ignore")
        return float(C_D * density * v**2 / 2 * np.pi * diameter**2 / 4 / weight - 1)

    stokes = np.log(weight / (3 * np.pi * viscosity * diameter))
    low = stokes - 20
    while excess(low) > 0:  # as in a fluid without any viscosity to speak of
        low -= 20
    return float(np.exp(brentq(excess, low, stokes + 1, xtol=1e-14, rtol=1e-14)))


def excess_weight(conditions: Conditions) -> float:
    """Gravity less buoyancy in N; raises :class:`InputError` for a sphere that does not sink."""
    ratio = conditions.sphere.density / conditions.fluid.density
    if not ratio > 1:
        raise InputError(
            Defect("is the density ratio sphere to fluid; only a sphere heavier than the fluid falls on the wall",
                   field="sphere.density / fluid.density", value=f"{ratio:g}")
        )  # fmt: skip
    volume = math.pi * conditions.sphere.diameter**3 / 6
    return (conditions.sphere.density - conditions.fluid.density) * volume * conditions.gravity


@lru_cache(maxsize=256)
def terminal_speed(conditions: Conditions, drag: DragLaw | None = None) -> float:
    """The steady speed in m/s far from walls at which ``drag`` balances gravity less buoyancy."""
    c = conditions
    return steady(drag or STANDARD(), excess_weight(c), c.sphere.diameter, c.fluid.density, c.fluid.viscosity)
