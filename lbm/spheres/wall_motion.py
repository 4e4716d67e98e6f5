"""Motion of a sphere along the normal of a wall during one fluid step, in sub-steps of its own.

With gap h, velocity v positive away from the wall, F fluid's force and weight, per sub-step::

    v' - v = dt [F/m + F_film(h_mid, (v + v')/2)/(m + m_a)],   h' = h + dt (v + v')/2,   h_mid = h + v dt/2

the implicit midpoint rule in v, second order. dt is at most ``fraction`` of h/|v|: the film is resolved
whatever the fluid's step, and the moment of contact falls where it falls.

Film and contact change the velocity within less time than sound needs to pass the sphere on the lattice. In
the liquid that is no time at all: they act on sphere and added mass m_a together. So with a
:class:`lbm.spheres.spheres.contact.DryRebound` they do here. Since the lattice's fluid asks the sphere for the
impulse m_a (change of velocity) only afterwards, what the film owes is kept as a debt, and the fluid's force is
not passed on to the sphere until it is paid. After a rebound the fluid answers with sound to and fro, and with a
layer that is thinner than a cell; what it asks for the added mass is not told from that by its sign or size. So
until sound is gone the sphere has a liquid's force of the jump, Basset's, and then the lattice's again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from lbm.arguments import shown
from lbm.errors import InputError
from lbm.faces.records import FACES
from lbm.fluid.lattice import BOUNCE
from lbm.spheres.carried import CarriedMotion
from lbm.spheres.contact import Contact, DryRebound, FilmRebound, Impact, SoftContact
from lbm.spheres.film import Film
from lbm.spheres.motion import Motion

FRACTION = 0.05
_FEWEST = 4  # sub-steps a step near a wall
_PER_CONTACT = 200  # sub-steps a soft contact


class SubStep(NamedTuple):
    """Gap and velocity before and after a time ``dt``; ``begin`` is counted from the begin of the fluid's step."""

    begin: float
    dt: float
    gap: float
    v: float
    new_gap: float
    new_v: float


class FilmMotion(Motion):
    """The sub-steps in the film, and the whole motion where there is no contact: nothing stops the sphere.

    It remembers the ``onset``, the velocity at the film's cut-off.
    """

    remembered = ("onset",)
    added_mass = 0.0
    """Mass that film and contact move with the sphere."""

    def __init__(self, film: Film | None, contact: Contact | None, fraction: float):
        self.film, self.contact, self.fraction = film, contact, fraction
        self.cut_off = film.cut_off if film else 0.0
        self.touch = film.floor if film else 0.0
        self.onset = math.nan

    def matters(self, gap: float, v: float) -> bool:
        """The film begins at its cut-off."""
        return gap + 2 * min(v, 0.0) < self.cut_off + 0.1

    def step(self, time, gap, v, fluid, weight, mass):
        """Sub-step after sub-step, each ended as the contact has it."""
        force = self._passed_on(fluid) + weight
        impacts: list[Impact] = []
        elapsed = 0.0
        while elapsed < 1.0:
            dt = min(1.0 - elapsed, self._substep_size(gap, v))
            if gap >= self.cut_off:
                self.onset = math.nan
            elif math.isnan(self.onset) and v < 0:
                self.onset = v
            sub = SubStep(elapsed, dt, gap, v, *self._substep(gap, v, force, mass, dt))
            elapsed, gap, v, impact = self._end(sub, force, mass)
            if impact is not None:
                impacts.append(replace(impact, step=time + impact.step))
        return gap, v, impacts

    def _passed_on(self, fluid: float) -> float:
        """What the sphere feels of the fluid's force."""
        return fluid

    def _substep_size(self, gap: float, v: float) -> float:
        if v == 0:
            return 1.0
        if gap < 0 and self.touch == 0:  # no film is left that asks for less
            return 1 / _FEWEST
        if gap < 2 * self.cut_off + 0.1:
            return min(1 / _FEWEST, self.fraction * max(gap, self.touch, 1e-6) / abs(v))
        return 1.0

    def _substep(self, gap: float, v: float, force: float, mass: float, dt: float) -> tuple[float, float]:
        middle = gap + 0.5 * dt * v
        force += self._solid_force(middle, v)
        still = slope = 0.0
        if self.film is not None and middle > 0:
            still, slope = self.film.resistance(middle, v, self.onset if v < 0 else math.nan)
        inertia = mass + self.added_mass
        half = 0.5 * slope * dt / inertia
        new = (v * (1 + half) + (force / mass + still / inertia) * dt) / (1 - half)
        return gap + 0.5 * dt * (v + new), new

    def _solid_force(self, gap: float, v: float) -> float:
        """What the wall itself pushes with."""
        return 0.0

    def _end(self, sub: SubStep, force: float, mass: float) -> tuple[float, float, float, Impact | None]:
        """Moment, gap and velocity from which to go on after ``sub``, and the impact if there was one."""
        return sub.begin + sub.dt, sub.new_gap, sub.new_v, None


