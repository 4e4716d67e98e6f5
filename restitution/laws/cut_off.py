"""Cut-off forms: what a flow solver of finite resolution has to add to the resistance that it resolves itself.

Given a full law lambda, the correction is the part that the grid loses once the gap is below eps_c,

    lambda_c(eps) = lambda(max(eps, eps_min)) - lambda(eps_c)   for eps < eps_c,   0 beyond,

held constant below eps_min, where roughness or contact takes over. eps_c is a property of the grid, given by
its users in cells; the defaults here turn that into radii at the resolution at which they used it. Both
parameters are calibrated, not physical, wherever the source says so.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from restitution.laws.base import CheckValue, Status, parameter
from restitution.laws.brenner_1961 import Brenner1961
from restitution.laws.pair import Taylor1925Pair
from restitution.laws.resistance import ResistanceLaw, Scale
from restitution.laws.wall_normal import Jeffrey1982, Taylor1925
from restitution.laws.wall_tangential import (
    Goldman1967CouplingForce,
    Goldman1967CouplingTorque,
    Goldman1967Rotation,
    Goldman1967Translation,
)

_CELLS_NORMAL = "2/3 cell (waLBerla) at 10 cells a radius, its runs of Gondret's spheres"
_CELLS_TANGENTIAL = "1/2 cell (waLBerla) at 10 cells a radius, its runs of Gondret's spheres"
_FLOOR_NORMAL = "waLBerla input for normal impacts; calibrated with collisions, not physical"
_FLOOR_OBLIQUE = "waLBerla input for oblique impacts; calibrated with collisions, not physical"
_DIFFERENCE = "difference of the values printed by Brenner 1961, with the deviation of 1/eps found independently"
_NEARLY = "Brenner 1961, tabulated value; 1/eps is known to be 1.9 % low there"
_GOLDMAN = "difference of the exact values of Goldman, Cox & Brenner 1967 at eps = 0.0032 and 0.005"


def _eps_c(default: float, source: str) -> Any:
    return parameter(default, (1e-4, 10.0), "r", "gap below which the correction acts", source)


def _eps_min(default: float, source: str) -> Any:
    return parameter(default, (0.0, 0.1), "r", "gap below which the correction stays constant", source)


@dataclass(frozen=True)
class CutOffLaw(ResistanceLaw):
    """The correction to ``full`` below eps_c; a subclass names the law and declares eps_c and eps_min."""

    full: ClassVar[type[ResistanceLaw]]
    subtracted: ClassVar[bool] = True
    """Whether the value at eps_c is taken off, so that the correction sets in at zero."""
    if TYPE_CHECKING:  # parameters of each law of this kind, with a default of its own
        eps_c: float
        eps_min: float

    def __init_subclass__(cls, **kwargs: Any) -> None:
        cls.variables = cls.full.variables
        if cls.full.formula is not None:
            floored, at_cut_off = (
                re.sub(r"\beps\b", eps, f"({cls.full.formula})") for eps in ("Max(eps, eps_min)", "eps_c")
            )
            correction = f"{floored} - {at_cut_off}" if cls.subtracted else floored
            cls.formula = f"Piecewise(({correction}, eps < eps_c), (0, True))"
        super().__init_subclass__(**kwargs)

    def __post_init__(self) -> None:
        super().__post_init__()
        self._ordered("eps_min", "eps_c")

    # The full law's own code, so that laws without a closed formula are served alike.
    def _value(self, eps: np.ndarray, *others: np.ndarray) -> np.ndarray:
        full = self.full()
        value = full._value(np.clip(eps, self.eps_min, self.eps_c), *others)
        if self.subtracted:
            value = value - full._value(np.asarray(self.eps_c), *others)
        return np.where(eps < self.eps_c, value, 0.0)

    def _derivative(self, eps: np.ndarray, *others: np.ndarray) -> np.ndarray:
        slope = self.full()._derivative(np.clip(eps, self.eps_min, self.eps_c), *others)
        return np.where((eps > self.eps_min) & (eps < self.eps_c), slope, 0.0)


@dataclass(frozen=True)
class NguyenLadd2002(CutOffLaw):
    """lambda_c = 1/max(eps, eps_min) - 1/eps_c: the classical difference, also ten Cate et al. 2002, eq. 10.

    With eps_c = 0.4 it is 0.7 % below the exact difference at eps = 0.01, 2.9 % at 0.1, 4.8 % at 0.3.
    """

    full: ClassVar = Taylor1925
    name: ClassVar = "nguyen_ladd_2002"
    title: ClassVar = "Nguyen & Ladd 2002, difference of 1/eps"
    reference: ClassVar = (
        "Nguyen & Ladd, Phys. Rev. E 66, 046708 (2002), doi:10.1103/PhysRevE.66.046708; "
        "ten Cate et al., Phys. Fluids 14, 4012 (2002)"
    )
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "form read in public code and documentation (ludwig, waLBerla) that cite it"
    checks: ClassVar = (
        CheckValue({"eps": 0.01}, 0.993 * 98.16038, 0.05, _DIFFERENCE, {"eps_c": 0.4, "eps_min": 1e-4}),
        CheckValue({"eps": 0.1}, 0.971 * 7.72358, 0.004, _DIFFERENCE, {"eps_c": 0.4, "eps_min": 1e-4}),
    )
    eps_c: float = _eps_c(0.0667, _CELLS_NORMAL)
    eps_min: float = _eps_min(5e-4, _FLOOR_NORMAL)


@dataclass(frozen=True)
class Brenner1961Difference(CutOffLaw):
    """lambda_c = lambda(eps) - lambda(eps_c) with the exact lambda of Brenner (1961)."""

    full: ClassVar = Brenner1961
    name: ClassVar = "brenner_1961_difference"
    title: ClassVar = "Difference of the exact resistance"
    formula_note: ClassVar = (
        "exact resistance less its value at the cut-off; 0 beyond the cut-off, constant below the floor"
    )
    reference: ClassVar = "Brenner, Chem. Eng. Sci. 16, 242 (1961), in the difference form of Nguyen & Ladd (2002)"
    status: ClassVar = Status.DERIVED
    evidence: ClassVar = "the exact resistance less what a grid resolves if it is exact at eps_c"
    checks: ClassVar = (
        CheckValue({"eps": 0.01}, 101.896 - 3.73562, 6e-4, "Brenner 1961, tabulated values"),
        CheckValue({"eps": 0.05}, 21.5858 - 3.73562, 6e-5, "Brenner 1961, tabulated values"),
    )
    eps_c: float = _eps_c(0.4, "two cells at five a radius, the set-up of the source abstract")
    eps_min: float = _eps_min(1e-4, "roughness of Gondret's spheres, quoted by Biegert et al. 2017")


@dataclass(frozen=True)
class BrandleDeMotta2013(CutOffLaw):
    """lambda_c = lambda(eps) - lambda(eps_c) with the expansion ``jeffrey_1982``; also Costa et al. 2015."""

    full: ClassVar = Jeffrey1982
    name: ClassVar = "brandle_de_motta_2013"
    title: ClassVar = "Brandle de Motta et al. 2013, Costa et al. 2015"
    reference: ClassVar = (
        "Brandle de Motta et al., Phys. Fluids 25, 083302 (2013), doi:10.1063/1.4817382; "
        "Costa et al., Phys. Rev. E 92, 053012 (2015), doi:10.1103/PhysRevE.92.053012"
    )
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = "form and defaults quoted from the literature; the papers were not opened"
    checks: ClassVar = (
        CheckValue({"eps": 0.01}, 101.896 - 11.4592, 0.02, "Brenner 1961, tabulated; 0.14 % low at eps_c"),
    )  # fmt: skip
    eps_c: float = _eps_c(0.1, "quoted from the literature (wall), not checked")
    eps_min: float = _eps_min(1e-3, "quoted from the literature, not checked")


@dataclass(frozen=True)
class Biegert2017(CutOffLaw):
    """lambda_c = 1/max(eps, eps_min) below eps_c, nothing subtracted, hence a jump at eps_c.

    Where the grid still resolves part of the film this counts it twice.
    """

    full: ClassVar = Taylor1925
    subtracted: ClassVar = False
    name: ClassVar = "biegert_2017"
    title: ClassVar = "Biegert et al. 2017, full 1/eps below two cells"
    reference: ClassVar = "Biegert, Vowinckel & Meiburg, J. Comput. Phys. 340, 105 (2017), arXiv:1608.03566, eq. 9"
    status: ClassVar = Status.VERIFIED
    evidence: ClassVar = "read in the paper"
    checks: ClassVar = (
        CheckValue({"eps": 0.01}, 101.896, 1.92, _NEARLY),
        CheckValue({"eps": 1e-3}, 333.33, 0.01, "1/zeta_min for zeta_min = 3e-3 r, by hand"),
    )
    eps_c: float = _eps_c(0.2105, "two cells at 19 cells a diameter, the paper's resolution")
    eps_min: float = _eps_min(3e-3, "calibrated in the paper on the rebound at St = 27, not physical")


@dataclass(frozen=True)
class Izard2014(ResistanceLaw):
    """lambda = 1/(eps + eta): a denominator shifted by an effective roughness, finite at contact."""

    name: ClassVar = "izard_2014"
    title: ClassVar = "Izard et al. 2014, shifted denominator"
    formula: ClassVar = "1/(eps + eta)"
    validity: ClassVar = (0.0, 0.031)
    validity_source: ClassVar = "that of 1/eps"
    reference: ClassVar = "Izard, Bonometti & Lacaze, J. Fluid Mech. 747, 422 (2014), doi:10.1017/jfm.2014.145"
    status: ClassVar = Status.UNVERIFIED
    evidence: ClassVar = (
        "that they shift the denominator is stated by Biegert et al. 2017; the paper was not opened"
    )
    checks: ClassVar = (
        CheckValue({"eps": 0.01}, 101.896, 1.92, _NEARLY, {"eta": 1e-6}),
        CheckValue({"eps": 1e-9}, 1e4, 0.1, "1/eta at contact, by hand"),
    )  # fmt: skip
    eta: float = parameter(
        1e-4,
        (1e-8, 0.1),
        "r",
        "effective roughness",
        "roughness of Gondret's spheres, quoted by Biegert et al. 2017; the authors' own value was not read",
    )


@dataclass(frozen=True)
class _SimeonovCalantoni2012(CutOffLaw):
    """What the tangential corrections share; the constant of the full asymptote drops out of the difference."""

    reference: ClassVar = (
        "Simeonov & Calantoni, Int. J. Multiphase Flow 46, 38 (2012); Rettinger & Rude, arXiv:2003.01490"
    )
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in public code (waLBerla) that cites it"
    full: ClassVar = Goldman1967Translation
    eps_c: float = _eps_c(0.05, _CELLS_TANGENTIAL)
    eps_min: float = _eps_min(2e-3, _FLOOR_OBLIQUE)


@dataclass(frozen=True)
class SimeonovCalantoni2012Translation(_SimeonovCalantoni2012):
    """lambda_c = -(8/15) ln(max(eps, eps_min)/eps_c): translation along a wall."""

    full: ClassVar = Goldman1967Translation
    name: ClassVar = "simeonov_calantoni_2012_translation"
    title: ClassVar = "Simeonov & Calantoni 2012, translation along a wall"
    motion: ClassVar = full.motion
    checks: ClassVar = (CheckValue({"eps": 0.0032}, 4.0223 - 3.7863, 0.003, _GOLDMAN, {"eps_c": 0.005}),)


@dataclass(frozen=True)
class SimeonovCalantoni2012Rotation(_SimeonovCalantoni2012):
    """lambda_c = -(2/5) ln(max(eps, eps_min)/eps_c): torque against rotation at a wall."""

    full: ClassVar = Goldman1967Rotation
    name: ClassVar = "simeonov_calantoni_2012_rotation"
    title: ClassVar = "Simeonov & Calantoni 2012, rotation at a wall"
    motion: ClassVar = full.motion
    scale: ClassVar[Scale] = full.scale
    checks: ClassVar = (CheckValue({"eps": 0.0032}, 2.6793 - 2.5056, 0.006, _GOLDMAN, {"eps_c": 0.005}),)


@dataclass(frozen=True)
class SimeonovCalantoni2012CouplingTorque(_SimeonovCalantoni2012):
    """lambda_c = -(1/10) ln(max(eps, eps_min)/eps_c): torque from translation along a wall."""

    full: ClassVar = Goldman1967CouplingTorque
    name: ClassVar = "simeonov_calantoni_2012_coupling_torque"
    title: ClassVar = "Simeonov & Calantoni 2012, torque from translation"
    motion: ClassVar = full.motion
    scale: ClassVar[Scale] = full.scale
    checks: ClassVar = (CheckValue({"eps": 0.0032}, 0.38494 - 0.34187, 0.002, _GOLDMAN, {"eps_c": 0.005}),)


@dataclass(frozen=True)
class SimeonovCalantoni2012CouplingForce(_SimeonovCalantoni2012):
    """lambda_c = -(2/15) ln(max(eps, eps_min)/eps_c): force from rotation at a wall."""

    full: ClassVar = Goldman1967CouplingForce
    name: ClassVar = "simeonov_calantoni_2012_coupling_force"
    title: ClassVar = "Simeonov & Calantoni 2012, force from rotation"
    motion: ClassVar = full.motion
    scale: ClassVar[Scale] = full.scale
    checks: ClassVar = (CheckValue({"eps": 0.0032}, 0.513254 - 0.455827, 0.003, _GOLDMAN, {"eps_c": 0.005}),)


@dataclass(frozen=True)
class SimeonovCalantoni2012Pair(_SimeonovCalantoni2012):
    """lambda_c = [kappa/(1+kappa)]^2 (1/max(eps, eps_min) - 1/eps_c), kappa = r_2/r_1, eps = gap/r_1.

    For kappa -> infinity this is ``nguyen_ladd_2002``.
    """

    full: ClassVar = Taylor1925Pair
    name: ClassVar = "simeonov_calantoni_2012_pair"
    title: ClassVar = "Simeonov & Calantoni 2012, two spheres along the line of centres"
    motion: ClassVar = full.motion
    checks: ClassVar = (
        CheckValue(
            {"eps": 1e-5, "kappa": 1.0}, 25003.5858 - 2503.06777, 0.6,
            "difference of two entries of Townsend's resistance table; its logarithm adds 0.52",
            {"eps_c": 1e-4, "eps_min": 0.0},
        ),
    )  # fmt: skip
    eps_c: float = _eps_c(0.0667, _CELLS_NORMAL)
    eps_min: float = _eps_min(5e-4, _FLOOR_NORMAL)
