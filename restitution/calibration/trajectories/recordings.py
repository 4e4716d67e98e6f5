"""Recorded trajectories for a fit: their frames, and what is known beforehand of start, clock and scale.

A record is a shipped one or a file of time and gap with its conditions. What it starts with is told by its frames:

- ``speed``: it falls steadily; the speed at the first frame is open, within 5 % of the mean of the approach;
- ``height``: it starts from rest, or is still far below the terminal speed; the height of the release is open;
- ``impact``: it begins on a rebound; the speed of the impact that nobody filmed is open, near the quoted one, or,
  where none is quoted, within 30 % of the first rebound over 0.75.

Frames at rest tell where the wall is and nothing else: one mean of them takes part, so that a long tail neither
outweighs the flights nor is lost.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from restitution import datasets
from restitution.bounce import Release, terminal_speed
from restitution.bounce.agreement import release_reaching
from restitution.calibration.estimation.parameters import Normal
from restitution.calibration.reading.reading import Reading
from restitution.calibration.reading.track_impacts import track_of
from restitution.calibration.trajectories.recording_checks import bounces, check
from restitution.conditions import Conditions
from restitution.doubts import Doubt, cleaned, of_track
from restitution.errors import Defect, InputError
from restitution.foreign.table import read_foreign
from restitution.foreign.track import is_track, what_is_needed
from restitution.inputs import read_bytes
from restitution.stokes import H_FILM
from restitution.tracks import Track, begins_on_rebound, contacts

SCALE = 0.01
"""Relative standard deviation of the scale of length where none is stated."""
LEVEL_D = 0.01
"""Standard deviation of the zero of the gap where none is stated, in diameters."""
STEADY = 0.05
"""Relative standard deviation of the speed of a steady fall about its mean over the approach."""
STILL_FALLING = 0.7
"""A sphere that is slower than this part of its terminal speed at the first frames was released at rest."""
FIRST_E = 0.75
"""Restitution that an impact which nobody filmed is taken to have had, to guess its speed from the rebound's."""
UNSEEN = 0.3
"""Relative standard deviation of such a guess."""
_RUN_UP_D = 5.0
"""Gap, in diameters, at which the model starts where the record begins on a rebound."""


@dataclass(frozen=True)
class Start:
    """What is open at the start, with its prior: m/s or m. ``gap`` is that of the release where it is known."""

    kind: Literal["speed", "height", "impact"]
    prior: Normal
    gap: float = 0.0
    release_speeds: tuple[float, ...] = ()
    """Of ``impact``: quadratic in the impact speed over its mean less 1, the release speed at ``gap``."""

    @property
    def name(self) -> str:
        """In words, with its unit."""
        return {"speed": "release_speed_m_s", "height": "release_gap_m", "impact": "impact_speed_m_s"}[self.kind]

    def release(self, value: float) -> Release:
        """The release at a value of what is open."""
        if self.kind == "height":
            return Release(value, 0.0)
        if self.kind == "speed":
            return Release(self.gap, value, developed=True)
        speed = float(np.polyval(self.release_speeds, value / self.prior.mean - 1))
        return Release(self.gap, speed, developed=True)


@dataclass(frozen=True)
class Recording:
    """Frames in motion (``time_s``, ``gap_m`` above the level at rest), and what is known beforehand.

    ``clock`` is the prior of the recorded time of the first contact, or of the release where the release is known.
    """

    name: str
    conditions: Conditions
    track: Track
    time_s: NDArray
    gap_m: NDArray
    sigma: float
    rest_frames: int
    rest_gap: float
    start: Start
    clock: Normal
    clock_of: Literal["contact", "release"]
    clock_rate: float
    """Standard deviation of the relative error of the time axis; 0: none."""
    scale: float
    level: float
    contacts_s: tuple[float, ...]
    """Of each bounce that was seen to rise, about when it was; nan where the record begins after it."""
    digest: str
    notes: tuple[str, ...] = ()
    doubts: tuple[Doubt, ...] = ()

    @property
    def fall_time(self) -> float:
        """Sqrt(d/g), the time scale of everything in s."""
        return math.sqrt(self.conditions.sphere.diameter / self.conditions.gravity)


def read_recordings(paths: Sequence[str], how: Reading) -> list[Recording]:
    """All records; raises :class:`InputError` with what is wrong in each."""
    records, defects = [], []
    for path in dict.fromkeys(map(str, paths)):
        try:
            records.append(read_recording(path, how))
        except InputError as error:
            defects += [d if d.file else replace(d, file=path) for d in error.defects]
    if defects:
        raise InputError(*defects)
    return records


def read_recording(path: str, how: Reading) -> Recording:
    """One record: a file, or a shipped one by its name."""
    if Path(path).exists():
        table = read_foreign(path, how.track.decimal)
        if not is_track(table, how.settings):
            raise InputError(what_is_needed(table))
        track, conditions, notes = track_of(table, how)
        record = recording(path, track, conditions, hashlib.sha256(read_bytes(path)).hexdigest())
        return replace(record, notes=(*(f"{path}: {note}" for note in notes), *record.notes))
    if path not in datasets.names():
        raise InputError(Defect("does not exist, and no shipped record has this name", file=path))
    r = datasets.resource(path)
    if r.table != "trajectory":
        raise InputError(Defect(f"is a {r.table} table; a trajectory of time and gap is needed", file=path))
    track, error = datasets.load_track(path), r.digitisation_error
    record = recording(
        path, track, how.conditions or r.conditions, r.hash.removeprefix("sha256:"), r.quoted.get("release_gap_m"),
        error.offset_sigma.get("gap_m"),
    )  # fmt: skip
    clock = record.clock
    if record.clock_of == "release":
        clock = Normal(0.0, error.offset_sigma.get("time_s", clock.sigma))
    return replace(
        record,
        clock=clock,
        clock_rate=error.scale_sigma.get("time_s", 0.0),
        scale=error.scale_sigma.get("gap_m", SCALE),
    )


