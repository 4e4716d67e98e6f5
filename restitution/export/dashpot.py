r"""Stiffness and damping of a spring-dashpot contact from the restitution it is to deliver, and the inverse.

    m x'' + c x' + k x = 0                  linear spring,
    m x'' + c x^(1/4) x' + k x^(3/2) = 0    Hertz, with the damping of Tsuji et al. (1992),

x being the overlap, m the reduced mass. The second is the first in disguise: with z = (4/5) x^(5/4) and
d(tau) = x^(1/4) dt the speed v = dz/d(tau) obeys m v' + c v + (5/4) k z = 0 (Antypov & Elliott 2011). Hence one
damping ratio,

    zeta = c/(2 sqrt(m k))  linear,      zeta = c/sqrt(5 m k)  Hertz,

and e depends on it alone, not on the impact speed. It does depend on when the contact is taken to end:

    overlap to zero   e = exp[-pi zeta/sqrt(1 - zeta^2)]                      zeta < 1
    force to zero     e = exp[-2 zeta acos(zeta)/sqrt(1 - zeta^2)]            zeta < 1
                      e = exp[-2 zeta acosh(zeta)/sqrt(zeta^2 - 1)]           zeta > 1

Under the first rule the spring pulls before it lets go; codes that cut this tension (`limit_damping` of LAMMPS,
`limitForce on` of LIGGGHTS, YADE's ViscEl contact) follow the second, but set c by the first: typed 0.5, they
deliver 0.55. :func:`typed` is what to type there. The second rule is Schwager & Poeschel's formula (2007), with
pi - atan(2 zeta s/(1 - 2 zeta^2)) = 2 acos(zeta), s = sqrt(1 - zeta^2).

Sources: Schwager & Poeschel, Granular Matter 9, 465 (2007); Tsuji, Tanaka & Ishida, Powder Technol. 71, 239
(1992); Antypov & Elliott, EPL 94, 50004 (2011). The papers were not opened; the formulas follow from the equations
above.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from restitution.errors import Defect, InputError


class End(StrEnum):
    """When a contact ends."""

    OVERLAP = "overlap"
    """When the spheres no longer overlap; until then the force may pull."""
    FORCE = "force"
    """When the force is zero: it never pulls."""


class Spring(StrEnum):
    """How the elastic force grows with the overlap x."""

    LINEAR = "linear"
    """k x, damped by c x'."""
    HERTZ = "hertz"
    """k x^(3/2), damped by c x^(1/4) x'."""


_LARGEST_RATIO = 1e6
"""Damping ratio beyond which no contact is sought; e is about 1/(4 zeta^2) there, 2.5e-13."""
_UNDAMPED_HERTZ = 4 * math.sqrt(math.pi) * math.gamma(0.4) / (5 * math.gamma(0.9))
"""Contact time of an undamped Hertz contact over greatest overlap/impact speed: 2.943."""


def restitution(zeta: float, end: End | str = End.OVERLAP) -> float:
    """The restitution that a damping ratio delivers; the same for either spring."""
    if not zeta >= 0:
        raise InputError(Defect("must not be negative", field="zeta", value=f"{zeta:g}"))
    if End(end) is End.OVERLAP:
        return math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2)) if zeta < 1 else 0.0
    return math.exp(-2 * zeta * _angle_over_sine(zeta))


def _angle_over_sine(zeta: float) -> float:
    """acos(zeta)/sqrt(1 - zeta^2), and acosh(zeta)/sqrt(zeta^2 - 1) beyond 1, where it is 1."""
    departure = zeta - 1
    if abs(departure) < 1e-6:  # first terms of the series: both roots vanish
        return 1 - departure / 3
    if zeta < 1:
        return math.acos(zeta) / math.sqrt(1 - zeta**2)
    return math.acosh(zeta) / math.sqrt(zeta**2 - 1)


def damping_ratio(e: float, end: End | str = End.OVERLAP) -> float:
    """The damping ratio that delivers ``e``, 0 < e <= 1; raises :class:`InputError` for any other."""
    if not 0 < e <= 1:
        raise InputError(Defect("a spring and a dashpot deliver 0 < e <= 1", field="e", value=f"{e:g}"))
    if End(end) is End.OVERLAP:
        return -math.log(e) / math.hypot(math.pi, math.log(e))
    if e == 1:
        return 0.0
    if e < restitution(_LARGEST_RATIO, End.FORCE):
        raise InputError(Defect("is too small for a dashpot", field="e", value=f"{e:g}"))
    return _ratio_of_a_contact_that_does_not_pull(e)


def _ratio_of_a_contact_that_does_not_pull(e: float) -> float:
    """The damping ratio of 0 < e < 1 where the contact ends with the force, by bisection of its logarithm."""
    low, high, sought = math.log(1e-18), math.log(1e6), -math.log(e)
    while low < (low + high) / 2 < high:
        middle = (low + high) / 2
        ratio = math.exp(middle)
        if 2 * ratio * _angle_over_sine(ratio) < sought:
            low = middle
        else:
            high = middle
    return math.exp(high)


