"""One record under the runs that simulate it: their flights, the emulator of them, its check, and the frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.reading.reading import Reading
from restitution.calibration.trajectories.recordings import Recording, read_recording
from restitution.doubts import Doubt
from restitution.emulation.emulator import Emulator, emulate
from restitution.emulation.emulator_check import Check, check
from restitution.emulation.flown import Flown, flight_of
from restitution.emulation.likelihood import FramesLikelihood
from restitution.emulation.registered import Registration
from restitution.emulation.runs_table import Run, Runs
from restitution.emulation.simulated import of_simulated
from restitution.errors import Defect, InputError
from restitution.impacts.bounces import filmed
from restitution.impacts.find import find_impacts
from restitution.stokes import Speed
from restitution.tracks import contacts
from restitution.validation.trajectory import ANOTHER

RUNS_PER_PARAMETER = 5
"""Fewer are doubted: with ten the error of an emulator is well told (Loeppky, Sacks & Welch, Technometrics 51
(2009) 366), with fewer than five hardly."""
SPARE_RUNS = 3
"""Beyond the parameters and one: fewer are refused."""
PREDICTS, HARDLY = 0.8, 0.3
"""Parts of the variance of unseen runs below which an emulator is doubted, and refused."""
COVERS = 0.8
"""Part of unseen runs within its 95 % intervals below which an emulator is doubted."""
_NAMED = 4


@dataclass(frozen=True)
class Emulated:
    """A record, its runs, and what is known of the solver between them."""

    recording: Recording
    runs: tuple[Run, ...]
    flights: tuple[Flown, ...]
    registration: Registration
    q: NDArray
    emulator: Emulator
    check: Check
    frames: FramesLikelihood

    @property
    def name(self) -> str:
        """Of the record."""
        return self.recording.name

    @property
    def predicts(self) -> float:
        """Part of the relative variance of heights and durations of unseen runs that is predicted."""
        c, use = self.check, [not label.startswith("e ") for label in self.check.labels]
        mean = c.given.mean(axis=0)
        return float(1 - np.sum((c.rms / mean)[use] ** 2) / np.sum((c.given.std(axis=0) / mean)[use] ** 2))

    @property
    def fails(self) -> str:
        """That the emulator predicts too little, and which run it misses most: one may be in another unit."""
        c = self.check
        away = np.abs(c.given - c.predicted) / np.median(c.given, axis=0)
        k, j = np.unravel_index(np.argmax(away), away.shape)
        return (
            f"the emulator predicts {max(self.predicts, 0.0):.0%} of the variance of runs it has not seen, of "
            f"{len(self.runs)} runs; most it misses {self.runs[k].name}, {c.labels[j]}: {c.given[k, j]:.3g}, by "
            f"the others {c.predicted[k, j]:.3g}. Is it as the others are? Else more runs, or a narrower range"
        )

    @property
    def widened(self) -> float:
        """Times by which the emulator's error is widened: root mean square of its components, by variance."""
        e = self.emulator
        size = np.sum((e.components * self.registration.weight) ** 2, axis=1)
        return float(np.sqrt(np.average([p.widened**2 for p in e.processes], weights=size)))

    def doubts(self) -> Iterator[Doubt]:
        """About the design and the emulator."""
        n, p = len(self.runs), len(self.emulator.names)
        if n < RUNS_PER_PARAMETER * p:
            rule = f"{n} runs vary {p} parameters: at least {RUNS_PER_PARAMETER} a parameter are needed to be sure"
            yield Doubt("few runs", rule, self.name)
        if self.predicts < PREDICTS:
            yield Doubt("emulator", self.fails, self.name)
        if self.check.coverage < COVERS:
            rule = (
                f"{self.check.coverage:.0%} of unseen runs lie within the emulator's 95 % intervals: it takes "
                "itself for surer than it is; more runs"
            )
            yield Doubt("coverage", rule, self.name)
        most = max(f.flights for f in self.flights)
        short = [f.name for f in self.flights if f.flights < most]
        if self.registration.flights < most and len(short) <= n // 2:
            rule = (
                f"{_some(short)} come{'s' if len(short) == 1 else ''} down {self.registration.flights} times, "
                f"others {most} times: frames after that have no say; run longer, or leave them out"
            )
            yield Doubt("short runs", rule, self.name)
        yield from of_simulated(self.runs, self.emulator.names, self.name, self.recording.conditions)

    @cached_property
    def measured(self) -> dict[str, tuple[float, float]]:
        """The record's own quantities, each with the standard deviation of its reading."""
        r = self.recording
        bounces = filmed(r.track, r.conditions)
        apex, frame = float(np.hypot(r.sigma, r.level)), float(np.median(np.diff(r.track.time_s)))
        level = contacts(r.track).level or 0.0
        found = {f"apex {k}, mm": (1e3 * (h - level), 1e3 * apex) for k, h in enumerate(bounces.apexes_m, 1)}
        found |= {f"flight {k}, ms": (1e3 * t, 250 * frame) for k, t in enumerate(bounces.intervals_s, 1)}
        rows = find_impacts(r.track, r.conditions, Speed.FAR, record=r.name).rows
        found |= {
            f"e {row['impact']}": (row["e_eff"], row["e_eff_sigma"]) for row in rows if row["outcome"] == "rebound"
        }
        return found


