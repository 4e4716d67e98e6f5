"""Frames that no flight passes through: the tracking program had lost the sphere and followed something else.

A sphere moves no farther between two frames than its speed allows, and a flight is smooth, so a frame is
mistracked if the frames before it and those after it both say that the sphere was elsewhere:

- anywhere: by more than the sphere goes in two frames at its fastest (a contact bends a track by less);
- far from the wall, where no contact can be between: by more than eight times its error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.doubts.doubt import Doubt
from restitution.tracks import MINIMUM_FRAMES, Track

_ERRORS = 8.0
"""Errors of a frame from which on a smooth flight does not pass through it."""
_NEIGHBOURS = 5
"""Frames on each side that say where the sphere was."""
_RUNS = 5
"""Rounds: a run of so many neighbouring frames is found from its ends."""
_MOST = 0.1
"""Part of the frames beyond which they are no exceptions: the track is then left as it is."""


@dataclass(frozen=True)
class Cleaned:
    """A track without its mistracked frames; ``lost`` are their indices in the track as it was."""

    track: Track
    lost: NDArray
    doubts: tuple[Doubt, ...]


def cleaned(track: Track, where: str = "") -> Cleaned:
    """The track without frames that no flight passes through."""
    lost = mistracked(track)
    if not len(lost):
        return Cleaned(track, lost, ())
    keep = np.setdiff1d(np.arange(len(track.time_s)), lost)
    times = track.time_s[lost]
    named = ", ".join(f"{t:.6g}" if abs(t) < 1e3 else f"{t:.4f}" for t in times[:_NAMED])
    more = f" and {len(lost) - _NAMED} more" if len(lost) > _NAMED else ""
    one = len(lost) == 1
    message = (
        f"{len(lost)} frame{'' if one else 's'} that no flight passes through left out (t = {named}{more} s): "
        f"was the sphere lost there? Delete {'it' if one else 'them'}, or leave the position empty"
    )
    rest = replace(track, time_s=track.time_s[keep], value=track.value[keep])
    return Cleaned(rest, lost, (Doubt("mistracked", message, where),))


_NAMED = 6
"""Times that a message names."""


def mistracked(track: Track) -> NDArray:
    """Indices of the frames of a gap track that no flight passes through."""
    n = len(track.time_s)
    none = np.array([], int)
    if track.quantity != "gap" or n < 2 * _NEIGHBOURS or not track.sigma > 0:
        return none
    lost: list[int] = []
    for _ in range(_RUNS):
        keep = np.setdiff1d(np.arange(n), lost)
        if len(keep) < MINIMUM_FRAMES + 2 * _NEIGHBOURS:
            return none
        found = keep[_jumps(track.time_s[keep], track.value[keep], track.sigma)]
        if not len(found):
            break
        lost += found.tolist()
    return np.array(sorted(lost), int) if len(lost) <= max(2, _MOST * n) else none


def _jumps(time: NDArray, value: NDArray, sigma: float) -> NDArray:
    """Places at which both sides say that the sphere was elsewhere; of neighbours the worse one alone."""
    step = np.diff(time)
    speed = np.abs(np.diff(value)) / step
    fastest = float(np.quantile(speed, 0.95))
    before, after = _said(time, value, sigma), _said(-time[::-1], value[::-1], sigma)[::-1]
    away = np.minimum(before[:, 0], after[:, 0])
    away[np.isinf(before[:, 0]) | np.isinf(after[:, 0])] = 0.0  # the first and the last frames have one side alone
    # Flights are no parabolas; how much they bend from frame to frame says how little they differ from them.
    bend = 2 * float(np.median(np.abs(np.diff(value, 2))))
    allowed = np.maximum(before[:, 1], after[:, 1]) + bend
    gaps = np.minimum(np.append(np.inf, step), np.append(step, np.inf))
    anywhere = 2.0 * fastest * gaps + _ERRORS * sigma
    # A frame is far from the wall if the sphere cannot have touched it within the neighbouring frames.
    local = np.convolve(np.append(speed, speed[-1]), np.ones(3) / 3, "same") * gaps
    low = np.minimum.reduce([np.roll(value, k) for k in range(-_NEIGHBOURS, _NEIGHBOURS + 1)])
    ceiling = float(np.quantile(value, 0.02)) + (_NEIGHBOURS + 1) * np.maximum(local, fastest * gaps)
    flying = (value > ceiling) & (low > np.quantile(value, 0.02) + fastest * gaps)
    wrong = np.where(flying, away > allowed, away > np.maximum(anywhere, allowed))
    score = np.where(wrong, away, 0.0)
    beside = np.maximum(np.append(0.0, score[:-1]), np.append(score[1:], 0.0))
    return np.flatnonzero(wrong & (score >= beside))


def _said(time: NDArray, value: NDArray, sigma: float) -> NDArray:
    """How far each frame is from where the frames before it say, and how far it may be, (frames, 2).

    They say it by the straight line through the last two and by the parabola through the last five; the nearer one
    counts, with the error that it has.
    """
    n = len(time)
    said = np.full((n, 2), [np.inf, 0.0])
    for frames, order in ((2, 1), (_NEIGHBOURS, 2)):
        if n <= frames:
            continue
        at = np.arange(frames, n)
        scale = time[at] - time[at - frames]
        away, squares = -value[at], np.zeros(len(at))
        # A column at a time: of the fit to the frames before, the value at the frame itself, where t = 0.
        t = [(time[at - k] - time[at]) / scale for k in range(1, frames + 1)]
        first = _first_row(t, order)
        for k, column in enumerate(t, 1):
            weight = sum(c * column**j for j, c in enumerate(first))
            away = away + weight * value[at - k]
            squares += weight**2
        away, error = np.abs(away), _ERRORS * sigma * np.sqrt(1 + squares)
        better = away - error < said[at, 0] - said[at, 1]
        said[at[better]] = np.stack([away, error], axis=1)[better]
    return said


def _first_row(t: list[NDArray], order: int) -> list[NDArray]:
    """The first row of the inverse of the normal matrix of a polynomial in t, for each frame."""
    s = [np.sum([column**j for column in t], axis=0) for j in range(2 * order + 1)]
    if order == 1:
        row = [s[2], -s[1]]
    else:
        row = [s[2] * s[4] - s[3] ** 2, s[2] * s[3] - s[1] * s[4], s[1] * s[3] - s[2] ** 2]
    determinant = np.sum([s[j] * row[j] for j in range(order + 1)], axis=0)
    return [c / determinant for c in row]
