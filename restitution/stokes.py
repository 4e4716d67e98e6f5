"""Which Stokes number, and which impact speed: the definitions, and the only way from one to another.

A Stokes number is a number *and* a convention. The literature on wet rebound uses at least five, up to a
factor of 18 apart, under the same symbol, so this package never passes a bare float: it passes a
:class:`StokesNumber`, which knows its convention and the impact speed it was made with.

All conventions are linear in the impact speed v, St = v * per_speed(conditions), so a conversion is a ratio.

================  ==========================================  =================================================
key               definition                                  used by
================  ==========================================  =================================================
``st``            rho_p v d / (9 mu) = m v / (6 pi mu r^2)    Joseph 2001, Gondret 2002, Biegert 2017 (default)
``st_star``       (rho_p + rho_f/2) v d / (9 mu)              Legendre 2005, 2006: added mass of a free sphere
``st_d``          rho_p v d / mu                              codes that leave out the 9
``st_18``         rho_p v d / (18 mu)                         relaxation time over d/v, turbulence literature
``st_b``          m* v / (6 pi mu r*^2)                       Davis 1986, Yang & Hunt 2006: reduced mass, radius
================  ==========================================  =================================================
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from restitution.errors import ConventionError, Defect, InputError

if TYPE_CHECKING:
    from restitution.conditions import Conditions


class Speed(StrEnum):
    """Which speed of the sphere an impact is described by; the same word serves approach and rebound.

    The definitions are carried out in :mod:`restitution.impacts`.
    """

    FAR = "far"
    """Of the motion outside the film, at gaps above :data:`H_FILM`, carried to the wall."""
    CONTACT = "contact"
    """The motion extrapolated to the instant of contact."""
    WINDOW = "window"
    """The mean slope of the track over a stated number of frames next to the contact."""
    FILM_EDGE = "film_edge"
    """At the edge of the elastohydrodynamic film, the gap D*: not seen by a camera, meant by theory."""
    UNSTATED = "unstated"
    """Of a law: its source does not say which, any is taken. Of a number: nobody said."""


MEASURED_SPEEDS = (Speed.FAR, Speed.CONTACT, Speed.WINDOW)
"""The definitions that a track can be measured by."""
H_FILM = 0.1
"""Gap outside which a sphere counts as outside the film, in diameters: where the ``far`` speed is of.

