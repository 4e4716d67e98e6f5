"""The correlation of Legendre et al. for bouncing drops and spheres: exponential in 1/St."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Status, parameter
from restitution.laws.rebound import ReboundLaw

_REFERENCE = (
    "Legendre, Daniel & Guiraud, Phys. Fluids 17, 097105 (2005), doi:10.1063/1.2010527; "
    "Legendre, Zenit, Daniel & Guiraud, Chem. Eng. Sci. 61, 3543 (2006)"
)


def _beta() -> float:
    return parameter(
        35.0, (0.0, 400.0), "1", "decay constant", "Legendre et al. 2006, as implemented in public codes"
    )


@dataclass(frozen=True)
class Legendre2005(ReboundLaw):
    """e_eff = e_dry exp(-beta / St*), beta = 35, with the added mass in St*."""

    name: ClassVar = "legendre_2005"
    title: ClassVar = "Legendre et al. 2005/2006"
    formula: ClassVar = "e_dry*exp(-beta/St)"
    convention: ClassVar = "st_star"
    validity: ClassVar = (10.0, 1000.0)
    validity_source: ClassVar = "drops and solid spheres, St* of about 10 to above 1000"
    reference: ClassVar = _REFERENCE
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in public code (StokesWallMPPIC) with its README; the papers were not opened"
    checks: ClassVar = (
        CheckValue(
            {"St": 100.0, "e_dry": 1.0},
            0.70,
            0.005,
            "README of StokesWallMPPIC: exp(-35/St*), evaluated by hand",
        ),
        CheckValue({"St": 161.9, "e_dry": 0.97}, 0.781, 6e-4, "independent evaluation of exp(-35/161.9)"),
    )
    beta: float = _beta()


@dataclass(frozen=True)
class Legendre2006PlainSt(ReboundLaw):
    """e_eff = e_dry exp(-beta / St) with the same beta but St without added mass, as LIGGGHTS has it."""

    name: ClassVar = "legendre_2006_plain_st"
    title: ClassVar = "Legendre et al. read with St, as in LIGGGHTS"
    formula: ClassVar = "e_dry*exp(-beta/St)"
    convention: ClassVar = "st_b"
    validity: ClassVar = (10.0, 1000.0)
    validity_source: ClassVar = "as for legendre_2005"
    reference: ClassVar = _REFERENCE
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = (
        "read in LIGGGHTS normal_model_hooke.h, 'Empirical from Legendre (2006)'; its user sets the constant"
    )
    checks: ClassVar = (CheckValue({"St": 500.0, "e_dry": 1.0}, 0.932, 6e-4, "exp(-0.07), by hand"),)
    beta: float = _beta()
