"""Resistance of a sphere that moves along a plane wall or turns about an axis parallel to it.

Four numbers describe it: the force against the translation, the torque against the rotation, and the two
couplings (see :mod:`restitution.laws.resistance` for scales and signs). The exact values of Goldman, Cox &
Brenner (1967) at eight gaps, 0.0032 to 9.07 radii, are what the errors quoted here refer to. Near contact all
four grow as ln(1/eps) only, so the constants matter and the asymptotes leave the exact curve early; between
the near and the far forms of rotation and coupling lies a range that no record here covers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Status
from restitution.laws.resistance import ResistanceLaw, Scale

_GOLDMAN = "Goldman, Cox & Brenner, Chem. Eng. Sci. 22, 637 (1967), doi:10.1016/0009-2509(67)80047-2"
_DANCE_MAXEY = "Dance & Maxey, J. Comput. Phys. 189, 212 (2003), doi:10.1016/S0021-9991(03)00209-2"
_EXACT = "Goldman, Cox & Brenner 1967, exact value; tolerance is the error stated for the law"
_AGREES = "compared with the exact table, see the class docstring"


@dataclass(frozen=True)
class Goldman1967Translation(ResistanceLaw):
    """lambda = (8/15) ln(1/eps) + 0.9588.

    Within 0.05 % up to eps = 0.005, low by 1.4 % at 0.045, 4.4 % at 0.128.
    """

    name: ClassVar = "goldman_1967_translation"
    title: ClassVar = "Goldman, Cox & Brenner 1967, translation along a wall"
    motion: ClassVar = "translation along a wall"
    formula: ClassVar = "-8*log(eps)/15 + 0.9588"
    validity: ClassVar = (0.0, 0.13)
    validity_source: ClassVar = "within 5 % of the exact table"
    reference: ClassVar = _GOLDMAN
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "coefficients read in public code; " + _AGREES
    checks: ClassVar = (CheckValue({"eps": 0.0032}, 4.0223, 0.002, _EXACT),)


@dataclass(frozen=True)
class Goldman1967Rotation(ResistanceLaw):
    """lambda = (2/5) ln(1/eps) + 0.3817: within 0.2 % up to eps = 0.005, low by 4.7 % at 0.045.

    Public codes also carry 0.3187 for the constant; the table gives 0.3817.
    """

    name: ClassVar = "goldman_1967_rotation"
    title: ClassVar = "Goldman, Cox & Brenner 1967, rotation at a wall"
    motion: ClassVar = "rotation about an axis along a wall"
    scale: ClassVar[Scale] = "torque"
    formula: ClassVar = "-2*log(eps)/5 + 0.3817"
    validity: ClassVar = (0.0, 0.046)
    validity_source: ClassVar = "within 5 % of the exact table"
    reference: ClassVar = _GOLDMAN
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = _AGREES
    checks: ClassVar = (CheckValue({"eps": 0.0032}, 2.6793, 0.002, _EXACT),)


@dataclass(frozen=True)
class Goldman1967CouplingTorque(ResistanceLaw):
    """lambda = (1/10) ln(1/eps) - 0.1895: low by 0.45 % at eps = 0.005, by 18 % at 0.045; zero at 0.15."""

    name: ClassVar = "goldman_1967_coupling_torque"
    title: ClassVar = "Goldman, Cox & Brenner 1967, torque from translation along a wall"
    motion: ClassVar = "torque from translation along a wall"
    scale: ClassVar[Scale] = "coupling torque"
    formula: ClassVar = "-log(eps)/10 - 0.1895"
    validity: ClassVar = (0.0, 0.02)
    validity_source: ClassVar = "within 5 %: 0.5 % at 0.005 by the exact table, 5 % at 0.02 by dance_maxey_2003"
    reference: ClassVar = _GOLDMAN
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = _AGREES
    checks: ClassVar = (CheckValue({"eps": 0.005}, 0.34187, 0.0017, _EXACT),)


@dataclass(frozen=True)
class Goldman1967CouplingForce(ResistanceLaw):
    """lambda = (2/15) ln(1/eps) - 0.2526: low by 0.4 % at eps = 0.005, by 18 % at 0.045; zero at 0.15."""

    name: ClassVar = "goldman_1967_coupling_force"
    title: ClassVar = "Goldman, Cox & Brenner 1967, force from rotation at a wall"
    motion: ClassVar = "force from rotation at a wall"
    scale: ClassVar[Scale] = "coupling force"
    formula: ClassVar = "-2*log(eps)/15 - 0.2526"
    validity: ClassVar = (0.0, 0.02)
    validity_source: ClassVar = "within 5 %: 0.5 % at 0.005 by the exact table, 5 % at 0.02 by dance_maxey_2003"
    reference: ClassVar = _GOLDMAN
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = _AGREES
    checks: ClassVar = (CheckValue({"eps": 0.005}, 0.455827, 0.0023, _EXACT),)


@dataclass(frozen=True)
class DanceMaxey2003Translation(ResistanceLaw):
    """lambda = -(8/15) ln(eps) - (64/375) eps ln(eps) + 0.952.

    Low by 0.1 % at eps = 0.003, 0.8 % at 0.045, 2.6 % at 0.128.
    """

    name: ClassVar = "dance_maxey_2003_translation"
    title: ClassVar = "Dance & Maxey 2003, translation along a wall"
    motion: ClassVar = "translation along a wall"
    formula: ClassVar = "-8*log(eps)/15 - 64*eps*log(eps)/375 + 0.952"
    validity: ClassVar = (0.0, 0.2)
    validity_source: ClassVar = "within 5 %: exact table up to 0.13, chaoui_feuillebois_2003 beyond"
    reference: ClassVar = _DANCE_MAXEY
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "coefficients read in public code (Grains3D); " + _AGREES
    checks: ClassVar = (CheckValue({"eps": 0.0453}, 2.6475, 0.022, _EXACT),)


@dataclass(frozen=True)
class DanceMaxey2003Rotation(ResistanceLaw):
    """lambda = -(2/5) ln(eps) - (66/125) eps ln(eps) + 0.371.

    Low by 0.05 % at eps = 0.005, 1 % at 0.045, 3.9 % at 0.128.
    """

    name: ClassVar = "dance_maxey_2003_rotation"
    title: ClassVar = "Dance & Maxey 2003, rotation at a wall"
    motion: ClassVar = "rotation about an axis along a wall"
    scale: ClassVar[Scale] = "torque"
    formula: ClassVar = "-2*log(eps)/5 - 66*eps*log(eps)/125 + 0.371"
    validity: ClassVar = (0.0, 0.13)
    validity_source: ClassVar = "within 5 % of the exact table"
    reference: ClassVar = _DANCE_MAXEY
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "coefficients read in public code (Grains3D); " + _AGREES
    checks: ClassVar = (CheckValue({"eps": 0.0453}, 1.6996, 0.018, _EXACT),)


@dataclass(frozen=True)
class DanceMaxey2003CouplingForce(ResistanceLaw):
    """lambda = -(2/15) ln(eps) - (86/375) eps ln(eps) - 0.257.

    Low by 0.1 % at eps = 0.005, 3.2 % at 0.045, 21 % at 0.128. The coupling torque is 3/4 of it.
    """

    name: ClassVar = "dance_maxey_2003_coupling_force"
    title: ClassVar = "Dance & Maxey 2003, force from rotation at a wall"
    motion: ClassVar = "force from rotation at a wall"
    scale: ClassVar[Scale] = "coupling force"
    formula: ClassVar = "-2*log(eps)/15 - 86*eps*log(eps)/375 - 0.257"
    validity: ClassVar = (0.0, 0.046)
    validity_source: ClassVar = "within 5 % of the exact table"
    reference: ClassVar = _DANCE_MAXEY
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "coefficients read in public code (Grains3D); " + _AGREES
    checks: ClassVar = (CheckValue({"eps": 0.005}, 0.455827, 0.0006, _EXACT),)


@dataclass(frozen=True)
class ChaouiFeuillebois2003(ResistanceLaw):
    """lambda = -(8/15) ln(eps) - (64/375) eps ln(eps) + 0.95429 + 0.42945 eps.

    Within 0.03 % of the exact table up to eps = 0.13, 0.14 % at 0.54, 0.3 % at 1.35: the best of the near forms.
    """

    name: ClassVar = "chaoui_feuillebois_2003"
    title: ClassVar = "Chaoui & Feuillebois 2003, translation along a wall"
    motion: ClassVar = "translation along a wall"
    formula: ClassVar = "-8*log(eps)/15 - 64*eps*log(eps)/375 + 0.95429 + 0.42945*eps"
    validity: ClassVar = (0.0, 1.36)
    validity_source: ClassVar = "within 0.3 % of the exact table"
    reference: ClassVar = "Chaoui & Feuillebois, Q. J. Mech. Appl. Math. 56, 381 (2003)"
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = "coefficients as quoted in the literature, the paper was not opened; " + _AGREES
    checks: ClassVar = (
        CheckValue({"eps": 0.1276}, 2.1514, 0.0007, _EXACT),
        CheckValue({"eps": 0.5431}, 1.5675, 0.0024, _EXACT),
    )


@dataclass(frozen=True)
class Faxen1922(ResistanceLaw):
    """lambda = 1/[1 - (9/16) k + k^3/8 - (45/256) k^4 - k^5/16], k = r/(r + gap): the far form.

    High by 0.1 % at eps = 1.35, 1 % at 0.54, 4.4 % at 0.128; it stays finite at contact.
    """

    name: ClassVar = "faxen_1922"
    title: ClassVar = "Faxen's far form, translation along a wall"
    motion: ClassVar = "translation along a wall"
    formula: ClassVar = (
        "1/(1 - 9/(16*(1 + eps)) + 1/(8*(1 + eps)**3) - 45/(256*(1 + eps)**4) - 1/(16*(1 + eps)**5))"
    )
    validity: ClassVar = (0.04, float("inf"))
    validity_source: ClassVar = "within 5 % of the exact table"
    reference: ClassVar = "Faxen, Ann. Phys. 373, 89 (1922); Happel & Brenner, Low Reynolds Number Hydrodynamics"
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in public code that names it; " + _AGREES
    checks: ClassVar = (
        CheckValue({"eps": 2.7622}, 1.1738, 0.0001, _EXACT),
        CheckValue({"eps": 0.5431}, 1.5675, 0.017, _EXACT),
    )


@dataclass(frozen=True)
class Goldman1967FarRotation(ResistanceLaw):
    """lambda = 1 + (5/16) k^3, k = r/(r + gap): low by 0.1 % at eps = 1.35, 1.3 % at 0.54, 12 % at 0.128."""

    name: ClassVar = "goldman_1967_far_rotation"
    title: ClassVar = "Far form, rotation at a wall"
    motion: ClassVar = "rotation about an axis along a wall"
    scale: ClassVar[Scale] = "torque"
    formula: ClassVar = "1 + 5/(16*(1 + eps)**3)"
    validity: ClassVar = (0.5, float("inf"))
    validity_source: ClassVar = "within 2 % of the exact table"
    reference: ClassVar = _GOLDMAN
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = "widely quoted; " + _AGREES
    checks: ClassVar = (CheckValue({"eps": 1.3524}, 1.025, 0.0011, _EXACT),)


@dataclass(frozen=True)
class Goldman1967FarCouplingTorque(ResistanceLaw):
    """lambda = (3/32) k^4 (1 - 3k/8), k = r/(r + gap): low by 0.07 % at eps = 2.8, 2.6 % at 1.35, 15 % at 0.54."""

    name: ClassVar = "goldman_1967_far_coupling_torque"
    title: ClassVar = "Far form, torque from translation along a wall"
    motion: ClassVar = "torque from translation along a wall"
    scale: ClassVar[Scale] = "coupling torque"
    formula: ClassVar = "3/(32*(1 + eps)**4)*(1 - 3/(8*(1 + eps)))"
    validity: ClassVar = (1.35, float("inf"))
    validity_source: ClassVar = "within 3 % of the exact table"
    reference: ClassVar = _GOLDMAN
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = "widely quoted; " + _AGREES
    checks: ClassVar = (CheckValue({"eps": 2.7622}, 0.0004216, 4e-7, _EXACT),)
