"""Acoustic stopwatches that write the times of one experiment side by side (phyphox), as a table of bounces."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import accumulate, pairwise

from restitution.errors import Defect, InputError
from restitution.foreign.number_text import as_number, is_lost

_TIME = re.compile(r"(start|(?:stop|bounce|time) \d+) ?\(s\)", re.IGNORECASE)


def is_stopwatch(names: Sequence[str]) -> bool:
    """Whether the columns are "Start (s)", "Stop 1 (s)", ..., or "Bounce 0 (s)", "Height 0 (m)", ...: phyphox."""
    return sum(bool(_TIME.fullmatch(name)) for name in names) > 1


def bounces(
    names: Sequence[str], rows: Sequence[tuple[int, list[str]]], file: str
) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Names and rows of the bounces, the first sound being the first contact; times that are missing end it.

    Times that do not grow are those between the contacts, of flight after flight (phyphox's inelastic collision).
    """
    filled = [(line, cells) for line, cells in rows if len(cells) == len(names)]
    if len(filled) != 1:
        rule = f"has {len(filled)} experiments of times side by side: keep one of its rows"
        raise InputError(Defect(rule, file=file, row=filled[1][0] if filled else 1))
    line, cells = filled[0]
    times = [cell for name, cell in zip(names, cells, strict=True) if _TIME.fullmatch(name)]
    lost = next((n for n, cell in enumerate(times) if is_lost(cell)), len(times))
    seen = times[:lost]
    values = [as_number(cell) for cell in seen]
    if len(seen) > 1 and all(later < earlier for earlier, later in pairwise(values)):
        seen = [f"{time:.9g}" for time in accumulate([0.0, *values])]
    return ["bounce", "time (s)"], [(line, [f"{n}", time]) for n, time in enumerate(seen, 1)]
