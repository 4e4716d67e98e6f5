"""Resistance of a sphere moving normal to a plane wall: closed approximations to the exact ``brenner_1961``.

F = -6 pi mu r v lambda(eps). The validity ranges of the near-contact forms end where they leave the exact
solution by 5 %.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Status
from restitution.laws.resistance import ResistanceLaw

_BRENNER = "Brenner, Chem. Eng. Sci. 16, 242 (1961), tabulated value; tolerance is the error stated for the law"
_WITHIN_5 = "within 5 % of the exact solution"


@dataclass(frozen=True)
class Taylor1925(ResistanceLaw):
    """lambda = 1/eps, i.e. F = -6 pi mu r^2 v/h: the pressure of the film alone.

    Low by 2 % at eps = 0.01, 13 % at 0.1, 33 % at 0.4.
    """

    name: ClassVar = "taylor_1925"
    title: ClassVar = "Taylor's lubrication force"
    formula: ClassVar = "1/eps"
    validity: ClassVar = (0.0, 0.031)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = (
        "G. I. Taylor, as printed by Hardy & Bircumshaw, Proc. R. Soc. A 108, 1 (1925) (attribution quoted from "
        "the literature); leading order of Cox & Brenner, Chem. Eng. Sci. 22, 1753 (1967)"
    )
    status: ClassVar = Status.VERIFIED
    evidence: ClassVar = "leading term of the exact series; read in Biegert et al. 2017, eq. 9"
    checks: ClassVar = (CheckValue({"eps": 0.01}, 101.896, 1.92, _BRENNER),)


@dataclass(frozen=True)
class CooleyONeill1969(ResistanceLaw):
    """lambda = 1/eps - ln(eps)/5 + 0.97128, with the first logarithm and the constant.

    Low by 0.004 % at eps = 0.01, 0.24 % at 0.1, 2.2 % at 0.4, 7 % at 1.
    """

    name: ClassVar = "cooley_oneill_1969"
    title: ClassVar = "Cooley & O'Neill 1969"
    formula: ClassVar = "1/eps - log(eps)/5 + 0.97128"
    validity: ClassVar = (0.0, 0.73)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = (
        "Cooley & O'Neill, Mathematika 16, 37 (1969); Cox & Brenner, Chem. Eng. Sci. 22, 1753 (1967)"
    )
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = (
        "read in public code that names it; coefficients -0.2 and 0.9712799 recovered from the exact series"
    )
    checks: ClassVar = (
        CheckValue({"eps": 0.01}, 101.896, 0.005, _BRENNER),
        CheckValue({"eps": 0.1}, 11.4592, 0.028, _BRENNER),
    )


@dataclass(frozen=True)
class Jeffrey1982(ResistanceLaw):
    """lambda = 1/eps - ln(eps)/5 - eps ln(eps)/21 + 0.9713.

    Low by 0.002 % at eps = 0.01, 0.14 % at 0.1, 1.7 % at 0.4. Public codes also carry the constant 0.848,
    which is wrong by more than a percent at eps = 0.1.
    """

    name: ClassVar = "jeffrey_1982"
    title: ClassVar = "Near-contact expansion with the eps ln(eps) term"
    formula: ClassVar = "1/eps - log(eps)/5 - eps*log(eps)/21 + 0.9713"
    validity: ClassVar = (0.0, 0.78)
    validity_source: ClassVar = _WITHIN_5
    reference: ClassVar = (
        "Jeffrey, Mathematika 29, 58 (1982) (attribution not checked); used by Kroupa et al., Langmuir 32, 8451 "
        "(2016), eq. 16"
    )
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = (
        "coefficients read in public code (Grains3D, pe); -1/5 and -1/21 recovered from the exact series"
    )
    checks: ClassVar = (
        CheckValue({"eps": 0.01}, 101.896, 0.003, _BRENNER),
        CheckValue({"eps": 0.1}, 11.4592, 0.017, _BRENNER),
    )


@dataclass(frozen=True)
class BevanPrieve2000(ResistanceLaw):
    """lambda = (6 eps^2 + 9 eps + 2)/(6 eps^2 + 2 eps): within 0.71 % of the exact solution at every gap.

    Right in both limits, 1/eps and 1; the cheapest closure for a sphere that comes from far. It is lowest,
    by 0.70 %, at eps = 0.06.
    """

    name: ClassVar = "bevan_prieve_2000"
    title: ClassVar = "Bevan & Prieve 2000, rational"
    formula: ClassVar = "(6*eps**2 + 9*eps + 2)/(6*eps**2 + 2*eps)"
    reference: ClassVar = "Bevan & Prieve, J. Chem. Phys. 113, 1228 (2000)"
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = "the paper was not opened; compared with the exact series at all gaps"
    checks: ClassVar = (
        CheckValue({"eps": 0.4}, 3.73562, 0.0085, _BRENNER),
        CheckValue({"eps": 0.05}, 21.5858, 0.152, _BRENNER),
    )
