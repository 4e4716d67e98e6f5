"""Resistance between two spheres near contact; eps = gap/r_1, forces in units of 6 pi mu r_1 v.

Along the line of centres the force on sphere 1 is

    F_1 = -6 pi mu r_1 [ self(eps) v_1 - cross(eps) v_2 ],

self being X^A_11 and cross -X^A_12 (Jeffrey & Onishi 1984, who scale the latter by the mean radius instead).
Both diverge alike, so spheres that move together feel a finite force. ``kappa`` = r_2/r_1; kappa -> infinity
is the wall. The reference is a table of the resistance functions computed by others (A. K. Townsend's
Stokesian-dynamics code: series beyond a gap of 0.025 mean radii, near-contact forms below), against which the
errors stated here were found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Status
from restitution.laws.resistance import ResistanceLaw, Scale

_JEFFREY_ONISHI = (
    "Jeffrey & Onishi, J. Fluid Mech. 139, 261 (1984), doi:10.1017/S0022112084000355; for equal spheres also "
    "Dance & Maxey, J. Comput. Phys. 189, 212 (2003)"
)
_TABLE = "resistance table of A. K. Townsend's Stokesian-dynamics code; tolerance is the error stated for the law"
_EVIDENCE = (
    "logarithms read in public code (Grains3D), constants those that a public test prints from Jeffrey & Onishi; "
    "compared with the table of Townsend"
)
_WITHIN_5 = "within 5 % of the table"


@dataclass(frozen=True)
class Taylor1925Pair(ResistanceLaw):
    """lambda = [kappa/(1 + kappa)]^2/eps, i.e. F = -6 pi mu r*^2 v/h with r* = r_1 r_2/(r_1 + r_2).

    For equal spheres below the table's self-resistance by 1 % at eps = 0.001, 7.5 % at 0.01; the smaller the
    other sphere, the smaller the gap it needs.
    """

    name: ClassVar = "taylor_1925_pair"
    title: ClassVar = "Taylor's lubrication force between two spheres"
    motion: ClassVar = "two spheres, along the line of centres"
    variables: ClassVar = ("eps", "kappa")
    formula: ClassVar = "(kappa/(1 + kappa))**2/eps"
    validity: ClassVar = (0.0, 0.006)
    validity_source: ClassVar = "within 5 % of the table for equal spheres"
    reference: ClassVar = "Taylor, as in taylor_1925; size ratio as in Simeonov & Calantoni, IJMF 46, 38 (2012)"
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in public code (waLBerla) and documentation (Lethe)"
    checks: ClassVar = (
        CheckValue({"eps": 1e-5, "kappa": 1.0}, 25003.5858, 4.0, _TABLE),
        CheckValue({"eps": 5.5e-6, "kappa": 0.1}, 1503.96517, 1.5, _TABLE),
    )


@dataclass(frozen=True)
class JeffreyOnishi1984Lubrication(ResistanceLaw):
    """The diverging part of the resistance along the line of centres, for any size ratio kappa:

    lambda = kappa^2/(1+kappa)^2 /eps - kappa (1 + 7 kappa + kappa^2)/[5 (1+kappa)^3] ln(eps)
             - (1 + 18 kappa - 29 kappa^2 + 18 kappa^3 + kappa^4)/[21 (1+kappa)^4] eps ln(eps).

    The same for self and cross. What is left out is a constant, which a flow solver or a Stokesian-dynamics
    far field supplies: 0.995, 1.024, 1.000 (self) and 0.350, 0.028, 0.000 (cross) for kappa = 1, 0.1, 0.01,
    and 0.971 at a wall; it holds to 0.01 up to eps = 0.1. kappa = 1 is the pair form, kappa -> infinity the
    wall form, of Kroupa et al. (2016).
    """

    name: ClassVar = "jeffrey_onishi_1984_lubrication"
    title: ClassVar = "Jeffrey & Onishi 1984, diverging part, any size ratio"
    motion: ClassVar = "two spheres, along the line of centres"
    variables: ClassVar = ("eps", "kappa")
    formula: ClassVar = (
        "(kappa/(1 + kappa))**2/eps - kappa*(1 + 7*kappa + kappa**2)/(5*(1 + kappa)**3)*log(eps)"
        " - (1 + 18*kappa - 29*kappa**2 + 18*kappa**3 + kappa**4)/(21*(1 + kappa)**4)*eps*log(eps)"
    )
    validity: ClassVar = (0.0, 0.1)
    validity_source: ClassVar = "the constant left out holds to 0.01"
    reference: ClassVar = _JEFFREY_ONISHI + "; Kroupa et al., Langmuir 32, 8451 (2016)"
    status: ClassVar = Status.DERIVED
    evidence: ClassVar = (
        "kappa = 1 and infinity read in public code (pe, Grains3D); kappa = 0.1, 0.01 compared with the table "
        "of Townsend; kappa > 1 by reciprocity"
    )
    checks: ClassVar = (
        CheckValue({"eps": 0.025, "kappa": 1.0}, 11.8308730 - 0.99542, 0.004, _TABLE),
        CheckValue({"eps": 0.01375, "kappa": 0.1}, 1.73970049 - 1.02438, 0.001, _TABLE),
    )


@dataclass(frozen=True)
class JeffreyOnishi1984NormalSelf(ResistanceLaw):
    """X^A_11 = 1/(4 eps) - (9/40) ln(eps) - (3/112) eps ln(eps) + 0.9954: low by 0.3 % at 0.1, 1.7 % at 0.3."""

    name: ClassVar = "jeffrey_onishi_1984_normal_self"
    title: ClassVar = "Jeffrey & Onishi 1984, equal spheres, self"
    motion: ClassVar = "two equal spheres, along the line of centres: the one that moves"
    formula: ClassVar = "1/(4*eps) - 9*log(eps)/40 - 3*eps*log(eps)/112 + 0.9954"
    validity: ClassVar = (0.0, 0.6)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = _JEFFREY_ONISHI
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = _EVIDENCE
    checks: ClassVar = (CheckValue({"eps": 0.1}, 4.03209762, 0.013, _TABLE),)


@dataclass(frozen=True)
class JeffreyOnishi1984NormalCross(ResistanceLaw):
    """-X^A_12 = 1/(4 eps) - (9/40) ln(eps) - (3/112) eps ln(eps) + 0.3502: low by 0.2 % at 0.1, 1.4 % at 0.3."""

    name: ClassVar = "jeffrey_onishi_1984_normal_cross"
    title: ClassVar = "Jeffrey & Onishi 1984, equal spheres, cross"
    motion: ClassVar = "two equal spheres, along the line of centres: the other one"
    formula: ClassVar = "1/(4*eps) - 9*log(eps)/40 - 3*eps*log(eps)/112 + 0.3502"
    validity: ClassVar = (0.0, 0.6)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = _JEFFREY_ONISHI
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = _EVIDENCE
    checks: ClassVar = (CheckValue({"eps": 0.1}, 3.38119748, 0.007, _TABLE),)


@dataclass(frozen=True)
class JeffreyOnishi1984TangentialSelf(ResistanceLaw):
    """Y^A_11 = -(1/6) ln(eps) + 0.9983: low by 0.4 % at 0.05, 0.8 % at 0.1, 2.6 % at 0.3.

    Grains3D adds -0.03 eps ln(eps), which the expansion for equal spheres does not have.
    """

    name: ClassVar = "jeffrey_onishi_1984_tangential_self"
    title: ClassVar = "Jeffrey & Onishi 1984, equal spheres, tangential self"
    motion: ClassVar = "two equal spheres, across the line of centres: the one that moves"
    formula: ClassVar = "-log(eps)/6 + 0.9983"
    validity: ClassVar = (0.0, 0.56)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = _JEFFREY_ONISHI
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = _EVIDENCE
    checks: ClassVar = (CheckValue({"eps": 0.1}, 1.39300628, 0.0115, _TABLE),)


@dataclass(frozen=True)
class JeffreyOnishi1984TangentialCross(ResistanceLaw):
    """-Y^A_12 = -(1/6) ln(eps) + 0.2737: low by 0.2 % at 0.05, 0.4 % at 0.1, 1.5 % at 0.3."""

    name: ClassVar = "jeffrey_onishi_1984_tangential_cross"
    title: ClassVar = "Jeffrey & Onishi 1984, equal spheres, tangential cross"
    motion: ClassVar = "two equal spheres, across the line of centres: the other one"
    formula: ClassVar = "-log(eps)/6 + 0.2737"
    validity: ClassVar = (0.0, 0.7)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = _JEFFREY_ONISHI
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = _EVIDENCE
    checks: ClassVar = (CheckValue({"eps": 0.1}, 0.659875260, 0.0027, _TABLE),)


@dataclass(frozen=True)
class JeffreyOnishi1984CouplingForce(ResistanceLaw):
    """-(2/3) Y^B_11 = -(1/6) ln(eps) - (1/12) eps ln(eps) - 0.1593.

    Low by 1 % at eps = 0.025, 2.7 % at 0.05, 7 % at 0.1. The coupling torque is 3/4 of it.
    """

    name: ClassVar = "jeffrey_onishi_1984_coupling_force"
    title: ClassVar = "Jeffrey & Onishi 1984, equal spheres, force from rotation"
    motion: ClassVar = "two equal spheres, force across the line of centres from own rotation"
    scale: ClassVar[Scale] = "coupling force"
    formula: ClassVar = "-log(eps)/6 - eps*log(eps)/12 - 0.1593"
    validity: ClassVar = (0.0, 0.05)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = _JEFFREY_ONISHI
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = _EVIDENCE
    checks: ClassVar = (CheckValue({"eps": 0.05}, 0.543189570 * 2 / 3, 0.010, _TABLE),)


@dataclass(frozen=True)
class JeffreyOnishi1984Rotation(ResistanceLaw):
    """Y^C_11 = -(1/5) ln(eps) - (47/250) eps ln(eps) + 0.7028: low by 1 % at 0.05, 2.1 % at 0.1, 7.7 % at 0.3."""

    name: ClassVar = "jeffrey_onishi_1984_rotation"
    title: ClassVar = "Jeffrey & Onishi 1984, equal spheres, rotation"
    motion: ClassVar = "two equal spheres, rotation about an axis across the line of centres"
    scale: ClassVar[Scale] = "torque"
    formula: ClassVar = "-log(eps)/5 - 47*eps*log(eps)/250 + 0.7028"
    validity: ClassVar = (0.0, 0.2)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = _JEFFREY_ONISHI
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = _EVIDENCE
    checks: ClassVar = (CheckValue({"eps": 0.1}, 1.23302792, 0.027, _TABLE),)
