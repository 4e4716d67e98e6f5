"""A track held against its conditions: what a falling sphere cannot do, and which mistake makes it seem to.

Free fall tells clock and unit of length apart from the fluid. Where it is right, the terminal speed tells
viscosity, diameter and densities: see :mod:`.pace`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from restitution.doubts import falls
from restitution.doubts.clock import of_frames
from restitution.doubts.doubt import Doubt
from restitution.doubts.pace import FAST, SLOW, of_pace
from restitution.doubts.place import below, holes, still
from restitution.doubts.stated import of_fluid, of_size
from restitution.tracks import Contacts, Track, contacts

if TYPE_CHECKING:
    from restitution.conditions import Conditions

CENTRE_D = 0.2
"""A record that never comes nearer to the wall, in diameters, has the height of the centre in place of the gap."""


def of_track(track: Track, found: Contacts, conditions: Conditions, where: str = "") -> list[Doubt]:
    """Everything doubtful about a track under its conditions; ``found`` are its contacts."""
    doubts = of_fluid(conditions) + (
        still(track) or _direction(track, found, conditions) or _of_motion(track, found, conditions)
    )
    return [replace(doubt, where=where) for doubt in doubts]


def _of_motion(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """Of a track that moves, the right way up, outside the film."""
    level, d = found.level or 0.0, conditions.sphere.diameter
    doubts = [
        *_hovering(track, found, conditions),
        *(hole.doubt(track) for hole in holes(track, found, conditions)),
    ]
    broken = bool(doubts)
    doubts += (of_frames(track, level, d) if not broken else []) + below(track, found, d)
    # Frames at wrong times tell no acceleration, and an approach that is not whole no fall.
    if any(doubt.name in ("repeated", "renumbered") for doubt in doubts) or of_fluid(conditions):
        return doubts
    paced = of_pace(track, found, conditions, not broken)
    return doubts + (paced or of_size(track, level, conditions) or _centre(track, conditions))


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
