"""How far a modelled trajectory is from a recorded one: two distances, each the rms of the gaps' difference in d.

Both take the frames up to t* = t sqrt(g/d) = 8 after the first contact. They differ in how the clocks of model and
record are brought together:

- :func:`agreement`, on the approach alone: the shift is the one with the least squares over the frames before the
  first contact, so that what follows is a prediction, the moment of the contact included. A record that begins on
  a rebound has its zero of time at the contact, and is taken at its word. The gap is counted from the level at
  which the recorded sphere comes to rest. Quoted of the point particle and of fitted laws.
- :func:`distance_from_contact_d`, at the first contacts: each trajectory runs from its own, without a shift that
  could be chosen. An error of the approach does not enter, so it serves models that are released otherwise than
  the sphere was filmed. Quoted of simulated runs, beside which the point particle then is scored alike.

A fit to whole trajectories has its own clock among its unknowns; its ``rms_d``
(:mod:`restitution.calibration.trajectories.whole_trajectories`) is neither of these.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from restitution.bounce.closures import Closures, Release
from restitution.bounce.model import Trajectory, bounce
from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.laws.legendre import Legendre2005
from restitution.tracks import Contacts, Track, contacts

UNTIL = 8.0
"""End of a comparison in t* = t sqrt(g/d) after the first contact."""
_CENTRE = 0.2
"""A record that never comes nearer to the wall, in d, has the height of the centre in place of the gap."""


class Flown(Protocol):
    """A trajectory with the times of its contacts (:class:`restitution.impacts.bounces.Bounces`)."""

    time_s: NDArray
    gap_m: NDArray
    contacts_s: NDArray


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
    touches = contacts(track)
    frames = _approach(track, touches)
    if len(frames) == 0 and conditions.impact is not None:
        return release_reaching(conditions.impact.speed, conditions, closures)
    frames = frames[track.value[frames] - (touches.level or 0.0) > 0.1 * conditions.sphere.diameter]
    if len(frames) < 2:
        raise InputError("the record has no approach: give the release, by gap and speed")
    slope = np.polyfit(track.time_s[frames], track.value[frames], 1)[0]
    return Release(float(track.value[frames[0]] - (touches.level or 0.0)), float(-slope), developed=True)


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
    if excess(0.1 * speed) > 0:
        rule = f"what falls {gap:g} m in this fluid meets the wall faster than the {speed:g} m/s of its rebounds"
        raise InputError(f"{rule}: the track is of another fluid, or begins amid a flight")
    return Release(gap, float(brentq(excess, 0.1 * speed, 3 * speed, xtol=1e-9)))


def distance_from_contact_d(model: Flown, record: Flown, conditions: Conditions, until: float = UNTIL) -> float:
    """Root mean square of the model's gap less the record's, in d, over the frames in 0 <= t* <= ``until``.

    Each from its own first contact. NaN where the model ends before the record does, up to ``until``.
    """
    d = conditions.sphere.diameter
    after = record.time_s - record.contacts_s[0]
    use = (after >= 0) & (after * math.sqrt(conditions.gravity / d) <= until)
    time = after[use] + model.contacts_s[0]
    if len(time) == 0 or model.time_s[-1] < time[-1]:
        return math.nan
    error = np.interp(time, model.time_s, model.gap_m) - record.gap_m[use]
    return float(np.sqrt(np.mean(error**2)) / d)


def agreement(trajectory: Trajectory, track: Track, until: float = UNTIL) -> Agreement:
    """The distance with the clocks together on the approach.

    Raises :class:`InputError` for a track without a bounce or of the height of the centre.
    """
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
    touches = contacts(track)
    if not touches.contacts and not _starts_at_contact(track):
        raise InputError("the record has no bounce")
    level, frames = touches.level or 0.0, _approach(track, touches)
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


def _approach(track: Track, touches: Contacts) -> NDArray:
    """Indices of the frames before the first contact."""
    if not touches.contacts or _starts_at_contact(track):
        return np.arange(0)
    return np.array(touches.contacts[0].approach, dtype=int)


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
