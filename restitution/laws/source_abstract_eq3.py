"""Equation (3) of the source abstract: the lubrication force with the approach speed varying across the film.

Of the printed equation the list of symbols survives (particle radius, v_p(Delta_0), v_p(h), critical distance
Delta_0, distance h), the range ("less than about 2 lattice units") and the remark that the change of the
velocity during the approach is considered. The first-ranked reading, the only simple one that uses all five
symbols (about 85 %, by judgement), is

    F = -6 pi mu r^2 [ v(h)/h - v(D0)/D0 ]   for h < D0,   0 beyond:

the film's full force at the present speed, less the part, frozen at onset, that the grid resolves. Taken
literally it fails in three places, mended here:

- once v(h) < v(D0) h/D0 it would drive the sphere to the wall: the force is held dissipative, F v <= 0;
- on the way out v(D0) is not known yet: v(D0) := v(h), the classical difference (``nguyen_ladd_2002``);
- at contact it diverges: 1/h stays constant below a smallest gap.

For St of 27 and more it cannot be told from the classical difference by a measurement: the speeds at contact
differ by less than 0.1 %, and by 1 % at St = 10. A run that imposes e_eff(St) at contact must not add this
force on the way out as well, or the viscous loss is counted twice.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from restitution.laws.base import CheckValue, Status, parameter
from restitution.laws.resistance import ResistanceLaw


@dataclass(frozen=True)
class Eq3VelocityDifference(ResistanceLaw):
    """lambda = max(0, 1/max(eps, eps_min) - v_ratio/eps_c) for eps < eps_c, 0 beyond; v_ratio = v(D0)/v(h).

    F = -6 pi mu r v(h) lambda. ``v_ratio`` is 1 on the way out.
    """

    name: ClassVar = "eq3_velocity_difference"
    title: ClassVar = "Eq. (3), difference with the speed at onset"
    variables: ClassVar = ("eps", "v_ratio")
    formula: ClassVar = "Piecewise((Max(0, 1/Max(eps, eps_min) - v_ratio/eps_c), eps < eps_c), (0, True))"
    reference: ClassVar = (
        "Source abstract, Eq. (3), surviving in part (extended abstract on lubrication correction and effective "
        "restitution in lattice-Boltzmann simulation; authors and venue not identified)"
    )
    status: ClassVar = Status.RECONSTRUCTED
    evidence: ClassVar = "rank 1 of three readings; the dissipative clamp and the smallest gap are additions"
    checks: ClassVar = (
        CheckValue(
            {"eps": 0.1, "v_ratio": 1.0}, 11.4592 - 3.73562, 0.23,
            "Brenner 1961, tabulated values; a difference of 1/eps is known to be 2.9 % low there",
        ),
        CheckValue({"eps": 0.1, "v_ratio": 4.0}, 0.0, 1e-12, "v(h)/h = v(D0)/D0 there: no force, by hand"),
    )  # fmt: skip
    eps_c: float = parameter(
        0.4,
        (1e-4, 10.0),
        "r",
        "gap D0 below which the force acts",
        "about two cells at five a radius, the set-up of the source abstract",
    )
    eps_min: float = parameter(
        1e-4,
        (0.0, 0.1),
        "r",
        "gap below which 1/eps stays constant",
        "roughness of Gondret's spheres, quoted by Biegert et al. 2017",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        self._ordered("eps_min", "eps_c")


def lubrication_force(
    gap: Any, v: Any, v_onset: Any = None, *, r: float, mu: float, D0: float, h_min: float
) -> Any:
    """Eq. (3) in SI, for a solver to call: force in N along the axis in which ``v`` counts.

    ``gap`` in m, at contact and below (overlap) it acts as ``h_min``; ``v`` the speed normal to the wall, m/s,
    positive on approach; ``v_onset`` the speed with which the sphere passed the gap ``D0``, None or NaN where
    it has not yet, and disregarded when it has the other sign (the sphere has rebounded since). ``r``, ``D0``,
    ``h_min`` in m, ``mu`` in Pa s. Arrays broadcast. The force never has the sign of ``v``; a positive
    approach speed gives a negative force, away from the wall.
    """
    gap, v = np.asarray(gap, float), np.asarray(v, float)
    v_onset = v if v_onset is None else np.asarray(v_onset, float)
    v_onset = np.where(v * v_onset > 0, v_onset, v)  # also where v_onset is NaN
    resisted = np.sign(v) * np.maximum(0.0, np.abs(v) / np.maximum(gap, h_min) - np.abs(v_onset) / D0)
    return np.where(gap < D0, -6 * np.pi * mu * r**2 * resisted, 0.0)[()]
