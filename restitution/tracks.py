"""A camera track (or a simulated one) and its contacts: where one flight ends and the next begins.

A flight under gravity is concave in gap(t), so every local minimum that stands out of the noise is a contact.
The frame nearest to a contact belongs to the approach or to the rebound: :mod:`restitution.impacts` decides
that from the contact time, here it is only named.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from restitution.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

MINIMUM_FRAMES = 4
GRAVITY = 9.81
"""For the time scale of flights too low to be seen; buoyancy only makes them longer."""
DETECTION = 5.0
"""A bounce is resolved if its flight rises above both contacts by this many times the noise."""


@dataclass(frozen=True)
class Track:
    """``value`` is the gap in m or the velocity (d gap/dt) in m/s at ``time_s``; ``sigma`` is its noise.

    ``scale_sigma`` is a relative error that all speeds of the track share, as from its time axis.
    """

    time_s: NDArray
    value: NDArray
    quantity: Literal["gap", "velocity"]
    sigma: float
    scale_sigma: float = 0.0

    @classmethod
    def from_table(cls, table: pd.DataFrame, sigma: float | None = None, scale_sigma: float = 0.0) -> Track:
        """A track from a table.

        Parameters
        ----------
        table : columns ``time_s`` and ``gap_m`` (m, of the lowest point) or ``velocity_m_s`` (away from the wall).
        sigma : noise of a position in m or of a velocity in m/s; estimated from the frames if not given.
        scale_sigma : relative error that all speeds share, as from the time axis.

        Raises
        ------
        InputError : for fewer than four frames.
        """
        quantity = "gap" if "gap_m" in table else "velocity"
        value = table["gap_m" if quantity == "gap" else "velocity_m_s"].to_numpy(float)
        time = table["time_s"].to_numpy(float)
        if len(time) < MINIMUM_FRAMES:
            raise InputError(f"{len(time)} frames are too few for an impact; {MINIMUM_FRAMES} are needed")
        return cls(time, value, quantity, sigma if sigma is not None else noise(time, value), scale_sigma)


@dataclass(frozen=True)
class Contact:
    """Frames around one contact, as index ranges into the track.

    ``nearest`` is a frame whose side is open; neither range has it. ``approach`` is empty where the record
    begins after the contact, ``rebound`` where the sphere stays at the wall.
    """

    approach: range
    nearest: int | None
    rebound: range


@dataclass(frozen=True)
class Contacts:
    """All contacts of a track in order of time; ``level`` is the gap at which the sphere comes to rest, if any."""

    contacts: list[Contact]
    level: float | None
    hovering: tuple[int, ...] = ()
    """Lowest frames of minima that are no contacts, since they lie far above the wall."""


def noise(time: NDArray, value: NDArray) -> float:
    """Standard deviation of the noise: what four neighbouring frames leave of a parabola, by the median.

    Of each four frames the third divided difference is free of any parabola; scaled to unit weight its
    standard deviation is that of one frame. The median over all fours ignores those across a contact. Positions
    on a pixel grid have at least the noise of that grid, its step over sqrt(12).
    """
    sigma = np.median(np.abs(differences(time, value)[0])) / 0.6745
    # Noise-free records keep a finite weight.
    return float(max(sigma, grid_step(value) / np.sqrt(12), 1e-6 * np.ptp(value)))


def differences(time: NDArray, value: NDArray) -> tuple[NDArray, NDArray]:
    """The third divided difference of each four neighbours, and the four weights that it has of unit length."""
    t = np.lib.stride_tricks.sliding_window_view(time, 4)
    y = np.lib.stride_tricks.sliding_window_view(value, 4)
    distance = t[:, :, None] - t[:, None, :]
    distance[:, range(4), range(4)] = 1.0
    weight = 1.0 / distance.prod(axis=2)
    weight /= np.linalg.norm(weight, axis=1, keepdims=True)
    return (weight * y).sum(axis=1), weight


def grid_step(value: NDArray) -> float:
    """The step of which all distances between values are multiples, as of pixels; 0 where there is none."""
    span = np.ptp(value)
    levels = np.unique(np.round(value / span, 9)) * span if span > 0 else np.zeros(1)
    steps = np.diff(levels)
    if not len(steps):
        return 0.0
    multiples = steps / steps.min()
    return float(steps.min()) if np.all(np.abs(multiples - np.rint(multiples)) < 0.01) else 0.0


def contacts(track: Track) -> Contacts:
    """All contacts of the track, the last one also where the sphere then stays at the wall."""
    rest, level = _rest(track)
    turns, hovering = _minima(track, rest, level) if track.quantity == "gap" else (_reversals(track), ())
    turns = [turn for turn in turns if turn[2] < rest]
    begins = [0, *(first for _, _, first in turns)]
    ends = [*(last for last, _, _ in turns[1:]), rest]
    found = [
        Contact(range(begin, last), nearest, range(first, end))
        for begin, (last, nearest, first), end in zip(begins, turns, ends, strict=False)
    ]
    if level is not None:
        found.append(Contact(range(begins[-1], rest), None, range(0)))
    return Contacts(found, level, hovering)


def _minima(
    track: Track, rest: int, level: float | None
) -> tuple[list[tuple[int, int | None, int]], tuple[int, ...]]:
    """Contacts of a gap track: end of the approach, nearest frame, begin of the rebound; and minima in mid-air.

    The sphere meets the wall where the frames beside it lie at most a frame's way above it. A minimum that
    is higher than this, and nearer to the top of the lower of its flights than to the wall, is no contact.
    """
    value, limit = track.value, DETECTION * track.sigma
    lows = [i for i in _lowest_frames(track, limit) if i < rest]
    if not lows:
        return [], ()
    # Below zero lies the overlap of a soft contact.
    wall = level if level is not None else max(0.0, float(min(value[i] for i in lows)))
    steps = np.abs(np.diff(value))
    touching, hovering = [], []
    for k, i in enumerate(lows):
        left, right = (lows[k - 1] if k else 0), (lows[k + 1] if k + 1 < len(lows) else rest)
        top = min(value[left : i + 1].max(), value[i:right].max())
        way = _FRAMES_WAY * float(np.median(steps[max(i - _BESIDE, 0) : i + _BESIDE]))
        above = value[i] - wall > max(0.5 * (top - wall), way + limit)
        (hovering if above else touching).append(i)
    return [(i, i, i + 1) for i in touching], tuple(hovering)


def _lowest_frames(track: Track, limit: float) -> list[int]:
    """The lowest frame of every minimum deeper than ``limit``, found in means of so many frames that few
    make a top.

    Of very many frames about the top of a flight some differ by more than the limit by noise alone.
    """
    value = track.value
    m = max(1, int(_lasting(limit) / float(np.median(np.diff(track.time_s))) / _FRAMES_OF_A_TOP))
    if m == 1:
        return lowest_points(value, limit)
    begins = np.arange(0, len(value) - m + 1, m)
    means = np.add.reduceat(value, begins)[:-1] / m
    around = [(max((b - 1) * m, 0), (b + 2) * m) for b in lowest_points(means, limit)]
    return [first + int(np.argmin(value[first:last])) for first, last in around]


_FRAMES_OF_A_TOP = 16
"""Frames within the limit of a flight's top; the noise of so many seldom differs by it."""