class DryMotion(FilmMotion):
    """The motion of :class:`lbm.spheres.spheres.contact.DryRebound`.

    It also remembers the impulse ``owed``, which the film has still to pay to the fluid; and the ``jump`` of the
    velocity at the last rebound with the time ``since`` then, as long as sound decides the fluid's force.
    """

    remembered = ("onset", "owed", "jump", "since")

    def __init__(self, film: Film | None, contact: DryRebound, fraction: float):
        super().__init__(film, contact, fraction)
        self.added_mass = contact.added_mass
        self.owed = 0.0
        self.jump = self.since = math.nan

    def matters(self, gap, v):
        """Also until the fluid has answered to the last rebound."""
        return not math.isnan(self.since) or super().matters(gap, v)

    def _passed_on(self, fluid):
        if not math.isnan(self.since):
            return self._liquid_answer()
        paid = min(max(-fluid, min(self.owed, 0.0)), max(self.owed, 0.0))
        self.owed -= paid
        return fluid + paid

    def _liquid_answer(self) -> float:
        """Basset's force of the jump, its mean over the step; the first one from the jump on."""
        begin, end = self.since if self.since > 1 else 0.0, self.since + 1
        self.since = end if end < self.contact.settling else math.nan
        self.owed = 0.0
        return -self.contact.history * self.jump * (math.sqrt(end) - math.sqrt(begin))

    def _end(self, sub, force, mass):
        begin, dt, gap, v, new_gap, new_v = sub
        self.owed += self.added_mass * (new_v - v - dt * force / mass)
        if not (new_gap < self.touch and new_v < 0):
            return super()._end(sub, force, mass)
        part = max(0.0, (gap - self.touch) / (gap - new_gap))
        moment = begin + part * dt
        v_in = -(v + part * (new_v - v))
        v_out = self.contact.e_dry * v_in
        if force < 0 and -2 * v_out * mass / force < 1:
            # It would be back within one step: at rest on the wall until something lifts it.
            return math.inf, self.touch, 0.0, Impact(moment, v_in, 0.0) if v != 0 else None
        self.jump, self.since = v_out + v_in, 1 - moment
        self.onset = math.nan
        return moment, self.touch, v_out, Impact(moment, v_in, v_out)


class SoftMotion(FilmMotion):
    """The motion of :class:`lbm.spheres.spheres.contact.SoftContact`.

    It also remembers ``touching``, the speed at the begin of a contact.
    """

    remembered = ("onset", "touching")

    def __init__(self, film: Film | None, contact: SoftContact, fraction: float):
        super().__init__(film, contact, fraction)
        self.touching = math.nan

    def _substep_size(self, gap, v):
        dt = super()._substep_size(gap, v)
        if v == 0:
            return dt
        if gap < 0 and self.touch == 0:  # no film is left that asks for less
            return min(1 / _FEWEST, self.contact.duration / _PER_CONTACT)
        dt = min(1 / _FEWEST, max(dt, self.fraction * self.touch / abs(v)))
        if gap < self.touch + abs(v) * dt:
            dt = min(dt, self.contact.duration / _PER_CONTACT)
        return dt

    def _solid_force(self, gap, v):
        if gap < self.touch and not math.isnan(self.touching):
            return self.contact.force(self.touch - gap, v, self.touching)
        return 0.0

    def _end(self, sub, force, mass):
        impact = None
        if math.isnan(self.touching) and sub.new_gap < self.touch and sub.new_v < 0:
            self.touching = -sub.new_v
        elif not math.isnan(self.touching) and sub.new_gap >= self.touch and sub.new_v > 0:
            impact = Impact(sub.begin, self.touching, sub.new_v)
            self.touching = math.nan
        return *super()._end(sub, force, mass)[:3], impact


MOTIONS: dict[type, Callable[..., Motion]] = {
    type(None): FilmMotion,
    FilmRebound: CarriedMotion,
    DryRebound: DryMotion,
    SoftContact: SoftMotion,
}
"""The motion at a wall by the kind of the contact."""


def motion_at_wall(film: Film | None, contact: Contact | None, fraction: float) -> Motion:
    """A new motion of one sphere at one wall; raises :class:`InputError` for what does not go together."""
    if type(contact) not in MOTIONS:
        known = ", ".join(kind.__name__ for kind in MOTIONS if kind is not type(None))
        raise InputError(f"contact = {shown(contact)}: give one of {known}, or None")
    if not 0 < fraction <= 0.5:
        raise InputError(f"fraction = {fraction:g}: sub-steps must lie in (0, 0.5] of gap / speed")
    return MOTIONS[type(contact)](film, contact, fraction)


def away(face: int) -> int:
    """Sign of the direction away from a face."""
    return 1 - 2 * (face % 2)


def gap_to(centre: Sequence[float], radius: float, face: int, shape: tuple[int, int, int]) -> float:
    """From a sphere to a face of the box."""
    axis = face // 2
    return float(centre[axis] - radius if face % 2 == 0 else shape[axis] - centre[axis] - radius)


def refuse_met(sphere: int, radius: float, track: Sequence[tuple], grid, *motions: Mapping) -> None:
    """Raise :class:`InputError` where one of the ``motions``, by sphere and face, may have acted on the track."""
    walls = [face for face, kind in enumerate(grid.faces) if kind == BOUNCE]
    for step, _, x, y, z, *v in track:
        for face in walls:
            gap, speed = gap_to((x, y, z), radius, face, grid.shape), away(face) * v[face // 2]
            if any(motion[sphere, face].matters(gap, speed) for motion in motions):
                raise InputError(
                    f"sphere {sphere} was {gap:.3g} cells from the face {FACES[face]} at step {step:.0f}, where a "
                    "film or a contact may have acted: another one can be taken before that only"
                )
