r"""Positions that nobody saw: lost frames which the tracking program filled by a straight line or the last place.

Between L + 2 such frames the L second differences vanish to the last digit that is written. Where a part p of the
second differences of the other frames does so, and a part q of those after one that does, a run of L happens by
chance

    N p q^(L-1)    times in N frames:

on a grid of pixels often, in a record with noise never. A sphere at rest or not yet let go lies on a line as well,
so that the frames beside a run must move.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.doubts.doubt import Doubt
from restitution.tracks import Track

_UNLIKELY = 1e-4
"""Expected number of runs from which on one is no chance."""
_DIGITS = 2.5
"""Last digits by which three rounded places on a line bend."""
_BESIDE = 3
"""Frames on each side of a run in which the sphere must have moved."""
_MOVED = 10.0
"""Errors of a frame by which it must have."""
_MOST = 0.1
"""Part of a record that is filled at most: a program that computes a steady fall has more of it."""


def of_filled(track: Track) -> list[Doubt]:
    """A doubt about the longest run of frames that lie on a line to the last digit, between others that do not."""
    time, value, n = track.time_s, track.value, len(track.value)
    usual = np.median(np.diff(time))
    if track.quantity != "gap" or n < 4 * _BESIDE or np.any(np.diff(time) > 1.5 * usual):
        return []
    straight = np.abs(np.diff(value, 2)) <= max(_DIGITS * _digit(value), 1e-9 * float(np.ptp(value)))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], straight.astype(np.int8), [0]])))
    runs = sorted(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True), key=lambda run: run[0] - run[1])
    for begin, end in runs[:_RUNS]:  # second difference k is that of the frames k to k + 2
        first, last = begin, end + 1
        if last - first + 1 > max(_MOST * n, 2 * _BESIDE):
            continue
        others = np.concatenate([straight[:begin], straight[end:]])
        if len(others) < 2 * _BESIDE or not _moves(value, first, last, track.sigma):
            continue
        p = (np.count_nonzero(others) + 1) / len(others)
        q = (np.count_nonzero(others[1:] & others[:-1]) + p) / (np.count_nonzero(others) + 1)
        if np.log(n * p) + (end - begin - 1) * np.log(q) < np.log(_UNLIKELY):
            flat = value[first] == value[last]
            how = "show the same position" if flat else "lie on one straight line to the last digit"
            return [
                Doubt(
                    "filled",
                    f"from t = {time[first]:.6g} to {time[last]:.6g} s {last - first + 1} frames {how}, where "
                    "others scatter: did the tracking program fill frames in which the sphere was lost? Leave "
                    "their positions empty (speeds and e beside them are wrong as they are)",
                )
            ]
    return []


_RUNS = 5
"""Longest runs that are looked at."""


def _digit(value: NDArray) -> float:
    """The smallest distance of different values: the last digit of a record that is written with few."""
    steps = np.diff(np.unique(value))
    return float(steps.min()) if len(steps) else 0.0


def _moves(value: NDArray, first: int, last: int, sigma: float) -> bool:
    """Whether the sphere moves before and after the run, so that it neither lies nor is held."""
    if first < _BESIDE or last + _BESIDE >= len(value):
        return False
    before, after = value[first] - value[first - _BESIDE], value[last + _BESIDE] - value[last]
    return bool(min(abs(before), abs(after)) > _MOVED * sigma)
