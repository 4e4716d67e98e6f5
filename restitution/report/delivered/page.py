"""The page: what the template needs, in its own words and numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restitution.export.drops.kept import CONSTANT_AT, STOKES, WITHIN, steel
from restitution.report.delivered.content import MEANT, Summary
from restitution.report.page import render as render_page

if TYPE_CHECKING:
    import pandas as pd

    from restitution.report.delivered.languages import Agreement


def render(table: pd.DataFrame, summary: list[Summary], languages: list[Agreement], svg: str) -> str:
    """The whole page as text."""
    impacts = steel()
    columns = [(s.program, s.level) for s in summary]
    by_stokes = [
        (first, [rows[(rows["program"] == p) & (rows["level"] == n)].iloc[:1] for p, n in columns])
        for _, rows in table.groupby("stokes", sort=True)
        for first in [rows.iloc[0]]
    ]
    return render_page(
        "delivered.html.j2",
        title="e asked and e delivered in other programs",
        command="restitution report export",
        alternative="; ".join(
            f"{s.program} level {s.level}: within {s.from_asked:.4f} of what is asked" for s in summary
        ),
        figure=svg,
        summary=summary,
        languages=languages,
        meant=MEANT,
        closure=impacts.closure,
        conditions=impacts.conditions,
        e_dry=impacts.e_dry,
        stokes=STOKES,
        constant_at=CONSTANT_AT,
        within=WITHIN,
        columns=columns,
        rows=[
            {
                "stokes": float(first["stokes"]),
                "speed": float(first["impact_speed"]),
                "law": float(first["e_law"]),
                "delivered": [float(c["e_delivered"].iloc[0]) if len(c) else None for c in cells],
            }
            for first, cells in by_stokes
        ],
        worst=max((s.from_law for s in summary if s.level == 2), default=float("nan")),
    )
