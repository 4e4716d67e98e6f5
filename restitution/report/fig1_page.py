"""The page of Figure 1: what the template needs, in its own words and numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restitution import datasets, laws
from restitution.impact_speed import H_FILM
from restitution.report import fig1 as content
from restitution.report.page import render as render_page
from restitution.stokes import CONVENTIONS, Speed

if TYPE_CHECKING:
    import pandas as pd

DEFINITIONS = [str(s) for s in (Speed.FAR, Speed.CONTACT, Speed.WINDOW)]


def render(fig1: content.Fig1, speed: Speed, svg: str) -> str:
    """The whole page as text."""
    overall = fig1.scores[fig1.scores.dataset == "all"].set_index(["law", "speed_definition"])
    measured = [r for r in map(datasets.resource, fig1.conditions) if r.kind == "measured"]
    return render_page(
        "fig1.html.j2",
        title="Fig. 1: effective restitution against the Stokes number",
        command="restitution report fig1",
        figure=svg,
        speed=str(speed),
        definitions=DEFINITIONS,
        counts={d: int(overall.xs(d, level=1)["impacts"].iloc[0]) for d in DEFINITIONS},
        ranking=_ranking(overall, str(speed)),
        verdict=_verdict(overall),
        records=len(measured),
        laboratories=len({r.experiment.doi for r in measured}),
        spread=_spread(fig1.every),
        impacts=_impacts(fig1),
        notes=fig1.notes,
        eq4=[laws.get(name) for name in content.EQ4_READINGS],
        published=[laws.get(name) for name in content.LITERATURE],
        conventions=list(CONVENTIONS.values()),
        film=H_FILM,
        data=[datasets.resource(name) for name in fig1.conditions],
    )


def _ranking(overall: pd.DataFrame, speed: str) -> list[tuple[str, list[dict]]]:
    """Laws by residual under the figure's definition, readings of Eq. (4) and published laws apart."""
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
            "limits": scores["limits"][speed],
            "exceeded": scores["limits_exceeded"][speed],
        }

    groups = (("Readings of Eq. (4)", content.EQ4_READINGS), ("Published laws", content.LITERATURE))
    return [(title, sorted(map(row, names), key=lambda r: r["rms"][speed])) for title, names in groups]


def _verdict(overall: pd.DataFrame) -> str:
    """Which reading of Eq. (4) is nearest, said only as far as all definitions of speed agree."""
    readings = overall.loc[list(content.EQ4_READINGS), "weighted_rms"].unstack()
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


def _spread(every: pd.DataFrame) -> float:
    """Largest difference of e_eff between definitions, over measured impacts that each gives within 0.06."""
    e = _by_definition(every[(every.kind == "measured") & (every.e_eff_sigma < 0.06)])
    wide = e[DEFINITIONS].astype(float)
    return float((wide.max(axis=1) - wide.min(axis=1)).max())


def _by_definition(every: pd.DataFrame) -> pd.DataFrame:
    """One row an impact, e_eff under each definition in its own column; impacts are matched by their time."""
    import pandas as pd

    rows = []
    for record, group in every.groupby("record", sort=False):
        reference = group[group.speed_definition == str(Speed.CONTACT)]
        for row in reference.itertuples():
            found: dict[str, object] = {"record": record, "row": row}
            for d in DEFINITIONS:
                other = group[(group.speed_definition == d) & ((group.time_s - row.time_s).abs() < 0.005)]
                found[d] = None if other.empty or pd.isna(other.e_eff.iloc[0]) else float(other.e_eff.iloc[0])
                found[f"{d}_row"] = None if other.empty else other.iloc[0]
            rows.append(found)
    return pd.DataFrame(rows)


def _impacts(fig1: content.Fig1) -> list[dict]:
    rows = []
    for found in _by_definition(fig1.every).itertuples():
        row = found.row
        cells = {d: _e(getattr(found, f"{d}_row")) for d in DEFINITIONS}
        rows.append(
            {
                "record": row.record,
                "simulated": row.kind == "simulated",
                "impact": row.impact,
                "v": f"{row.impact_speed_m_s:.3f} ± {row.impact_speed_sigma_m_s:.3f}",
                "St": f"{row.stokes:.1f} ± {row.stokes_sigma:.1f}",
                "e": cells,
                "note": row.note,
            }
        )
    return rows


def _e(row: pd.Series | None) -> str:
    if row is None:
        return ""
    if row.outcome == "not_resolved":
        return f"< {row.e_eff_upper:.2f}"
    return f"{row.e_eff:.3f} ± {row.e_eff_sigma:.3f}"