def emulated(group: Runs, record: str, how: Reading) -> Emulated:
    """What the runs of a group say of a record; raises :class:`InputError` where they cannot be used."""
    runs = group.of(record)
    p = len(group.parameters)
    if len(runs) < p + 1 + SPARE_RUNS:
        where = f" of {group.label}" if group.label else ""
        rule = (
            f"has {len(runs)} runs{where} for {record}, which vary {p} parameters: at least {p + 1 + SPARE_RUNS} "
            f"are needed, {RUNS_PER_PARAMETER * p} to be sure"
        )
        raise InputError(Defect(rule, file=group.file))
    r = read_recording(record, how)
    flights = _flights(runs, r, how)
    _check_same_impact(flights, r)
    approach = max(0.0, -float(r.time_s[0] - _touch(r)))
    registration = Registration.of(flights, r.conditions, approach)
    q, theta = np.array([registration.vector(f) for f in flights]), np.array([run.values for run in runs])
    emulator = emulate(group.parameters, theta, q, registration.weight)
    frames = FramesLikelihood.of(r, emulator, registration, float(registration.ends_s(q).min()))
    found = Emulated(
        r, runs, flights, registration, q, emulator, check(group.parameters, theta, q, registration), frames
    )
    if found.predicts < HARDLY:
        raise InputError(Defect(found.fails, file=group.file, field="record", value=record))
    return found


def _touch(r: Recording) -> float:
    return r.clock.mean if r.clock_of == "contact" or not np.isfinite(r.contacts_s[0]) else r.contacts_s[0]


def _flights(runs: Sequence[Run], r: Recording, how: Reading) -> tuple[Flown, ...]:
    """Of all runs; raises naming each that cannot be read, and at once those that end too soon."""
    flights, defects = [], []
    for run in runs:
        try:
            flights.append(flight_of(run, r.conditions, how.settings, r.track))
        except InputError as error:
            defects += [replace(d, file=d.file or str(run.track)) for d in error.defects]
    short = [f.name for f in flights if f.flights < 1]
    if short:
        rule = (
            f"{_some(short)} end{'s' if len(short) == 1 else ''} before a second contact: run longer, or leave "
            "out of the table (state: failed)"
        )
        defects.append(Defect(rule, file=r.name))
    if defects:
        raise InputError(*defects)
    return tuple(flights)


def _some(names: Sequence[str]) -> str:
    shown = ", ".join(names[:_NAMED])
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return f"run{'s' if len(names) > 1 else ''} {shown}{more}"


def _check_same_impact(flights: Sequence[Flown], r: Recording) -> None:
    """Refuse runs that meet the wall at another speed than the record: they are of another experiment."""
    rows = find_impacts(r.track, r.conditions, Speed.FAR, record=r.name).rows
    if not rows:
        return
    theirs, speed = rows[0]["impact_speed_m_s"], float(np.median([f.approach_m_s for f in flights]))
    if not 1 / ANOTHER <= speed / theirs <= ANOTHER:
        rule = (
            f"is met at {theirs:.3g} m/s, by its runs at {speed:.3g} m/s: they do not simulate this record, or a "
            "unit of length or time is wrong"
        )
        raise InputError(Defect(rule, file=r.name))


def read_all(group: Runs, records: Sequence[str], how: Reading) -> Mapping[str, Emulated]:
    """All records of a group; raises with what is wrong in each."""
    found, defects = {}, []
    for record in records:
        try:
            found[record] = emulated(group, record, how)
        except InputError as error:
            defects += error.defects
    if defects:
        raise InputError(*dict.fromkeys(defects))
    return found
