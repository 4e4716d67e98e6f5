r"""History force on a sphere: kernels K of the memory that the fluid keeps of past accelerations.

    F = -6 pi mu r int_-inf^t K(t - s) (dv/ds) ds,

as a function of the lag tau = nu (t - s)/r^2 and of Re = v d/nu. An impact is an acceleration too: the jump of
v there leaves -6 pi mu r (v_out - v_in) K behind it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Law, Status, parameter


@dataclass(frozen=True)
class HistoryLaw(Law):
    """A memory kernel K(tau, Re), tau = nu (t - s)/r^2."""

    family: ClassVar[str] = "history"
    symbol: ClassVar[str] = "K"
    variables: ClassVar[tuple[str, ...]] = ("tau", "Re")


@dataclass(frozen=True)
class Basset1888(HistoryLaw):
    """K = (pi tau)^(-1/2): creeping flow, exact; never forgets, so it is too strong once the wake is convected."""

    name: ClassVar = "basset_1888"
    title: ClassVar = "Basset 1888, creeping flow"
    formula: ClassVar = "1/sqrt(pi*tau)"
    validity_source: ClassVar = "Re small"
    reference: ClassVar = "Basset, A Treatise on Hydrodynamics, vol. 2 (1888)"
    status: ClassVar = Status.VERIFIED
    evidence: ClassVar = "exact solution of the unsteady Stokes equations"
    checks: ClassVar = (
        CheckValue({"tau": 0.25, "Re": 1.0}, 1.1283791671, 1e-9, "2/sqrt(pi), by hand"),
    )


@dataclass(frozen=True)
class MeiAdrian1992(HistoryLaw):
    """K = {(pi tau)^(1/4) + [pi Re^3 tau^2/(16 f_H^3)]^(1/2)}^-2, f_H = 0.75 + 0.105 Re.

    Basset's at short lags, decaying as tau^-2 once the wake has been swept away.
    """

    name: ClassVar = "mei_adrian_1992"
    title: ClassVar = "Mei & Adrian 1992, finite Reynolds number"
    formula: ClassVar = "((pi*tau)**(1/4) + sqrt(pi*Re**3*tau**2/(16*(f_0 + f_1*Re)**3)))**(-2)"
    reference: ClassVar = "Mei & Adrian, J. Fluid Mech. 237, 323 (1992), doi:10.1017/S0022112092003434"
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in three public codes that cite it; the paper was not opened"
    validity_source: ClassVar = "small fluctuations about a steady motion; a rebound is not small"
    checks: ClassVar = (
        CheckValue({"tau": 1e-12, "Re": 100.0}, 564189.58, 700.0, "Basset's kernel at short lags"),
        CheckValue(
            {"tau": 1.0, "Re": 10.0}, 0.0196503, 1e-7,
            "by hand: (1.331335 + sqrt(196.349541/5.832))^-2",
        ),
    )  # fmt: skip
    f_0: float = parameter(0.75, (0.01, 10.0), "1", "f_H at Re -> 0", "Mei & Adrian 1992, as in public codes")
    f_1: float = parameter(0.105, (1e-3, 1.0), "1", "slope of f_H in Re", "Mei & Adrian 1992, as in public codes")