def _lasting(height: float) -> float:
    """How long in s a flight of ``height`` in m lasts."""
    return float(2 * np.sqrt(2 * height / GRAVITY))


_FRAMES_WAY = 2.0
"""How many frames' way a lowest frame may lie above the wall: the frame, and half as much for what slows it."""
_BESIDE = 4
"""Frames on each side that tell how far the sphere moves in one."""


def lowest_points(value: NDArray, depth: float) -> list[int]:
    """Where minima lie from which one must rise by ``depth`` on both sides to come to a lower place.

    A flat minimum is counted at its middle, the ends of the record are none. One pass over the record: the lowest
    place so far is a minimum once the record has risen from it by ``depth``.
    """
    if len(value) == 0:
        return []
    begins = np.flatnonzero(np.diff(value, prepend=np.nan) != 0)
    ends = np.append(begins[1:], len(value)) - 1
    heights = np.asarray(value, float)[begins].tolist()
    found, falling, low, top = [], False, 0, heights[0]
    for k, height in enumerate(heights):
        if not falling:
            top = max(top, height)
            falling, low = top - height >= depth and height < top, k
        elif height < heights[low]:
            low = k
        elif height - heights[low] >= depth:
            found.append(int(begins[low] + ends[low]) // 2)
            falling, top = False, height
    return found


def _reversals(track: Track) -> list[tuple[int, int | None, int]]:
    """Contacts of a velocity track: from towards the wall to away from it, beyond noise, faster than gravity
    turns.

    A frame between the two has seen both sides of the contact and belongs to neither. Where the velocity grows on
    after it has turned, the contact lasts: nothing but the wall pushes the sphere away, so all frames about the
    turn whose velocity so grows belong to the contact.
    """
    time, value = track.time_s, track.value
    sign = np.sign(np.where(np.abs(value) < DETECTION * track.sigma, 0.0, value))
    moving = np.flatnonzero(sign)
    slope = np.diff(value) / np.diff(time)
    grows = slope > DETECTION * np.sqrt(2) * track.sigma / np.diff(time)
    steep = grows & (slope > _STEEP * np.median(np.abs(slope)))
    turns = []
    for k, j in pairwise(moving.tolist()):
        if not sign[k] < 0 < sign[j]:
            continue
        if j - k > 2 and value[j] - value[k] < _STEEP * GRAVITY * (time[j] - time[k]):
            continue
        pushed = j
        while pushed < len(grows) and grows[pushed]:
            pushed += 1
        if pushed > j:
            while k > 0 and steep[k - 1]:
                k -= 1
            k, pushed = max(k - 1, 0), min(pushed + 1, len(value) - 1)  # begin and end lie within a frame
        turns.append((k + 1, None, pushed))
    return turns


_STEEP = 8.0
"""Times the typical acceleration of a record from which on the wall pushes: a wake brakes by three."""


def begins_on_rebound(track: Track, found: Contacts) -> bool:
    """Whether the record begins on a rebound: up to its first contact it rises from the first frame on,
    fastest at first.

    A sphere that is held or lifted before its release does not; nor does noise about the release.
    """
    end = found.contacts[0].approach.stop if found.contacts else len(track.time_s)
    flight, limit = track.value[:end], DETECTION * track.sigma
    if len(flight) < 3:
        return False
    if track.quantity == "velocity":
        return bool(flight[0] > limit)
    top = int(np.argmax(flight))
    rise = flight[top] - flight[0]
    if top == 0 or rise < np.sqrt(2) * limit:
        return False
    share = (track.time_s[top] - track.time_s[0]) / 3
    early = np.interp(track.time_s[0] + share, track.time_s[: top + 1], flight[: top + 1])
    return bool(early - flight[0] > 0.4 * rise)


def _rest(track: Track) -> tuple[int, float | None]:
    """From which frame on the sphere lies still at the wall, and its gap there; the end and None if it does not.

    Still means: at least five frames without trend, as far from the last ones as the noise of so many frames goes,
    for longer than a bounce too low to be seen lasts. A gap must be the lowest of the record, a velocity zero.
    """
    time, value, n = track.time_s, track.value, len(track.value)
    level = float(np.median(value[-5:])) if track.quantity == "gap" else 0.0
    band = (np.sqrt(2 * np.log(n)) + 2) * track.sigma
    away = np.flatnonzero(np.abs(value - level) > band)
    rest = int(away[-1]) + 1 if len(away) else 0
    lowest = track.quantity == "velocity" or level < np.min(value) + 2 * band
    if rest == 0 or n - rest < 5 or not lowest:
        return n, None
    t, y = time[rest:] - time[rest:].mean(), value[rest:] - level
    limit = DETECTION * track.sigma
    unseen = _lasting(limit) if track.quantity == "gap" else 2 * limit / GRAVITY
    trend, error = (t @ y) / (t @ t), track.sigma / np.sqrt(t @ t)
    if np.ptp(t) < unseen or abs(trend) > 4 * error:
        return n, None
    return rest, float(np.median(value[rest:])) if track.quantity == "gap" else 0.0
