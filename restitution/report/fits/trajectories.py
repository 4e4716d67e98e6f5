"""The report of a fit to whole trajectories: that of any fit, and the records with the model beside them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from restitution.calibration.trajectories.fit import closures_of
from restitution.calibration.trajectories.whole_trajectories import band, distance_d
from restitution.report.drawing import Drawing, as_text, save, style
from restitution.report.fits import report

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from restitution.calibration.result.fit_result import FitResult
    from restitution.calibration.trajectories.fit import TrajectoryFit
    from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory

_COLUMNS = 2
"""Records side by side."""
_POINTS = 1200
"""Of a line over a record."""


def write(folder: str | Path, fit: TrajectoryFit, result: FitResult, out: str | None = None) -> list[str]:
    """Write the report into ``folder``, the record to ``out`` as well; returns the names of the files."""
    drawing = draw(fit)
    return report.write(
        folder,
        result,
        "trajectory_fit.html.j2",
        {"trajectories.svg": drawing.svg, "trajectories.png": drawing.png},
        out,
        trajectories=drawing.svg,
        slopes=_slopes(fit),
        seen=[f"{t.record}: rms {t.rms_d:.3f} d with its own restitutions" for t in result.trajectories],
    )


def draw(fit: TrajectoryFit) -> Drawing:
    """For each record its frames with the model, and below the residuals."""
    from matplotlib.figure import Figure

    trajectories = fit.trajectories
    columns = min(_COLUMNS, len(trajectories))
    rows = -(-len(trajectories) // columns)
    with style():
        figure = Figure(figsize=(5.5 * columns if columns > 1 else 9.0, 4.2 * rows), layout="constrained")
        for panel, t in zip(np.ravel(figure.subfigures(rows, columns, squeeze=False)), trajectories, strict=False):
            upper, lower = panel.subplots(2, 1, sharex=True, height_ratios=(3, 1))
            _record(upper, lower, fit, t)
        return save(figure)


def _record(upper: Axes, lower: Axes, fit: TrajectoryFit, t: WholeTrajectory) -> None:
    r, d = t.recording, t.recording.conditions.sphere.diameter
    time = np.linspace(r.time_s[0], r.time_s[-1], _POINTS)
    low, high = np.quantile(band(t, time), [0.025, 0.975], axis=0) / d
    upper.fill_between(1e3 * time, low, high, color="#9a9a9a", lw=0, label="95 % of the model, own restitutions")
    line = t.likelihood.predict(t.mean, time) / d
    upper.plot(1e3 * time, line, color="black", lw=1.2, label="model, own restitutions")
    path, _, _ = distance_d(t, closures_of(fit.fit, t.forces, fit.measured.edge, r.name))
    own = t.likelihood.own_time(t.mean, t.likelihood.model(t.mean), time)
    if r.clock_of == "contact":
        own = own - t.likelihood.model(t.mean).contacts[1] + path.impacts[0].time_s
    name = fit.fit.likelihood.model.name
    law = {"color": "#0072B2", "ls": (0, (6, 2)), "lw": 1.2, "label": as_text(f"model, e by {name}")}
    upper.plot(1e3 * time, path.gap(own) / d, **law)
    look = {"marker": "s", "ms": 3, "mfc": "white", "mec": "black", "ls": "none"}
    upper.plot(1e3 * r.time_s, r.gap_m / d, label="frames", **look)
    upper.set_title(as_text(r.name), loc="left", fontsize=10)
    upper.set_ylabel("gap  $h/d$  [-]")
    upper.legend(fontsize=7.5, loc="upper right")
    upper.set_ylim(-0.04 * np.max(r.gap_m) / d, 1.35 * np.max(r.gap_m) / d)
    residual = (r.gap_m - t.likelihood.predict(t.mean)) / d
    lower.plot(1e3 * r.time_s, residual, color="#666666", **(look | {"ls": "-", "lw": 0.8}))
    lower.axhspan(-2 * r.sigma / d, 2 * r.sigma / d, color="#dddddd", lw=0, zorder=0)
    lower.set_ylabel("residual  [$d$]")
    lower.set_xlabel("recorded time  [ms]")


def _slopes(fit: TrajectoryFit) -> list[dict]:
    """Parameters of the law by whole trajectories, and by the slopes beside each contact."""
    rows = []
    for j, p in enumerate(fit.fit.maximum.parameters):
        row = {"name": p.name, "whole": _value(fit.fit, j), "slopes": ""}
        if not isinstance(fit.slopes, str):
            names = [q.name for q in fit.slopes.maximum.parameters]
            row["slopes"] = _value(fit.slopes, names.index(p.name)) if p.name in names else ""
        rows.append(row)
    return rows


def _value(fit, j: int) -> str:
    low, high = fit.maximum.intervals[0.68][j]
    return f"{fit.maximum.values[j]:.4g} ({low:.4g} to {high:.4g})"
