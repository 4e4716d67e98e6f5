"""The dry restitution of an elastic, perfectly plastic sphere: what e_dry becomes at high impact speed.

The contact follows Hertz until its central pressure reaches the yield pressure p_Y; beyond, the force grows by
dF/d(delta) = pi p_Y r; it unloads as a Hertz contact of the flattened radius r_p,
r_p F_max = r F_Hertz(delta_max). Energy balance gives the restitution as a function of v/v_Y alone, v_Y being
the speed at which yield sets in. Dissipation by waves and by the material's viscosity is left out, so e = 1
below v_Y.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from restitution.laws.base import CheckValue, Law, Status

_REFERENCE = "Thornton, J. Appl. Mech. 64, 383 (1997), doi:10.1115/1.2787319"


def yield_velocity(p_Y: float, E_r: float, r: float, m: float) -> float:
    """v_Y = sqrt[pi^5 p_Y^5 r^3/(30 E*^4 m)] in m/s: the speed whose Hertz contact just reaches p_Y.

    Contact yield pressure and reduced modulus in Pa, reduced radius in m, reduced mass in kg. p_Y is the peak
    pressure, about 1.6 times the yield stress.
    """
    return math.sqrt(math.pi**5 * p_Y**5 * r**3 / (30 * E_r**4 * m))


@dataclass(frozen=True)
class Thornton1997(Law):
    """e(v/v_Y), with y = v_Y/v <= 1:

    e = (6 sqrt(3)/5)^(1/2) [1 - y^2/6]^(1/2) { y/[y + 2 sqrt(6/5 - y^2/5)] }^(1/4),

    1 up to v = v_Y, tending to 1.185 (v_Y/v)^(1/4) at high speed.
    """

    name: ClassVar = "thornton_1997"
    family: ClassVar = "dry"
    title: ClassVar = "Thornton 1997, elastic-perfectly plastic sphere"
    symbol: ClassVar = r"e_{\mathrm{dry}}"
    variables: ClassVar = ("v_over_vY",)
    formula: ClassVar = (
        "sqrt(6*sqrt(3)/5*(1 - Min(1, 1/v_over_vY)**2/6))"
        "*(Min(1, 1/v_over_vY)/(Min(1, 1/v_over_vY) + 2*sqrt(6/5 - Min(1, 1/v_over_vY)**2/5)))**(1/4)"
    )
    reference: ClassVar = _REFERENCE
    status: ClassVar = Status.DERIVED
    evidence: ClassVar = (
        "the paper was not opened; the formula equals the numerical energy balance of the model's loading and "
        "unloading curves to 1e-8"
    )
    checks: ClassVar = (
        CheckValue({"v_over_vY": 1.0}, 1.0, 1e-12, "the onset of yield, by hand: nothing lost yet"),
        CheckValue({"v_over_vY": 1e8}, 1.18e-2, 1e-4, "limit 1.18 (v_Y/v)^(1/4), widely quoted"),
    )

    def _latex_name(self, symbol: str) -> str:
        return {"v_over_vY": "v/v_Y"}.get(symbol, super()._latex_name(symbol))
