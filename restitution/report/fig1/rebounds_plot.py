"""The drawing of the simulated rebounds: e_eff/e_dry over St, and the K that each would have by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restitution import laws
from restitution.report.drawing import Drawing, save, stokes_axis, style
from restitution.report.fig1.rebounds import EXPONENTIAL, Rebounds, each_K
from restitution.stokes import StokesNumber

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

MARKS = ("o", "^", "s", "D", "v")
"""Of the density ratios, in their order."""
FACES = {True: "#bbbbbb", False: "white"}
"""Of the greatest e_dry and of others."""
_K = (r"$St\,\ln(e_{dry}/e_{eff})/(1+e_{dry})$", r"$e_{dry}\,St\,\ln(e_{dry}/e_{eff})/(1+e_{dry})$")
"""K by one rebound, in the two forms that have one."""


def draw(r: Rebounds, definition: str) -> Drawing:
    """Left the rebounds with the best form, right K of each."""
    from matplotlib.figure import Figure

    rows = r.of(definition)
    with style():
        figure = Figure(figsize=(11.0, 6.0), layout="constrained")
        grid = figure.add_gridspec(2, 2)
        left = figure.add_subplot(grid[:, 0])
        _lines(left, r, definition, rows)
        _rebounds(left, rows)
        left.set_ylim(0, 1.05)
        left.set_ylabel(r"effective restitution  $e_{\mathrm{eff}}/e_{\mathrm{dry}}$  [-]")
        left.set_title("(c) Simulated rebounds", loc="left", fontsize=11)
        for k, (name, label) in enumerate(zip(EXPONENTIAL, _K, strict=True)):
            ax = figure.add_subplot(grid[k, 1])
            _each_K(ax, rows, name)
            ax.set_ylabel(label + "  [-]", fontsize=8)
            ax.set_title(f"({'de'[k]}) K by each rebound: {name}", loc="left", fontsize=11)
        for ax in figure.axes:
            stokes_axis(ax)
            ax.set_xlim(8, 1400)
        for ax in (left, figure.axes[-1]):
            ax.set_xlabel(r"Stokes number at impact  $St=\rho_p v d/(9\mu)$  [-]")
        left.legend(loc="lower right", fontsize=8.5)
        return save(figure)


def _groups(rows: pd.DataFrame) -> list[tuple[float, float, str, str, pd.DataFrame]]:
    ratios, most = sorted(set(rows.density_ratio)), rows.e_dry.max()
    return [
        (ratio, e, MARKS[ratios.index(ratio) % len(MARKS)], FACES[e == most], group)
        for (ratio, e), group in rows.groupby(["density_ratio", "e_dry"])
    ]


def _rebounds(ax: Axes, rows: pd.DataFrame) -> None:
    for ratio, e_dry, mark, face, group in _groups(rows):
        look = {"mfc": face, "mec": "black", "ms": 6, "ls": "none", "zorder": 4}
        seen, limit = group[group.outcome == "rebound"], group[group.e_eff_upper < group.e_dry]
        label = rf"$\rho_p/\rho_f$ = {ratio:g}, $e_{{dry}}$ = {e_dry:g}"
        e = (seen.e_eff / e_dry).to_numpy(float)
        for sigma, width, cap in ((seen.e_total_sigma, 0.7, 0), (seen.e_grid_sigma, 1.4, 3)):
            ax.errorbar(
                seen.stokes, e, yerr=(sigma / e_dry).to_numpy(float), ls="none", ecolor="black",
                elinewidth=width, capsize=cap, zorder=3,
            )  # fmt: skip
        ax.plot(seen.stokes, e, marker=mark, label=label, **look)
        upper = (limit.e_eff_upper / e_dry).to_numpy(float)
        ax.errorbar(
            limit.stokes, upper, yerr=0.05, uplims=True, marker=mark, color="black", elinewidth=0.8, **look
        )


def _lines(ax: Axes, r: Rebounds, definition: str, rows: pd.DataFrame) -> None:
    held = next(h for h in r.held if h.definition == definition)
    K = float(held.best.fit.maximum.values[0])
    law, St = laws.get_rebound(held.best.label, K=K), np.geomspace(8, 1400, 400)
    for e_dry, dashes in zip(sorted(set(rows.e_dry), reverse=True), ("-", "--", ":"), strict=False):
        e = law(StokesNumber(St, "st", law.speed), e_dry, None, out_of_range="ignore")
        label = f"{held.best.label}, K = {K:.1f}, $e_{{dry}}$ = {e_dry:g}"
        ax.plot(St, e / e_dry, ls=dashes, color="black", lw=1.2, label=label, zorder=2)


def _each_K(ax: Axes, rows: pd.DataFrame, form: str) -> None:
    for _, _, mark, face, group in _groups(rows[rows.outcome == "rebound"]):
        K, per_e = each_K(form, group)
        for sigma, width, cap in ((group.e_total_sigma, 0.7, 0), (group.e_grid_sigma, 1.4, 3)):
            ax.errorbar(
                group.stokes, K, yerr=per_e * sigma, ls="none", ecolor="black", elinewidth=width, capsize=cap,
                zorder=3,
            )  # fmt: skip
        ax.plot(group.stokes, K, ls="none", marker=mark, mfc=face, mec="black", ms=5.5, zorder=4)
    ax.set_ylim(bottom=0)
