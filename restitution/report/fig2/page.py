"""The page of Figure 2: what the template needs, in its own words and numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from restitution import datasets
from restitution.bounce.agreement import UNTIL
from restitution.bounce.unbounded import REYNOLDS
from restitution.impacts.shipped import impacts_of
from restitution.report.fig2.bounce_table import main_rows, rows_of_other_records, run_row
from restitution.report.fig2.content import DRY, RECORD, SHORT, VERIFICATION, Fig2
from restitution.report.fig2.findings import in_words
from restitution.report.fig2.scores import BOUNCES, reference_apexes
from restitution.report.fig2.sensitivity import sensitivity
from restitution.report.fig2.solver import check, missed, numerics, older, settling
from restitution.report.fig2.unbounded import RANGES, drag_rows, history_rows
from restitution.report.page import number, percent, png_image
from restitution.report.page import render as render_page
from restitution.stokes import MEASURED_SPEEDS

if TYPE_CHECKING:
    from restitution.report.drawing import Drawing
    from restitution.runs.record import SolverContact

DEFINITIONS = tuple(str(s) for s in MEASURED_SPEEDS)


def render(
    fig2: Fig2, figure: Drawing, others: Drawing | None, flow: Drawing | None, forces: Drawing, alone: Drawing
) -> str:
    """The whole page as text."""
    predictions = [run.case for run in fig2.runs.values() if run.case.record is None]
    return render_page(
        "fig2.html.j2",
        title="Fig. 2: the bouncing sphere, simulated and measured",
        command="restitution report fig2",
        figure=figure.svg,
        alternative=_alternative(fig2),
        others=None if others is None else others.svg,
        flow=None if flow is None else png_image(flow.png),
        record=datasets.resource(RECORD),
        noise=datasets.load_track(RECORD).sigma,
        until=UNTIL,
        bounces=range(1, BOUNCES + 1),
        findings=in_words(fig2),
        main=main_rows(fig2),
        impacts=_impacts(fig2),
        definitions=DEFINITIONS,
        sensitivity=sensitivity(fig2),
        predictions=[run_row(fig2, case.name) for case in predictions],
        prediction_notes={case.name: case.note for case in predictions if case.note},
        other_records=rows_of_other_records(fig2),
        settling=settling(fig2),
        physics=_forces_off(fig2.forces_off),
        forces=forces.svg,
        unbounded=alone.svg,
        drag_ranges=[REYNOLDS, *RANGES],
        drag_rows=drag_rows(),
        history_rows=history_rows(),
        numerics=[numerics(run) for run in fig2.runs.values()],
        checks=[check(c) for c in fig2.checks],
        missed=missed(fig2.checks),
        older=older(fig2.checks),
        verification=VERIFICATION,
        failed=fig2.failed,
        stale=[name for name, run in fig2.runs.items() if run.stale],
        missing=fig2.missing,
        own=fig2.own,
        flow_case=DRY,
    )


def _forces_off(off: pd.DataFrame) -> list[dict]:
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


def _impacts(fig2: Fig2) -> list[dict]:
    """E_eff of each bounce, measured and simulated, by the same definitions and as the solver had it."""
    rows = []
    measured = {d: {r["impact"]: r for r in impacts_of(RECORD, d).rows} for d in MEASURED_SPEEDS}
    for impact in sorted({k for found in measured.values() for k in found}):
        found = {d: measured[d].get(impact, {}) for d in DEFINITIONS}
        rows.append(_impact_row("measured", impact, found, None))
    for name in SHORT:
        if (run := fig2.runs.get(name)) is None:
            continue
        for impact, solver in enumerate(run.about.contacts[: len(rows)], 1):
            own = run.impacts[run.impacts.impact == impact].set_index("speed_definition").to_dict("index")
            rows.append(_impact_row(name, impact, {d: own.get(d, {}) for d in DEFINITIONS}, solver))
            if impact == 4:
                break
    return rows


def _impact_row(name: str, impact: int, found: dict[str, dict], solver: SolverContact | None) -> dict:
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


def _alternative(fig2: Fig2) -> str:
    """What the figure shows, in words with its own numbers."""
    goal = reference_apexes(RECORD, fig2.records[RECORD]) * 1e3
    words = (
        f"Velocity and gap of the 3 mm sphere in time. The measured apexes are {goal[0]:.2f} and {goal[1]:.2f} mm"
    )
    for name in SHORT:
        if name in fig2.runs:
            first, second = (number(apex * 1e3, 2) for apex in fig2.scores[name].bounces.apexes_m[:2])
            words += f"; {name} has {first} and {second} mm"
    return words + "."
