"""The drawings of Figure 2: velocity and gap in time, the other records, and the flow about the first impact."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from restitution import datasets
from restitution.impacts.bounces import frame_velocity
from restitution.report.drawing import Drawing, save, style
from restitution.report.fig2 import point_lines
from restitution.report.fig2.bands import band
from restitution.report.fig2.content import DRY, FINE, IMPOSED, PUBLISHED, RECORD, Fig2
from restitution.runs.flow_pictures import MOMENTS

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from restitution.runs.kept import KeptRun

# label, colour, dashes: told apart by the dashes alone; hatching of the band of what is not known
LINES = {
    IMPOSED: ("simulation (a): Eq. (4) imposed, K of the other records", "#000000", "-", "////"),
    DRY: ("simulation (b): $e_{dry}$, film resolved", "#D55E00", (0, (6, 2)), "...."),
    FINE: ("the same, 20 cells per diameter", "#0072B2", (0, (1, 1.2)), ""),
}
POINTS = {
    point_lines.DRY: ("point particle: $e_{dry}$, cavitating film", "#009E73", (0, (1, 3))),
    point_lines.FITTED: ("point particle: Eq. (4), K of all records", "#CC79A7", (0, (9, 2, 1, 2, 1, 2))),
}
PUBLISHED_LINE = {"color": "#888888", "lw": 1.0, "marker": "D", "ms": 3, "mfc": "#cccccc", "mec": "#888888"}
MEASURED = {
    "fmt": "s",
    "ms": 4,
    "mfc": "white",
    "mec": "black",
    "color": "black",
    "elinewidth": 0.8,
    "capsize": 1.5,
}
_BEFORE_MS, _AFTER_MS = -18.0, 165.0


def draw(fig2: Fig2) -> Drawing:
    """Velocity and gap against time from the first contact."""
    from matplotlib.figure import Figure

    record, published = fig2.records[RECORD], fig2.records[PUBLISHED]
    conditions = datasets.resource(RECORD).conditions
    d, star = conditions.sphere.diameter, math.sqrt(conditions.gravity / conditions.sphere.diameter)
    with style():
        figure = Figure(figsize=(11.0, 8.6), layout="constrained")
        top, bottom = figure.subplots(2, 1, sharex=True)
        for name, (label, colour, dashes, hatch) in LINES.items():
            if (run := fig2.runs.get(name)) is None:
                continue
            look = {"color": colour, "ls": dashes, "zorder": 3}
            top.plot(run.velocity.time_s * 1e3, run.velocity.velocity_m_s, label=label, **look)
            bottom.plot(run.trajectory.time_s * 1e3, run.trajectory.gap_m / d, **look)
            if (about := band(fig2, name)) is not None:
                spread = {"facecolor": "none", "edgecolor": colour, "hatch": hatch, "lw": 0.4, "zorder": 1}
                bottom.fill_between(about.time_s * 1e3, about.low_m / d, about.high_m / d, **spread)
        for line in fig2.lines:
            if line.name not in POINTS:
                continue
            label, colour, dashes = POINTS[line.name]
            look = {"color": colour, "ls": dashes, "lw": 1.1, "zorder": 2}
            top.plot(line.time_s * 1e3, line.velocity_m_s, label=label, **look)
            bottom.plot(line.time_s * 1e3, line.gap_m / d, **look)
        for ax, values in zip((top, bottom), _published(fig2, published.contacts_s), strict=True):
            scale = 1 if ax is top else 1 / d
            ax.plot(
                values[0] * 1e3,
                values[1] * scale,
                label="Biegert et al. 2017, simulation",
                zorder=1,
                **PUBLISHED_LINE,
            )
        track = datasets.load_track(RECORD)
        time, velocity, error = frame_velocity(track, record.contacts_s)
        first = record.contacts_s[0]
        top.errorbar(
            (time - first) * 1e3, velocity, yerr=error, label="Gondret et al. 2002, measured", zorder=4, **MEASURED
        )
        bottom.errorbar(
            (record.time_s - first) * 1e3, record.gap_m / d, yerr=track.sigma / d, zorder=4, **MEASURED
        )
        top.axhline(0, color="#bbbbbb", lw=0.8, zorder=0)
        top.set_ylabel("velocity away from the wall  [m/s]")
        bottom.set_ylabel("gap between sphere and wall  $h/d$  [-]")
        bottom.set_xlabel("time from the first contact  $t$  [ms]")
        bottom.set_xlim(_BEFORE_MS, _AFTER_MS)
        bottom.set_ylim(-0.1, 3.4)
        above = top.secondary_xaxis("top", functions=(lambda t: t * 1e-3 * star, lambda t: t / star * 1e3))
        above.set_xlabel(r"$t^*=t\,\sqrt{g/d}$  [-]")
        top.legend(loc="upper right", fontsize=8.5, ncols=2)
        return save(figure)


def _published(fig2: Fig2, contacts_s: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Velocity, by differences of its points, and gap of the published simulation, from its own zero of time."""
    track = datasets.load_track(PUBLISHED)
    time, velocity, _ = frame_velocity(track, contacts_s)
    breaks = np.searchsorted(time, contacts_s)
    return [
        (np.insert(time, breaks, np.nan), np.insert(velocity, breaks, np.nan)),
        (track.time_s, track.value),
    ]


