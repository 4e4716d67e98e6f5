"""The page of Figure 1: what the template needs, in its own words and numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from restitution import datasets, laws
from restitution.impacts.shipped import impacts_of
from restitution.laws.source_abstract_eq4 import READINGS
from restitution.report.fig1 import content, rebounds, trajectories
from restitution.report.fig1.verdict import in_words, table
from restitution.report.page import render as render_page
from restitution.stokes import CONVENTIONS, H_FILM, MEASURED_SPEEDS, Speed

if TYPE_CHECKING:
    import pandas as pd

DEFINITIONS = [str(s) for s in MEASURED_SPEEDS]


def render(fig1: content.Fig1, speed: Speed, svg: str, rebounds_svg: str | None = None) -> str:
    """The whole page as text."""
    overall = fig1.scores[fig1.scores.record == "all"].set_index(["law", "speed_definition"])
    measured = [r for r in map(datasets.resource, fig1.conditions) if r.kind == "measured"]
    return render_page(
        "fig1.html.j2",
        title="Fig. 1: effective restitution against the Stokes number",
        command=f"restitution report fig1 --speed {speed}",
        alternative=_alternative(fig1),
        least_chi_square=float((overall["chi_square"] / overall["impacts"]).min()),
        noise={name: datasets.load_track(name).sigma for name in fig1.conditions},
        films=_films(),
        figure=svg,
        rebounds_figure=rebounds_svg,
        rebounds=fig1.rebounds and _simulated(fig1.rebounds),
        speed=str(speed),
        definitions=DEFINITIONS,
        counts={d: int(overall.xs(d, level=1)["impacts"].iloc[0]) for d in DEFINITIONS},
        ranking=_ranking(overall, str(speed)),
        verdict=_verdict(overall),
        support=in_words(fig1.judgements, READINGS),
        judged=_judged(fig1.judgements),
        trajectory_support=trajectories.in_words(fig1.trajectories),
        trajectory_rows=trajectories.table(fig1.trajectories),
        trajectory_records=trajectories.records(fig1.trajectories),
        left_out=fig1.trajectories.left_out,
        left_out_form=trajectories.LEFT_OUT_FORM,
        records=len(measured),
        experiments=len({r.experiment.doi for r in measured}),
        spread=_spread(fig1.every),
        impacts=_impacts(fig1, str(speed)),
        notes=fig1.notes,
        eq4=[laws.get(name) for name in READINGS],
        others=[laws.get(name) for name in content.OTHERS],
        conventions=list(CONVENTIONS.values()),
        film=H_FILM,
        data=[datasets.resource(name) for name in fig1.conditions],
    )


def _simulated(r: rebounds.Rebounds) -> dict[str, Any]:
    """What the section of the simulated rebounds says."""
    grid = r.points.e_grid_sigma.dropna()
    return {
        "cells": [f"{c:g}" for c in sorted({c for pair in r.points.cells for c in pair})],
        "words": rebounds.in_words(r),
        "rows": rebounds.table(r),
        "points": [row for d in rebounds.DEFINITIONS for row in r.of(str(d)).to_dict("records")],
        "grid_median": float(grid.median()),
        "grid_largest": float(grid.max()),
        "rates_differ": r.rates_differ,
        "lost": r.lost.to_dict("records"),
    }


def _ranking(overall: pd.DataFrame, speed: str) -> list[tuple[str, list[dict]]]:
    """Laws by residual under the figure's definition, readings of Eq. (4) and other laws apart."""
    best = {d: overall.xs(d, level=1)["weighted_rms"].min() for d in DEFINITIONS}

    def row(name: str) -> dict:
        law, scores = laws.get(name), overall.loc[name]
        return {
            "name": name,
            "title": law.title,
            "status": law.status,
            "rms": scores["weighted_rms"],
            "chi_square": scores["chi_square"],
            "best": {d: scores["weighted_rms"][d] == best[d] for d in DEFINITIONS},
        }

    groups = (("Readings of Eq. (4)", READINGS), ("Other laws", content.OTHERS))
    return [(title, sorted(map(row, names), key=lambda r: r["rms"][speed])) for title, names in groups]


