"""Motion at a wall where an effective law owns the film: the law moves the sphere, and the fluid follows.

Within one ``edge`` of the wall the sphere falls freely, inwards and outwards; see
:class:`lbm.spheres.spheres.contact.FilmRebound`.
"""

from __future__ import annotations

import math

from lbm.errors import InputError
from lbm.spheres.contact import FilmRebound, Impact
from lbm.spheres.film import Film
from lbm.spheres.motion import Motion


class CarriedMotion(Motion):
    """The motion of :class:`lbm.spheres.spheres.contact.FilmRebound`.

    It remembers whether the sphere is ``inside`` the film (1 or 0) and the ``count`` of impacts.
    """

    remembered = ("inside", "count")

    def __init__(self, film: Film | None, contact: FilmRebound, fraction: float):
        if film is not None and film.normal is not None:
            raise InputError(
                "FilmRebound with a normal force of the film counts the viscous loss twice: "
                "take Film(normal=None), or DryRebound"
            )
        self.contact = contact
        self.inside = self.count = 0.0

    def matters(self, gap: float, v: float) -> bool:
        """From the edge of the film on."""
        return gap + 2 * min(v, 0.0) < self.contact.edge + 0.1

    def step(self, time, gap, v, fluid, weight, mass):
        """Moved by the fluid outside the film, by the law within."""
        if self._rests(gap, v):
            self.inside = float(fluid + weight <= 0)
            if self.inside:
                return gap, v, []
        elif gap < self.contact.edge and v < 0:
            self.inside = 1.0
        if not self.inside:
            acceleration = (fluid + weight) / mass
            moved = gap + v + 0.5 * acceleration
            if moved < 0 and gap < self.contact.edge:  # lifted for a moment, then pressed down: it lies as before
                self.inside = 1.0
                return 0.0, 0.0, []
            return moved, v + acceleration, []
        return self._move_inside(time, gap, v)

    def _rests(self, gap: float, v: float) -> bool:
        """Whether the sphere lies on the wall, from where only the fluid can lift it."""
        return bool(self.inside) and gap == 0.0 and v == 0.0

    def _move_inside(self, time: float, gap: float, v: float) -> tuple[float, float, list[Impact]]:
        contact, impacts, fall = self.contact, [], self.contact.free_fall
        left = 1.0
        while left > 0:
            dt = _time_to_wall(gap, v, fall)
            if dt > left:
                gap, v = gap + v * left - 0.5 * fall * left * left, v - fall * left
                break
            v_in = fall * dt - v
            v_out = contact.rebound(v_in, int(self.count))
            left -= dt
            self.count += 1
            if 2 * v_out < fall or v_out == 0:  # it would be back within one step
                impacts.append(Impact(time + 1 - left, v_in, 0.0))
                return 0.0, 0.0, impacts
            impacts.append(Impact(time + 1 - left, v_in, v_out))
            gap, v = 0.0, v_out
        if gap >= contact.edge and v > 0:
            self.inside = 0.0
        return gap, v, impacts


def _time_to_wall(gap: float, v: float, fall: float) -> float:
    """Positive root of gap + v t - fall t^2/2 = 0, or infinity."""
    root = math.sqrt(v * v + 2 * fall * gap)
    if v < 0:
        return 2 * gap / (root - v)
    return (v + root) / fall if fall > 0 else math.inf
