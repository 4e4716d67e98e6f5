"""Trajectories side by side against their record: a figure, a page, and ``scores.json``."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from restitution import __version__, datasets
from restitution.bounce.agreement import UNTIL
from restitution.impacts.bounces import Bounces
from restitution.report.drawing import Drawing, as_text, save, style
from restitution.report.fig2.scores import BOUNCES
from restitution.report.page import percent
from restitution.report.page import render as render_page
from restitution.validation.page import shown
from restitution.validation.rebound import record_bounces
from restitution.validation.trajectory import Scored
from restitution.validation.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILES = ("index.html", "figure.svg", "figure.png", "scores.json")
LINES = ("-", "--", "-.", ":")
"""Of one trajectory after the other; from the fifth on they are told apart by their greys too."""
_GREYS = ("black", "#777777")
_BEFORE = -2.0
"""Earliest beginning of the figure in t* before the first contact."""
_BESIDE = 0.4
"""Of it, beside what is shown."""
_LONGER = 2.0
"""Times the record's bounces up to which those of a trajectory are shown."""


def files(scored: Sequence[Scored]) -> dict[str, str | bytes]:
    """All that is written, by name; the trajectories are of one case."""
    drawing = _draw(scored)
    record = datasets.resource(scored[0].case.record)
    page = render_page(
        "trajectories.html.j2",
        title=f"Trajectories beside {scored[0].case.record}",
        command="restitution validate --trajectory FILE --case CASE",
        figure=drawing.svg,
        scored=scored,
        record=record,
        rows=rows(scored),
        tolerance=scored[0].judged.row.tolerance,
    )
    return dict(zip(FILES, (page, drawing.svg, drawing.png, _text(scored)), strict=True))


def rows(scored: Sequence[Scored]) -> list[dict[str, Any]]:
    """One a quantity: the record's value with its error, and each trajectory's with deviation and verdict."""
    found = []
    for reference in scored[0].judged.row.truth():
        bound = reference.side == "at most"
        cells = []
        for one in scored:
            value = one.values.get(reference.label)
            off = math.nan if value is None or bound else value / reference.value - 1
            verdict = one.judged.truth_by_label[reference.label]
            cells.append({"value": shown(value), "off": percent(off), "verdict": verdict})
        held = f"\N{LESS-THAN OR EQUAL TO} {shown(reference.value)}"
        if not bound:
            held = f"{shown(reference.value)} \N{PLUS-MINUS SIGN} {reference.tolerance:.2g}"
        found.append({"label": reference.label, "record": held, "cells": cells})
    return found


def _text(scored: Sequence[Scored]) -> str:
    content = {
        "restitution": __version__,
        "case": scored[0].case.name,
        "record": scored[0].case.record,
        "tolerance": scored[0].judged.row.tolerance,
        "trajectories": [
            {
                "name": one.name,
                "values": one.values,
                "verdicts": {k: str(v) for k, v in one.judged.truth_by_label.items()},
                "notes": list(one.notes),
            }
            for one in scored
        ],
        "references": {
            r.label: {"value": float(r.value), "tolerance": float(r.tolerance), "side": r.side}
            for r in scored[0].judged.row.truth()
        },
    }
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def _draw(scored: Sequence[Scored]) -> Drawing:
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(7.5, 4.2), layout="constrained")
        fill(figure.subplots(), scored)
        return save(figure)


def fill(ax: Axes, scored: Sequence[Scored]) -> None:
    """Frames of the record and lines of the trajectories, as far as they are scored."""
    case = scored[0].case
    d, unit = case.sphere.diameter, math.sqrt(case.sphere.diameter / case.gravity)
    record, error = record_bounces(case.record), datasets.resource(case.record).digitisation_error
    sigma = error.sigma.get("gap_m", 0.0) / d
    begin, end = _span(record, [one.bounces for one in scored], unit)
    t = (record.time_s - record.contacts_s[0]) / unit
    near = (t >= begin) & (t <= end)
    ax.errorbar(
        t[near], record.gap_m[near] / d, yerr=sigma, fmt="s", ms=4, mfc="white", mec="black", ecolor="black",
        elinewidth=0.8, label=f"measured: {case.record}", zorder=1,
    )  # fmt: skip
    for k, one in enumerate(scored):
        t = (one.bounces.time_s - one.bounces.contacts_s[0]) / unit
        near = (t >= begin) & (t <= end)
        ax.plot(
            t[near], one.bounces.gap_m[near] / d, LINES[k % len(LINES)],
            color=_GREYS[k // len(LINES) % len(_GREYS)], label=as_text(one.name), zorder=2 + k,
        )  # fmt: skip
    ax.set_xlabel(r"time after the first contact, $t\,\sqrt{g/d}$  [-]")
    ax.set_ylabel(r"gap, $h/d$  [-]")
    ax.set_xlim(begin, end)
    highest = max(record.apexes_m)
    apexes = [apex for one in scored for apex in one.bounces.apexes_m if apex < _LONGER * highest]
    ax.set_ylim(bottom=0, top=1.25 * max(highest, *apexes) / d)
    ax.legend(loc="upper right", fontsize=8.5)


def _span(record: Bounces, flown: Sequence[Bounces], unit: float) -> tuple[float, float]:
    """From the approach to the end of the last flight that is scored, of whichever takes longer, in t*."""
    theirs = [_last(one) / unit for one in flown]
    end = max(UNTIL, _last(record) / unit)
    end = min(max(end, *theirs), _LONGER * end) + _BESIDE
    first = min((one.time_s[0] - one.contacts_s[0]) / unit for one in (record, *flown))
    return max(_BEFORE, first - _BESIDE), end


def _last(found: Bounces) -> float:
    """Seconds from the first contact to the end of the last flight that is scored, or of the trajectory."""
    ends = found.contacts_s[BOUNCES] if len(found.contacts_s) > BOUNCES else found.time_s[-1]
    return float(ends - found.contacts_s[0])


def verdict_of(scored: Sequence[Scored]) -> Verdict:
    """Of all trajectories together: not evaluated, where one does not reach what the record has, is no pass."""
    if any(one.missed for one in scored):
        return Verdict.FAIL
    return Verdict.NOT_EVALUATED if any(one.left_open for one in scored) else Verdict.PASS
