"""The files of a look: the picture, and a page with how it was read, impacts, flights, notes and doubts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from restitution.report.look.plot import draw
from restitution.report.look.view import View
from restitution.report.page import number, render

if TYPE_CHECKING:
    import pandas as pd

    from restitution.report.drawing import Drawing

_MOST_REMARKS = 8
"""Notes and doubts written into the picture; the page has all."""


@dataclass(frozen=True)
class Told:
    """What a command says of a track besides: how it was read, notes, and doubts with the likely mistake."""

    name: str
    reading: str = ""
    notes: Sequence[str] = ()
    doubts: Sequence[str] = ()


def picture(view: View, told: Told) -> Drawing:
    """The picture with name, reading, doubts and notes."""
    title = f"{told.name}: {told.reading}" if told.reading else told.name
    remarks = [*(f"doubt: {text}" for text in told.doubts), *(f"note: {text}" for text in told.notes)]
    more = len(remarks) - _MOST_REMARKS
    return draw(view, title, [*remarks[:_MOST_REMARKS], *([f"and {more} more"] if more > 0 else [])])


def pages(view: View, told: Told, impacts: pd.DataFrame | None) -> dict[str, str | bytes]:
    """The files by name: the picture as SVG and PNG, and the page.

    ``impacts`` is the table of impacts; None where there are no conditions for it.
    """
    drawing = picture(view, told)
    page = render(
        "look.html.j2",
        title=f"Look at {told.name}",
        command="restitution look TRACK --out FOLDER",
        told=told,
        view=view,
        figure=drawing.svg,
        alternative=_alternative(view),
        impacts=None if impacts is None else list(impacts.itertuples()),
        flights=_flights(view),
        number=number,
    )
    return {"figure.svg": drawing.svg, "figure.png": drawing.png, "index.html": page}


def _alternative(view: View) -> str:
    what = "gap" if view.track.quantity == "gap" else "velocity"
    t, touches = view.track.time_s, view.touches
    at = f" at {', '.join(f'{touch.time_s:.4g}' for touch in touches)} s" if touches else ""
    return f"{len(t)} frames of {what} from {t[0]:.4g} to {t[-1]:.4g} s; {len(touches)} contacts{at}"


def _flights(view: View) -> list[dict]:
    """One row a flight between two contacts."""
    rows = []
    for touch, flight in zip(view.touches, view.flights, strict=False):
        share = flight.acceleration / -view.free_fall if view.free_fall else math.nan
        rows.append(
            {
                "after": touch.number, "duration": number(1e3 * (flight.end - flight.begin), 2),
                "apex": number(1e3 * flight.top_m, 3), "acceleration": number(flight.acceleration, 3),
                "error": number(flight.error, 3), "share": number(share, 3),
            }
        )  # fmt: skip
    return rows
