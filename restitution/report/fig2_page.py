"""The page of Figure 2: what the template needs, in its own words and numbers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from restitution import datasets
from restitution.bounces import UNTIL, gap_error_d
from restitution.impacts import find_impacts
from restitution.report import fig2 as content
from restitution.report.fig2_scores import BOUNCES, reference_apexes
from restitution.report.page import png_image
from restitution.report.page import render as render_page
from restitution.stokes import Speed

if TYPE_CHECKING:
    from restitution.kept_runs import KeptRun
    from restitution.report.drawing import Drawing
    from restitution.report.fig2 import Fig2
    from restitution.report.point_particle import PointLine

DEFINITIONS = tuple(str(s) for s in (Speed.FAR, Speed.CONTACT, Speed.WINDOW))
SENSITIVITY = (
    ("cells per diameter, contact (b)", ("gondret_st152_10", "gondret_st152_16", "gondret_st152_20")),
    (
        "cells per diameter, contact (b), in a smaller box",
        ("gondret_st152_10_small", "gondret_st152_16_small", "gondret_st152_20_small"),
    ),
    ("a box 6 d wide and 12 d high, a way of 9 d", ("gondret_st152_10", "gondret_st152_10_small")),
    (
        "cells per diameter, contact (a)",
        ("gondret_st152_10_measured", "gondret_st152_16_measured", "gondret_st152_20_measured"),
    ),
    ("cells per diameter, contact (c)", ("gondret_st152_10_soft", "gondret_st152_16_soft")),
    ("width of the box", ("gondret_st152_10", "gondret_st152_10_wide")),
    ("lattice speed", ("gondret_st152_10", "gondret_st152_10_fast")),
    (
        "film: what the grid lacks, or Eq. (3) from 1 or 2 cells on",
        ("gondret_st152_10", "gondret_st152_10_cutoff1", "gondret_st152_10_cutoff2"),
    ),
    (
        "tension the film bears: 1 atm, calibrated at St 27, any",
        ("gondret_st152_10", "gondret_st152_10_calibrated", "gondret_st152_10_suction"),
    ),
    (
        "added mass that the wall pays for: the lattice's, potential flow's",
        ("gondret_st152_10", "gondret_st152_10_potential"),
    ),
)
"""What is varied, and the cases; changes are from the first."""


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
        main=_main(fig2, table),
        impacts=_impacts(fig2),
        definitions=DEFINITIONS,
        sensitivity=_sensitivity(fig2, table),
        predictions=[_bounce_row(fig2, table, run) for run in fig2.runs.values() if run.case.record is None],
        other_records=[_bounce_row(fig2, table, run) for run in _of_other_records(fig2)],
        settling=_settling(fig2, table),
        physics=_physics(off),
        forces=forces.svg,
        numerics=[_numerics(run) for run in fig2.runs.values()],
        checks=[_check(c) for c in fig2.checks],
        verification=str(content.VERIFICATION),
        failed=fig2.failed,
        stale=[name for name, run in fig2.runs.items() if run.stale],
        missing=_missing(fig2),
    )


def _main(fig2: Fig2, table: pd.DataFrame) -> list[dict]:
    """The record, the published simulation, and every run of the record at the main case's conditions."""
    rows = [
        _record_row(fig2, content.RECORD, "measured"),
        _record_row(fig2, content.PUBLISHED, "published simulation"),
    ]
    runs = [run for run in fig2.runs.values() if run.case.record == content.RECORD]
    rows += [_bounce_row(fig2, table, run) for run in runs]
    return rows + [_line_row(table, line) for line in fig2.lines]


def _record_row(fig2: Fig2, name: str, kind: str) -> dict:
    resource, found = datasets.resource(name), fig2.records[name]
    goal = fig2.records[content.RECORD]
    own = name == content.RECORD
    apexes, goals = reference_apexes(name, found), reference_apexes(content.RECORD, goal)
    far = [
        r for r in find_impacts(datasets.load_track(name), resource.conditions, Speed.FAR).rows if r["impact"] == 1
    ]
    return {
        "name": resource.experiment.cite,
        "contact": kind,
        "cells": "",
        "v": f"{far[0]['impact_speed_m_s']:.3f}" if far else "",
        "apexes": [_with_error(apexes, goals, k, 1e3, own) for k in range(BOUNCES)],
        "intervals": [_with_error(found.intervals_s, goal.intervals_s, k, 1e3, own) for k in range(BOUNCES)],
        "rms": "" if own else f"{gap_error_d(found, goal, resource.conditions):.3f}",
        "made": resource.name,
        "stale": False,
    }


