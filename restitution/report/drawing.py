"""Figures as bytes that do not change from run to run, in one style that reads without colour."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from restitution.errors import printable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "mathtext.fontset": "dejavusans",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "svg.hashsalt": "restitution",
    "savefig.facecolor": "white",
}


@dataclass(frozen=True)
class Drawing:
    """One figure as SVG text and PNG bytes."""

    svg: str
    png: bytes


@contextmanager
def style() -> Iterator[None]:
    """Draw in the project's style, whatever the user's settings are."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        yield


def save(figure: Figure, dpi: int = 160) -> Drawing:
    """The figure without dates and versions in its metadata. Call within :func:`style`."""
    svg, png = io.StringIO(), io.BytesIO()
    figure.savefig(svg, format="svg", metadata={"Date": None, "Creator": None})
    figure.savefig(png, format="png", dpi=dpi, metadata={"Software": None})
    return Drawing(svg.getvalue(), png.getvalue())


LONGEST_NAME = 60
"""Characters of a user's name in a figure."""


def as_text(name: str) -> str:
    """A text of a user's as it is to be drawn: its dollars begin no formula, and it is of a length that fits."""
    return printable(name, LONGEST_NAME).replace("$", r"\$")


def stokes_axis(ax: Axes) -> None:
    """A logarithmic axis of x that names 1, 2, 5, 10, ... as plain numbers, however short it is."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    ax.set_xscale("log")
    ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ax.xaxis.set_minor_locator(LogLocator(subs=tuple(range(1, 10))))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda St, _: f"{St:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())


def equation(latex: str) -> str:
    """An equation as SVG text, for pages that load nothing."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(0.01, 0.01))
        figure.text(0, 0, f"${latex}$", fontsize=11)
        svg = io.StringIO()
        metadata = {"Date": None, "Creator": None}
        figure.savefig(
            svg, format="svg", bbox_inches="tight", pad_inches=0.03, metadata=metadata, transparent=True
        )
    return svg.getvalue()
