"""How far a modelled trajectory is from a camera track: residuals in diameters over a stretch of time.

The clocks of model and camera are brought together on the approach alone, so that what follows the first contact
is a prediction: the shift is the one with the least squares over the frames before it. A record that begins on
a rebound has its zero of time at the contact, and is taken at its word. The gap is counted from the level at which
the recorded sphere comes to rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.bounce.closures import Closures, Release
from restitution.bounce.model import Trajectory, bounce
from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.laws.legendre import Legendre2005
from restitution.tracks import Contacts, Track, contacts

UNTIL = 8.0
"""End of the comparison in t* = t sqrt(g/d) after the first contact."""
_CENTRE = 0.2


@dataclass(frozen=True)
class Agreement:
    """Frames from the first contact to ``until``: time after it in s, model less record in m; rms in diameters."""

    time_s: NDArray
    residual_m: NDArray
    shift_s: float
    rms_d: float


def release_of(track: Track, conditions: Conditions, closures: Closures | None = None) -> Release:
    """The release that a record gives, its wake developed.

    With a recorded approach: its first frame, and the mean speed of its frames outside the film. Of a record that
    begins on a rebound: five diameters above the wall, at the speed from which the model reaches the far impact
    speed that the conditions quote. Raises :class:`InputError` where there is neither.

    For the St 27 record that is 0.66 m/s, above the terminal 0.52: its quoted 0.518 m/s may well mean the speed
    further up. Released at the terminal speed the model meets the wall with 0.469 m/s, and its first apex comes
    out a fifth lower.
    """
    found = contacts(track)
    frames = _approach(track, found)
    if len(frames) == 0 and conditions.impact is not None:
        return release_reaching(conditions.impact.speed, conditions, closures)
    frames = frames[track.value[frames] - (found.level or 0.0) > 0.1 * conditions.sphere.diameter]
    if len(frames) < 2:
        raise InputError("the record has no approach: give the release, by gap and speed")
    slope = np.polyfit(track.time_s[frames], track.value[frames], 1)[0]
    return Release(float(track.value[frames[0]] - (found.level or 0.0)), float(-slope), developed=True)


def release_reaching(
    speed: float, conditions: Conditions, closures: Closures | None = None, gap: float | None = None
) -> Release:
    """The release at ``gap`` (m, by default five diameters) that meets the wall with the far ``speed`` (m/s)."""
    from scipy.optimize import brentq

    gap = gap or 5 * conditions.sphere.diameter
    # The far speed is what the approach outside the film would meet the wall with, whatever the film then does.
    closures = replace(closures or Closures(), rebound=Legendre2005(), lubrication=False, e_dry=1.0)

    def excess(start: float) -> float:
        flight = bounce(conditions, Release(gap, start), closures, end=10 * gap / speed)
        return (flight.impacts[0].v_in if flight.impacts else 0.0) - speed

    if excess(3 * speed) < 0:
        raise InputError(f"no release {gap:g} m above the wall meets it with {speed:g} m/s: is the unit right?")
    return Release(gap, float(brentq(excess, 0.1 * speed, 3 * speed, xtol=1e-9)))


def agreement(trajectory: Trajectory, track: Track, until: float = UNTIL) -> Agreement:
    """Compare; raises :class:`InputError` for a track without a bounce or of the height of the centre."""
    if track.quantity != "gap":
        raise InputError("a trajectory is compared with gaps; this record has velocities")
    if not np.all(np.isfinite(track.value)) or np.any(np.diff(track.time_s) <= 0):
        raise InputError("the record has gaps that are not numbers, or its time does not increase")
    d = trajectory.conditions.sphere.diameter
    if np.min(track.value) > _CENTRE * d:
        raise InputError(
            f"the gap never falls below {np.min(track.value):.3g} m, {np.min(track.value) / d:.2g} d: is it the "
            "height of the centre? It must be that of the lowest point"
        )
    if not trajectory.impacts:
        raise InputError("the model has no impact within its time: let it run longer")
    found = contacts(track)
    if not found.contacts and not _starts_at_contact(track):
        raise InputError("the record has no bounce")
    level, frames = found.level or 0.0, _approach(track, found)
    gap, first = track.value - level, trajectory.impacts[0]
    touch = 0.0  # time of the first contact by the record's clock, from the record alone where that can be
    if len(frames) > 0:
        near = frames[-1]
        last = frames[-2:]
        speed = -np.polyfit(track.time_s[last], gap[last], 1)[0] if len(last) > 1 else first.v_in
        touch = track.time_s[near] + gap[near] / speed
        shift = _shift(trajectory, track.time_s[frames], gap[frames], first.time_s - touch)
    else:
        shift = first.time_s
    after = track.time_s - touch
    use = after <= until * math.sqrt(d / trajectory.conditions.gravity)
    use[: frames[-1] + 1 if len(frames) else 0] = False
    residual = trajectory.gap(track.time_s[use] + shift) - gap[use]
    return Agreement(after[use], residual, shift, float(np.sqrt(np.mean(residual**2)) / d))


def _approach(track: Track, found: Contacts) -> NDArray:
    """Indices of the frames before the first contact."""
    if not found.contacts or _starts_at_contact(track):
        return np.arange(0)
    return np.array(found.contacts[0].approach, dtype=int)


def _starts_at_contact(track: Track) -> bool:
    """Whether the first frames rise: the record begins on a rebound."""
    return len(track.value) > 2 and track.value[2] > track.value[0]


def _shift(trajectory: Trajectory, time: NDArray, gap: NDArray, begin: float) -> float:
    """Model time less record time that brings the approach frames together, by Gauss-Newton."""
    shift = begin
    for _ in range(20):
        v = trajectory.velocity(time + shift)
        step = -float(v @ (trajectory.gap(time + shift) - gap)) / float(v @ v)
        shift += step
        if abs(step) < 1e-9:
            break
    return shift
