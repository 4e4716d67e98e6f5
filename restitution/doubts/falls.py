"""What the flights of a track say of gravity and of the greatest speed, whatever the fluid does.

A rebound rises, stops and falls back: about its apex, where drag vanishes, it accelerates by free fall,

    g_eff = g (rho_p - rho_f)/(rho_p + rho_f/2),

whatever the viscosity is. An approach does so as long as it is slow. A time axis that is wrong by a factor f
changes the acceleration by 1/f^2, a wrong unit of length by its own factor: both show here at once, before
any law of drag.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.tracks import GRAVITY, Contacts, Track

_LEAST = 5
"""Frames that tell an acceleration."""
_SURE = 0.25
"""Relative error up to which an acceleration takes part."""
_PIECES = 8
"""A flight's greatest speed is that of the fastest of so many pieces."""


@dataclass(frozen=True)
class Fall:
    """An acceleration towards the wall in m/s2, its error, and the mean speed in m/s and the mean gap in m
    meanwhile; of velocities the gap is not known: without end.
    """

    acceleration: float
    error: float
    mean_speed: float
    gap: float = math.inf

    @property
    def sure(self) -> bool:
        """Whether it is known well enough to be compared."""
        return self.error < _SURE * abs(self.acceleration)


def flights(track: Track, contacts: Contacts) -> list[range]:
    """The frames between contacts; the approach is the first one, unless the record begins with a contact."""
    if not contacts.contacts:
        return [range(len(track.time_s))]
    first, last = contacts.contacts[0], contacts.contacts[-1]
    between = [c.rebound for c in contacts.contacts if len(c.rebound)]
    end = [range(last.rebound.start, len(track.time_s))] if len(last.rebound) else []
    return [first.approach, *between[:-1], *(end or between[-1:])]


def apexes(track: Track, contacts: Contacts) -> list[Fall]:
    """The accelerations about the apexes of all flights that turn."""
    return [fall for flight in flights(track, contacts) for fall in _about_the_apex(track, flight) if fall.sure]


def _about_the_apex(track: Track, flight: range) -> Iterator[Fall]:
    """The upper half of a flight of gaps, the slower half of one of velocities, where it rises and falls."""
    t, y = track.time_s[flight.start : flight.stop], track.value[flight.start : flight.stop]
    if len(t) < _LEAST:
        return
    if track.quantity == "velocity":
        if np.max(y) <= 0 or np.min(y) >= 0:
            return
        slow = np.abs(y) < 0.7 * min(np.max(y), -np.min(y))
        if np.count_nonzero(slow) >= _LEAST:
            yield _fall(t[slow], y[slow], track, 1)
        return
    top = int(np.argmax(y))
    sides = max(y[0], y[-1]) if 0 < top < len(y) - 1 else y[top]
    upper = y > 0.5 * (y[top] + sides)
    if np.count_nonzero(upper) >= _LEAST and y[top] - sides > 10 * track.sigma:
        yield _fall(t[upper], y[upper], track, 2)


def approach(track: Track, contacts: Contacts) -> Fall | None:
    """The acceleration of the first flight, where it comes down all the way."""
    first = flights(track, contacts)[0]
    t, y = track.time_s[first.start : first.stop], track.value[first.start : first.stop]
    if len(t) < _LEAST:
        return None
    begin = _release(t, y, track.sigma) if track.quantity == "gap" else 0
    return (
        _fall(t[begin:], y[begin:], track, 2 if track.quantity == "gap" else 1)
        if len(t) - begin >= _LEAST
        else None
    )


def _release(t: NDArray, y: NDArray, sigma: float) -> int:
    """The frame with the greatest gap, or, of a sphere that is held there, one at about its release.

    The noise of so many frames hides as much of a fall as lasts sqrt(2 h/g), twice that at a quarter of gravity.
    """
    noise = 2 * np.sqrt(2 * np.log(len(y))) * sigma
    hidden = t[y >= np.max(y) - noise][-1] - 2 * np.sqrt(2 * noise / GRAVITY)
    return max(int(np.argmax(y)), int(np.searchsorted(t, hidden)))


def _fall(t: NDArray, y: NDArray, track: Track, order: int) -> Fall:
    """By the parabola of gaps, by the line of velocities."""
    span = float(np.ptp(t))
    x = (t - t.mean()) / span
    design = x[:, None] ** np.arange(order + 1)
    inverse = np.linalg.pinv(design)
    c = inverse @ y
    scatter = float(np.sqrt(np.sum((y - design @ c) ** 2) / max(len(t) - order - 1, 1)))
    error = max(track.sigma, scatter) * float(np.linalg.norm(inverse[order])) * _together(y - design @ c)
    if order == 2:
        return Fall(-2 * c[2] / span**2, 2 * error / span**2, abs(c[1]) / span, float(np.mean(y)))
    return Fall(-c[1] / span, error / span, float(np.mean(np.abs(y))))


def _together(rest: NDArray) -> float:
    """By how much errors that neighbours share, as those of a pixel grid, make an error larger."""
    whole = float(rest @ rest)
    shared = float(rest[1:] @ rest[:-1]) / whole if whole > 0 else 0.0
    shared = min(max(shared, 0.0), 0.95)
    return float(np.sqrt((1 + shared) / (1 - shared)))


def begin_of_approach(track: Track, contacts: Contacts, terminal: float) -> Fall | None:
    """The acceleration of the first flight while it is slow, below half of ``terminal`` (m/s)."""
    first = flights(track, contacts)[0]
    t, y = track.time_s[first.start : first.stop], track.value[first.start : first.stop]
    if len(t) < 3 * _LEAST:
        return None
    if track.quantity == "velocity":
        slow = np.flatnonzero(np.abs(y) > 0.5 * terminal)
    else:
        begin = _release(t, y, track.sigma)
        t, y = t[begin:], y[begin:]
        s = max(len(t) // _PIECES, 1)
        slow = np.flatnonzero(np.abs(y[s:] - y[:-s]) > 0.5 * terminal * (t[s:] - t[:-s]))
    end = int(slow[0]) if len(slow) else len(t)
    if end < 2 * _LEAST:
        return None
    return _fall(t[:end], y[:end], track, 2 if track.quantity == "gap" else 1)


def fastest(track: Track, contacts: Contacts) -> float:
    """The greatest speed in m/s that the noise does not explain: of a piece of a flight, less three of its
    errors.
    """
    found = [0.0]
    for flight in flights(track, contacts):
        t, y = track.time_s[flight.start : flight.stop], track.value[flight.start : flight.stop]
        if len(t) < 2:
            continue
        if track.quantity == "velocity":
            found.append(float(np.quantile(np.abs(y), 0.9)) - 3 * track.sigma)
            continue
        s = max(len(t) // _PIECES, 1)
        dt = t[s:] - t[:-s]
        found.append(float(np.quantile(np.abs(y[s:] - y[:-s]) / dt - 3 * np.sqrt(2) * track.sigma / dt, 0.98)))
    return max(found)