def _with_error(values: np.ndarray, goals: np.ndarray, k: int, scale: float, own: bool) -> str:
    if k >= len(values):
        return ""
    error = "" if own or k >= len(goals) else f" ({_percent(values[k] / goals[k] - 1)})"
    return f"{values[k] * scale:.3g}{error}" if scale * values[k] < 1 else f"{values[k] * scale:.2f}{error}"


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
            shown = "" if math.isnan(value) else f"{value * 1e3:.3g}" if value < 1e-3 else f"{value * 1e3:.2f}"
            found.append(shown + (f" ({_percent(error)})" if not math.isnan(error) else ""))
        return found

    return {
        "name": name,
        "contact": row["contact"],
        "v": _number(row["approach_speed_m_s"], 3),
        "apexes": cells("apex", "m"),
        "intervals": cells("interval", "s"),
        "rms": _number(row["rms_gap_d"], 3),
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
                "changes": [_percent(c) if row.Index else "" for c in changes],
                "whole": f"{row.change_d:.3f}",
                "rms": f"{row.rms_d:.3f}",
            }
        )
    return rows


def _of_other_records(fig2: Fig2) -> list[KeptRun]:
    return [
        r for r in fig2.runs.values() if r.case.record not in (None, content.RECORD) and r.case.contact is not None
    ]


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


def _sensitivity(fig2: Fig2, table: pd.DataFrame) -> list[dict]:
    """Changes of apexes, intervals and rms gap from the first case of each group that is kept."""
    rows = []
    for what, names in SENSITIVITY:
        kept = [name for name in names if name in fig2.runs]
        if len(kept) < 2:
            continue
        base = table.loc[kept[0]]
        for name in kept:
            row = table.loc[name]
            change = [_percent(row[f"apex_{k}_m"] / base[f"apex_{k}_m"] - 1) for k in (1, 2)]
            rows.append(
                {
                    "what": what,
                    "name": name,
                    "apexes": [_number(row[f"apex_{k}_m"] * 1e3, 3) for k in (1, 2)],
                    "changes": ["", ""] if name == kept[0] else change,
                    "intervals": [_number(row[f"interval_{k}_s"] * 1e3, 2) for k in (1, 2)],
                    "v": _number(row["approach_speed_m_s"], 4),
                    "rms": _number(row["rms_gap_d"], 3),
                    "made": fig2.runs[name].made_with,
                    "stale": fig2.runs[name].stale,
                }
            )  # fmt: skip
    return rows


def _settling(fig2: Fig2, table: pd.DataFrame) -> list[dict]:
    rows = []
    for name, run in fig2.runs.items():
        row = table.loc[name]
        if run.case.contact is not None or math.isnan(row["peak_over_terminal"]):
            continue
        rows.append(
            {
                "name": name,
                "peak": f"{row['peak_over_terminal']:.4f}",
                "error": _percent(row["peak_over_terminal_error"], ".2f"),
                "rms": "" if math.isnan(row["rms_over_drop"]) else f"{row['rms_over_drop'] * 100:.2f} %",
                "made": run.made_with,
                "stale": run.stale,
            }
        )
    return rows


def _numerics(run: KeptRun) -> dict:
    n, film, about = run.case.numerics, run.case.film, run.about
    return {
        "name": run.case.name,
        "cells": f"{n.cells_per_diameter:g}",
        "shape": " × ".join(str(s) for s in about.shape),
        "steps": about.steps,
        "step_us": f"{about.step_s * 1e6:.3g}",
        "numbers": {k: f"{about.numbers[k]:.4g}" for k in ("Re", "Ma", "relaxation time", "grid Re")},
        "method": f"{n.rates}, {n.interpolation}, {n.precision}; sides {n.sides}, top {n.top}",
        "film": film.form if film.form == "none" else f"{film.form}, {film.cut_off:g} cells",
        "seconds": f"{about.seconds:.0f} ({about.threads})",
    }  # fmt: skip


def _missing(fig2: Fig2) -> list[str]:
    from restitution import case_files

    return [name for name in case_files.names() if name not in fig2.runs and name not in fig2.failed]


def _alternative(fig2: Fig2, table: pd.DataFrame) -> str:
    """What the figure shows, in words with its own numbers."""
    goal = reference_apexes(content.RECORD, fig2.records[content.RECORD]) * 1e3
    words = (
        f"Velocity and gap of the 3 mm sphere in time. The measured apexes are {goal[0]:.2f} and {goal[1]:.2f} mm"
    )
    for name in content.SHORT:
        if name in fig2.runs:
            row = table.loc[name]
            words += f"; {name} has {_number(row['apex_1_m'] * 1e3, 2)} and {_number(row['apex_2_m'] * 1e3, 2)} mm"
    return words + "."


def _check(c: content.Check) -> dict:
    # Against 0 the error is the figure itself, which stands there already.
    return {
        "name": c.name,
        "case": c.case,
        "measured": f"{c.measured:.4g}",
        "reference": f"{c.reference:.4g}" if c.reference else "",
        "error": _percent(c.error, ".2f"),
        "target": "" if c.target is None else f"{c.target * 100:g} %",
        "missed": c.target is not None and abs(c.error) > c.target,
        "source": c.source,
    }


def _number(value: float, digits: int) -> str:
    return "" if math.isnan(value) else f"{value:.{digits}f}"


def _percent(value: float, digits: str = ".1f") -> str:
    """A relative error in per cent, with its sign."""
    return "" if math.isnan(value) else f"{value * 100:+{digits}} %"
