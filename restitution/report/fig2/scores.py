"""How far each run is from its record: one score a run, in the words and units of the report.

The report reads the fields of a :class:`Score`; names of columns are spelt here alone, for the table beside it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from restitution import datasets
from restitution.bounce.agreement import distance_from_contact_d
from restitution.cases.case import Case
from restitution.impacts.bounces import Bounces, modelled
from restitution.runs.kept import KeptRun
from restitution.stokes import Speed

if TYPE_CHECKING:
    import pandas as pd

    from restitution.report.fig2.point_lines import PointLine

BOUNCES = 3
"""Bounces whose apex and interval are scored."""

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class BounceByBounce:
    """Of each of :data:`BOUNCES` the apex, and the time to the next contact; NaN where there is none.

    Errors are relative to the record's.
    """

    apexes_m: Numbers
    apex_errors: Numbers
    intervals_s: Numbers
    interval_errors: Numbers

    @classmethod
    def of(cls, found: Bounces | None, record: Bounces | None, name: str | None) -> BounceByBounce:
        """Those of a trajectory beside those of the record ``name``."""
        nothing = np.empty(0)
        apexes, intervals = (found.apexes_m, found.intervals_s) if found is not None else (nothing, nothing)
        goal = reference_apexes(name, record) if name is not None and record is not None else nothing
        pace = record.intervals_s if record is not None else nothing
        return cls(*_against(apexes, goal), *_against(intervals, pace))

    def columns(self) -> dict[str, float]:
        """By name, bounce by bounce."""
        row: dict[str, float] = {}
        for k in range(BOUNCES):
            n = k + 1
            row |= {f"apex_{n}_m": self.apexes_m[k], f"apex_{n}_error": self.apex_errors[k]}
            row |= {f"interval_{n}_s": self.intervals_s[k], f"interval_{n}_error": self.interval_errors[k]}
        return row


@dataclass(frozen=True)
class Settled:
    """Of a release without contact: peak over terminal speed, its error, and rms distance from the track."""

    peak_over_terminal: float = math.nan
    peak_over_terminal_error: float = math.nan
    rms_over_drop: float = math.nan


@dataclass(frozen=True)
class Grid:
    """The grid, the box and the film of a resolved run; a line of the point-particle model has none."""

    cells_per_diameter: float
    width_d: float
    lattice_speed: float
    film: str
    cut_off_cells: float


@dataclass(frozen=True)
class Made:
    """How long a result took, and what made it: ``date``, code and version of a kept run, None of what is not."""

    steps: int
    seconds: float = math.nan
    threads: int = 1
    date: str | None = None
    code_hash: str | None = None
    physics: int | None = None
    stale: bool = False


@dataclass(frozen=True)
class Score:
    """One run, or one line of the point-particle model, beside its record; the gap's distance is in diameters."""

    case: str
    record: str
    contact: str
    floor_m: float | None
    approach_speed_m_s: float
    bounces: BounceByBounce
    rms_gap_d: float
    made: Made
    grid: Grid | None = None
    settled: Settled = Settled()

    def columns(self) -> dict[str, object]:
        """A row of the table of scores."""
        no_grid = dict.fromkeys(field.name for field in fields(Grid))
        row: dict[str, object] = {"case": self.case, "record": self.record, "contact": self.contact}
        row |= vars(self.grid) if self.grid is not None else no_grid
        row |= {"floor_m": self.floor_m, "approach_speed_m_s": self.approach_speed_m_s}
        row |= self.bounces.columns() | {"rms_gap_d": self.rms_gap_d}
        return row | vars(self.settled) | vars(self.made)


def scores(
    runs: Mapping[str, KeptRun], records: Mapping[str, Bounces], lines: Iterable[PointLine] = ()
) -> dict[str, Score]:
    """Scores of runs and of lines of the point-particle model, by case."""
    found = [_of_run(run, records.get(run.case.record or "")) for run in runs.values()]
    found += [_of_line(line, records[line.record]) for line in lines]
    return {score.case: score for score in found}


def scores_table(scores: Iterable[Score]) -> pd.DataFrame:
    """One row a score; empty cells: not measured, or no grid."""
    import pandas as pd

    return pd.DataFrame([score.columns() for score in scores])


