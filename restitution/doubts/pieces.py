r"""Whether a record is one film of one sphere at one rate: no jump, and no kink in mid-air.

    jump   within one frame the sphere is elsewhere, and stays there: another recording or sphere follows
    kink   within one frame, away from the wall, it goes on at another speed: another frame rate follows

Between contacts gravity and drag change a speed within k frames of dt by a few g_eff k dt alone. Where frames are
counted at one rate, and the camera (a telephone whose slow motion begins, a player) took them at two, the speed
changes by the ratio of both.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.doubts.doubt import Doubt
from restitution.tracks import DETECTION, GRAVITY, Track

_FAR = 6.0
"""Times the fastest way of a frame: a jump; a swift contact makes no more than two."""
_FEW = 3
"""Jumps of a record at most: where there are more the sphere is lost again and again."""
_STAYS, _BACK = 4, 0.75
"""Frames on each side that lie together, to this part of the jump: a record may begin with a fast fall."""
_SIDES = (6, 12, 24)
"""Frames on each side of a kink that tell a speed: many where a camera takes many."""
_RATIO = 1.6
"""Of the speeds, from which on it is a kink; cameras and players have rates of twice one another or more."""
_FALLS = 4.0
"""Free falls by which a sphere brakes at most: drag just after a contact adds one, wake and history another."""
_SURE = 8.0
"""Errors of a difference of speeds."""


def of_pieces(track: Track, level: float, diameter: float, fall: float = GRAVITY) -> list[Doubt]:
    """Doubts about a gap track with its wall at ``level`` (m), ``fall`` the free fall in m/s2."""
    if track.quantity != "gap" or len(track.value) < 4 * _SIDES[0]:
        return []
    level = max(level, float(np.min(track.value)))  # where no rest tells it, the wall may be stated too low
    doubts = _jumps(track, diameter)
    for side in _SIDES:
        doubts = doubts or _kinks(track, level, diameter, fall, side)
    return doubts


def _jumps(track: Track, diameter: float) -> list[Doubt]:
    time, value = track.time_s, track.value
    dt, way = np.diff(time), np.abs(np.diff(value))
    moved = way[way > DETECTION * track.sigma]
    if len(moved) < 4 * _FEW:
        return []
    fastest = float(np.sort(moved)[-_FEW - 1])
    limit = max(_FAR * fastest, diameter / 2, 20 * track.sigma)
    found = np.flatnonzero((way > limit) & (dt < 1.5 * np.median(dt)))
    found = found[(found >= _STAYS) & (found < len(way) - _STAYS)]
    stays = [
        i for i in found.tolist() if max(np.ptp(value[i - _STAYS : i + 1]), _after(value, i)) < _BACK * way[i]
    ]
    if not stays:
        return []
    i = stays[0]
    message = (
        f"between t = {time[i]:.6g} and {time[i + 1]:.6g} s the sphere is moved by {way[i]:.2g} m, "
        f"{way[i] / fastest:.2g} times as far as in its fastest frame else, and goes on from there: does another "
        "recording or another sphere begin there? Give each a file of its own (or --particle)"
    )
    return [Doubt("moved", message)]


def _after(value: NDArray, i: int) -> float:
    return float(np.ptp(value[i + 1 : i + 2 + _STAYS]))


def _kinks(track: Track, level: float, diameter: float, fall: float, k: int) -> list[Doubt]:
    """The greatest change of speed between k frames and the k after them."""
    time, value = track.time_s, track.value
    dt = float(np.median(np.diff(time)))
    if len(value) < 4 * k or np.any(np.diff(time) > 1.5 * dt) or not math.isfinite(level):
        return []
    x = np.arange(k) - (k - 1) / 2
    slope = np.lib.stride_tricks.sliding_window_view(value, k) @ x / (x @ x) / dt
    before, after = slope[:-k], slope[k:]  # of the k frames up to frame i + k - 1, and of the k that follow
    error = max(track.sigma, _grid(value)) / dt * math.sqrt(2 / float(x @ x))
    # Where the unit of length or time is wrong, all accelerations are so.
    bend = abs(float(np.median(value[8:] - 2 * value[4:-4] + value[:-8]))) / (4 * dt) ** 2
    usual = _FALLS * max(fall, bend) * k * dt
    small, large = np.minimum(np.abs(before), np.abs(after)), np.maximum(np.abs(before), np.abs(after))
    lowest = np.lib.stride_tricks.sliding_window_view(value, 2 * k).min(axis=1)
    kinked = (
        (before * after > 0)
        & (small > _SURE * error / 2)
        & (large - small > usual + _SURE * error)
        & (large > _RATIO * small)
        & (lowest > level + np.maximum(diameter / 2, large * k * dt))  # else a contact may be among the frames
    )
    found = np.flatnonzero(kinked)
    if not len(found):
        return []
    i = int(found[np.argmax((large - small)[found])])
    ratio = float(abs(after[i]) / abs(before[i]))
    way = f"{ratio:.2g} times as fast" if ratio > 1 else f"at 1/{1 / ratio:.2g} of the speed"
    message = (
        f"at t = {time[i + k - 1]:.6g} s, {value[i + k - 1] - level:.2g} m above the wall, the sphere goes on "
        f"{way} as before, from one frame to the next: does the frame rate of the film change there, or another "
        "sphere follow? Take the times that the camera wrote, or the part at one rate (--fps holds for all frames)"
    )
    return [Doubt("kink", message)]


def _grid(value: NDArray) -> float:
    """The error of a frame by the step of a grid of pixels, if its values lie on one."""
    steps = np.diff(np.unique(value))
    smallest = float(steps.min()) if len(steps) else 0.0
    if smallest == 0 or np.any(np.abs(steps / smallest - np.rint(steps / smallest)) > 0.02):
        return 0.0
    return smallest / math.sqrt(12)
