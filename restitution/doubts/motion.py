"""A track held against its conditions: what a falling sphere cannot do, and which mistake makes it seem to.

Free fall tells clock and unit of length apart from the fluid. Where it is right, the terminal speed tells
viscosity, diameter and densities: see :mod:`.pace`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from restitution.doubts import falls
from restitution.doubts.clock import of_frames, of_smoothed
from restitution.doubts.doubt import Doubt
from restitution.doubts.filled import of_filled
from restitution.doubts.meeting import of_mirrored
from restitution.doubts.pace import FAST, SLOW, of_pace
from restitution.doubts.pieces import of_pieces
from restitution.doubts.place import below, half_as_large, holes, still, unsigned
from restitution.doubts.stated import of_diameter, of_fluid, of_size
from restitution.tracks import Contacts, Track, contacts

if TYPE_CHECKING:
    from restitution.conditions import Conditions

CENTRE_D = 0.2
"""A record that never comes nearer to the wall, in diameters, has the height of the centre in place of the gap."""


def of_track(track: Track, found: Contacts, conditions: Conditions, where: str = "") -> list[Doubt]:
    """Everything doubtful about a track under its conditions; ``found`` are its contacts."""
    doubts = of_fluid(conditions) + (
        still(track)
        or unsigned(track)
        or _direction(track, found, conditions)
        or _of_motion(track, found, conditions)
    )
    return [replace(doubt, where=where) for doubt in doubts]


def _of_motion(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """Of a track that moves, the right way up, outside the film."""
    level, d = found.level or 0.0, conditions.sphere.diameter
    doubts = [
        *of_mirrored(track, found, d),
        *_hovering(track, found, conditions),
        *(hole.doubt(track) for hole in holes(track, found, conditions)),
    ]
    broken = bool(doubts)
    if not broken:
        doubts += of_frames(track, level, d) or of_filled(track)
    elif all(doubt.name == "minimum" for doubt in doubts):  # which a smoothed contact leaves beside it
        doubts = of_smoothed(track, level, d) or doubts
    if all(doubt.name == "minimum" for doubt in doubts) and (
        pieces := of_pieces(track, level, d, abs(conditions.free_fall))
    ):
        return pieces  # no speed between two pieces is one of a sphere
    doubts += [] if of_diameter(conditions) else below(track, found, d)
    # Frames at wrong times tell no acceleration, and an approach that is not whole no fall.
    if any(doubt.name in ("repeated", "renumbered") for doubt in doubts) or of_fluid(conditions):
        return doubts
    paced = of_pace(track, found, conditions, not broken)
    return doubts + (paced or _of_size(track, found, conditions))


def _direction(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """Records that are upside down: flights curve away from the wall, or the sphere rests at its greatest
    value.
    """
    over = replace(track, value=-track.value)
    other = contacts(over)
    here, there = (falls.apexes(t, c) for t, c in ((track, found), (over, other)))
    g = _gravity(abs(conditions.free_fall), [*here, *there])
    falling = sum(fall.acceleration > 0.1 * g for fall in here)
    upside = sum(fall.acceleration > 0.1 * g for fall in there)
    if track.quantity == "velocity":
        slope = _typical_slope(track)
        if slope > 0.2 * g and upside >= falling:
            message = (
                "velocities grow between contacts, as those of a fall that is counted positive: --direction down"
            )
            return [Doubt("direction", message), *_pace_of(over, other, conditions)]
        return []
    if other.level is not None and found.level is None:
        message = (
            "the record is upside down: the sphere comes to rest at the greatest value of the record, as "
            "a distance "
            "fallen does: "
            "--direction down --wall rest"
        )
        return [Doubt("direction", message), *_pace_of(over, other, conditions)]
    # A contact that is taken for an apex turns much faster than gravity does.
    turned = [sum(SLOW * g < fall.acceleration < FAST * g for fall in some) for some in (here, there)]
    over_there = turned[1] > turned[0] or (upside > falling and turned[1] == turned[0])
    if _convex(track) and len(other.contacts) and over_there:
        message = (
            "the record is upside down: its flights curve away from the wall, as those of a distance "
            "fallen or of rows of an "
            "image do: --direction down --wall X"
        )
        return [Doubt("direction", message), *_pace_of(over, other, conditions)]
    return []


def _gravity(g: float, turning: list[falls.Fall]) -> float:
    """Free fall as the record has it, which a film that is played slowly has less of: that of the flight that
    turns most gently, for a contact that is taken for one turns much faster.
    """
    sure = [fall.acceleration for fall in turning if 0 < fall.error < _TURNS * fall.acceleration]
    return min(sure) if sure and min(sure) < SLOW * g else g


_TURNS = 0.1
"""Relative error of an acceleration up to which a parabola is a flight's; a contact has no parabola."""


def _pace_of(over: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """The clock of a record that was turned over."""
    return [doubt for doubt in of_pace(over, found, conditions, False) if doubt.name == "clock"]


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
    """Minima in mid-air that no noise makes, not even in the many frames of a sphere that is held."""
    d, wall = conditions.sphere.diameter, found.level or 0.0
    value, depth = track.value, 2 * (np.sqrt(2 * np.log(len(track.value))) + 2) * track.sigma
    return [
        Doubt(
            "minimum",
            f"the minimum at t = {track.time_s[i]:.6g} s lies {track.value[i] - wall:.2g} m above the wall, "
            f"{(track.value[i] - wall) / d:.2g} d: it is no contact and was left out (was the sphere lost there, "
            "or the track smoothed?)",
        )
        for i in found.hovering
        if min(np.max(value[:i], initial=value[i]), np.max(value[i:])) - value[i] > depth
    ]


def _of_size(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """A diameter, and a height of the wall or of the point, that do not fit where the sphere touches."""
    level, d = found.level or 0.0, conditions.sphere.diameter
    doubts = of_size(track, level, conditions) or of_diameter(conditions)
    return doubts or half_as_large(found, d) or _centre(track, found, d)


def _centre(track: Track, found: Contacts, d: float) -> list[Doubt]:
    """A sphere that is seen to come near the wall and never to touch it."""
    lowest = float(np.min(track.value))
    if track.quantity != "gap" or not lowest > CENTRE_D * d or not _seen(track, found):
        return []
    if _CENTRES[0] < lowest / d < _CENTRES[1]:
        question = (
            "is it the height of the centre (--point centre), or, where that is given, of the top, d/2 above it "
            "(--point lowest --wall X, the top of the sphere at rest)?"
        )
    elif abs(lowest / d - 1) < _ALIKE_D:
        question = (
            "is it the height of the top of the sphere, or the wall so much higher (--wall, or --wall rest)?"
        )
    else:
        question = "is the wall so much higher than stated (--wall, or --wall rest)?"
    return [Doubt("centre", f"the gap never falls below {lowest:.3g} m, {lowest / d:.2g} d: {question}")]


def _seen(track: Track, found: Contacts) -> bool:
    """Whether any contact is seen in its frames: none where frames are missing at each, as behind an edge."""
    step = np.diff(track.time_s)
    some = [c for c in found.contacts if c.approach and c.rebound]
    return found.level is not None or any(
        np.max(step[max(c.approach[-1] - 1, 0) : c.rebound[0] + 1]) < _HIDDEN * np.median(step) for c in some
    )


_HIDDEN = 4.0
"""Usual times between frames for which a sphere is behind an edge at least."""
_CENTRES = (0.4, 0.6)
"""Diameters about the radius."""
_ALIKE_D = 0.05
"""About the diameter."""
