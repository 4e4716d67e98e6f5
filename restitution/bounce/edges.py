"""An e_eff of one edge of the film as that of another, by the point particle.

Within the edge h_e of its film an e_eff stands for every viscous force; sphere and added mass fall freely there::

    (m + C_M(0) m_f) V^2 = (m + C_M(h_e) m_f) v^2 + 2 (m - m_f) g h_e,

v being the speed at the edge and V, of which e_eff is the ratio, that at the wall. One passage has a restitution
at each of two edges: a sphere that comes through the wider one with a given speed is carried to the narrower one
by the forces of :class:`restitution.bounce.Closures`, rebounds there with e_narrow, and is carried out again. The
restitution at the wider edge is that which gives the same speed outwards there; of a rebound that does not get
there, the same apex. The wider film thus has more of the loss in it. The wake of the approach takes no part, and
drag and history are those of Schiller & Naumann and Dorgan & Loth, whatever the defaults are: a conversion belongs
to what a law says, and runs have been told its numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from restitution.bounce.added_mass import added_mass
from restitution.bounce.closures import Closures, Release
from restitution.bounce.model import Trajectory, bounce
from restitution.conditions import Conditions
from restitution.errors import ConventionError, Defect, InputError
from restitution.laws.drag import SchillerNaumann1935, excess_weight, terminal_speed
from restitution.laws.history import DorganLoth2007
from restitution.laws.rebound import ReboundLaw
from restitution.stokes import Speed, StokesNumber, film_edge

_TOLERANCE = 1e-6
"""Of a step of the integration."""
_LOW_E, _HIGH_E = 1e-3, 1.0
_FASTEST = 20.0
"""Speed at the wide edge, over that at the narrow one, beyond which none is looked for."""


@dataclass(frozen=True)
class Passage:
    """A sphere that comes through the ``wide`` edge of a film and returns, two edges in diameters.

    ``speed``, in m/s towards the wall, is that with which it comes through the wide edge. Of a sphere that falls
    from rest within it, ``wide`` is where it begins to fall; where that is not above the narrow edge, both edges
    have one and the same e_eff.
    """

    conditions: Conditions
    narrow: float
    wide: float
    speed: float

    @property
    def v_wide(self) -> float:
        """The impact speed in m/s at the wide edge, carried to the wall."""
        return carried(self.conditions, self.speed, self.wide)

    @property
    def v_narrow(self) -> float:
        """The impact speed in m/s at the narrow edge, carried to the wall; 0 where it does not get there."""
        if self.wide <= self.narrow:
            return self.v_wide
        impacts = self._flight(0.0).impacts
        return float(impacts[0].v_in) if impacts else 0.0

    def widened(self, e: float) -> float:
        """The restitution at the wide edge of a rebound with ``e`` at the narrow one."""
        if self.wide <= self.narrow:
            return e
        path = self._flight(e)
        if not path.impacts or path.impacts[0].v_out == 0:
            return 0.0
        return _rebound_speed(path, self.wide) / self.v_wide

    def narrowed(self, e: float) -> float:
        """The restitution at the narrow edge of a rebound with ``e`` at the wide one; at most 1."""
        if self.wide <= self.narrow:
            return e
        if e <= self.widened(_LOW_E):
            return 0.0
        if e >= self.widened(_HIGH_E):
            return 1.0
        return float(brentq(lambda x: self.widened(x) - e, _LOW_E, _HIGH_E, xtol=1e-6))

    def _flight(self, e: float) -> Trajectory:
        c = self.conditions
        height = self.wide * c.sphere.diameter
        falls = math.sqrt(2 * height / c.free_fall) + self.v_wide / c.free_fall
        long = 10 * (falls + height / terminal_speed(c))
        closures = Closures(drag=SchillerNaumann1935(), history=DorganLoth2007(), measured=(e,), film=self.narrow)
        return bounce(c, Release(height, self.speed), closures, long, _TOLERANCE)


def carried(conditions: Conditions, speed: float, edge: float) -> float:
    """The speed in m/s at the wall of a free fall, or rise, that has ``speed`` at the ``edge`` (diameters)."""
    at_edge, at_wall, weight = _inertia(conditions, edge)
    return math.sqrt((at_edge * speed**2 + weight) / at_wall)


def at_edge(conditions: Conditions, v: float, edge: float) -> float:
    """The speed in m/s at the ``edge`` of a fall that meets the wall with ``v``; 0 of one that began below it."""
    at_edge, at_wall, weight = _inertia(conditions, edge)
    return math.sqrt(max(at_wall * v**2 - weight, 0.0) / at_edge)


def _inertia(conditions: Conditions, edge: float) -> tuple[float, float, float]:
    """Sphere and added mass at the edge and at the wall in kg, and twice the weight's work between them in J."""
    c = conditions
    fluid = c.fluid.density * math.pi / 6 * c.sphere.diameter**3
    C_edge, C_wall = added_mass(np.array([2 * edge, 0.0]))
    weight = 2 * excess_weight(c) * edge * c.sphere.diameter
    return c.sphere.mass + C_edge * fluid, c.sphere.mass + C_wall * fluid, weight


