"""The impacts of one pair: a closure with fluid and sphere, so that e_eff follows from the impact speed alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions, Sphere
from restitution.errors import Defect, InputError
from restitution.export.closure import Closure
from restitution.stokes import convention

_TWICE = "a film force beside an e_eff would count the viscous loss twice"
_NO_REBOUND = {
    "film": _TWICE,
    "resistance": _TWICE,
    "dry": "the dry restitution alone would leave out the viscous loss, which nothing else has there",
}
"""By family, why a code that does not resolve the film gets no such law."""


@dataclass(frozen=True)
class Impacts:
    """e_eff of a sphere and a wall, or its partner, in a fluid."""

    closure: Closure
    conditions: Conditions
    e_dry: float

    @property
    def per_speed(self) -> float:
        """The law's Stokes number over the impact speed, s/m."""
        return stokes_per_speed(self.closure.convention, self.conditions)

    @property
    def mass(self) -> float:
        """Reduced mass in kg: that of the sphere at a wall."""
        sphere, partner = self.conditions.sphere, self.conditions.partner
        return sphere.mass * partner.mass / (sphere.mass + partner.mass) if partner else sphere.mass

    def stokes(self, speed: NDArray | float) -> NDArray:
        """The law's Stokes number of impact speeds in m/s."""
        return np.asarray(speed, float) * self.per_speed

    def restitution(self, St: NDArray | float) -> NDArray:
        """e_eff at Stokes numbers of the law."""
        arguments = (St, self.e_dry) if "e_dry" in self.closure.variables else (St,)
        return self.closure.value(*arguments)


def stokes_per_speed(key: str, conditions: Conditions) -> float:
    """St over the speed, s/m; of two spheres by reduced mass over reduced radius squared (lubrication)."""
    if conditions.partner is None:
        return float(convention(key).per_speed(conditions))
    both = (conditions.sphere, conditions.partner)
    d_1, d_2 = (sphere.diameter for sphere in both)
    # Of each sphere at a wall; times d^2 it goes as the mass.
    s_1, s_2 = (stokes_per_speed(key, at_a_wall(conditions, s)) * s.diameter**2 for s in both)
    return s_1 * s_2 / (s_1 + s_2) * ((d_1 + d_2) / (d_1 * d_2)) ** 2


def at_a_wall(conditions: Conditions, sphere: Sphere | None = None) -> Conditions:
    """The same fluid, and one of the spheres at a wall."""
    return conditions.model_copy(update={"sphere": sphere or conditions.sphere, "partner": None})


def impacts_of(closure: Closure, conditions: Conditions | None, e_dry: float | None, target: str) -> Impacts:
    """The impacts of a target's pair; raises :class:`InputError` naming what is missing."""
    if not closure.rebound:
        reason = _NO_REBOUND.get(closure.family, "it exports as a function: --to c, python, ...")
        rule = f"takes e_eff at impact; {closure.name} is a {closure.family} law: {reason}"
        raise InputError(Defect(rule, field="--to", value=target))
    if conditions is None:
        rule = "needs fluid and sphere: --fluid density=D,viscosity=MU --sphere diameter=D,density=RHO,e_dry=E"
        raise InputError(Defect(rule, field="--to", value=target))
    held = closure.e_dry if closure.e_dry is not None else conditions.sphere.e_dry
    if e_dry is not None and held is not None and e_dry != held:
        whose = "the fit" if closure.e_dry is not None else "the sphere"
        raise InputError(Defect(f"{whose} has {held:g} already", field="--e-dry", value=f"{e_dry:g}"))
    dry = next((x for x in (closure.e_dry, e_dry, conditions.sphere.e_dry) if x is not None), None)
    if dry is None:
        raise InputError(Defect("is needed: --e-dry 0.97, or --sphere ...,e_dry=0.97", field="e_dry"))
    if not 0 < dry <= 1:
        raise InputError(Defect("must lie above 0 and be at most 1", field="e_dry", value=f"{dry:g}"))
    return Impacts(closure, conditions, dry)
