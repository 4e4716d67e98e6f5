"""The report of Figure 1: its content drawn, tabulated and put on a page."""

from __future__ import annotations

from pathlib import Path

from restitution.files import write_folder
from restitution.report.fig1 import content, page, plot, rebounds, rebounds_plot, trajectories, verdict
from restitution.stokes import Speed
from restitution.tables.writing import records_text, table_text

_MEASURED = "%.5g"
"""Digits of measured values: the sixth may depend on the machine's arithmetic."""
_ESTIMATED = "%.3g"
"""Digits of estimates: the fourth may depend on it."""
_SCORED = "%.2f"
"""Digits of scores of fits, which a search for a maximum gives on any machine."""


def write(
    folder: str | Path,
    speed: Speed = content.SPEED,
    runs: str | Path | None = None,
    simulated: str | Path | None = None,
) -> list[str]:
    """Write the report into ``folder``; returns the names of the files. The same input gives the same bytes.

    ``runs`` and ``simulated``: kept simulations and the table of simulated rebounds, as in
    :func:`restitution.report.fig1.content.gather`.
    """
    fig1 = content.gather(speed, runs, simulated)
    drawing = plot.draw(fig1, speed)
    beside = None if fig1.rebounds is None else rebounds_plot.draw(fig1.rebounds, _of_rebounds(speed))
    files = {
        "figure.svg": drawing.svg,
        "figure.png": drawing.png,
        "impacts.csv": table_text(fig1.impacts, _MEASURED),
        "impacts_by_speed.csv": table_text(fig1.every, _MEASURED),
        "laws.csv": table_text(fig1.scores, _MEASURED),
        "readings.csv": records_text(verdict.table(fig1.judgements), _SCORED),
        "trajectories.csv": records_text(trajectories.records(fig1.trajectories), _ESTIMATED),
        "trajectory_readings.csv": records_text(trajectories.table(fig1.trajectories), _SCORED),
        "trajectory_left_out.csv": records_text(fig1.trajectories.left_out, _SCORED),
        "index.html": page.render(fig1, speed, drawing.svg, None if beside is None else beside.svg),
    }
    if beside is not None:
        told = records_text(rebounds.table(fig1.rebounds), _SCORED)
        files |= {"rebounds.svg": beside.svg, "rebounds.png": beside.png, "rebounds_readings.csv": told}
    write_folder(folder, files)
    return list(files)


def _of_rebounds(speed: Speed) -> str:
    """The definition that simulated rebounds are drawn by: the figure's, where they are fitted by it."""
    return str(speed if speed in rebounds.DEFINITIONS else rebounds.DEFINITIONS[-1])
