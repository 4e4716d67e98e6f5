"""Motion of a sphere along the normal of a wall during one fluid step, in sub-steps of its own.

With gap h, velocity v positive away from the wall, F fluid's force and weight, per sub-step::

    v' - v = dt [F/m + F_film(h_mid, (v + v')/2)/(m + m_a)],   h' = h + dt (v + v')/2,   h_mid = h + v dt/2

the implicit midpoint rule in v, second order. dt is at most ``fraction`` of h/|v|: the film is resolved
whatever the fluid's step, and the moment of contact falls where it falls.

Film and contact change the velocity within less time than sound needs to pass the sphere on the lattice. In
the liquid that is no time at all: they act on sphere and added mass m_a together. So with a
:class:`lbm.contact.DryRebound` they do here, and since the lattice's fluid asks the sphere for the impulse
m_a (change of velocity) only afterwards, that impulse is kept as a debt and the fluid's force is not passed on
to the sphere until it is paid. The principle has no time or number of steps to choose.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, fields

from lbm.contact import Contact, DryRebound, FilmRebound, SoftContact
from lbm.errors import InputError
from lbm.film import Film

FRACTION = 0.05
_FEWEST = 4  # sub-steps a step near a wall
_PER_CONTACT = 200  # sub-steps a soft contact


@dataclass
class WallState:
    """What a sphere remembers of one wall; NaN where there is nothing to remember.

    ``onset`` velocity at the film's cut-off, ``owed`` impulse that film and wall have still to pay to the
    fluid, ``touching`` speed at the begin of a soft contact; for :class:`FilmRebound` ``inside`` the film or
    not, the ``acceleration`` there, time and velocity (``timed``, ``passed``) two edges away, and the
    ``count`` of impacts.
    """

    onset: float = math.nan
    owed: float = 0.0
    touching: float = math.nan
    inside: float = 0.0
    acceleration: float = 0.0
    timed: float = math.nan
    passed: float = math.nan
    count: float = 0.0

    def row(self) -> tuple[float, ...]:
        """The state as numbers."""
        return astuple(self)


STATE_SIZE = len(fields(WallState))


@dataclass(frozen=True)
class Impact:
    """One contact: ``step`` (with fraction), speeds before and after it at the wall, or carried to it."""

    step: float
    speed_in: float
    speed_out: float


class WallMotion:
    """The rules for a sphere of ``mass`` at a wall; lengths in cells, times in steps."""

    def __init__(self, film: Film | None, contact: Contact | None, fraction: float = FRACTION):
        if isinstance(contact, FilmRebound) and film is not None and film.normal is not None:
            raise InputError(
                "FilmRebound with a normal force of the film counts the viscous loss twice: "
                "take Film(normal=None), or DryRebound"
            )
        if not 0 < fraction <= 0.5:
            raise InputError(f"fraction = {fraction:g}: sub-steps must lie in (0, 0.5] of gap / speed")
        self.film, self.contact, self.fraction = film, contact, fraction
        self.cut_off = film.cut_off if film else 0.0
        self.touch = film.floor if film else 0.0
        self.added_mass = contact.added_mass if isinstance(contact, DryRebound) else 0.0

    def matters(self, gap: float, v: float) -> bool:
        """Whether the wall may act within the next step."""
        near = 2 * self.contact.edge if isinstance(self.contact, FilmRebound) else self.cut_off
        return gap + 2 * min(v, 0.0) < near + 0.1

    def step(self, state: WallState, time: float, gap: float, v: float, fluid: float, weight: float, mass: float):
        """Gap, velocity and impacts one step later; ``weight`` is less buoyancy."""
        if isinstance(self.contact, FilmRebound):
            return self._carried(state, self.contact, time, gap, v, (fluid + weight) / mass)
        paid = min(max(-fluid, min(state.owed, 0.0)), max(state.owed, 0.0))
        state.owed -= paid
        force = fluid + paid + weight
        impacts: list[Impact] = []
        elapsed = 0.0
        while elapsed < 1.0:
            dt = min(1.0 - elapsed, self._substep_size(gap, v))
            if gap >= self.cut_off:
                state.onset = math.nan
            elif math.isnan(state.onset) and v < 0:
                state.onset = v
            new_gap, new_v = self._substep(state, gap, v, force, mass, dt)
            if isinstance(self.contact, DryRebound) and new_gap < self.touch and new_v < 0:
                part = max(0.0, (gap - self.touch) / (gap - new_gap))
                v_in = -(v + part * (new_v - v))
                out = self.contact.e_dry * v_in
                elapsed += part * dt
                if force < 0 and -2 * out * mass / force < 1:
                    # It would be back within one step: at rest on the wall until something lifts it.
                    return self.touch, 0.0, [*impacts, Impact(time + elapsed, v_in, 0.0)] if v != 0 else impacts
                impacts.append(Impact(time + elapsed, v_in, out))
                state.owed += self.added_mass * (out + v_in)
                state.onset = math.nan
                gap, v = self.touch, out
                continue
            if isinstance(self.contact, SoftContact):
                impacts += self._soft_impact(state, time + elapsed, gap, v, new_gap, new_v)
            gap, v = new_gap, new_v
            elapsed += dt
        return gap, v, impacts

    def _substep_size(self, gap: float, v: float) -> float:
        if v == 0:
            return 1.0
        dt = 1.0
        if gap < 2 * self.cut_off + 0.1:
            dt = min(1 / _FEWEST, self.fraction * max(gap, self.touch, 1e-6) / abs(v))
        if isinstance(self.contact, SoftContact):
            dt = min(1 / _FEWEST, max(dt, self.fraction * self.touch / abs(v)))
            if gap < self.touch + abs(v) * dt:
                dt = min(dt, self.contact.duration / _PER_CONTACT)
        return dt

    def _substep(self, state: WallState, gap: float, v: float, force: float, mass: float, dt: float):
        middle = gap + 0.5 * dt * v
        if isinstance(self.contact, SoftContact) and middle < self.touch and not math.isnan(state.touching):
            force += self.contact.force(self.touch - middle, v, state.touching)
        still = slope = 0.0
        if self.film is not None and middle > 0:
            still, slope = self.film.resistance(middle, v, state.onset if v < 0 else math.nan)
        inertia = mass + self.added_mass
        half = 0.5 * slope * dt / inertia
        new = (v * (1 + half) + (force / mass + still / inertia) * dt) / (1 - half)
        state.owed += self.added_mass * (new - v - dt * force / mass)
        return gap + 0.5 * dt * (v + new), new

    def _soft_impact(self, state, time, gap, v, new_gap, new_v) -> list[Impact]:
        if math.isnan(state.touching) and new_gap < self.touch and new_v < 0:
            state.touching = -new_v
        elif not math.isnan(state.touching) and new_gap >= self.touch and new_v > 0:
            found = [Impact(time, state.touching, new_v)]
            state.touching = math.nan
            return found
        return []

    def _carried(self, state: WallState, contact: FilmRebound, time, gap, v, acceleration):
        """The motion when the closure owns the film; see :class:`lbm.contact.FilmRebound`."""
        impacts: list[Impact] = []
        if not state.inside:
            if gap >= 2 * contact.edge or v >= 0:
                state.timed, state.passed = math.nan, math.nan
            elif math.isnan(state.timed):
                state.timed, state.passed = time, v
            if gap >= contact.edge or v >= 0:
                return gap + v + 0.5 * acceleration, v + acceleration, impacts
            state.inside = 1.0
            state.acceleration = 0.0
            if time > state.timed:
                state.acceleration = (v - state.passed) / (time - state.timed)
        left = 1.0
        while left > 0:
            a = state.acceleration
            dt = _time_to_wall(gap, v, a)
            if dt > left:
                gap, v = gap + v * left + 0.5 * a * left * left, v + a * left
                break
            v_in = -(v + a * dt)
            out = contact.rebound(v_in, int(state.count))
            left -= dt
            state.count += 1
            state.acceleration = -contact.free_fall
            impacts.append(Impact(time + 1 - left, v_in, out))
            gap, v = 0.0, out
            if 2 * out < contact.free_fall:
                return 0.0, 0.0, impacts
        if gap >= contact.edge and v > 0:
            state.inside = 0.0
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
