"""The drawing of what to measure next: gain against the Stokes number, feasible experiments as points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restitution.report.drawing import Drawing, as_text, save, stokes_axis, style

if TYPE_CHECKING:
    from restitution.calibration.result.design import Design, Gain, Target

DASHES = ("-", (0, (6, 2)), (0, (1, 1.2)), (0, (3, 1.5, 1, 1.5)))


def draw(plan: Design, gains: list[Gain], shots: tuple[int, ...], target: Target) -> Drawing:
    """One curve a number of shots; the feasible experiments on the curve of the greatest."""
    from matplotlib.figure import Figure

    low, high = plan.result.stokes_range
    reach = [gain.stokes for gain in gains]
    St = np.geomspace(min(low, *reach), max(high, *reach), 300)
    with style():
        figure = Figure(figsize=(7.0, 4.6), layout="constrained")
        ax = figure.subplots()
        for m, dashes in zip(shots, DASHES * len(shots), strict=False):
            ax.plot(St, plan.ratio(St, m), color="black", ls=dashes, label=f"{m} impact{'s' * (m > 1)}")
        ax.plot(reach, [g.ratio[-1] for g in gains], "o", ms=4, mfc="white", mec="black", label="feasible pairs")
        stokes_axis(ax)
        ax.set_ylim(0, 1.02)
        ax.set_xlabel(f"Stokes number of the new impacts ({plan.result.stokes_convention}) [-]")
        what = as_text(target.parameter) if target.parameter else f"$e_{{eff}}$ at St {target.stokes:g}"
        ax.set_ylabel(f"standard error of {what} after / now [-]")
        ax.legend(fontsize=8.5, loc="lower right")
        return save(figure)