def _verdict(overall: pd.DataFrame) -> str:
    """Which reading of Eq. (4) is nearest, said only as far as all definitions of speed agree."""
    readings = overall.loc[list(READINGS), "weighted_rms"].unstack()
    nearest = readings.idxmin()
    rejected = [n for n in readings.index if (readings.loc[n] > 2 * readings.min()).all()]
    if nearest.nunique() == 1:
        words = f"Of the readings of Eq. (4), {nearest.iloc[0]} is nearest under all three definitions of speed."
    else:
        words = "Which reading of Eq. (4) is nearest depends on the definition of speed: " + (
            ", ".join(f"{name} ({d})" for d, name in nearest.items()) + "."
        )
    if rejected:
        words += f" More than twice as far as the nearest under every definition: {', '.join(rejected)}."
    return words + " Being nearest does not make a reading the printed equation: see the evidence below."


def _judged(judgements: list) -> list[tuple[str, list[dict]]]:
    """Rows of the table of predictive scores, by definition of speed."""
    rows = table(judgements)
    return [(d, [row for row in rows if row["speed_definition"] == d]) for d in DEFINITIONS]


def _spread(every: pd.DataFrame) -> float:
    """Largest difference of e_eff between definitions, over measured impacts that each gives within 0.06."""
    e = _by_definition(every[(every.kind == "measured") & (every.e_eff_sigma < 0.06)])
    wide = e[DEFINITIONS].astype(float)
    return float((wide.max(axis=1) - wide.min(axis=1)).max())


def _by_definition(every: pd.DataFrame) -> pd.DataFrame:
    """One row an impact, e_eff under each definition in its own column; impacts are numbered alike in all."""
    return every.pivot(index=["record", "impact"], columns="speed_definition", values="e_eff")


def _impacts(fig1: content.Fig1, speed: str) -> list[dict]:
    """Cells of the table of impacts: speed and St by the figure's definition, else by the first that has them."""
    rows = []
    for (record, impact), group in fig1.every.groupby(["record", "impact"], sort=False):
        by_definition = {row.speed_definition: row for row in group.itertuples()}
        shown = speed if speed in by_definition else next(d for d in DEFINITIONS if d in by_definition)
        row = by_definition[shown]
        mark = "" if shown == speed else f" ({shown})"
        rows.append(
            {
                "record": record,
                "simulated": row.kind == "simulated",
                "impact": impact,
                "v": f"{row.impact_speed_m_s:.3f} ± {row.impact_speed_sigma_m_s:.3f}{mark}",
                "St": f"{row.stokes:.1f} ± {row.stokes_sigma:.1f}",
                "e": {d: _e(by_definition.get(d)) for d in DEFINITIONS},
                "note": row.note,
            }
        )
    order = {name: i for i, name in enumerate((*fig1.conditions, *fig1.simulated))}
    return sorted(rows, key=lambda r: (order[r["record"]], r["impact"]))


def _e(row: Any | None) -> str:
    if row is None:
        return ""
    if row.outcome == "not_resolved":
        return f"< {row.e_eff_upper:.2f}" if row.e_eff_upper < row.e_dry else "not bounded"
    return f"{row.e_eff:.3f} ± {row.e_eff_sigma:.3f}"


def _alternative(fig1: content.Fig1) -> str:
    """What the figure shows, in words with its own numbers."""
    rebounds = fig1.measured[fig1.measured.outcome == "rebound"].sort_values("stokes")
    first, last = rebounds.iloc[0], rebounds.iloc[-1]
    return (
        f"Effective over dry restitution against the Stokes number. Measured impacts rise from "
        f"{first.e_eff / first.e_dry:.2f} at St {first.stokes:.0f} to {last.e_eff / last.e_dry:.2f} at St "
        f"{last.stokes:.0f}; the readings of Eq. (4) and other laws run as lines from zero to one."
    )


def _films() -> dict[float, list[str]]:
    """E_eff of the first three bounces of the 3 mm sphere, far from films of half, one and two times the usual."""
    name, table = content.SIMULATED_BY_ABSTRACT, {}
    for h in (H_FILM / 2, H_FILM, 2 * H_FILM):
        impacts = impacts_of(name, Speed.FAR, h)
        table[h] = [f"{r['e_eff']:.2f} ± {r['e_eff_sigma']:.2f}" for r in impacts.rows[:3] if "e_eff" in r]
    return table
