"""The figures of a calibrated solver: posterior, check of the emulator, records against the calibrated band."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from restitution.emulation.calibration import Calibration
from restitution.emulation.emulated import Emulated
from restitution.emulation.held_out import Predicted
from restitution.emulation.told import Told
from restitution.report.drawing import Drawing, as_text, save, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

MARKS = ("o", "s", "^", "D", "v", "P", "X", "*")
_MASS = (0.95, 0.68)
_BINS = 30


def corner(c: Calibration) -> Drawing:
    """The posterior: each parameter with its prior, each pair with the regions of 68 and 95 %."""
    from matplotlib.figure import Figure

    n = len(c.told)
    with style():
        size = max(3.4, 2.3 * n)
        figure = Figure(figsize=(size, size), layout="constrained")
        axes = figure.subplots(n, n, squeeze=False)
        for i, row in enumerate(c.told):
            for j, column in enumerate(c.told):
                ax = axes[i, j]
                if j > i:
                    ax.set_axis_off()
                    continue
                ax.set_xlim(column.prior)
                if column.logarithmic:
                    ax.set_xscale("log")
                    _decades(ax.xaxis)
                if i == j:
                    _single(ax, row, c.draws[:, i], None if c.before is None else c.before[row.name])
                else:
                    _pair(ax, c, column, row, c.draws[:, j], c.draws[:, i])
                _label(ax, i, j, n, column, row)
        return save(figure)


def _label(ax: Axes, i: int, j: int, n: int, column: Told, row: Told) -> None:
    ax.tick_params(labelsize=7)
    if i == n - 1:
        ax.set_xlabel(as_text(column.name), fontsize=8.5)
    else:
        ax.tick_params(labelbottom=False, which="both")
    if j == 0 and i > 0:
        ax.set_ylabel(as_text(row.name), fontsize=8.5)
    elif i != j:
        ax.tick_params(labelleft=False, which="both")
    if i == j:
        ax.set_yticks([])


def _decades(axis: Axis) -> None:
    """Numbers at the decades alone: between them they would run into one another."""
    from matplotlib.ticker import LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(numticks=5))
    axis.set_minor_formatter(NullFormatter())


def _edges(t: Told) -> np.ndarray:
    return np.geomspace(*t.prior, _BINS + 1) if t.logarithmic else np.linspace(*t.prior, _BINS + 1)


def _single(ax: Axes, t: Told, draws: np.ndarray, before: float | None) -> None:
    share, edges = np.histogram(draws, _edges(t))
    ax.stairs(share / share.sum() * _BINS, edges, color="black", lw=1.4, label="posterior")
    ax.axhline(1.0, color="black", ls=":", lw=1.0, label="prior")
    ax.axvspan(*t.intervals[0.68], color="0.85", zorder=0)
    ax.axvline(t.median, color="black", lw=1.0)
    if before is not None:
        ax.axvline(before, color="black", ls="--", lw=1.0, label="before")
    ax.set_ylim(0, 1.08 * max(1.0, float(share.max()) / share.sum() * _BINS))


def _pair(ax: Axes, c: Calibration, column: Told, row: Told, x: np.ndarray, y: np.ndarray) -> None:
    share, ex, ey = np.histogram2d(x, y, [_edges(column), _edges(row)])
    # The draws are many, but not so many in each cell: a means over neighbours shows the region, not its noise.
    for axis in (0, 1):
        padded = np.pad(share, [(1, 1) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
        left, right = (np.take(padded, range(k, k + share.shape[axis]), axis) for k in (0, 2))
        share = (left + 2 * share + right) / 4
    ordered = np.sort(share.ravel())[::-1]
    mass = np.cumsum(ordered) / ordered.sum()
    levels = [float(ordered[np.searchsorted(mass, m)]) for m in _MASS]
    mid_x, mid_y = (np.sqrt(e[1:] * e[:-1]) if t.logarithmic else 0.5 * (e[1:] + e[:-1])
                    for e, t in ((ex, column), (ey, row)))  # fmt: skip
    if levels[0] < levels[1] < share.max():
        ax.contourf(mid_x, mid_y, share.T, [*levels, share.max()], colors=["0.85", "0.6"])
        ax.contour(mid_x, mid_y, share.T, levels, colors="black", linewidths=[0.8, 1.2], linestyles=[":", "-"])
    else:
        ax.plot(x[::20], y[::20], ".", color="0.4", ms=1)
    theta = np.array([run.values for run in c.group.runs])
    names = list(c.group.parameters)
    ax.plot(theta[:, names.index(column.name)], theta[:, names.index(row.name)], "+", color="black", ms=3, mew=0.6)
    if c.before is not None:
        ax.plot(c.before[column.name], c.before[row.name], "x", color="black", ms=7, mew=1.6)
    ax.set_ylim(row.prior)
    if row.logarithmic:
        ax.set_yscale("log")
        _decades(ax.yaxis)


def emulator(records: tuple[Emulated, ...]) -> Drawing:
    """Of runs left out: predicted over given, and the standardised errors."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(8.6, 3.4 * len(records)), layout="constrained")
        axes = figure.subplots(len(records), 2, squeeze=False)
        for (left, right), e in zip(axes, records, strict=True):
            c = e.check
            mean = c.given.mean(axis=0)
            for k, label in enumerate(c.labels):
                mark, fill = MARKS[k % len(MARKS)], "white" if label.startswith("e ") else "0.5"
                left.errorbar(
                    c.given[:, k] / mean[k], c.predicted[:, k] / mean[k], yerr=1.96 * c.sigma[:, k] / mean[k],
                    fmt=mark, ms=4, mfc=fill, mec="black", ecolor="0.6", elinewidth=0.6,
                    label=label.split(",")[0],
                )  # fmt: skip
                right.plot(
                    np.full(len(c.given), k) + np.linspace(-0.25, 0.25, len(c.given)), c.standardised[:, k], mark,
                    ms=4, mfc=fill, mec="black",
                )  # fmt: skip
            ends = [float(f(c.given / mean)) for f in (np.min, np.max)]
            left.plot(ends, ends, "-", color="black", lw=0.8)
            left.set_xlabel("run, over the mean of the runs  [-]")
            left.set_ylabel("predicted without it  [-]")
            left.set_title(as_text(e.name), fontsize=9.5)
            left.legend(fontsize=7, ncols=2)
            for y in (-1.96, 1.96):
                right.axhline(y, color="black", ls="--", lw=0.8)
            right.axhline(0, color="black", lw=0.6)
            most = max(4.0, 1.1 * float(np.max(np.abs(c.standardised))))
            right.set_ylim(-most, most)
            right.set_xticks(
                range(len(c.labels)), [label.split(",")[0] for label in c.labels], rotation=45, fontsize=8
            )
            right.set_ylabel("error over its standard deviation  [-]")
        return save(figure)


