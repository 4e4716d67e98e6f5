"""Whether the frames of a gap track are those of a camera: each seen once, at its own time.

    repeated    a film of fewer frames than the clock counts: the sphere stays put while it moves
    renumbered  frames were lost and the rest numbered on: within one frame the sphere goes the way of several
    smoothed    above the film nothing but the wall turns the sphere, and it does so within a frame

All three change speeds and restitutions, and leave gaps that look well.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.doubts.doubt import Doubt
from restitution.stokes import H_FILM
from restitution.tracks import GRAVITY, Track

_AROUND = 8
"""Frames on each side that tell how far the sphere goes meanwhile."""
_BESIDE = 4
"""The same for one frame that goes too far."""
_REPEATED = 0.15
"""Part of the frames that repeat the one before, while the sphere moves, from which on they are doubtful."""
_WAYS = 0.6
"""Ways of a frame beyond the one expected from which on a frame is lost: one lost frame adds one."""
_SURE = 10.0
"""Errors of a frame, for a way that noise does not make in any of very many frames."""
_BENT = 5.0
"""Errors of a frame, two of a bend, that noise does not make in many triples in a row."""
_LASTING = 3
"""Triples of frames, beyond the two that a sudden contact lies in, from which on a turn lasts."""


def of_frames(track: Track, level: float, diameter: float) -> list[Doubt]:
    """What is doubtful about the frames of a gap track; the wall is at ``level`` (m)."""
    if track.quantity != "gap" or len(track.value) < 3 * _AROUND:
        return []
    return _repeated(track) or _renumbered(track) or _smoothed(track, level + H_FILM * diameter)


def of_smoothed(track: Track, level: float, diameter: float) -> list[Doubt]:
    """Whether contacts are rounded above the film, the wall being at ``level`` (m)."""
    return _smoothed(track, level + H_FILM * diameter) if track.quantity == "gap" else []


def _repeated(track: Track) -> list[Doubt]:
    """Equal neighbours where the sphere goes more than a step of the pixel grid in each frame."""
    value = track.value
    step = np.abs(np.diff(value))
    moved = step[step > 0]
    if not len(moved):
        return []
    far = np.abs(value[2 * _AROUND :] - value[: -2 * _AROUND]) / (2 * _AROUND)
    way = np.pad(far, (_AROUND, _AROUND - 1), constant_values=0.0)  # of each step, by the frames about it
    pixel = float(np.quantile(moved, 0.01))
    going = way > max(2 * pixel, 3 * track.sigma / np.sqrt(2 * _AROUND)) if pixel > 0 else way > 0
    # On a grid of pixels every step is a multiple of one; of repeated frames the others are of any size.
    if np.count_nonzero(going) < _AROUND:
        going = way > np.quantile(way, 0.7)
    if not going.any():
        return []
    share = float(np.mean(step[going] == 0))
    if share < _REPEATED or _on_a_grid(moved, way[going]):
        return []
    times = 1 / (1 - share)
    return [
        Doubt(
            "repeated",
            f"{share:.0%} of the frames repeat the position of the frame before while the sphere moves: was each "
            f"picture tracked {times:.2g} times? Keep one frame of each, at the rate of the camera (speeds and e "
            "are off as they are)",
        )
    ]


def _on_a_grid(moved: NDArray, way: NDArray) -> bool:
    """Whether all steps are multiples of the smallest, and that is no less than the way of a frame."""
    pixel = moved.min()
    multiples = moved / pixel
    return bool(np.all(np.abs(multiples - np.rint(multiples)) < 0.02) and np.median(way) < 2 * pixel)


def _renumbered(track: Track) -> list[Doubt]:
    """Frames between which the sphere goes farther than before and after, and as fast on both sides."""
    time, value = track.time_s, track.value
    dt, dy = np.diff(time), np.diff(value)
    speed = dy / dt
    n, k = len(speed), _BESIDE
    windows = np.lib.stride_tricks.sliding_window_view(speed, k)
    i = np.arange(k, n - k)
    before, after = np.median(windows[i - k], axis=1), np.median(windows[i + 1], axis=1)
    # What gravity may add in the frames beside it, and what noise makes of medians of differences.
    # Where the unit of length or time is wrong, gravity is so too.
    bend = abs(float(np.median(value[2 * k :] - 2 * value[k:-k] + value[: -2 * k]))) / (k * np.median(dt)) ** 2
    slack = max(GRAVITY, bend) * (k + 1) * dt[i] * dt[i] + _SURE * track.sigma
    way = np.maximum(np.abs(before), np.abs(after)) * dt[i]
    excess = np.abs(dy[i]) - way - slack
    same = before * after > 0
    usual = dt[i] < 1.5 * np.median(dt)
    found = i[same & usual & (np.sign(dy[i]) == np.sign(before)) & (excess > _WAYS * way)]
    if not len(found):
        return []
    j = int(found[np.argmax(np.abs(dy[found]))])
    lost = abs(dy[j]) / (max(abs(before[j - k]), abs(after[j - k])) * dt[j]) - 1
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    return [
        Doubt(
            "renumbered",
            f"between t = {time[j]:.6g} and {time[j + 1]:.6g} s{more} the sphere goes {abs(dy[j]):.3g} m, as far "
            f"as in {lost + 1:.2g} frames beside it: were about {max(round(lost), 1)} frames lost there and the "
            "others numbered on? Number them as the camera took them (later times and speeds about it are off)",
        )
    ]


def _smoothed(track: Track, film: float) -> list[Doubt]:
    """Upward bends above the film that last longer than the frames beside a sudden contact."""
    usual = float(np.median(np.diff(track.time_s)))
    time, value = _filled_up(track, usual)
    even = bool(np.all(np.diff(time) < 1.5 * usual))
    stride = 1
    while even and 8 * stride < len(value) and stride <= 32:
        s = stride
        bend = value[2 * s :] - 2 * value[s:-s] + value[: -2 * s]
        limit = GRAVITY * (s * usual) ** 2 + _BENT * track.sigma
        lowest = np.minimum(np.minimum(value[2 * s :], value[s:-s]), value[: -2 * s])
        turns = (bend > limit) & (lowest > film)
        length, at = _longest(turns)
        if length >= 2 * s + _LASTING * s:
            frames = length - 2 * s + 1
            middle = time[at + length // 2 + s]
            return [
                Doubt(
                    "smoothed",
                    f"near t = {middle:.4g} s the track turns upwards over some {frames} frames above the film, "
                    f"{lowest[at : at + length].min():.2g} m or more from the wall, where a contact takes one: "
                    "was it smoothed by the tracking program? Take the raw positions: of rounded contacts no "
                    "speed is to be had",
                )
            ]
        stride *= 2
    return []


def _filled_up(track: Track, usual: float) -> tuple[NDArray, NDArray]:
    """Times and gaps with single missing frames, as mistracked ones leave, on the line between the others."""
    time = track.time_s
    step = np.diff(time)
    alone = np.flatnonzero((step > 1.5 * usual) & (step < 2.5 * usual))
    time = np.insert(time, alone + 1, time[alone] + step[alone] / 2)
    return time, np.interp(time, track.time_s, track.value)


def _longest(flags: NDArray) -> tuple[int, int]:
    """Length and begin of the longest run of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(np.int8), [0]])))
    if not len(edges):
        return 0, 0
    lengths = edges[1::2] - edges[::2]
    k = int(np.argmax(lengths))
    return int(lengths[k]), int(edges[2 * k])
