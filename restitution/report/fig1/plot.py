"""The drawing of Figure 1: two panels with the same impacts, readings of Eq. (4) left, published laws right."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from restitution import laws
from restitution.calibration.result.fit_result import result_of
from restitution.calibration.result.prediction import predict
from restitution.laws.source_abstract_eq4 import READINGS
from restitution.report.drawing import Drawing, save, style
from restitution.report.fig1.content import OTHERS, SIMULATED_BY_ABSTRACT, Fig1
from restitution.stokes import Speed, StokesNumber

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

    from restitution.conditions import Conditions

St_MIN, St_MAX = 4.0, 2000.0
E_DRY = 0.97

# label, colour, line style: told apart by the dashes alone.
LINES = {
    "eq4_exponential": (r"$e\,\exp[-18(1+e)/St]$", "#000000", "-"),
    "eq4_exponential_over_e": (r"$e\,\exp[-18(1+e)/(e\,St)]$", "#0072B2", (0, (1, 1.2))),
    "eq4_rational": (r"$e/[1+18(1+e)/St]$", "#D55E00", (0, (6, 2))),
    "eq4_linear": (r"$e-18(1+e)/St$ (rejected)", "#777777", (0, (3, 1.5, 1, 1.5))),
    "eq4_linear_relative": (r"$e[1-18(1+e)/St]$ (rejected)", "#777777", (0, (1, 3))),
    "legendre_2005": ("Legendre et al. 2005", "#000000", "-"),
    "barnocky_davis_1988": (r"Barnocky & Davis 1988, $St_c=10$", "#D55E00", (0, (3, 1.5, 1, 1.5))),
    "two_way_lubrication": (r"Two-way lubrication, $h_{min}=10^{-4}r$ (derived here)", "#0072B2", (0, (6, 2))),
    "ehd_composite": ("Elastohydrodynamic composite (derived here)", "#009E73", (0, (1, 1.2))),
}
_FORMS = {
    "eq4_exponential": r"$e\,\exp[-K(1+e)/St]$",
    "eq4_rational": r"$e/[1+K(1+e)/St]$",
    "eq4_linear": r"$e-K(1+e)/St$",
}
# label, marker, face; the edge is black. By record, or by experiment for all of its records.
SERIES = {
    "gondret2002_st152": ("Gondret et al. 2002, 3 mm (used in the simulation)", "s", "black"),
    "gondret2002_st27": ("Gondret et al. 2002, 6 mm (impact speed quoted)", "o", "white"),
    "Li et al. 2012": ("Li et al. 2012, five drops", "^", "white"),
    "Biegert et al. 2017": ("Biegert et al. 2017, simulation", "D", "#cccccc"),
}
_FURTHER = (("P", "#cccccc"), ("X", "#cccccc"), ("*", "#cccccc"), ("v", "#cccccc"), ("p", "#cccccc"))
"""Markers and faces of series that have none above: those of this package's runs, in turn."""


_BY_RATIO = {1.5: "<", 2.5: ">", 8.0: "d"}
"""Of simulated rebounds over St, by density ratio."""


