r"""History force on a sphere: kernels K of the memory that the fluid keeps of past accelerations.

    F = -6 pi mu r int_-inf^t K(t - s) (dv/ds) ds,

as a function of the lag tau = nu (t - s)/r^2 and of Re = v d/nu. An impact is an acceleration too: the jump of
v there leaves -6 pi mu r (v_out - v_in) K behind it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

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
    checks: ClassVar = (CheckValue({"tau": 0.25, "Re": 1.0}, 1.1283791671, 1e-9, "2/sqrt(pi), by hand"),)


@dataclass(frozen=True)
class FiniteReynolds(HistoryLaw):
    """K = {(pi tau)^(1/(2 c_1)) + [pi Re^3 tau^2/(16 f_H^3)]^(1/c_1)}^(-c_1), f_H = f_0 + f_1 Re.

    Basset's at short lags, decaying as tau^-2 once the wake has been swept away, which is from
    tau_c = (256/pi)^(1/3) (f_H/Re)^2 on. Re is that of the present motion.
    """

    formula: ClassVar = "((pi*tau)**(1/(2*c_1)) + (pi*Re**3*tau**2/(16*(f_0 + f_1*Re)**3))**(1/c_1))**(-c_1)"
    validity_source: ClassVar = (
        "small fluctuations about a steady motion, Re up to about 100; a rebound is neither"
    )
    status: ClassVar = Status.IN_CODE
    if TYPE_CHECKING:  # parameters of each law of this kind, with a default of its own
        f_0: float
        f_1: float
        c_1: float

    def crossover(self, Re: Any) -> Any:
        """tau_c, the lag nu (t - s)/r^2 from which on the kernel leaves Basset's."""
        return (256 / math.pi) ** (1 / 3) * ((self.f_0 + self.f_1 * Re) / Re) ** 2


def _f_0() -> Any:
    return parameter(0.75, (0.01, 10.0), "1", "f_H at Re -> 0", "Mei & Adrian 1992, as in public codes")


def _f_1(default: float, source: str) -> Any:
    return parameter(default, (1e-3, 100.0), "1", "slope of f_H in Re", source)


def _c_1(default: float, source: str) -> Any:
    return parameter(default, (0.5, 10.0), "1", "sharpness of the crossover", source)


_SHORT = CheckValue({"tau": 1e-14, "Re": 100.0}, 5641895.8, 3000.0, "Basset's kernel at short lags")
_PUBLIC = "constants as in public code on inertial particles that names the paper"


@dataclass(frozen=True)
class MeiAdrian1992(FiniteReynolds):
    """K = {(pi tau)^(1/4) + [pi Re^3 tau^2/(16 f_H^3)]^(1/2)}^-2, f_H = 0.75 + 0.105 Re."""

    name: ClassVar = "mei_adrian_1992"
    title: ClassVar = "Mei & Adrian 1992, finite Reynolds number"
    reference: ClassVar = "Mei & Adrian, J. Fluid Mech. 237, 323 (1992), doi:10.1017/S0022112092003434"
    evidence: ClassVar = "read in three public codes that cite it; the paper was not opened"
    checks: ClassVar = (
        _SHORT,
        CheckValue({"tau": 1.0, "Re": 10.0}, 0.0196503, 1e-7, "by hand: (1.331335 + sqrt(196.349541/5.832))^-2"),
    )
    f_0: float = _f_0()
    f_1: float = _f_1(0.105, "Mei & Adrian 1992, as in public codes")
    c_1: float = _c_1(2.0, "Mei & Adrian 1992, as in public codes")


@dataclass(frozen=True)
class Kim1998(FiniteReynolds):
    """c_1 = 2.5, f_H = 0.75 + 0.126 Re, without that paper's factor for strong accelerations."""

    name: ClassVar = "kim_1998"
    title: ClassVar = "Kim, Elghobashi & Sirignano 1998, without the acceleration factor"
    reference: ClassVar = "Kim, Elghobashi & Sirignano, J. Fluid Mech. 367, 221 (1998)"
    evidence: ClassVar = _PUBLIC
    checks: ClassVar = (
        _SHORT,
        CheckValue(
            {"tau": 1.0, "Re": 10.0}, 0.0194731, 1e-7,
            "by hand: (1.257274 + (196.349541/8.120601)^0.4)^-2.5",
        ),
    )  # fmt: skip
    f_0: float = _f_0()
    f_1: float = _f_1(0.126, "Kim et al. 1998, as in public code")
    c_1: float = _c_1(2.5, "Kim et al. 1998, as in public code")


@dataclass(frozen=True)
class DorganLoth2007(FiniteReynolds):
    """c_1 = 2.5, f_H = 0.75 + 0.2 Re; said to hold for Re up to a few hundred (not checked in the paper)."""

    name: ClassVar = "dorgan_loth_2007"
    title: ClassVar = "Dorgan & Loth 2007, finite Reynolds number"
    reference: ClassVar = "Dorgan & Loth, Int. J. Multiphase Flow 33, 833 (2007)"
    evidence: ClassVar = _PUBLIC
    checks: ClassVar = (
        _SHORT,
        CheckValue(
            {"tau": 1.0, "Re": 10.0}, 0.0376673, 1e-7,
            "by hand: (1.257274 + (196.349541/20.796875)^0.4)^-2.5",
        ),
    )  # fmt: skip
    f_0: float = _f_0()
    f_1: float = _f_1(0.2, "Dorgan & Loth 2007, as in public code")
    c_1: float = _c_1(2.5, "Dorgan & Loth 2007, as in public code")
