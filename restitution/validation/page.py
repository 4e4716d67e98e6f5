"""The page of a scorecard: every row with its verdicts, its numbers and its small plot, in one file."""

from __future__ import annotations

import math

from restitution.report.page import render as render_page
from restitution.validation.plot import draw
from restitution.validation.scorecard import Judged, Scorecard
from restitution.validation.verdict import Verdict

_NAMED = 5
STATUS = {
    0: "Nothing fails: every row passes, or is a known miss that has not moved.",
    1: "Not as it should be:",
    3: "Something was not evaluated, or there is no baseline for it.",
}


def render(card: Scorecard) -> str:
    """The whole page as text."""
    return render_page(
        "validation.html.j2",
        title="Did the change spoil the solver?",
        command="restitution validate",
        card=card,
        made=card.made,
        status=_status(card),
        verdicts=list(Verdict),
        rows=[_row(judged) for judged in card.rows],
    )


def _status(card: Scorecard) -> str:
    """What the scorecard comes to, naming the first rows that fail."""
    failed = [judged.row.name for judged in card.rows if Verdict.FAIL in (judged.truth, judged.baseline)]
    more = f" and {len(failed) - _NAMED} more" if len(failed) > _NAMED else ""
    return STATUS[card.status] + (f" {', '.join(failed[:_NAMED])}{more}." if failed else "")


def _row(judged: Judged) -> dict[str, object]:
    found = judged.result.numbers or {}
    values = [
        {
            "label": r.label, "value": shown(found.get(r.label)), "reference": _reference(r),
            "truth": judged.truth_by_label[r.label], "baseline": judged.baseline_by_label[r.label],
            "known": judged.row.known.get(r.label, ""),
            "held": shown(judged.held[r.label].value) if judged.held and r.label in judged.held else "",
        }
        for r in judged.row.truth()
    ]  # fmt: skip
    return {"judged": judged, "row": judged.row, "values": values, "plot": draw(judged)}


def shown(value: float | None) -> str:
    """A value in four digits; a dash where there is none."""
    if value is None or math.isnan(value):
        return "–"
    return f"{value:.4g}".replace("-", "\N{MINUS SIGN}")


def _reference(reference) -> str:
    if reference.side != "both":
        return f"{'|x| ≤' if reference.side == 'at most' else '≥'} {shown(reference.value)}"
    return f"{shown(reference.value)} ± {reference.tolerance:.2g}"
