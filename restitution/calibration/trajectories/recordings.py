"""Recorded trajectories for a fit: their frames, and what is known beforehand of start, clock and scale.

A record is a shipped one or a file of time and gap with its conditions. How it starts is told by its frames, or by
a stated release from rest (:mod:`.starts`).

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
from restitution.bounce import terminal_speed
from restitution.calibration.estimation.parameters import Normal
from restitution.calibration.reading.reading import Reading
from restitution.calibration.reading.track_impacts import track_of
from restitution.calibration.trajectories.recording_checks import bounces, check
from restitution.calibration.trajectories.starts import STATED, Start, rate, start_of
from restitution.conditions import Conditions
from restitution.doubts import Doubt, cleaned, of_track
from restitution.errors import Defect, InputError
from restitution.foreign.asking import what_is_needed
from restitution.foreign.settings import Units
from restitution.foreign.table import read_foreign
from restitution.foreign.track import is_track
from restitution.inputs import read_bytes
from restitution.tracks import Track, begins_on_rebound, contacts

SCALE = 0.01
"""Relative standard deviation of the scale of length where none is stated."""
LEVEL_D = 0.01
"""Standard deviation of the zero of the gap where none is stated, in diameters."""
UNKNOWN_LEVEL_D = 0.05
"""And where no frame at rest shows the wall either."""


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
        table = read_foreign(path, how.track.decimal, how.track.sheet)
        if not is_track(table, how.settings):
            raise InputError(what_is_needed(table, how.settings))
        track, conditions, notes = track_of(table, how)
        digest = hashlib.sha256(read_bytes(path)).hexdigest()
        record = recording(path, track, conditions, digest, stated_release(how, conditions))
        return replace(record, notes=(*(f"{path}: {note}" for note in notes), *record.notes))
    if path not in datasets.names():
        raise InputError(Defect("does not exist, and no shipped record has this name", file=path))
    r = datasets.resource(path)
    if r.table != "trajectory":
        raise InputError(Defect(f"is a {r.table} table; a trajectory of time and gap is needed", file=path))
    track, error = datasets.load_track(path), r.digitisation_error
    conditions, quoted = how.conditions or r.conditions, r.quoted.get("release_gap_m")
    level = error.offset_sigma.get("gap_m", LEVEL_D * conditions.sphere.diameter)
    known = stated_release(how, conditions)
    if known is None and quoted is not None:
        known = Normal(quoted, level)
    record = recording(path, track, conditions, r.hash.removeprefix("sha256:"), known, level)
    if quoted is not None and known is not None and record.start.kind == "height":
        # The clock of a shipped record of a drop starts with its release.
        release = Normal(0.0, error.offset_sigma.get("time_s", record.clock.sigma))
        record = replace(record, clock=release, clock_of="release")
    return replace(
        record,
        clock_rate=error.scale_sigma.get("time_s", 0.0),
        scale=error.scale_sigma.get("gap_m", SCALE),
    )


def stated_release(how: Reading, conditions: Conditions) -> Normal | None:
    """The gap in m of a release from rest that options, settings or conditions state, with its error."""
    stated = conditions.release
    if how.track.release is not None:
        stated = Units.of(how.track, conditions).release(how.track.release)
    if stated is None:
        return None
    return Normal(stated, math.hypot(STATED * stated, LEVEL_D * conditions.sphere.diameter))


def recording(
    name: str, track: Track, conditions: Conditions, digest: str = "", release: Normal | None = None,
    level_sigma: float | None = None,
) -> Recording:  # fmt: skip
    """A record from its track; ``release`` is the gap in m of one from rest, ``level_sigma`` the error of zero."""
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
    unseen = LEVEL_D if rest < len(track.time_s) else UNKNOWN_LEVEL_D
    zero = unseen * d if level_sigma is None else level_sigma
    approach = np.arange(0) if rising else np.array(touches.contacts[0].approach, int)
    if release is not None and len(approach) and gap[approach].max() > release.mean + 3 * release.sigma:
        rule = f"is below frames of the approach, at up to {1e3 * gap[approach].max():.4g} mm: is it a gap?"
        raise InputError(Defect(rule, file=name, field="release", value=f"{1e3 * release.mean:g} mm"))
    start = start_of(name, time, gap, track.sigma, approach, conditions, release, zero, notes)
    dt, touch = float(np.median(np.diff(track.time_s))), 0.0
    if not rising:
        back, last = approach[::-1], approach[-1]
        speed = -rate(time[back], gap[back], track.sigma) if len(back) > 1 else terminal_speed(conditions)
        touch = float(time[last] + max(gap[last], 0.0) / max(speed, 1e-9))
    elif abs(time[0]) > 2 * dt:
        touch = float(time[0] - gap[0] / max(rate(time, gap, track.sigma), 1e-9))
    clock, clock_of = Normal(touch, dt), "contact"
    return Recording(
        name, conditions, track, time, gap, track.sigma, len(track.time_s) - rest,
        float(np.mean(track.value[rest:]) - level) if rest < len(track.time_s) else 0.0,
        start, clock, clock_of, 0.0, SCALE, zero, bounces(track, touches)[0], digest, tuple(notes), doubts,
    )  # fmt: skip
