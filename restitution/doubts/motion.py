"""A track held against its conditions: what a falling sphere cannot do, and which mistake makes it seem to.

Free fall tells clock and unit of length apart from the fluid: see :mod:`.falls`. Where it is right, the
terminal speed tells viscosity, diameter and densities.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from restitution.doubts import falls, record
from restitution.doubts.doubt import Doubt
from restitution.tracks import Contacts, Track, contacts

if TYPE_CHECKING:
    from restitution.conditions import Conditions

SLOW, FAST = 0.65, 2.5
"""Parts of free fall between which the sphere accelerates about its apex: 0.9 to 1.04 in the shipped
records; up to twice as much where a wake three times as strong as theirs outlasts the rise."""
SLOW_AT_FIRST, FAST_AT_FIRST = 0.4, 2.5
"""The same of an approach, where added mass, history and drag differ more."""
BEYOND = 1.3
"""Times the terminal speed above which a sphere does not fall: laws of drag agree to a tenth."""
CENTRE_D = 0.2
"""A record that never comes nearer to the wall, in diameters, has the height of the centre in place of the gap."""
_LIGHT = 30.0
"""Density in kg/m3 below which one of a solid or a liquid is taken to be in g/cm3."""


def of_track(track: Track, found: Contacts, conditions: Conditions, where: str = "") -> list[Doubt]:
    """Everything doubtful about a track under its conditions; ``found`` are its contacts."""
    doubts = _direction(track, found, conditions)
    if not doubts:
        doubts = [
            *record.of_record(track, found, conditions),
            *_hovering(track, found, conditions),
            *(_of_pace(track, found, conditions) or _centre(track, conditions)),
        ]
    return [replace(doubt, where=where) for doubt in doubts]


def _direction(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """Records that are upside down: flights curve away from the wall, or the sphere rests at its greatest
    value.
    """
    over = replace(track, value=-track.value)
    other = contacts(over)
    g = abs(conditions.free_fall)
    here, there = (falls.apexes(t, c) for t, c in ((track, found), (over, other)))
    falling = sum(fall.acceleration > 0.1 * g for fall in here)
    upside = sum(fall.acceleration > 0.1 * g for fall in there)
    if track.quantity == "velocity":
        slope = _typical_slope(track)
        if slope > 0.2 * g and upside >= falling:
            message = (
                "velocities grow between contacts, as those of a fall that is counted positive: --direction down"
            )
            return [Doubt("direction", message)]
        return []
    if other.level is not None and found.level is None:
        message = (
            "the record is upside down: the sphere comes to rest at the greatest value of the record, as "
            "a distance "
            "fallen does: "
            "--direction down --wall rest"
        )
        return [Doubt("direction", message)]
    # A contact that is taken for an apex turns much faster than gravity does.
    turned = [sum(SLOW * g < fall.acceleration < FAST * g for fall in some) for some in (here, there)]
    over_there = turned[1] > turned[0] or (upside > falling and turned[1] == turned[0])
    if _convex(track) and len(other.contacts) and over_there:
        message = (
            "the record is upside down: its flights curve away from the wall, as those of a distance "
            "fallen or of rows of an "
            "image do: --direction down --wall X"
        )
        return [Doubt("direction", message)]
    return []


def _typical_slope(track: Track) -> float:
    return float(np.median(np.diff(track.value) / np.diff(track.time_s)))


def _convex(track: Track) -> bool:
    """Whether most of the record curves upwards, beyond its noise."""
    n = len(track.value)
    s = max(n // 20, 1)
    y = track.value
    second = y[2 * s :] - 2 * y[s:-s] + y[: -2 * s]
    seen = second[np.abs(second) > 5 * track.sigma]
    return len(seen) > 3 and np.count_nonzero(seen > 0) > 0.5 * len(seen)


def _hovering(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """Minima in mid-air."""
    d, wall = conditions.sphere.diameter, found.level or 0.0
    return [
        Doubt(
            "minimum",
            f"the minimum at t = {track.time_s[i]:.6g} s lies {track.value[i] - wall:.2g} m above the wall, "
            f"{(track.value[i] - wall) / d:.2g} d: it is no contact and was left out (was the sphere lost there?)",
        )
        for i in found.hovering
    ]


def _centre(track: Track, conditions: Conditions) -> list[Doubt]:
    d = conditions.sphere.diameter
    if track.quantity != "gap" or not np.min(track.value) > CENTRE_D * d:
        return []
    lowest = float(np.min(track.value))
    message = (
        f"the gap never falls below {lowest:.3g} m, {lowest / d:.2g} d: is it the height of the centre? "
        "It must be "
        "that of the lowest point (--point centre)"
    )
    return [Doubt("centre", message)]


def _of_pace(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """The pace, which of a sphere that would rise has one likely explanation."""
    doubts, sphere, fluid = _pace(track, found, conditions), conditions.sphere, conditions.fluid
    if not doubts or sphere.density >= fluid.density:
        return doubts
    message = (
        f"the sphere, {sphere.density:g} kg/m3, is lighter than the fluid, {fluid.density:g} kg/m3, and does "
        "not move as one that rises to a wall above it: are the densities exchanged, or one of them in g/cm3?"
    )
    return [Doubt("lighter", message)]


def _pace(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """Clock and unit by free fall, then fluid and sphere by the terminal speed."""
    g, terminal = abs(conditions.free_fall), _terminal(conditions)
    if g == 0:
        return []
    turning, coming = falls.apexes(track, found), falls.approach(track, found)
    fast = falls.fastest(track, found)
    # Of the surest apex, mostly that of the highest flight, where a wake has the least part.
    share = (
        min(turning, key=lambda fall: fall.error / abs(fall.acceleration)).acceleration / g
        if turning
        else math.nan
    )
    slow, quick = SLOW, FAST
    if not turning and coming is not None and coming.mean_speed < 0.5 * terminal:
        expected, slow, quick = g * (1 - coming.mean_speed / terminal), SLOW_AT_FIRST, FAST_AT_FIRST
        if coming.error < 0.2 * expected:
            share = max(coming.acceleration, coming.error) / expected
    if share > 0 and not slow <= share <= quick:
        return [_clock(share, g)]
    if fast > BEYOND * terminal:
        return [_too_fast(fast, terminal, conditions)]
    if coming is not None and coming.mean_speed < 0.5 * terminal:
        expected = g * (1 - coming.mean_speed / terminal)
        if coming.error < 0.2 * expected and coming.acceleration < 0.2 * expected:
            return [_too_slow(coming.mean_speed, terminal)]
    return []


def _clock(share: float, g: float) -> Doubt:
    density = ", or a density is wrong" if 0.2 < share < 3 else ""
    if share < 1:
        factor = math.sqrt(1 / share)
        words = (
            f"the sphere accelerates in free flight by {share * g:.2g} m/s2, 1/{1 / share:.3g} of free "
            "fall under these "
            f"conditions ({g:.2g} m/s2): times are {factor:.2g} times too long (a film played slowly: --fps, "
            f"--time-unit), or lengths {1 / share:.2g} times too small (--unit; dimensionless numbers: "
            f"--unit d){density}"
        )
    else:
        words = (
            f"the sphere accelerates in free flight by {share * g:.2g} m/s2, {share:.3g} times free fall "
            "under these "
            f"conditions ({g:.2g} m/s2): times are {math.sqrt(share):.2g} times too short (--fps, "
            "--time-unit), or "
            f"lengths {share:.2g} times too large (--unit, --pixel){density}"
        )
    return Doubt("clock", words)


def _too_fast(fast: float, terminal: float, conditions: Conditions) -> Doubt:
    """Of the mistakes that explain the speed, the smallest one."""
    fluid, sphere = conditions.fluid, conditions.sphere
    mistakes = [
        (replace_in(conditions, diameter=2), f"is the diameter, {sphere.diameter:g} m, the radius?"),
        (
            replace_in(conditions, viscosity=1e-3),
            f'is the viscosity, {fluid.viscosity:g} Pa s, in mPa s (cP)? viscosity = "{fluid.viscosity:g} mPa s"',
        ),
    ]
    if fluid.density < _LIGHT and sphere.density < _LIGHT:
        mistakes.insert(0, (replace_in(conditions, density=1e3), "are the densities in g/cm3 (kg/m3 are meant)?"))
    likely = [question for other, question in mistakes if fast < 1.1 * _terminal(other)]
    question = likely[0] if likely else "are viscosity, diameter and densities right, and the unit of length?"
    return Doubt(
        "speed",
        f"the sphere moves at {fast:.3g} m/s, {fast / terminal:.2g} times its terminal speed under these "
        "conditions "
        f"({terminal:.2g} m/s): {question}",
    )


def _too_slow(speed: float, terminal: float) -> Doubt:
    return Doubt(
        "speed",
        f"the sphere falls steadily at {speed:.3g} m/s, where it reaches {terminal:.2g} m/s under these "
        "conditions: is "
        'the viscosity too small (of a kinematic one write its unit, as in "10 cSt"), the diameter that '
        "of another "
        "sphere, or the vessel narrow?",
    )


def replace_in(
    conditions: Conditions, viscosity: float = 1, diameter: float = 1, density: float = 1
) -> Conditions:
    """The conditions with some numbers multiplied."""
    fluid, sphere = conditions.fluid, conditions.sphere
    own = {"density": density * fluid.density, "viscosity": viscosity * fluid.viscosity}
    of_sphere = {"density": density * sphere.density, "diameter": diameter * sphere.diameter}
    return conditions.model_copy(
        update={"fluid": fluid.model_copy(update=own), "sphere": sphere.model_copy(update=of_sphere)}
    )


def _terminal(conditions: Conditions) -> float:
    """The terminal speed; of a sphere lighter than the fluid that of its rise, inf where it neither falls
    nor rises.
    """
    from restitution.laws.drag import STANDARD, steady

    c = conditions
    weight = abs(c.sphere.density - c.fluid.density) * math.pi * c.sphere.diameter**3 / 6 * c.gravity
    if weight == 0:
        return math.inf
    return steady(STANDARD(), weight, c.sphere.diameter, c.fluid.density, c.fluid.viscosity)