def recording(
    name: str, track: Track, conditions: Conditions, digest: str = "", release_gap: float | None = None,
    level_sigma: float | None = None,
) -> Recording:  # fmt: skip
    """A record from its track; ``release_gap`` (m) is that of a release from rest, ``level_sigma`` its error."""
    d = conditions.sphere.diameter
    clean = cleaned(track, name)
    track, touches = clean.track, contacts(clean.track)
    doubts = (*clean.doubts, *of_track(track, touches, conditions, name))
    check(name, track, touches, conditions, doubts)
    level = touches.level or 0.0
    rest = touches.contacts[-1].approach.stop if touches.level is not None else len(track.time_s)
    time, gap = track.time_s[:rest], track.value[:rest] - level
    rising = begins_on_rebound(track, touches)
    notes = []
    if rest < len(track.time_s):
        n = len(track.time_s) - rest
        notes.append(f"{name}: the {n} frames at rest tell the level of the wall ({level:.2g} m) and nothing else")
    zero = LEVEL_D * d if level_sigma is None else level_sigma
    approach = np.arange(0) if rising else np.array(touches.contacts[0].approach, int)
    start = _start(name, time, gap, track.sigma, approach, conditions, release_gap, zero, notes)
    dt = float(np.median(np.diff(track.time_s)))
    if start.kind == "height" and release_gap is not None:
        clock, clock_of = Normal(0.0, dt), "release"
    else:
        touch = 0.0
        if not rising:
            back, last = approach[::-1], approach[-1]
            speed = -_speed(time[back], gap[back], track.sigma) if len(back) > 1 else terminal_speed(conditions)
            touch = float(time[last] + max(gap[last], 0.0) / max(speed, 1e-9))
        elif abs(time[0]) > 2 * dt:
            touch = float(time[0] - gap[0] / max(_speed(time, gap, track.sigma), 1e-9))
        clock, clock_of = Normal(touch, dt), "contact"
    return Recording(
        name, conditions, track, time, gap, track.sigma, len(track.time_s) - rest,
        float(np.mean(track.value[rest:]) - level) if rest < len(track.time_s) else 0.0,
        start, clock, clock_of, 0.0, SCALE, zero, bounces(track, touches)[0], digest, tuple(notes), doubts,
    )  # fmt: skip


_MOVED = 10.0
"""Errors of a frame by which a sphere must have moved to tell its speed."""


def _speed(time: NDArray, gap: NDArray, sigma: float, least: int = 2) -> float:
    """Rate of the gap in m/s over the first frames, at least so many, in which the sphere moves."""
    moved = np.flatnonzero(np.abs(gap - gap[0]) > _MOVED * sigma)
    n = max(least, int(moved[0]) + 1 if len(moved) else len(gap))
    return float(np.polyfit(time[:n] - time[0], gap[:n], 1)[0])


def _start(
    name: str, time: NDArray, gap: NDArray, sigma: float, approach: NDArray, conditions: Conditions,
    release_gap: float | None, zero: float, notes: list[str],
) -> Start:  # fmt: skip
    d, terminal = conditions.sphere.diameter, terminal_speed(conditions)
    if release_gap is not None:
        return Start("height", Normal(release_gap, zero))
    frames = approach[gap[approach] > H_FILM * d]
    if len(frames) >= 2:
        first = -_speed(time[frames], gap[frames], sigma, max(2, min(4, len(frames) // 2)))
        if first >= STILL_FALLING * terminal:
            speed = -float(np.polyfit(time[frames], gap[frames], 1)[0])
            return Start("speed", Normal(speed, STEADY * speed), float(gap[frames[0]]))
        # Free fall up to here: a little more than it, by the drag.
        height = float(gap[frames[0]] + max(first, 0.0) ** 2 / (2 * conditions.free_fall))
        notes.append(f"{name}: taken to start from rest, at a gap of about {1e3 * height:.3g} mm")
        return Start("height", Normal(height, 0.1 * (height - gap[frames[0]]) + 0.02 * d))
    if conditions.impact is not None:
        quoted = conditions.impact
        impact = Normal(quoted.speed, max(quoted.speed_sigma, 1e-3 * quoted.speed))
    else:
        out = _speed(time, gap, sigma)
        impact = Normal(out / FIRST_E, UNSEEN * out / FIRST_E)
        notes.append(f"{name}: begins on a rebound whose impact was not filmed; its speed is open within 30 %")
    about = np.array([-0.04, 0.0, 0.04]) if conditions.impact is not None else np.array([-0.3, 0.0, 0.3])
    reach = [release_reaching(float(impact.mean * (1 + x)), conditions, gap=_RUN_UP_D * d).speed for x in about]
    return Start("impact", impact, _RUN_UP_D * d, tuple(map(float, np.polyfit(about, reach, 2))))
