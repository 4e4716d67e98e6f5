"""The film of a rebound: pulled apart, it holds no more tension than the liquid bears, and cavitates.

Reynolds' pressure between a sphere and a wall that part at v is -3 mu r v/H^2 with H = h + s^2/(2 r) at the
distance s from the axis. Cut at the tension p_c it gives, with H_c = sqrt(3 mu r v/p_c),

    F = 2 pi r [p_c (H_c - h) + p_c H_c]   for h < H_c,     6 pi mu r^2 v/h   beyond,

which stays finite at contact. That liquids cavitate here while the sphere rebounds, not while it arrives, was
seen by Marston et al. (2011) and Mansoor et al. (2014). p_c is about the ambient pressure where bubbles have
nuclei; clean liquids bear more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Status
from restitution.laws.resistance import ResistanceLaw

ATMOSPHERE = 101_325.0
"""Tension in Pa at which a film under ambient pressure reaches zero absolute pressure."""
_QUADRATURE = "2/eta^2 times the integral of min(1, eta^2/H^2) over H from eps, in closed form by hand"


@dataclass(frozen=True)
class CavitatingFilm(ResistanceLaw):
    """lambda = 1/eps for eps >= eta, (2 - eps/eta)/eta below; eta = H_c/r = sqrt(3 mu v/(p_c r))."""

    name: ClassVar = "cavitating_film"
    title: ClassVar = "Film that cavitates on rebound"
    motion: ClassVar = "away from a wall"
    variables: ClassVar = ("eps", "eta")
    formula: ClassVar = "Piecewise(((2 - eps/eta)/eta, eps < eta), (1/eps, True))"
    validity: ClassVar = (0.0, 0.031)
    validity_source: ClassVar = "that of 1/eps"
    reference: ClassVar = (
        "derived here; cavitation on rebound: Marston et al., Exp. Fluids 50, 729 (2011), "
        "doi:10.1007/s00348-010-0979-9; Mansoor et al., Exp. Fluids 55, 1648 (2014)"
    )
    status: ClassVar = Status.DERIVED
    evidence: ClassVar = "Reynolds' pressure cut at a tension; that it cavitates is read in the papers' abstracts"
    checks: ClassVar = (
        CheckValue({"eps": 0.001, "eta": 0.01}, 190.0, 1e-9, _QUADRATURE),
        CheckValue({"eps": 0.02, "eta": 0.01}, 50.0, 1e-9, "1/eps where the film holds"),
    )


def film_edge(mu: float, v: float, r: float, p_c: float = ATMOSPHERE) -> float:
    """eta = sqrt(3 mu v/(p_c r)): gap in radii below which a film that parts at v cavitates; SI."""
    return (3 * mu * abs(v) / (p_c * r)) ** 0.5
