"""A trajectory bounce by bounce: times of contact and apex heights, recorded or modelled alike.

Where a contact is stretched in time it is counted from its end, when the rebound begins. How far one trajectory is
from another stands in :mod:`restitution.bounce.agreement`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.impacts.find import find_impacts
from restitution.stokes import Speed
from restitution.tracks import Track, contacts

LEAST_RISE_D = 1e-3
"""A modelled sphere has come to rest once it rises by less, in diameters."""
_FRAMES = 5
"""Frames about the highest one through which the parabola of an apex is laid."""


@dataclass(frozen=True)
class Bounces:
    """Gap in m at times in s, the times of all contacts, and the apexes between them."""

    time_s: NDArray
    gap_m: NDArray
    contacts_s: NDArray
    apexes_m: NDArray

    @property
    def intervals_s(self) -> NDArray:
        """Times between contacts."""
        return np.diff(self.contacts_s)


def bounces(time_s: NDArray, gap_m: NDArray, contacts_s: NDArray, resolution_m: float = 0.0) -> Bounces:
    """The bounces of a trajectory whose contacts are known; it ends with the first flight below ``resolution_m``.

    The last flight counts if it was seen to come down.
    """
    apexes: list[float] = []
    for k, begin in enumerate(contacts_s):
        end = contacts_s[k + 1] if k + 1 < len(contacts_s) else math.inf
        flight = (time_s > begin) & (time_s < end)
        height = _apex(time_s[flight], gap_m[flight], math.isinf(end))
        if height is None or height < resolution_m:
            contacts_s = contacts_s[: k + 1]
            break
        apexes.append(height)
    return Bounces(time_s, gap_m, np.asarray(contacts_s), np.array(apexes))


def modelled(time_s: NDArray, gap_m: NDArray, contacts_s: NDArray, conditions: Conditions) -> Bounces:
    """The bounces of a computed trajectory, its contacts as the model had them."""
    return bounces(time_s, gap_m, contacts_s, LEAST_RISE_D * conditions.sphere.diameter)


def filmed(track: Track, conditions: Conditions, first_s: float | None = None) -> Bounces:
    """The bounces of a gap track, its contacts where approach and rebound meet (``contact``).

    ``first_s`` overrides the time of the first contact, for a track whose zero of time is better known. Raises
    :class:`InputError` for a track without any contact.
    """
    times = {row["impact"]: row["time_s"] for row in find_impacts(track, conditions, Speed.CONTACT).rows}
    lowest = [c.nearest for c in contacts(track).contacts if c.nearest is not None]
    quoted = 1 in times and (not lowest or times[1] < track.time_s[max(lowest[0] - 2, 0)])
    for k, frame in enumerate(lowest, 2 if quoted else 1):
        times.setdefault(k, _touch(track, frame))
    if not times:
        raise InputError("the track has no contact")
    touches = np.array([time for _, time in sorted(times.items())])
    if first_s is not None:
        touches[0] = first_s
    return bounces(track.time_s, track.value, touches, 3 * track.sigma)


def _touch(track: Track, frame: int) -> float:
    """When the sphere touches about the lowest ``frame``: on from the two frames of the approach before it."""
    (t0, t1), (h0, h1) = track.time_s[frame - 1 : frame + 1], track.value[frame - 1 : frame + 1]
    return (
        float(t1 + max(h1, 0.0) * (t1 - t0) / (h0 - h1)) if frame > 0 and h0 > h1 else float(track.time_s[frame])
    )


def frame_velocity(track: Track, contacts_s: NDArray) -> tuple[NDArray, NDArray, float]:
    """Times, velocities and their standard error by differences of neighbouring frames, none across a contact."""
    time, step = 0.5 * (track.time_s[1:] + track.time_s[:-1]), np.diff(track.time_s)
    velocity = np.diff(track.value) / step
    spans = ((track.time_s[:-1, None] < contacts_s) & (contacts_s < track.time_s[1:, None])).any(axis=1)
    return time[~spans], velocity[~spans], float(math.sqrt(2) * track.sigma / np.median(step))


def _apex(time: NDArray, gap: NDArray, must_fall: bool) -> float | None:
    """Height of the parabola through the highest frames; the highest frame itself where there are too few."""
    if len(time) == 0:
        return None
    top = int(np.argmax(gap))
    if must_fall and top == len(gap) - 1:
        return None
    about = slice(max(0, top - _FRAMES // 2), top + _FRAMES // 2 + 1)
    t, y = time[about] - time[top], gap[about]
    if len(t) < 4:
        return float(gap[top])
    a, b, c = np.polyfit(t / np.ptp(t), y, 2)
    return float(c - b**2 / (4 * a)) if a < 0 else float(gap[top])