def draw(fig1: Fig1, speed: Speed) -> Drawing:
    """Both panels as SVG and PNG."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(11.0, 5.6), layout="constrained")
        left, right = figure.subplots(1, 2, sharey=True)
        for ax, title, names in (
            (left, "(a) Readings of Eq. (4) of the source abstract", READINGS),
            (right, "(b) Other laws", OTHERS),
        ):
            _known_without_points(ax)
            if ax is left:
                _band(ax, fig1, speed)
                _trajectory_band(ax, fig1)
            _lines(ax, names, fig1)
            _points(ax, fig1)
            if fig1.rebounds is not None:
                _rebounds(ax, fig1.rebounds.of(str(speed)))
            ax.set_title(title, loc="left", fontsize=11)
            ax.set_xscale("log")
            ax.set_xlim(St_MIN, St_MAX)
            ax.set_ylim(0, 1.06)
            ax.set_xlabel(r"Stokes number at impact  $St=\rho_p v d/(9\mu)$  [-]")
            handles = [h for h in ax.get_lines() if h.get_label() in {LINES[n][0] for n in names}]
            handles += [h for h in ax.collections if h.get_label().startswith("95 %")]
            ax.legend(
                handles=handles, loc="lower right", fontsize=8, handlelength=3.6, frameon=True, framealpha=0.85,
                edgecolor="none", borderpad=0.1,
            )  # fmt: skip
        left.set_ylabel(r"effective restitution  $e_{\mathrm{eff}}/e_{\mathrm{dry}}$  [-]")
        figure.legend(
            handles=[_key(*look) for look in (*looks(fig1).values(), *_looks_of_rebounds(fig1))],
            loc="outside lower center",
            ncols=2,
            fontsize=8.5,
        )
        return save(figure)


def _drawn_for(fig1: Fig1) -> Conditions:
    """The sphere whose St the axis is in, where a law has another."""
    return fig1.conditions[SIMULATED_BY_ABSTRACT]


def _band(ax: Axes, fig1: Fig1, speed: Speed) -> None:
    """The best supported form of Eq. (4) with K fitted: where the curve lies with 95 %."""
    best = fig1.judgement(speed).fitted.scores[0]
    St = np.geomspace(St_MIN, St_MAX, 600)
    band = predict(result_of(best.fit), St, E_DRY, _drawn_for(fig1))
    low, high = np.clip(band.law["95%"] / E_DRY, 0, None).T
    K = best.fit.maximum.values[0]
    label = f"95 % of {_FORMS[best.label]}, K fitted: {K:.1f}"
    ax.fill_between(St, low, high, color="#9a9a9a", alpha=0.6, lw=0, zorder=1, label=label)


def _known_without_points(ax: Axes) -> None:
    """Joseph et al. 2001, abstract: no rebound below St of about 10, the dry value above about 500."""
    for low, high, text in ((St_MIN, 10, "no rebound"), (500, St_MAX, "dry value")):
        ax.axvspan(low, high, color="#e9e9e9", lw=0, zorder=0)
        words = f"{text}\n(Joseph et al.\n2001)"
        ax.text(np.sqrt(low * high), 0.66, words, ha="center", va="center", fontsize=7.5, color="#333333")


def _trajectory_band(ax: Axes, fig1: Fig1) -> None:
    """The same of the fit to whole trajectories, hatched."""
    St = np.geomspace(St_MIN, St_MAX, 600)
    K, law = fig1.trajectories.band(St, E_DRY, _drawn_for(fig1))
    low, high = np.clip(law / E_DRY, 0, None).T
    form = _FORMS[fig1.trajectories.best.label]
    label = f"95 % of {form}, K from all positions: {K:.1f}"
    ax.fill_between(
        St, low, high, facecolor="none", edgecolor="#0072B2", hatch="////", lw=0.9, zorder=1.5, label=label
    )


def _lines(ax: Axes, names: tuple[str, ...], fig1: Fig1) -> None:
    """The laws over the axis, at e_dry = 0.97, in St; those of another convention for the 3 mm sphere."""
    St = np.geomspace(St_MIN, St_MAX, 600)
    conditions = _drawn_for(fig1)
    for name in names:
        law = laws.get_rebound(name)
        label, colour, dashes = LINES[name]
        e = law(StokesNumber(St, "st", law.speed), E_DRY, conditions, out_of_range="ignore")
        ax.plot(St, e / E_DRY, color=colour, ls=dashes, label=label, zorder=2)


def _points(ax: Axes, fig1: Fig1) -> None:
    series = np.array(_series(fig1))
    for name, (_, marker, face) in looks(fig1).items():
        rows = fig1.impacts[series == name]
        rebound, limit = rows[rows.outcome == "rebound"], rows[rows.e_eff_upper < rows.e_dry]
        ax.errorbar(
            rebound.stokes.astype(float), (rebound.e_eff / rebound.e_dry).astype(float),
            xerr=rebound.stokes_sigma.astype(float), yerr=(rebound.e_eff_sigma / rebound.e_dry).astype(float),
            fmt=marker, ms=6, mfc=face, mec="black", mew=1.0, ecolor="black", elinewidth=0.8, capsize=2, zorder=4,
        )  # fmt: skip
        upper = (limit.e_eff_upper / limit.e_dry).astype(float)
        ax.errorbar(
            limit.stokes.astype(float), upper, xerr=limit.stokes_sigma.astype(float), yerr=0.06, uplims=True,
            fmt=marker, ms=4, mfc=face, mec="black", color="black", elinewidth=0.8, zorder=3,
        )  # fmt: skip


def _rebounds(ax: Axes, rows: pd.DataFrame) -> None:
    """Simulated first rebounds of the greatest e_dry, by density ratio, each with the error of its grids."""
    rows = rows[(rows.e_dry == rows.e_dry.max()) & (rows.outcome == "rebound")]
    for ratio, group in rows.groupby("density_ratio"):
        ax.errorbar(
            group.stokes, group.e_eff / group.e_dry, yerr=group.e_grid_sigma / group.e_dry,
            fmt=_BY_RATIO[ratio], ms=4.5, mfc="#dddddd", mec="#444444", ecolor="#444444", mew=0.8,
            elinewidth=0.8, capsize=1.5, zorder=3,
        )  # fmt: skip


def _looks_of_rebounds(fig1: Fig1) -> list[tuple[str, str, str]]:
    if fig1.rebounds is None:
        return []
    ratios = sorted(set(fig1.rebounds.points.density_ratio))
    return [
        (f"this package, simulation over St at a density ratio of {ratio:g}", _BY_RATIO[ratio], "#dddddd")
        for ratio in ratios
    ]


def _series(fig1: Fig1) -> list[str]:
    """Of each impact the series it is drawn in: the one that its case states, or its record, or its experiment."""
    own = {name: predicted.series for name, predicted in fig1.simulated.items()}
    columns = zip(fig1.impacts.record, fig1.impacts.experiment, strict=True)
    return [own.get(record, record if record in SERIES else experiment) for record, experiment in columns]


def looks(fig1: Fig1) -> dict[str, tuple[str, str, str]]:
    """Label, marker and face of every series that is drawn."""
    own = {predicted.series for predicted in fig1.simulated.values()}
    drawn = dict.fromkeys(_series(fig1))
    found = {name: look for name, look in SERIES.items() if name in drawn}
    further = [name for name in drawn if name not in SERIES]
    for name, look in zip(further, cycle(_FURTHER)):
        found[name] = f"this package, simulation of {name}" if name in own else name, *look
    return found


def _key(label: str, marker: str, face: str) -> Line2D:
    """An entry of the legend."""
    from matplotlib.lines import Line2D

    return Line2D([], [], ls="none", marker=marker, ms=6, mfc=face, mec="black", label=label)
