"""A camera track (or a simulated one) and its contacts: where one flight ends and the next begins.

A flight under gravity is concave in gap(t), so every local minimum that stands out of the noise is a contact.
The frame nearest to a contact belongs to the approach or to the rebound: :mod:`restitution.impacts` decides
that from the contact time, here it is only named.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, takewhile
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


def noise(time: NDArray, value: NDArray) -> float:
    """Standard deviation of the noise: what four neighbouring frames leave of a parabola, by the median.

    Of each four frames the third divided difference is free of any parabola; scaled to unit weight its
    standard deviation is that of one frame. The median over all fours ignores those across a contact. Positions
    on a pixel grid have at least the noise of that grid, its step over sqrt(12).
    """
    t = np.lib.stride_tricks.sliding_window_view(time, 4)
    y = np.lib.stride_tricks.sliding_window_view(value, 4)
    distance = t[:, :, None] - t[:, None, :]
    distance[:, range(4), range(4)] = 1.0
    weight = 1.0 / distance.prod(axis=2)
    weight /= np.linalg.norm(weight, axis=1, keepdims=True)
    sigma = np.median(np.abs((weight * y).sum(axis=1))) / 0.6745
    span = np.ptp(value)
    levels = np.unique(np.round(value / span, 9)) * span if span > 0 else np.zeros(1)
    grid = np.min(np.diff(levels), initial=np.inf) / np.sqrt(12) if len(levels) > 1 else 0.0
    return float(max(sigma, grid, 1e-6 * span))  # noise-free records keep a finite weight


def contacts(track: Track) -> Contacts:
    """All contacts of the track, the last one also where the sphere then stays at the wall."""
    rest, level = _rest(track)
    turns = _minima(track) if track.quantity == "gap" else _reversals(track)
    turns = [turn for turn in turns if turn[2] < rest]
    begins = [0, *(first for _, _, first in turns)]
    ends = [*(last for last, _, _ in turns[1:]), rest]
    found = [
        Contact(range(begin, last), nearest, range(first, end))
        for begin, (last, nearest, first), end in zip(begins, turns, ends, strict=False)
    ]
    if level is not None:
        found.append(Contact(range(begins[-1], rest), None, range(0)))
    return Contacts(found, level)


def _minima(track: Track) -> list[tuple[int, int | None, int]]:
    """Contacts of a gap track: end of the approach, nearest frame, begin of the rebound."""
    return [(i, i, i + 1) for i in lowest_points(track.value.tolist(), DETECTION * track.sigma)]


def lowest_points(value: Sequence[float], depth: float) -> list[int]:
    """Where minima lie from which one must rise by ``depth`` on both sides to come to a lower place.

    Those of ``scipy.signal.find_peaks`` by its prominence, without that package, which takes a second to load. A
    flat minimum is counted at its middle, the ends of the record are none.
    """
    found = []
    for left, right in _flat_minima(value):
        highest = []
        for side in (range(left, -1, -1), range(right, len(value))):
            above = takewhile(value[left].__le__, map(value.__getitem__, side))
            highest.append(max(above))
        if min(highest) - value[left] >= depth:
            found.append((left + right) // 2)
    return found


def _flat_minima(value: Sequence[float]) -> Iterator[tuple[int, int]]:
    """First and last place of every run of equal values whose neighbours are both greater."""
    left = 0
    for i in range(1, len(value)):
        if value[i] != value[left]:
            if left > 0 and value[left - 1] > value[left] < value[i]:
                yield left, i - 1
            left = i


def _reversals(track: Track) -> list[tuple[int, int | None, int]]:
    """Contacts of a velocity track: from towards the wall to away from it, beyond noise, within two frames.

    A frame between the two has seen both sides of the contact and belongs to neither.
    """
    sign = np.sign(np.where(np.abs(track.value) < DETECTION * track.sigma, 0.0, track.value))
    moving = np.flatnonzero(sign)
    turns = [(int(k), int(j)) for k, j in pairwise(moving) if sign[k] < 0 < sign[j] and j - k <= 2]
    return [(k + 1, None, j) for k, j in turns]


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
    unseen = 2 * np.sqrt(2 * limit / GRAVITY) if track.quantity == "gap" else 2 * limit / GRAVITY
    trend, error = (t @ y) / (t @ t), track.sigma / np.sqrt(t @ t)
    if np.ptp(t) < unseen or abs(trend) > 4 * error:
        return n, None
    return rest, float(np.median(value[rest:])) if track.quantity == "gap" else 0.0
