"""The gap at which a liquid film stops thinning: the surfaces' roughness, or their elastic dent.

Everything in SI. E_r is the reduced modulus of the two bodies, 1/E_r = sum (1 - nu_i^2)/E_i; r the reduced
radius, which against a wall is that of the sphere; v the normal speed. Below the gap at which the pressure of
the film dents the bodies they no longer approach as rigid ones; asperities touch if they are higher than that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Law, Status, parameter

_RV10 = {"mu": 0.01, "E_r": 55e9, "r": 1.5e-3}
_RV100 = {"mu": 0.1, "E_r": 55e9, "r": 3e-3}
_NIJSSEN = "Nijssen, Ottens & Padding, Powder Technol. 413, 118017 (2022)"
_INDEPENDENT = "evaluated independently of this package for Gondret's spheres, E* = 55 GPa assumed"


def reduced_modulus(E_1: float, nu_1: float, E_2: float, nu_2: float) -> float:
    """E* in Pa from Young's moduli in Pa and Poisson ratios: 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2."""
    return 1 / ((1 - nu_1**2) / E_1 + (1 - nu_2**2) / E_2)


@dataclass(frozen=True)
class FilmLaw(Law):
    """A film thickness or length in m."""

    family: ClassVar[str] = "film"
    symbol: ClassVar[str] = r"h_{\mathrm{min}}"


@dataclass(frozen=True)
class Roughness(FilmLaw):
    """h_min = sigma_r r: asperities in proportion to the radius; r in m."""

    name: ClassVar = "roughness"
    title: ClassVar = "Roughness"
    variables: ClassVar = ("r",)
    formula: ClassVar = "sigma_r*r"
    reference: ClassVar = (
        "Biegert, Vowinckel & Meiburg, J. Comput. Phys. 340, 105 (2017), arXiv:1608.03566, sec. 4.4"
    )
    status: ClassVar = Status.VERIFIED
    evidence: ClassVar = "the value is read in the paper, which quotes it for the spheres of Gondret et al. 2002"
    checks: ClassVar = (
        CheckValue({"r": 1.5e-3}, 0.15e-6, 1e-12, "quoted for the 3 mm sphere"),
        CheckValue({"r": 3e-3}, 0.3e-6, 1e-12, "quoted for the 6 mm sphere"),
    )
    sigma_r: float = parameter(
        1e-4,
        (0.0, 0.1),
        "r",
        "height of the asperities over the radius",
        "Gondret's spheres, quoted by Biegert et al. 2017",
    )


@dataclass(frozen=True)
class YangHunt2008(FilmLaw):
    """h_e = 0.37 [(mu v/E*)^2 r^3]^(1/5): least gap of smooth elastic bodies; v m/s, mu Pa s, E_r Pa, r m."""

    name: ClassVar = "yang_hunt_2008"
    title: ClassVar = "Elastohydrodynamic minimum gap"
    symbol: ClassVar = "h_e"
    variables: ClassVar = ("v", "mu", "E_r", "r")
    formula: ClassVar = "0.37*((mu*v/E_r)**2*r**3)**(1/5)"
    reference: ClassVar = (
        "Yang & Hunt, Phil. Trans. R. Soc. A 366, 2205 (2008), doi:10.1098/rsta.2008.0014; form of " + _NIJSSEN
    )
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in the public script of Nijssen et al., their eqs. 5 and 6"
    checks: ClassVar = (
        CheckValue({"v": 0.585, **_RV10}, 0.05e-6, 0.005e-6, _INDEPENDENT + ": 1st bounce, St 152"),
        CheckValue({"v": 0.0885, **_RV10}, 0.02e-6, 0.005e-6, _INDEPENDENT + ": 4th bounce, St 23"),
        CheckValue({"v": 0.518, **_RV100}, 0.18e-6, 0.005e-6, _INDEPENDENT + ": St 27"),
    )


@dataclass(frozen=True)
class Nijssen2022(FilmLaw):
    """h_min = max(h_e, sigma), h_e as in ``yang_hunt_2008``: whichever comes first, asperities or the dent.

    sigma in m: 24 nm for ball-bearing steel, 134 nm for glass, 272 nm for steel beads, 796 nm for Delrin.
    """

    name: ClassVar = "nijssen_2022"
    title: ClassVar = "Minimum gap, roughness or elastohydrodynamic"
    variables: ClassVar = ("v", "mu", "E_r", "r")
    formula: ClassVar = "Max(0.37*((mu*v/E_r)**2*r**3)**(1/5), sigma)"
    reference: ClassVar = _NIJSSEN
    status: ClassVar = Status.IN_CODE
    evidence: ClassVar = "read in the authors' public script"
    checks: ClassVar = (
        CheckValue({"v": 0.585, **_RV10}, 0.15e-6, 1e-12, "Gondret's 3 mm sphere is limited by its roughness"),
        CheckValue({"v": 0.518, **_RV100}, 0.18e-6, 0.005e-6, _INDEPENDENT, {"sigma": 0.15e-6}),
    )
    sigma: float = parameter(
        1.5e-7,
        (0.0, 1e-3),
        "m",
        "height of the asperities",
        "Gondret's 3 mm sphere, 1e-4 of its radius, quoted by Biegert et al. 2017",
    )


@dataclass(frozen=True)
class ElastohydrodynamicLength(FilmLaw):
    """D* = [m v^2/(E* sqrt(r))]^(2/5): where film pressure and elasticity balance; v m/s, m kg, E_r Pa, r m.

    The unit of length in which the elastohydrodynamic rebound depends on St alone. The dry Hertz contact of the
    same energy is dented by (15/16)^(2/5) D* = 0.974 D*.
    """

    name: ClassVar = "ehd_length"
    title: ClassVar = "Elastohydrodynamic length"
    symbol: ClassVar = "D^*"
    variables: ClassVar = ("v", "m", "E_r", "r")
    formula: ClassVar = "(m*v**2/(E_r*sqrt(r)))**(2/5)"
    reference: ClassVar = (
        "Bertin, J. Fluid Mech. (2024), arXiv:2308.10754; after Davis, Serayssol & Hinch, J. Fluid Mech. 163, "
        "479 (1986)"
    )
    status: ClassVar = Status.DERIVED
    evidence: ClassVar = "follows from the dimensionless equations read in a public script of the paper"
    checks: ClassVar = tuple(
        CheckValue({"v": v, "m": m, "E_r": 55e9, "r": r}, D, tolerance, f"{_INDEPENDENT}: St {St}")
        for v, m, r, D, tolerance, St in (
            (0.585, 1.1027e-4, 1.5e-3, 3.2e-6, 0.06e-6, 152),
            (0.3023, 1.1027e-4, 1.5e-3, 1.9e-6, 0.06e-6, 79),
            (0.1715, 1.1027e-4, 1.5e-3, 1.2e-6, 0.06e-6, 45),
            (0.0885, 1.1027e-4, 1.5e-3, 0.7e-6, 0.06e-6, 23),
            (0.518, 8.8216e-4, 3e-3, 5.7e-6, 0.06e-6, 27),
        )
    )
