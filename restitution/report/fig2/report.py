"""The report of Figure 2: its content drawn, tabulated and put on a page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from restitution.files import write_folder
from restitution.report.fig2 import content, page, plot, unbounded
from restitution.report.fig2.scores import scores_table
from restitution.tables.writing import table_text

_DIGITS = "%.5g"
"""Digits of scores: the sixth may depend on the machine's arithmetic."""


def write(
    folder: str | Path,
    runs: str | Path,
    verification: str | Path | None = None,
    full: bool = False,
    fresh: bool = False,
    show: Callable[[str], None] | None = None,
) -> tuple[list[str], dict[str, str]]:
    """Write the report into ``folder``; returns the names of its files, and what runs failed and why.

    The other arguments are those of :func:`restitution.report.fig2.content.gather`.
    """
    import pandas as pd

    fig2 = content.gather(runs, verification, full, fresh, show)
    figure, others, flow = plot.draw(fig2), plot.draw_records(fig2), plot.draw_flow(fig2)
    forces, alone = plot.draw_forces(fig2.forces_off), unbounded.draw()
    impacts = [run.impacts for run in fig2.runs.values() if len(run.impacts)]
    files: dict[str, str | bytes] = {
        "figure.svg": figure.svg,
        "figure.png": figure.png,
        "scores.csv": table_text(scores_table(fig2.scores.values()), _DIGITS),
        "impacts.csv": table_text(pd.concat(impacts, ignore_index=True), _DIGITS) if impacts else "",
        "physics.csv": table_text(fig2.forces_off, _DIGITS),
        "physics.png": forces.png,
        "unbounded.png": alone.png,
        "index.html": page.render(fig2, figure, others, flow, forces, alone),
    }
    files |= {"records.png": others.png} if others is not None else {}
    files |= {"flow.png": flow.png} if flow is not None else {}
    write_folder(folder, files)
    return list(files), fig2.failed