def mode_of(case: Case) -> str:
    """The contact of a case in words."""
    c = case.contact
    if c is None:
        return "no contact"
    if c.mode == "dry":
        return "(b) dry, film resolved"
    if c.mode.startswith("soft"):
        return f"(c) soft, {c.mode.removeprefix('soft_')}"
    return "(a) e_eff measured" if c.law is None else f"(a) {c.law}"


def reference_apexes(record: str, found: Bounces) -> np.ndarray:
    """Apexes of a record in m: as stated with it, read independently of this package, else as found here."""
    quoted = datasets.resource(record).quoted.get("apex_m")
    return np.asarray(quoted if quoted is not None else found.apexes_m, float)


def _of_line(line: PointLine, record: Bounces) -> Score:
    found = modelled(line.time_s, line.gap_m, line.contacts_s, line.conditions)
    return Score(
        case=line.name,
        record=line.record,
        contact=line.contact,
        floor_m=line.path.closures.contact_gap(line.conditions) or math.nan,
        approach_speed_m_s=line.far_speed,
        bounces=BounceByBounce.of(found, record, line.record),
        rms_gap_d=distance_from_contact_d(found, record, line.conditions),
        made=Made(steps=len(line.path.time_s) - 1),
    )


def _of_run(run: KeptRun, record: Bounces | None) -> Score:
    case, n, about = run.case, run.case.numerics, run.about
    found = _bounces_of(run)
    far = run.impacts[(run.impacts.speed_definition == str(Speed.FAR)) & (run.impacts.impact == 1)]
    both = found is not None and record is not None
    return Score(
        case=case.name,
        record=case.record or "",
        contact=mode_of(case),
        floor_m=case.floor,
        approach_speed_m_s=float(far.impact_speed_m_s.iloc[0]) if len(far) else math.nan,
        bounces=BounceByBounce.of(found, record, case.record),
        rms_gap_d=distance_from_contact_d(found, record, case.conditions) if both else math.nan,
        made=Made(
            about.steps, about.seconds, about.threads, about.date, about.code_hash, about.physics, run.stale
        ),
        grid=Grid(n.cells_per_diameter, n.width_d, n.lattice_speed, case.film.form, case.film.cut_off),
        settled=_settled(run),
    )


def _bounces_of(run: KeptRun) -> Bounces | None:
    """The bounces of a run, its contacts as the solver had them; None without any."""
    if not run.about.contacts:
        return None
    times = np.array([c.time_s for c in run.about.contacts])
    time, gap = (run.trajectory[name].to_numpy(float) for name in ("time_s", "gap_m"))
    return modelled(time, gap, times, run.case.conditions)


def _against(values: np.ndarray, references: np.ndarray) -> tuple[Numbers, Numbers]:
    """The first :data:`BOUNCES` values, and how far each is from its reference, relatively."""
    shown = [float(values[k]) if k < len(values) else math.nan for k in range(BOUNCES)]
    errors = [x / references[k] - 1 if k < len(references) else math.nan for k, x in enumerate(shown)]
    return tuple(shown), tuple(errors)


def _settled(run: KeptRun) -> Settled:
    """Peak speed over the quoted terminal speed, and the distance from the track over the drop."""
    if run.case.contact is not None or run.case.record is None:
        return Settled()
    resource = datasets.resource(run.case.record)
    terminal = resource.quoted.get("terminal_speed_m_s")
    if terminal is None:
        return Settled()
    peak = float(-run.velocity.velocity_m_s.min()) / terminal
    goal = 1.0 if run.case.numerics.sides == "periodic" else resource.quoted["maximum_over_terminal_speed"]
    if run.case.prediction or resource.table != "trajectory":
        return Settled(peak, peak / goal - 1)
    track = datasets.load_track(run.case.record)
    use = track.time_s <= run.trajectory.time_s.iloc[-1]
    gap = np.interp(track.time_s[use], run.trajectory.time_s, run.trajectory.gap_m)
    drop = run.case.release.gap_d * run.case.sphere.diameter
    return Settled(peak, peak / goal - 1, float(np.sqrt(np.mean((gap - track.value[use]) ** 2)) / drop))
