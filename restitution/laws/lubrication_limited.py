"""Rebound limited by the lubrication film: laws linear in 1/St, with a Stokes number below which none occurs.

A sphere of speed v at the gap h0 that meets the film force -6 pi mu r^2 v/h slows as

    v(h) = v0 [1 - ln(h0/h)/St],

rebounds at h_min with e_dry v(h_min) and loses the same momentum again on its way out to h0, hence

    e_eff = e_dry - (1 + e_dry) ln(h0/h_min) / St,     St_c = (1 + e_dry) ln(h0/h_min) / e_dry.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Status, parameter
from restitution.laws.rebound import ReboundLaw
from restitution.stokes import Speed


@dataclass(frozen=True)
class TwoWayLubrication(ReboundLaw):
    """e_eff = max(0, e_dry - (1 + e_dry) ln(h0/h_min)/St); h0, h_min in sphere radii."""

    name: ClassVar = "two_way_lubrication"
    title: ClassVar = "Two-way lubrication"
    formula: ClassVar = "Max(0, e_dry - (1 + e_dry)*log(h0/h_min)/St)"
    speed: ClassVar = Speed.FAR
    validity: ClassVar = (10.0, 1000.0)
    validity_source: ClassVar = "inertia of the fluid outside the film is left out"
    reference: ClassVar = (
        "Momentum balance in this module; of the type of Barnocky & Davis, Phys. Fluids 31, 1324 (1988) and "
        "Yang & Hunt, Phil. Trans. R. Soc. A 366 (2008) (attribution of this exact form not checked)"
    )
    status: ClassVar = Status.DERIVED
    evidence: ClassVar = "derived in the module docstring"
    checks: ClassVar = (
        CheckValue(
            {"St": 78.6, "e_dry": 0.97}, 0.744, 6e-4, "independent evaluation of e - 9(1+e)/St",
            {"h0": 1.0, "h_min": 1.23409804e-4},
        ),
        CheckValue({"St": 18.7, "e_dry": 0.97}, 0.0, 6e-4, "threshold for h_min = 1e-4 r, independently"),
    )  # fmt: skip
    h0: float = parameter(
        1.0, (1e-3, 10.0), "r", "gap where the film begins to act", "order of the radius; a choice", chosen=True
    )
    h_min: float = parameter(
        1e-4,
        (1e-9, 1e-1),
        "r",
        "gap of closest approach",
        "roughness of Gondret's spheres, quoted by Biegert et al. 2017",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        self._ordered("h_min", "h0")


@dataclass(frozen=True)
class BarnockyDavis1988(ReboundLaw):
    """e_eff = max(0, e_dry (1 - St_c/St)): one parameter, the critical Stokes number."""

    name: ClassVar = "barnocky_davis_1988"
    title: ClassVar = "Barnocky & Davis 1988, critical Stokes number"
    formula: ClassVar = "Max(0, e_dry*(1 - St_c/St))"
    convention: ClassVar = "st_b"
    speed: ClassVar = Speed.FAR
    validity: ClassVar = (1.0, 1000.0)
    validity_source: ClassVar = "film-dominated impacts; no published range was read"
    reference: ClassVar = (
        "Barnocky & Davis, Phys. Fluids 31, 1324 (1988), doi:10.1063/1.866725; "
        "Davis, Rager & Good, J. Fluid Mech. 468, 107 (2002)"
    )
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = "form quoted from the literature; only the abstract of the 2002 paper was read"
    checks: ClassVar = (CheckValue({"St": 40.0, "e_dry": 0.96}, 0.72, 1e-12, "0.96 * 3/4, by hand"),)
    St_c: float = parameter(
        10.0,
        (0.0, 100.0),
        "1",
        "critical Stokes number",
        "no rebound below about 10: Joseph et al. 2001, abstract",
    )