CONTACT_WITHOUT_TENSION = (_angle_over_sine, _ratio_of_a_contact_that_does_not_pull)
"""Functions of plain Python whose source goes into scripts of other programs; they need ``math`` alone."""


def typed(e: float, share: float = 1.0) -> float:
    """The e to type into a code that sets its damping by the overlap rule and cuts the tension, to have ``e``.

    ``share`` is what the contact gets of the damping ratio that the code means to set: 1/sqrt(2) at walls of YADE.

    Raises
    ------
    InputError : for an e that no e typed there delivers: up to exp(-2) = 0.135, of the share 1/sqrt(2) 0.208.
    """
    least = restitution(share, End.FORCE)
    if not least < e <= 1:
        rule = (
            f"a contact that is not let pull delivers {least:.3f} < e <= 1; a faster impact has more, and level 2"
        )
        raise InputError(Defect(rule, field="e", value=f"{e:g}"))
    return restitution(damping_ratio(e, End.FORCE) / share, End.OVERLAP)


@dataclass(frozen=True)
class Dashpot:
    """A contact: ``stiffness`` k in N/m (Hertz: N/m^1.5), ``damping`` c in kg/s (Hertz: kg/(s m^0.25)).

    ``mass`` is the reduced mass in kg: that of the sphere at a wall, m1 m2/(m1 + m2) of a pair.
    """

    stiffness: float
    damping: float
    mass: float
    end: End
    spring: Spring

    @property
    def ratio(self) -> float:
        """The damping ratio zeta."""
        if self.spring is Spring.HERTZ:
            return self.damping / math.sqrt(5 * self.mass * self.stiffness)
        return self.damping / (2 * math.sqrt(self.mass * self.stiffness))

    @property
    def restitution(self) -> float:
        """The e it delivers."""
        return restitution(self.ratio, self.end)

    def contact_time(self, speed: float | None = None) -> float:
        """In s; of a Hertz contact, which needs the impact ``speed`` in m/s, that without damping."""
        if self.spring is Spring.HERTZ:
            if speed is None:
                raise InputError(Defect("is needed for the contact time of a Hertz contact", field="speed"))
            overlap = (5 * self.mass * speed**2 / (4 * self.stiffness)) ** 0.4
            return _UNDAMPED_HERTZ * overlap / speed
        frequency, zeta = math.sqrt(self.stiffness / self.mass), self.ratio
        if self.end is End.FORCE:
            return 2 * _angle_over_sine(zeta) / frequency
        return math.pi / (frequency * math.sqrt(1 - zeta**2)) if zeta < 1 else math.inf


def dashpot(
    e: float,
    mass: float,
    *,
    stiffness: float | None = None,
    contact_time: float | None = None,
    end: End | str = End.OVERLAP,
    spring: Spring | str = Spring.LINEAR,
) -> Dashpot:
    """The contact that delivers ``e``.

    Parameters
    ----------
    e : restitution to be delivered.
    mass : reduced mass in kg: of the sphere at a wall, half of it for two equal spheres.
    stiffness : k in N/m, of a Hertz spring in N/m^1.5 (4/3 E* sqrt(r*)).
    contact_time : of a linear spring, in s, instead of the stiffness.
    end : when the contact ends: "overlap" to zero, or "force" to zero.
    spring : "linear" or "hertz".

    Returns
    -------
    Stiffness, damping and mass; its ``restitution`` is the e that it delivers.

    Raises
    ------
    InputError : for an e that no damping delivers, a mass or stiffness that is not positive, or neither or both
        of stiffness and contact time.
    """
    end, spring = End(end), Spring(spring)
    for name, value in (("mass", mass), ("stiffness", stiffness), ("contact_time", contact_time)):
        if value is not None and not 0 < value < math.inf:
            raise InputError(Defect("must be positive and finite", field=name, value=f"{value:g}"))
    if (stiffness is None) == (contact_time is None):
        raise InputError("give either the stiffness or the contact time of the contact")
    zeta = damping_ratio(e, end)
    if contact_time is not None:
        if spring is Spring.HERTZ:
            raise InputError(
                Defect("of a Hertz contact depends on the impact speed: give its stiffness", field="contact_time")
            )
        unit = Dashpot(1.0, 2 * zeta, 1.0, end, spring)
        stiffness = mass * (unit.contact_time() / contact_time) ** 2
    damping = (
        zeta * math.sqrt(5 * mass * stiffness)
        if spring is Spring.HERTZ
        else 2 * zeta * math.sqrt(mass * stiffness)
    )
    return Dashpot(stiffness, damping, mass, end, spring)