def record(p: Predicted, d: float, gravity: float) -> Drawing:
    """One record: frames as squares, the median before, the median and 95 % band after; below the distances."""
    from matplotlib.figure import Figure

    unit = math.sqrt(d / gravity)
    with style():
        figure = Figure(figsize=(7.5, 5.2), layout="constrained")
        top, below = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1.3])
        t = (p.time_s - p.time_s[0]) / unit
        top.fill_between(t, p.after[0] / d, p.after[4] / d, color="0.75", lw=0, label="calibrated, 95 %")
        top.plot(t, p.after[2] / d, "-", color="black", lw=1.2, label="calibrated")
        top.plot(t, p.before[2] / d, "--", color="0.35", lw=1.2, label="before")
        top.errorbar(
            t, p.gap_m / d, yerr=p.sigma_m / d, fmt="s", ms=3.5, mfc="white", mec="black", ecolor="black",
            elinewidth=0.7, label=f"measured: {as_text(p.record)}",
        )  # fmt: skip
        top.set_ylabel(r"gap, $h/d$  [-]")
        highest = max(float(x.max()) for x in (p.gap_m, p.after[4], p.before[2])) / d
        top.set_ylim(-0.05 * highest, 1.05 * highest)
        figure.legend(*top.get_legend_handles_labels(), fontsize=8, ncols=2, loc="outside upper center")
        low, high = (p.after[k] - p.gap_m for k in (0, 4))
        below.fill_between(t, low / d, high / d, color="0.75", lw=0)
        below.plot(t, (p.after[2] - p.gap_m) / d, "-", color="black", lw=1.2)
        below.plot(t, (p.before[2] - p.gap_m) / d, "--", color="0.35", lw=1.2)
        below.axhspan(-p.sigma_m / d, p.sigma_m / d, fill=False, hatch="////", lw=0, edgecolor="0.3")
        below.axhline(0, color="black", lw=0.6)
        below.set_ylabel(r"less measured  [$d$]")
        below.set_xlabel(r"time, $t\,\sqrt{g/d}$  [-]")
        return save(figure)