def _rebound_speed(path: Trajectory, edge: float) -> float:
    """The speed in m/s at the wall of a free rise that is the first rebound from the edge on."""
    c, first = path.conditions, path.impacts[0].time_s
    height = edge * c.sphere.diameter
    after = np.flatnonzero((path.time_s >= first) & (path.velocity_m_s > 0))
    above = after[path.gap_m[after] >= height]
    if len(above):
        i = above[0]
        begin, end = path.time_s[i - 1], path.time_s[i]
        when = end if path.gap_m[i] == height else brentq(lambda t: path.gap(t) - height, begin, end)
        return carried(c, float(path.velocity(min(when, np.nextafter(end, 0)))), edge)
    apex = float(path.apexes()[0]) if len(path.apexes()) else float(path.gap_m[after].max(initial=0.0))
    _, at_wall, _ = _inertia(c, edge)
    return math.sqrt(2 * excess_weight(c) * apex / at_wall)


@lru_cache(maxsize=4096)
def passage(conditions: Conditions, v: float, edge: float, other: float) -> Passage:
    """The passage of a sphere whose impact speed at ``edge`` is ``v`` (m/s), through that and the ``other`` edge.

    Raises :class:`InputError` for a speed that no sphere has there.
    """
    narrow, wide = sorted((edge, other))
    begin = fall_height(conditions, v)
    if begin <= narrow or (edge == wide and begin <= wide):
        return Passage(conditions, narrow, begin, 0.0)
    if edge == wide:
        return Passage(conditions, narrow, wide, at_edge(conditions, v, wide))
    at_rest, falling = Passage(conditions, narrow, wide, 0.0), Passage(conditions, narrow, wide, _FASTEST * v)
    if v < at_rest.v_narrow:
        height = brentq(lambda h: Passage(conditions, narrow, h, 0.0).v_narrow - v, narrow, wide, rtol=1e-9)
        return Passage(conditions, narrow, float(height), 0.0)
    if v > falling.v_narrow:
        rule = f"is more than a sphere can have left after its way from {wide:g} d to {narrow:g} d"
        raise InputError(Defect(rule, field="impact speed", value=f"{v:.3g}"))
    speed = brentq(lambda u: Passage(conditions, narrow, wide, u).v_narrow - v, 0.0, falling.speed, xtol=1e-9 * v)
    return Passage(conditions, narrow, wide, float(speed))


def fall_height(conditions: Conditions, v: float) -> float:
    """The gap in diameters from which a sphere at rest, in free fall, meets the wall with ``v`` (m/s)."""
    _, at_wall, _ = _inertia(conditions, 0.0)
    return at_wall * v**2 / (2 * excess_weight(conditions) * conditions.sphere.diameter)


@dataclass(frozen=True)
class LawAtEdge:
    """A rebound law whose constants belong to one edge of the film (``own``, in diameters), used at another.

    Called as any :class:`~restitution.laws.ReboundLaw`; the Stokes number is that of the impact speed at ``edge``.
    """

    law: ReboundLaw
    own: float
    edge: float

    @property
    def name(self) -> str:
        """Of the law, and between which edges it is converted."""
        return f"{self.law.name} of {self.own:g} d at {self.edge:g} d"

    @property
    def speed(self) -> Speed:
        """The impact speed that the law is meant for."""
        return self.law.speed

    def __call__(
        self, St: StokesNumber, e_dry: float, conditions: Conditions | None = None, out_of_range: str = "warn"
    ) -> float:
        """e_eff at ``edge``; raises :class:`ConventionError` without the conditions."""
        if conditions is None:
            raise ConventionError(f"{self.name}: the conversion needs fluid and sphere: pass conditions")
        per_speed = StokesNumber.from_speed(1.0, conditions, St.convention).value

        def restitution(v: float) -> float:
            own = StokesNumber.from_speed(v, conditions, St.convention, St.speed)
            return float(self.law(own, e_dry, conditions, out_of_range))

        return restitution_at(conditions, float(St.value) / per_speed, self.edge, self.own, restitution)


def restitution_at(
    conditions: Conditions, v: float, edge: float, own: float, restitution: Callable[[float], float]
) -> float:
    """e_eff at ``edge`` of an impact at ``v`` (m/s) there, of which ``restitution`` knows that at ``own``.

    ``restitution(v)`` is asked with the impact speed in m/s at its own edge.
    """
    if edge == own:
        return restitution(v)
    through = passage(conditions, v, edge, own)
    if own < edge:
        speed = through.v_narrow
        return through.widened(restitution(speed)) if speed > 0 else 0.0
    return through.narrowed(restitution(through.v_wide))


def law_at(law: ReboundLaw, edge: float, own: float | None = None) -> ReboundLaw | LawAtEdge:
    """A law as it is to be used at ``edge``, in diameters.

    Parameters
    ----------
    law : any rebound law.
    edge : of the film outside which the speeds are those of the motion.
    own : the edge that the law's constants belong to; by default the law's own, and of a law whose source states
        none ``edge`` itself.

    Raises
    ------
    InputError : for an edge out of range.
    """
    own = law.edge if own is None else own
    edge = film_edge(edge)
    if own is None or own == edge:
        return law
    return LawAtEdge(law, film_edge(own, "own"), edge)