An e_eff of the ``far`` speed has the film of one edge in it, this one where nobody states another: the wider the
film, the more of the loss is in e_eff. A number of another edge is converted (:mod:`restitution.bounce.edges`).
"""
WIDEST_FILM = 1.0
"""Edge in diameters beyond which nothing is a film."""


@dataclass(frozen=True)
class Convention:
    """One definition of the Stokes number: ``per_speed(conditions)`` is St over the impact speed, in s/m."""

    key: str
    symbol: str
    latex: str
    definition: str
    source: str
    per_speed: Callable[[Conditions], float]


def _reduced_mass_over_area(c: Conditions) -> float:
    """m*/(6 pi mu r*^2) with m* = m1 m2/(m1+m2), r* = r1 r2/(r1+r2); a wall has infinite mass and radius."""
    mass, radius = c.sphere.mass, c.sphere.radius
    if c.partner is not None:
        mass = mass * c.partner.mass / (mass + c.partner.mass)
        radius = radius * c.partner.radius / (radius + c.partner.radius)
    return mass / (6 * np.pi * c.fluid.viscosity * radius**2)


CONVENTIONS: dict[str, Convention] = {
    c.key: c
    for c in (
        Convention(
            "st",
            "St",
            r"St = \rho_p v d / (9 \mu)",
            "rho_p v d/(9 mu)",
            "Joseph et al. 2001; Gondret et al. 2002; Biegert et al. 2017, arXiv:1608.03566, introduction",
            lambda c: c.sphere.density * c.sphere.diameter / (9 * c.fluid.viscosity),
        ),
        Convention(
            "st_star",
            "St^*",
            r"St^* = (\rho_p + \rho_f/2) v d / (9 \mu)",
            "(rho_p + rho_f/2) v d/(9 mu)",
            "Legendre et al. 2005, 2006, as implemented in public code (added-mass coefficient 0.5)",
            lambda c: (c.sphere.density + 0.5 * c.fluid.density) * c.sphere.diameter / (9 * c.fluid.viscosity),
        ),
        Convention(
            "st_d",
            "St_d",
            r"St_d = \rho_p v d / \mu",
            "rho_p v d/mu",
            "YADE lubrication validation script",
            lambda c: c.sphere.density * c.sphere.diameter / c.fluid.viscosity,
        ),
        Convention(
            "st_18",
            "St_{18}",
            r"St_{18} = \rho_p v d / (18 \mu)",
            "rho_p v d/(18 mu)",
            "common in the turbulence literature; no single source was opened",
            lambda c: c.sphere.density * c.sphere.diameter / (18 * c.fluid.viscosity),
        ),
        Convention(
            "st_b",
            "St_B",
            r"St_B = m^* v / (6 \pi \mu r^{*2})",
            "m* v/(6 pi mu r*^2), m* = m1 m2/(m1+m2), r* = r1 r2/(r1+r2)",
            "Davis et al. 1986; Yang & Hunt 2006; Nijssen et al. 2022",
            _reduced_mass_over_area,
        ),
    )
}

# Fixed ratios to ``st`` that hold for any sphere and fluid, so that these need no conditions.
_RATIO_TO_ST = {"st": 1.0, "st_d": 9.0, "st_18": 0.5}


def film_edge(given: float, field: str = "edge") -> float:
    """An edge of the film in diameters; raises :class:`InputError` for one out of range."""
    if not 0 < given <= WIDEST_FILM:  # also NaN
        rule = f"is the edge of the film in diameters: above 0, at most {WIDEST_FILM:g}"
        raise InputError(Defect(rule, field=field, value=f"{given:g}"))
    return given


def convention(key: str) -> Convention:
    """The convention of that key; raises :class:`ConventionError` naming the known ones."""
    try:
        return CONVENTIONS[key]
    except KeyError:
        raise ConventionError(f"unknown Stokes convention {key!r}; known: {', '.join(CONVENTIONS)}") from None


@dataclass(frozen=True)
class StokesNumber:
    """A Stokes number (scalar or array) with the convention and the impact speed it stands for."""

    value: float | np.ndarray
    convention: str = "st"
    speed: Speed = Speed.UNSTATED

    def __post_init__(self) -> None:
        convention(self.convention)
        object.__setattr__(self, "speed", Speed(self.speed))

    @classmethod
    def from_speed(
        cls, v: float | np.ndarray, conditions: Conditions, key: str = "st", speed: Speed = Speed.UNSTATED
    ) -> StokesNumber:
        """St of an impact speed.

        Parameters
        ----------
        v : impact speed in m/s, positive towards the wall; a number or an array.
        conditions : fluid and sphere (and wall or partner, for conventions that need it).
        key : convention, "st" = rho_p v d/(9 mu) by default; all are in :data:`CONVENTIONS`.
        speed : which impact speed ``v`` is.

        Raises
        ------
        InputError : for an unknown convention, or one that the conditions do not suffice for.
        """
        return cls(np.asarray(v, float)[()] * convention(key).per_speed(conditions), key, speed)

    def to(self, key: str, conditions: Conditions | None = None) -> StokesNumber:
        """The same impact in convention ``key``.

        ``st``, ``st_d`` and ``st_18`` differ by fixed factors; the others depend on the density ratio or on
        the second body, and without ``conditions`` this raises :class:`ConventionError`.
        """
        target = convention(key)
        if key == self.convention:
            return self
        if key in _RATIO_TO_ST and self.convention in _RATIO_TO_ST:
            ratio = _RATIO_TO_ST[key] / _RATIO_TO_ST[self.convention]
        elif conditions is None:
            raise ConventionError(
                f"a Stokes number of convention {self.convention!r} was given where {key!r} is needed; "
                f"the two differ by a factor that depends on fluid and sphere: pass conditions"
            )
        else:
            ratio = target.per_speed(conditions) / convention(self.convention).per_speed(conditions)
        return replace(self, value=self.value * ratio, convention=key)

    def read_as(self, speed: Speed | str) -> StokesNumber:
        """The same number, taken by the caller's decision as one made with another impact speed.

        There is no conversion between impact speeds: it would need a model of the film. This states in the
        caller's code that the difference is ignored.
        """
        return replace(self, speed=Speed(speed))
