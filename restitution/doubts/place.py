"""Where a track is: a coordinate that moves, a wall that the sphere does not pass, frames about each contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.doubts.doubt import Doubt
from restitution.tracks import DETECTION, Contacts, Track

if TYPE_CHECKING:
    from restitution.conditions import Conditions

OVERLAP_D = 0.05
"""Overlap of soft spheres in diameters that no solver's springs are meant to exceed."""
_HOLE = 6.0
"""Usual times between frames from which on frames are missing."""
_APART = 0.3
"""Part of a hole between coming to the wall and leaving it, for which one contact does not account: drag and noise
move both by a tenth."""
_FRAMES = 5
"""Frames on each side of a hole that say how the sphere moves."""


def still(track: Track) -> list[Doubt]:
    """A coordinate that does not move, or goes away from the wall in a straight line."""
    n, value = len(track.value), track.value
    noise = 2 * (np.sqrt(2 * np.log(n)) + 2) * track.sigma
    moves = float(np.ptp(value) if track.quantity == "gap" else 2 * np.max(np.abs(value)))
    other = "is it the one along the wall? Take that towards it (--column gap_m=NAME)"
    if moves <= noise:
        what = f"moves by {moves:.2g} m, no more than its noise" if track.quantity == "gap" else "is that of rest"
        return [Doubt("still", f"this coordinate {what}: {other}")]
    if track.quantity == "velocity":
        return []
    t = track.time_s - track.time_s.mean()
    slope = float(t @ (value - value.mean()) / (t @ t))
    rest = value - value.mean() - slope * t
    if slope > 0 and np.max(np.abs(rest)) < 0.5 * noise and slope * np.ptp(t) > noise:
        return [
            Doubt("still", f"this coordinate grows steadily, by {slope:.3g} m/s, and nothing falls in it: {other}")
        ]
    return []


def unsigned(track: Track) -> list[Doubt]:
    """Velocities of one sign that vanish between two flights, as speeds do about an apex."""
    value, noise = track.value, 5 * track.sigma
    v = np.abs(value)
    one_sign = np.min(value) > -noise or np.max(value) < noise
    if track.quantity != "velocity" or not one_sign or not np.max(v) > 4 * noise:
        return []
    before, after = np.maximum.accumulate(v), np.maximum.accumulate(v[::-1])[::-1]
    slow = v < np.minimum(np.minimum(before, after) / 10, np.max(v) / 10)
    if not np.any(slow & (np.minimum(before, after) > np.maximum(np.max(v) / 5, 2 * noise))):
        return []
    message = (
        "the velocities vanish between flights and never change sign: are they speeds, |v|? Those towards the "
        "wall and away from it need different signs; or give the positions (--column gap_m=NAME)"
    )
    return [Doubt("unsigned", message)]


def below(track: Track, found: Contacts, diameter: float) -> list[Doubt]:
    """Contacts far within the wall."""
    lows = [track.value[c.nearest] for c in found.contacts if c.nearest is not None]
    if track.quantity != "gap" or not lows:
        return []
    deep = float(np.median(lows)) - (found.level or 0.0)
    if not deep < -OVERLAP_D * diameter - DETECTION * track.sigma:
        return []
    other = "are these heights of the centre above another level?"
    if deep < -_OTHER_UNIT * diameter:
        other = "is its place not in the unit of the positions, as --wall is meant?"
    elif abs(deep / diameter + 0.5) < _HALF_D:
        other = "are these heights of the lowest point (--point lowest)?"
    elif abs(deep / diameter + 0.25) < _HALF_D / 2:
        other = f"is the diameter {diameter / 2:.3g} m?"
    return [
        Doubt(
            "wall",
            f"the sphere goes {-deep:.2g} m, {-deep / diameter:.2g} d, into the wall before it turns: is the wall "
            f"{-deep:.2g} m lower than stated (--wall, or --wall rest), or {other} "
            "Times, speeds and e are those of a contact that comes too early",
        )
    ]


_OTHER_UNIT = 2.0
"""Diameters from which on a wall is hardly at a place that was read wrongly."""
_HALF_D = 0.04
"""Diameters by which frames beside a contact are away from it."""


def half_as_large(found: Contacts, diameter: float) -> list[Doubt]:
    """A rest where a sphere of half the diameter has its centre above the wall: the double of it was stated."""
    level = found.level
    if level is None or abs(level / diameter + 0.25) > _ALIKE_D:
        return []
    return [
        Doubt(
            "diameter",
            f"the sphere rests at a gap of {level:.3g} m, -d/4: is its diameter {diameter / 2:.3g} m, half of "
            "what is stated, or the wall so much lower (--wall)?",
        )
    ]


_ALIKE_D = 0.01
"""Diameters by which a rest is where it would be by that."""


@dataclass(frozen=True)
class Hole:
    """Missing frames between ``last`` and the next one, in which the sphere came to the wall at ``comes`` and left
    it at ``leaves`` (s), too late for one contact.
    """

    last: int
    comes: float
    leaves: float

    def doubt(self, track: Track) -> Doubt:
        """In words."""
        begin, end = track.time_s[self.last], track.time_s[self.last + 1]
        return Doubt(
            "hole",
            f"frames are missing from t = {begin:.5g} to {end:.5g} s, in which the sphere comes to the wall at "
            f"{self.comes:.5g} and leaves it at {self.leaves:.5g} s: a whole flight is lost there, and its "
            "contacts have no e",
        )


def holes(track: Track, found: Contacts, conditions: Conditions) -> list[Hole]:
    """Where frames are missing and more than one contact lies between the frames beside."""
    time, value, g = track.time_s, track.value, abs(conditions.free_fall)
    dt = np.diff(time)
    if track.quantity != "gap" or g == 0:
        return []
    some = []
    for i in np.flatnonzero(dt > _HOLE * np.median(dt)).tolist():
        if min(i + 1, len(time) - 1 - i) < _FRAMES:
            continue
        level = found.level or 0.0
        before, after = slice(i - _FRAMES + 1, i + 1), slice(i + 1, i + 1 + _FRAMES)
        since, until = (
            _way(t, gap - level, g, track.sigma)
            for t, gap in (
                (time[after] - time[i + 1], value[after]),
                (time[i] - time[before][::-1], value[before][::-1]),
            )
        )
        leaves, comes = float(time[i + 1] - since[0]), float(time[i] + until[0])
        apart = _APART * dt[i] + 3 * np.hypot(since[1], until[1])
        if comes < leaves - apart and leaves > time[i] and comes < time[i + 1]:
            some.append(Hole(i, comes, leaves))
    return some


def _way(t: NDArray, gap: NDArray, g: float, sigma: float) -> tuple[float, float]:
    """How long in s a free flight takes between the wall and the nearest of these frames, at t = 0, and the error.

    With the speed v away from the others, h_0 - v s - g s^2/2 = 0.
    """
    low = int(np.argmin(gap))
    if low < 3 and gap[low] <= np.median(np.abs(np.diff(gap))):
        return float(-t[low]), 0.0  # at the wall within these frames
    speed, height = np.polyfit(t, gap + g * t**2 / 2, 1)
    root = float(np.sqrt(speed**2 + 2 * g * max(height, 0.0)))
    error = sigma / (np.std(t) * np.sqrt(len(t)))
    return (root - float(speed)) / g, float(error * abs(speed / root - 1) / g) if root > 0 else 0.0
