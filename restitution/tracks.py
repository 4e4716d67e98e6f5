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
        """A track from a table with ``time_s`` and ``gap_m`` or ``velocity_m_s``; noise estimated if not given."""
        quantity = "gap" if "gap_m" in table else "velocity"
        value = table["gap_m" if quantity == "gap" else "velocity_m_s"].to_numpy(float)
        time = table["time_s"].to_numpy(float)
        if len(time) < MINIMUM_FRAMES:
            raise InputError(f"{len(time)} frames are too few for an impact; {MINIMUM_FRAMES} are needed")
        return cls(time, value, quantity, sigma if sigma is not None else noise(time, value), scale_sigma)


@dataclass(frozen=True)
class Contact:
    """Frames around one contact, as index ranges into the track.

    ``approach`` and ``rebound`` exclude ``nearest``, the frame whose side is open. ``rebound`` is empty for a
    last contact after which no flight is resolved; then ``level`` is the gap (or velocity) at rest.
    """

    approach: range
    nearest: int | None
    rebound: range
    level: float = 0.0


def noise(time: NDArray, value: NDArray) -> float:
    """Standard deviation of the noise: what four neighbouring frames leave of a parabola, by the median.

    Of each four frames the third divided difference is free of any parabola; scaled to unit weight its
    standard deviation is that of one frame. The median over all fours ignores those across a contact.
    """
    t = np.lib.stride_tricks.sliding_window_view(time, 4)
    y = np.lib.stride_tricks.sliding_window_view(value, 4)
    distance = t[:, :, None] - t[:, None, :]
    distance[:, range(4), range(4)] = 1.0
    weight = 1.0 / distance.prod(axis=2)
    weight /= np.linalg.norm(weight, axis=1, keepdims=True)
    sigma = np.median(np.abs((weight * y).sum(axis=1))) / 0.6745
    return float(max(sigma, 1e-6 * np.ptp(value)))  # noise-free records keep a finite weight


def contacts(track: Track) -> list[Contact]:
    """All contacts of the track in order of time, the last one also where no rebound is resolved."""
    nearest = _minima(track) if track.quantity == "gap" else _reversals(track)
    n = len(track.time_s)
    ends = [*nearest, _rest(track, nearest[-1] + 1 if nearest else 0)]
    found = []
    start = 0
    for i, end in zip(nearest, ends[1:], strict=True):
        found.append(Contact(range(start, i), i, range(i + 1, n if end is None else end)))
        start = i + 1
    rest = ends[-1]
    if rest is not None and rest - start >= 2:
        found.append(Contact(range(start, rest), None, range(0), float(np.median(track.value[rest:]))))
    return found


def _minima(track: Track) -> list[int]:
    from scipy.signal import find_peaks

    return [int(i) for i in find_peaks(-track.value, prominence=DETECTION * track.sigma)[0]]


def _reversals(track: Track) -> list[int]:
    """Frames at which the velocity turns from towards the wall to away from it, beyond noise."""
    sign = np.sign(np.where(np.abs(track.value) < DETECTION * track.sigma, 0.0, track.value))
    moving = np.flatnonzero(sign)
    turns = [k for k, j in pairwise(moving) if sign[k] < 0 < sign[j] and j - k <= 2]
    return [int(k) + 1 for k in turns]


def _rest(track: Track, start: int) -> int | None:
    """First frame from which on the sphere lies still, or None if the record ends before that.

    Still means: at least three frames, all within the detection limit of their median, after a descent.
    """
    value, limit = track.value, DETECTION * track.sigma
    top = start + int(np.argmax(value[start:])) if track.quantity == "gap" else start
    for i in range(top + 1, len(value) - 2):
        level = np.median(value[i:])
        if np.all(np.abs(value[i:] - level) < limit):
            return i if abs(value[top] - level) > limit or track.quantity == "velocity" else None
    return None
