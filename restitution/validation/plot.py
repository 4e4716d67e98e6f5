"""The small plot of a row: how far each value is from its reference, in tolerances; the band is what passes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from restitution.report.drawing import as_text, style
from restitution.validation.row import Reference
from restitution.validation.scorecard import Judged
from restitution.validation.verdict import Verdict, over_tolerance

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FURTHEST = 3.0
"""Tolerances at which an arrow stands for all that lies beyond."""
_WIDTH, _ROW, _FRAME = 4.6, 0.2, 0.5
"""In inches: of a plot, of a value in it, of what is around them."""
_MARKS = {Verdict.PASS: ("o", "black"), Verdict.KNOWN_MISS: ("D", "white"), Verdict.FAIL: ("X", "black")}


def draw(judged: Judged) -> str:
    """The plot as SVG text."""
    import io

    from matplotlib.figure import Figure

    references = judged.row.truth()
    with style():
        figure = Figure(figsize=(_WIDTH, _FRAME + _ROW * len(references)), layout="constrained")
        ax = figure.subplots()
        for height, reference in enumerate(reversed(references)):
            _value(ax, height, reference, judged)
        _frame(ax, references)
        svg = io.StringIO()
        figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": None})
    return svg.getvalue()


def _frame(ax: Axes, references: tuple[Reference, ...]) -> None:
    ax.axvline(0.0, color="black", lw=0.8, zorder=0)
    ax.set_xlim(-FURTHEST - 0.4, FURTHEST + 0.4)
    ax.set_ylim(-0.6, len(references) - 0.4)
    ax.set_yticks(range(len(references)), [as_text(r.label) for r in reversed(references)], fontsize=7.5)
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    ax.set_xticks([-3, -2, -1, 0, 1, 2, 3])
    ax.tick_params(axis="x", labelsize=7.5)
    ax.set_xlabel("(value $-$ reference) / tolerance  [-]", fontsize=7.5)


def _value(ax: Axes, height: int, reference: Reference, judged: Judged) -> None:
    low, high = {"both": (-1, 1), "at most": (-1, 1), "at least": (0, FURTHEST + 0.4)}[reference.side]
    ax.barh(height, high - low, left=low, height=0.72, color="#dcdcdc", zorder=0)
    held = (judged.held or {}).get(reference.label)
    if held is not None:
        ax.plot(_shown(_place(reference, held.value)), height, "|", color="#777777", ms=11, mew=1.4)
    values = judged.result.numbers or {}
    if reference.label not in values:
        ax.text(0.08, height, "not evaluated", va="center", fontsize=7, color="#555555")
        return
    at = _place(reference, values[reference.label])
    if math.isnan(at):
        ax.text(0.08, height, "not a number", va="center", fontsize=7)
        return
    marker, face = _MARKS[judged.truth_by_label[reference.label]]
    if abs(at) > FURTHEST:
        marker = ">" if at > 0 else "<"
    ax.plot(_shown(at), height, marker, mfc=face, mec="black", ms=5.5)


def _shown(at: float) -> float:
    return max(-FURTHEST, min(FURTHEST, at))


def _place(reference: Reference, value: float) -> float:
    """Where a value stands: in tolerances; of a bound its share of it; of what is to be reached, relatively."""
    if reference.side == "at most":
        return over_tolerance(value, reference.value + reference.tolerance)
    if reference.side == "at least":
        return (value - reference.value) / abs(reference.value)
    return over_tolerance(value - reference.value, reference.tolerance)