def draw_records(fig2: Fig2) -> Drawing | None:
    """Gap in time for every other record of which a run is kept; None where there is none."""
    from matplotlib.figure import Figure

    runs = [r for r in fig2.runs.values() if r.case.record not in (None, RECORD) and not r.case.prediction]
    by_record: dict[str, list[KeptRun]] = {}
    for run in runs:
        if datasets.resource(run.case.record).table == "trajectory":  # not one of velocities
            by_record.setdefault(run.case.record, []).append(run)
    if not by_record:
        return None
    columns = 3
    rows = -(-len(by_record) // columns)
    with style():
        figure = Figure(figsize=(11.0, 3.0 * rows), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False)
        for ax in axes.flat[len(by_record) :]:
            ax.set_axis_off()
        for ax, (name, kept) in zip(axes.flat, by_record.items(), strict=False):
            _panel(ax, fig2, name, kept)
        for ax in axes[:, 0]:
            ax.set_ylabel("gap  $h/d$  [-]")
        for ax in axes[-1]:
            ax.set_xlabel("time  [ms]")
        return save(figure)


def _panel(ax: Axes, fig2: Fig2, name: str, kept: list[KeptRun]) -> None:
    """One record and the runs of it, each from its own first contact, or from the release."""
    resource = datasets.resource(name)
    d, track = resource.conditions.sphere.diameter, datasets.load_track(name)
    dashes = ("-", (0, (6, 2)), (0, (1, 1.2)), (0, (3, 1.5, 1, 1.5)))
    for i, run in enumerate(kept):
        ax.plot(
            run.trajectory.time_s * 1e3, run.trajectory.gap_m / d, color="black", ls=dashes[i % len(dashes)],
            label=run.case.name, zorder=3,
        )  # fmt: skip
    first = fig2.records[name].contacts_s[0] if name in fig2.records else 0.0
    ax.errorbar(
        (track.time_s - first) * 1e3, track.value / d, yerr=track.sigma / d, zorder=2, **(MEASURED | {"ms": 3})
    )
    margin = 0.1 * np.ptp(track.time_s)
    ax.set_xlim(*((track.time_s[[0, -1]] - first + np.array([-margin, margin])) * 1e3))
    ax.set_ylim(-0.05 * np.ptp(track.value) / d, 1.15 * max(np.max(track.value), 0) / d)
    ax.set_title(f"{resource.experiment.cite}: {name}", fontsize=9, loc="left")
    ax.legend(fontsize=7)


def draw_flow(fig2: Fig2) -> Drawing | None:
    """Vorticity in the middle plane before, at and after the first impact; None where no picture is kept."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle

    run = fig2.runs.get(DRY)
    frames = run.flow.frames if run is not None else {}
    if not frames:
        return None
    scale = run.case.sphere.diameter / run.case.reference_speed
    with style():
        figure = Figure(figsize=(11.0, 4.0), layout="constrained")
        axes = figure.subplots(1, len(MOMENTS), sharey=True)
        for ax, moment in zip(axes, MOMENTS, strict=True):
            if moment not in frames:
                ax.set_axis_off()
                continue
            f = frames[moment]
            drawn = ax.pcolormesh(  # in the SVG an image: as triangles it is megabytes
                f.x_d, f.z_d, f.vorticity.T * scale, cmap="RdBu_r", vmin=-5, vmax=5, shading="gouraud",
                rasterized=True,
            )  # fmt: skip
            ax.contour(  # told apart without colour by the dashes, matplotlib's for negative levels
                f.x_d, f.z_d, f.vorticity.T * scale, levels=(-4, -2, -1, 1, 2, 4), colors="black", linewidths=0.5
            )
            ax.add_patch(Circle((0, 0.5 + f.gap_d), 0.5, fc="#dddddd", ec="black", lw=1, zorder=3))
            ax.axhline(0, color="black", lw=3)
            ax.set_aspect("equal")
            ax.set_ylim(-0.05, 3.0)
            ax.set_xlabel("$x/d$  [-]")
            ax.set_title(f"{moment} the impact: $t$ = {f.time_s * 1e3:.1f} ms, $h/d$ = {f.gap_d:.2f}", fontsize=10)
        axes[0].set_ylabel("height  $z/d$  [-]")
        figure.colorbar(drawn, ax=axes, label=r"vorticity  $\omega_y d/u_{in}$  [-]", shrink=0.8, extend="both")
        return save(figure)


def draw_forces(table: pd.DataFrame) -> Drawing:
    """What each force does to the first apex, and to the distance from the frames."""
    from matplotlib.figure import Figure

    whole, rows = table.iloc[0], table.iloc[1:].sort_values("apex_1_change", key=abs)
    with style():
        figure = Figure(figsize=(9.0, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2, sharey=True)
        y = np.arange(len(rows))
        left.barh(y, 100 * rows.apex_1_change, color="#999999", edgecolor="black", lw=0.8)
        left.axvline(0, color="black", lw=0.8)
        left.set_yticks(y, rows.off)
        left.set_ylabel("without")
        left.set_xlabel("change of the first apex  [%]")
        right.plot(rows.rms_d, y, "o", color="black", ms=5)
        right.axvline(whole.rms_d, color="black", ls="--", lw=1.0, label="whole model")
        right.set_xscale("log")
        right.set_xlabel("rms distance from the frames  [$d$]")
        right.grid(axis="y", color="#dddddd", lw=0.8)
        right.legend(fontsize=8, loc="lower right")
        return save(figure)
