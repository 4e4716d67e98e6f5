"""What there is to see in a track: contacts, what approach and rebound were read as, and the flights between.

Of each flight between two contacts the upper half, where the sphere is slow and drag small, is fitted
by a parabola

    h = h_top + a (t - t_top)^2 / 2,

so that a, held against free fall under the conditions, says whether the clock and the unit of length are right.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import terminal_speed
from restitution.conditions import Conditions
from restitution.doubts import cleaned
from restitution.impacts import Impacts
from restitution.impacts.speed import ReadBranch
from restitution.tracks import Track, contacts

_LEAST = 5
"""Frames above half the height of a flight that a parabola needs."""
_BLOCKS = 60
"""Stretches of a record that velocities are drawn for, at least;"""
_ERROR = 0.1
"""they are as long as it takes to know the mean slope to this part of the mean speed."""


@dataclass(frozen=True)
class Touch:
    """A contact, ``value`` that of its nearest frame; ``e`` in words, ``read``: impacts have a row of it."""

    number: int
    time_s: float
    value: float
    e: str = ""
    read: bool = False


@dataclass(frozen=True)
class Flight:
    """The frames between two contacts: begin and end in s, and the parabola of their upper half, if any."""

    begin: float
    end: float
    top_s: float = math.nan
    top_m: float = math.nan
    acceleration: float = math.nan
    error: float = math.nan
    lowest: float = math.nan
    """Where the frames of the parabola begin, in m."""

    def parabola(self, points: int = 80) -> tuple[NDArray, NDArray]:
        """Times and gaps of the parabola over its frames."""
        half = math.sqrt(max(2 * (self.lowest - self.top_m) / self.acceleration, 0.0))
        t = np.linspace(max(-half, self.begin - self.top_s), min(half, self.end - self.top_s), points)
        return self.top_s + t, self.top_m + self.acceleration / 2 * t**2


@dataclass(frozen=True)
class LeftOut:
    """Frames that were left out: times in s and values of the track as it was read."""

    time_s: NDArray
    value: NDArray


@dataclass(frozen=True)
class View:
    """All that is drawn of a track; ``level`` is where it comes to rest, in m, None if it does not."""

    track: Track
    level: float | None
    touches: list[Touch]
    branches: list[ReadBranch]
    flights: list[Flight]
    left_out: LeftOut
    conditions: Conditions | None
    film_m: float | None
    """Gap below which frames take no part in the speeds, in m."""

    @property
    def free_fall(self) -> float | None:
        """Acceleration in m/s2 of a flight without drag under the conditions."""
        return None if self.conditions is None else self.conditions.free_fall

    @property
    def terminal(self) -> float | None:
        """Terminal speed in m/s; None where the conditions are not known or the sphere does not sink."""
        c = self.conditions
        return terminal_speed(c) if c is not None and c.sphere.density > c.fluid.density else None

    def velocity(self) -> tuple[NDArray, NDArray]:
        """Times and mean slopes of the gap over stretches of a few frames, none across a contact."""
        t, y = self.track.time_s, self.track.value
        n, scale = 3, np.ptp(y) / np.ptp(t)
        error = self.track.sigma * math.sqrt(12) * len(t) / np.ptp(t)
        while error / n**1.5 > _ERROR * scale and n < len(t) // _BLOCKS:
            n += 1
        begins = np.arange(0, len(t) - n + 1, n)
        rows = begins[:, None] + np.arange(n)
        x = t[rows] - t[rows].mean(axis=1, keepdims=True)
        slope = (x * y[rows]).sum(axis=1) / (x**2).sum(axis=1)
        touch = np.array([touch.time_s for touch in self.touches])
        low, high = t[begins], t[begins + n - 1]
        across = ((low[:, None] < touch) & (touch < high[:, None])).any(axis=1)
        return t[rows].mean(axis=1)[~across], slope[~across]


def view_of(track: Track, conditions: Conditions | None, impacts: Impacts | None) -> View:
    """What there is to see.

    Parameters
    ----------
    track : positions or velocities in time.
    conditions : fluid and sphere, None where they are not known.
    impacts : what was read of the contacts, None where that was not possible.

    Frames that no flight passes through are drawn as left out, as impacts leave them out.
    """
    clean = cleaned(track)
    left_out = LeftOut(track.time_s[clean.lost], track.value[clean.lost])
    track = clean.track
    found = contacts(track)
    touching = found.contacts if impacts is None else impacts.contacts
    rows = {} if impacts is None else {row["impact"]: row for row in impacts.rows}
    touches = []
    for number, contact in enumerate(touching, 1):
        row = rows.get(number)
        frame = contact.nearest if contact.nearest is not None else max(contact.rebound.start, 1) - 1
        if not contact.rebound:
            frame = contact.approach.stop - 1
        frame = min(frame, len(track.time_s) - 1)
        time = row["time_s"] if row else float(track.time_s[frame])
        touches.append(
            Touch(number, time, float(track.value[frame]), _in_words(row) if row else "", row is not None)
        )
    branches, film = [], None
    if impacts is not None:
        branches = [branch for contact in touching for branch in impacts.measure.branches(contact)]
        film = impacts.measure.film_m if str(impacts.measure.speed) == "far" else None
    flights = []
    if track.quantity == "gap":
        times = [touch.time_s for touch in touches]
        flights = [_flight(track, found.level or 0.0, a, b) for a, b in pairwise(times)]
    return View(track, found.level, touches, branches, flights, left_out, conditions, film)


def _in_words(row: dict) -> str:
    if row["outcome"] == "rebound":
        return f"e {row['e_eff']:.2f}"
    return f"e < {row['e_eff_upper']:.2f}"


def _flight(track: Track, level: float, begin: float, end: float) -> Flight:
    """The parabola of the frames above half the height of a flight."""
    during = (track.time_s > begin) & (track.time_s < end)
    t, h = track.time_s[during], track.value[during]
    if not len(h):
        return Flight(begin, end)
    half = (level + float(np.max(h))) / 2
    upper = h > half
    if upper.sum() < _LEAST or np.max(h) - level < 5 * track.sigma:
        return Flight(begin, end)
    origin, span = float(t[upper].mean()), float(np.ptp(t[upper]))
    x, powers = (t[upper] - origin) / span, np.array([1.0, span, span**2])
    design = x[:, None] ** np.arange(3)
    c = np.linalg.lstsq(design, h[upper], rcond=None)[0] / powers
    error = float(track.sigma * np.sqrt(np.linalg.inv(design.T @ design)[2, 2]) / span**2)
    if not c[2] < 0:
        return Flight(begin, end)
    top = -c[1] / (2 * c[2])
    if not begin < origin + top < end:
        return Flight(begin, end)
    highest = float(c[0] + c[1] * top / 2)
    return Flight(begin, end, origin + top, highest, 2 * float(c[2]), 2 * error, min(half, highest))
