"""The page of Figure 2: what the template needs, in its own words and numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from restitution import datasets
from restitution.bounce.agreement import UNTIL, distance_from_contact_d
from restitution.impacts.find import find_impacts
from restitution.report.fig2 import content
from restitution.report.fig2.findings import GRIDS, in_words
from restitution.report.fig2.scores import BOUNCES, reference_apexes
from restitution.report.fig2.sensitivity import sensitivity
from restitution.report.fig2.solver import check, missed, numerics, older, settling
from restitution.report.page import number, percent, png_image
from restitution.report.page import render as render_page
from restitution.stokes import MEASURED_SPEEDS, Speed

if TYPE_CHECKING:
    from restitution.report.drawing import Drawing
    from restitution.report.fig2.content import Fig2
    from restitution.report.fig2.point_lines import PointLine
    from restitution.runs.kept import KeptRun

DEFINITIONS = tuple(str(s) for s in MEASURED_SPEEDS)


def render(
    fig2: Fig2, figure: Drawing, others: Drawing | None, flow: Drawing | None, off: pd.DataFrame, forces: Drawing
) -> str:
    """The whole page as text."""
    record = datasets.resource(content.RECORD)
    table = fig2.scores.set_index("case")
    return render_page(
        "fig2.html.j2",
        title="Fig. 2: the bouncing sphere, simulated and measured",
        command="restitution report fig2",
        figure=figure.svg,
        alternative=_alternative(fig2, table),
        others=None if others is None else others.svg,
        flow=None if flow is None else png_image(flow.png),
        record=record,
        noise=datasets.load_track(content.RECORD).sigma,
        until=UNTIL,
        bounces=range(1, BOUNCES + 1),
        findings=in_words(fig2, *content.SHORT, content.RECORD),
        main=_main(fig2, table),
        impacts=_impacts(fig2),
        definitions=DEFINITIONS,
        sensitivity=sensitivity(fig2, table),
        predictions=[_bounce_row(fig2, table, run) for run in fig2.runs.values() if run.case.record is None],
        prediction_notes={
            name: r.case.note for name, r in fig2.runs.items() if r.case.record is None and r.case.note
        },
        other_records=_of_other_records(fig2, table),
        settling=settling(fig2, table),
        physics=_physics(off),
        forces=forces.svg,
        numerics=[numerics(run) for run in fig2.runs.values()],
        checks=[check(c) for c in fig2.checks],
        missed=missed(fig2.checks),
        older=older(fig2.checks),
        verification=content.VERIFICATION,
        failed=fig2.failed,
        stale=[name for name, run in fig2.runs.items() if run.stale],
        missing=_missing(fig2),
        own=fig2.own,
        main_case=content.MAIN,
    )


def _main(fig2: Fig2, table: pd.DataFrame) -> list[dict]:
    """The record, the published simulation, the runs of the figure and its finer grids, the point particle."""
    rows = [
        _record_row(fig2, content.RECORD, "measured"),
        _record_row(fig2, content.PUBLISHED, "published simulation"),
    ]
    own = [name for name in fig2.own if fig2.runs[name].case.record == content.RECORD]
    shown = dict.fromkeys((*content.SHORT, *GRIDS, *own))
    rows += [_bounce_row(fig2, table, fig2.runs[name]) for name in shown if name in fig2.runs]
    return rows + [_line_row(table, line) for line in fig2.lines]


def _record_row(fig2: Fig2, name: str, kind: str) -> dict:
    resource, found = datasets.resource(name), fig2.records[name]
    goal = fig2.records[content.RECORD]
    own = name == content.RECORD
    apexes, goals = reference_apexes(name, found), reference_apexes(content.RECORD, goal)
    return {
        "name": resource.experiment.cite,
        "contact": kind,
        "cells": "",
        "v": _far_speed(name),
        "apexes": [_with_error(apexes, goals, k, 1e3, own) for k in range(BOUNCES)],
        "intervals": [_with_error(found.intervals_s, goal.intervals_s, k, 1e3, own) for k in range(BOUNCES)],
        "rms": "" if own else f"{distance_from_contact_d(found, goal, resource.conditions):.3f}",
        "made": resource.name,
        "stale": False,
    }


def _measured_row(fig2: Fig2, name: str) -> dict:
    """A record as the row that its runs are compared with; its bounces as far as there are any."""
    found = fig2.records.get(name)
    apexes = np.empty(0) if found is None else reference_apexes(name, found)
    pace = np.empty(0) if found is None else found.intervals_s
    return {
        "name": datasets.resource(name).experiment.cite,
        "contact": "measured",
        "cells": "",
        "v": "" if found is None else _far_speed(name),
        "apexes": [_with_error(apexes, apexes, k, 1e3, True) for k in range(BOUNCES)],
        "intervals": [_with_error(pace, pace, k, 1e3, True) for k in range(BOUNCES)],
        "rms": "",
        "made": name,
        "stale": False,
    }


def _far_speed(name: str) -> str:
    """Speed of the first approach of a record outside the film."""
    track, conditions = datasets.load_track(name), datasets.resource(name).conditions
    rows = [r for r in find_impacts(track, conditions, Speed.FAR).rows if r["impact"] == 1]
    return f"{rows[0]['impact_speed_m_s']:.3f}" if rows else ""


def _with_error(values: np.ndarray, goals: np.ndarray, k: int, scale: float, own: bool) -> str:
    if k >= len(values):
        return ""
    error = "" if own or k >= len(goals) else f" ({percent(values[k] / goals[k] - 1)})"
    return f"{_three_digits(values[k] * scale)}{error}"


def _three_digits(value: float) -> str:
    """Two decimals, below 1 three digits."""
    return f"{value:#.3g}" if value < 1 else f"{value:.2f}"


def _bounce_row(fig2: Fig2, table: pd.DataFrame, run: KeptRun) -> dict:
    row = table.loc[run.case.name]
    about = {"cells": f"{row['cells_per_diameter']:g}", "made": run.made_with, "stale": run.stale}
    return _scored(row, run.case.name) | about


def _line_row(table: pd.DataFrame, line: PointLine) -> dict:
    about = {"cells": "", "made": "point-particle model, at once", "stale": False}
    return _scored(table.loc[line.name], line.name) | about


def _scored(row: pd.Series, name: str) -> dict:
    """A row of the scores as the table of bounces has it."""

    def cells(what: str, unit: str) -> list[str]:
        found = []
        for k in range(1, BOUNCES + 1):
            value, error = row[f"{what}_{k}_{unit}"], row[f"{what}_{k}_error"]
            shown = "" if math.isnan(value) else _three_digits(value * 1e3)
            found.append(shown + (f" ({percent(error)})" if not math.isnan(error) else ""))
        return found

    return {
        "name": name,
        "contact": row["contact"],
        "v": number(row["approach_speed_m_s"], 3),
        "apexes": cells("apex", "m"),
        "intervals": cells("interval", "s"),
        "rms": number(row["rms_gap_d"], 3),
    }


def _physics(off: pd.DataFrame) -> list[dict]:
    """Each force off: first apex, changes of the first three, distance from the whole model and the frames."""
    rows = []
    for row in off.itertuples():
        changes = (row.apex_1_change, row.apex_2_change, row.apex_3_change)
        rows.append(
            {
                "off": row.off,
                "apex": f"{row.apex_1_m * 1e3:.2f}",
                "changes": [percent(c) if row.Index else "" for c in changes],
                "whole": f"{row.change_d:.3f}",
                "rms": f"{row.rms_d:.3f}",
            }
        )
    return rows


def _of_other_records(fig2: Fig2, table: pd.DataFrame) -> list[dict]:
    """Each record followed by its runs."""
    runs = [
        r for r in fig2.runs.values() if r.case.record not in (None, content.RECORD) and r.case.contact is not None
    ]
    rows = []
    for record in dict.fromkeys(run.case.record for run in runs):
        rows.append(_measured_row(fig2, record))
        rows += [_bounce_row(fig2, table, run) for run in runs if run.case.record == record]
    return rows


def _impacts(fig2: Fig2) -> list[dict]:
    """E_eff of each bounce, measured and simulated, by the same definitions and as the solver had it."""
    rows = []
    track, conditions = datasets.load_track(content.RECORD), datasets.resource(content.RECORD).conditions
    measured = {d: {r["impact"]: r for r in find_impacts(track, conditions, d).rows} for d in DEFINITIONS}
    for impact in sorted({k for found in measured.values() for k in found}):
        found = {d: measured[d].get(impact, {}) for d in DEFINITIONS}
        rows.append(_impact_row("measured", impact, found, None))
    for name in content.SHORT:
        if (run := fig2.runs.get(name)) is None:
            continue
        for impact, solver in enumerate(run.about.contacts[: len(rows)], 1):
            own = run.impacts[run.impacts.impact == impact].set_index("speed_definition").to_dict("index")
            rows.append(_impact_row(name, impact, {d: own.get(d, {}) for d in DEFINITIONS}, solver))
            if impact == 4:
                break
    return rows


def _impact_row(name: str, impact: int, found: dict[str, dict], solver: object | None) -> dict:
    e = {}
    for d, row in found.items():
        value, sigma = row.get("e_eff"), row.get("e_eff_sigma")
        e[d] = "" if value is None or pd.isna(value) else f"{value:.3f} ± {sigma:.3f}"
    at_wall = ""
    if solver is not None and solver.speed_in_m_s > 0:
        v_in, v_out = solver.speed_in_m_s, solver.speed_out_m_s
        at_wall = f"{v_in:.3f} → {v_out:.3f} ({v_out / v_in:.3f})"
    St = found.get("contact", {}).get("stokes")
    return {"name": name, "impact": impact, "St": "" if St is None else f"{St:.0f}", "e": e, "solver": at_wall}


def _missing(fig2: Fig2) -> list[str]:
    from restitution import cases

    return [name for name in cases.names() if name not in fig2.runs and name not in fig2.failed]


def _alternative(fig2: Fig2, table: pd.DataFrame) -> str:
    """What the figure shows, in words with its own numbers."""
    goal = reference_apexes(content.RECORD, fig2.records[content.RECORD]) * 1e3
    words = (
        f"Velocity and gap of the 3 mm sphere in time. The measured apexes are {goal[0]:.2f} and {goal[1]:.2f} mm"
    )
    for name in content.SHORT:
        if name in fig2.runs:
            row = table.loc[name]
            words += f"; {name} has {number(row['apex_1_m'] * 1e3, 2)} and {number(row['apex_2_m'] * 1e3, 2)} mm"
    return words + "."
