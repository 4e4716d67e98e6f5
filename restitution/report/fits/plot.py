"""The drawing of a fit: impacts with the law and its bands above, pulls below."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restitution.calibration.result.fit_result import FitResult, sources
from restitution.calibration.result.prediction import predict
from restitution.report.drawing import Drawing, as_text, save, stokes_axis, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MARKERS = "osD^vP<>Xph*"
DASHES = ("-", (0, (6, 2)), (0, (1, 1.2)), (0, (3, 1.5, 1, 1.5)))
MOST_NAMES = 12
"""Sources, or levels of separate parameters, named in the legend; of more the markers repeat."""


def draw(result: FitResult) -> Drawing:
    """Figure of two panels over one axis of St."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(7.6, 6.6), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        _law(upper, result)
        _impacts(upper, lower, result)
        stokes_axis(upper)
        highest = max([1.0, *(p.e_eff for p in result.points if p.e_eff is not None)])
        upper.set_ylim(min(0.0, *(p.e_eff for p in result.points if p.e_eff is not None)), 1.04 * highest)
        upper.set_ylabel(r"$e_{\mathrm{eff}}$  [-]")
        lower.set_ylabel("residual / $\\sigma$  [-]")
        reach = max(2.6, 1.15 * result.goodness.largest_pull)
        lower.set_ylim(-reach, reach)
        for level in (-2, 0, 2):
            lower.axhline(level, color="#999999", lw=0.8, zorder=0)
        lower.set_xlabel(f"Stokes number ({result.stokes_convention}, speed {result.speed_definition})  [-]")
        upper.legend(fontsize=8.5, loc="lower right")
        return save(figure)


def _law(ax: Axes, result: FitResult) -> None:
    """One curve with its bands for each combination of levels and dry restitution that was fitted."""
    low, high = result.stokes_range
    St = np.geomspace(low / 1.15, high * 1.15, 300)
    estimated = any(p.name.startswith("e_dry") for p in result.parameters) or "e_dry" in result.fixed
    cases = dict.fromkeys((tuple(p.levels.items()), None if estimated else p.e_dry) for p in result.points)
    for (levels, e_dry), dashes in zip(cases, DASHES * len(cases), strict=False):
        found = predict(result, St, e_dry, None, dict(levels))
        name = ", ".join(
            [*(f"{v}" for _, v in levels), *([f"e_dry {e_dry:g}"] if len(cases) > 1 and e_dry else [])]
        )
        first = (levels, e_dry) == next(iter(cases))
        more, law = found.impact["95%"], found.law["95%"]
        ax.fill_between(St, *more.T, color="#e3e3e3", lw=0, label="95 % of single impacts" if first else None)
        ax.fill_between(St, *law.T, color="#b5b5b5", lw=0, label="95 % interval of the law" if first else None)
        ax.plot(St, found.value, color="black", ls=dashes, label=as_text(f"fit {name}".rstrip()))


def _impacts(upper: Axes, lower: Axes, result: FitResult) -> None:
    many = len(sources(result)) > 1
    named = [", ".join([*([p.source] if many else []), *p.levels.values()]) for p in result.points]
    names = list(dict.fromkeys(named))
    for k, name in enumerate(names):
        points = [p for p, own in zip(result.points, named, strict=True) if own == name]
        seen = [p for p in points if p.e_eff is not None]
        limits = [p for p in points if p.e_eff is None and p.e_eff_upper < (p.e_dry or 1.0)]
        marker, face = MARKERS[k % len(MARKERS)], ("black", "white")[(k // len(MARKERS) + k) % 2]
        look = {
            "fmt": marker,
            "ms": 5,
            "mfc": face,
            "mec": "black",
            "ecolor": "black",
            "elinewidth": 0.8,
            "capsize": 2,
        }
        label = as_text(name) if 1 < len(names) <= MOST_NAMES else None
        x, sx = [p.stokes for p in seen], [p.stokes_sigma for p in seen]
        if seen:
            upper.errorbar(x, [p.e_eff for p in seen], [p.e_eff_sigma for p in seen], sx, label=label, **look)
            lower.plot(x, [p.pull for p in seen], marker, ms=5, mfc=face, mec="black")
        if limits:
            at, most = [p.stokes for p in limits], [p.e_eff_upper for p in limits]
            upper.errorbar(at, most, yerr=0.05, uplims=True, **(look | {"ms": 3}))
