"""How far each run is from its record: one row a run, in the words and units of the report."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from restitution import datasets
from restitution.bounce.agreement import distance_from_contact_d
from restitution.cases.case import Case
from restitution.impacts.bounces import Bounces, modelled
from restitution.runs.kept import KeptRun

if TYPE_CHECKING:
    import pandas as pd

    from restitution.report.fig2.point_lines import PointLine

BOUNCES = 3
"""Bounces whose apex and interval are scored."""


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


def of_run(run: KeptRun) -> Bounces | None:
    """The bounces of a run, its contacts as the solver had them; None without any."""
    if not run.about.contacts:
        return None
    times = np.array([c.time_s for c in run.about.contacts])
    time, gap = (run.trajectory[name].to_numpy(float) for name in ("time_s", "gap_m"))
    return modelled(time, gap, times, run.case.conditions)


def reference_apexes(record: str, found: Bounces) -> np.ndarray:
    """Apexes of a record in m: as stated with it, read independently of this package, else as found here."""
    quoted = datasets.resource(record).quoted.get("apex_m")
    return np.asarray(quoted if quoted is not None else found.apexes_m, float)


def scores(
    runs: Mapping[str, KeptRun], records: Mapping[str, Bounces], lines: Iterable[PointLine] = ()
) -> pd.DataFrame:
    """One row a run or a line of the point-particle model; errors are relative, but the gap's, in diameters.

    Empty cells: not measured, or no grid.
    """
    import pandas as pd

    rows = [_row(run, records.get(run.case.record or "")) for run in runs.values()]
    return pd.DataFrame(rows + [_line(line, records[line.record]) for line in lines])


def _line(line: PointLine, record: Bounces) -> dict[str, object]:
    found = modelled(line.time_s, line.gap_m, line.contacts_s, line.conditions)
    row = {
        "case": line.name,
        "record": line.record,
        "contact": line.contact,
        "floor_m": line.path.closures.contact_gap(line.conditions) or math.nan,
        "approach_speed_m_s": line.far_speed,
    }
    row |= _bounce_by_bounce(found, record, line.record)
    row["rms_gap_d"] = distance_from_contact_d(found, record, line.conditions)
    return row | {"steps": len(line.path.time_s) - 1, "threads": 1, "stale": False}


def _row(run: KeptRun, record: Bounces | None) -> dict[str, object]:
    case, n = run.case, run.case.numerics
    found = of_run(run)
    far = run.impacts[(run.impacts.speed_definition == "far") & (run.impacts.impact == 1)]
    row: dict[str, object] = {
        "case": case.name,
        "record": case.record or "",
        "contact": mode_of(case),
        "cells_per_diameter": n.cells_per_diameter,
        "width_d": n.width_d,
        "lattice_speed": n.lattice_speed,
        "film": case.film.form,
        "cut_off_cells": case.film.cut_off,
        "floor_m": case.floor,
        "approach_speed_m_s": float(far.impact_speed_m_s.iloc[0]) if len(far) else math.nan,
    }
    row |= _bounce_by_bounce(found, record, case.record)
    both = found is not None and record is not None
    row["rms_gap_d"] = distance_from_contact_d(found, record, case.conditions) if both else math.nan
    row |= _settling(run)
    return row | {
        "steps": run.about.steps,
        "seconds": run.about.seconds,
        "threads": run.about.threads,
        "date": run.about.date,
        "code_hash": run.about.code_hash,
        "physics": run.about.physics,
        "stale": run.stale,
    }


def _bounce_by_bounce(found: Bounces | None, record: Bounces | None, name: str | None) -> dict[str, float]:
    """Apexes and times between contacts, and their errors where the record has them."""
    apexes = found.apexes_m if found is not None else np.empty(0)
    intervals = found.intervals_s if found is not None else np.empty(0)
    goal = reference_apexes(name, record) if record is not None else np.empty(0)
    pace = record.intervals_s if record is not None else np.empty(0)
    row: dict[str, float] = {}
    for k in range(BOUNCES):
        row[f"apex_{k + 1}_m"], row[f"apex_{k + 1}_error"] = _against(apexes, goal, k)
        row[f"interval_{k + 1}_s"], row[f"interval_{k + 1}_error"] = _against(intervals, pace, k)
    return row


def _against(values: np.ndarray, references: np.ndarray, k: int) -> tuple[float, float]:
    value = float(values[k]) if k < len(values) else math.nan
    return value, value / references[k] - 1 if k < len(references) else math.nan


def _settling(run: KeptRun) -> dict[str, float]:
    """Of a release without contact: peak speed over the quoted terminal speed, and the distance from the track."""
    empty = {"peak_over_terminal": math.nan, "peak_over_terminal_error": math.nan, "rms_over_drop": math.nan}
    if run.case.contact is not None or run.case.record is None:
        return empty
    resource = datasets.resource(run.case.record)
    terminal = resource.quoted.get("terminal_speed_m_s")
    if terminal is None:
        return empty
    peak = float(-run.velocity.velocity_m_s.min()) / terminal
    goal = 1.0 if run.case.numerics.sides == "periodic" else resource.quoted["maximum_over_terminal_speed"]
    found = {"peak_over_terminal": peak, "peak_over_terminal_error": peak / goal - 1}
    if run.case.prediction or resource.table != "trajectory":
        return empty | found
    track = datasets.load_track(run.case.record)
    use = track.time_s <= run.trajectory.time_s.iloc[-1]
    gap = np.interp(track.time_s[use], run.trajectory.time_s, run.trajectory.gap_m)
    drop = run.case.release.gap_d * run.case.sphere.diameter
    return found | {"rms_over_drop": float(np.sqrt(np.mean((gap - track.value[use]) ** 2)) / drop)}
