"""Motion at a wall where an effective law owns the film: the law moves the sphere, and the fluid follows.

Within one ``edge`` of the wall the sphere moves with constant acceleration: inwards the mean one of the last edge
before, outwards that of its free fall; see :class:`lbm.spheres.spheres.contact.FilmRebound`.
"""

from __future__ import annotations

import math

from lbm.errors import InputError
from lbm.spheres.contact import FilmRebound, Impact
from lbm.spheres.film import Film
from lbm.spheres.motion import Motion


class CarriedMotion(Motion):
    """The motion of :class:`lbm.spheres.spheres.contact.FilmRebound`.

    It remembers whether the sphere is ``inside`` the film (1 or 0) and with what ``acceleration``, time and
    velocity (``timed``, ``passed``) two edges away, and the ``count`` of impacts.
    """

    remembered = ("inside", "acceleration", "timed", "passed", "count")

    def __init__(self, film: Film | None, contact: FilmRebound, fraction: float):
        if film is not None and film.normal is not None:
            raise InputError(
                "FilmRebound with a normal force of the film counts the viscous loss twice: "
                "take Film(normal=None), or DryRebound"
            )
        self.contact = contact
        self.inside = self.acceleration = self.count = 0.0
        self.timed = self.passed = math.nan

    def matters(self, gap: float, v: float) -> bool:
        """Two edges away the approach begins to be timed."""
        return gap + 2 * min(v, 0.0) < 2 * self.contact.edge + 0.1

    def step(self, time, gap, v, fluid, weight, mass):
        """Moved by the fluid outside the film, by the law within."""
        if not self.inside:
            self._time_approach(time, gap, v)
            if gap >= self.contact.edge or v >= 0:
                acceleration = (fluid + weight) / mass
                return gap + v + 0.5 * acceleration, v + acceleration, []
            self._enter(time, v)
        return self._move_inside(time, gap, v)

    def _time_approach(self, time: float, gap: float, v: float) -> None:
        if gap >= 2 * self.contact.edge or v >= 0:
            self.timed, self.passed = math.nan, math.nan
        elif math.isnan(self.timed):
            self.timed, self.passed = time, v

    def _enter(self, time: float, v: float) -> None:
        self.inside = 1.0
        self.acceleration = 0.0
        if time > self.timed:
            self.acceleration = (v - self.passed) / (time - self.timed)

    def _move_inside(self, time: float, gap: float, v: float) -> tuple[float, float, list[Impact]]:
        contact, impacts = self.contact, []
        left = 1.0
        while left > 0:
            a = self.acceleration
            dt = _time_to_wall(gap, v, a)
            if dt > left:
                gap, v = gap + v * left + 0.5 * a * left * left, v + a * left
                break
            v_in = -(v + a * dt)
            v_out = contact.rebound(v_in, int(self.count))
            left -= dt
            self.count += 1
            self.acceleration = -contact.free_fall
            impacts.append(Impact(time + 1 - left, v_in, v_out))
            gap, v = 0.0, v_out
            if 2 * v_out < contact.free_fall:
                return 0.0, 0.0, impacts
        if gap >= contact.edge and v > 0:
            self.inside = 0.0
        return gap, v, impacts


def _time_to_wall(gap: float, v: float, a: float) -> float:
    """First positive root of gap + v t + a t^2/2 = 0, or infinity."""
    inner = v * v - 2 * a * gap
    if inner < 0:
        return math.inf
    root = math.sqrt(inner)
    if v < 0:
        return 2 * gap / (root - v)
    return (v + root) / -a if a < 0 else math.inf
