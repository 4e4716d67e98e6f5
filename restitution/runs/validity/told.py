"""What the solver is told of a case, as numbers and words by name: a kept run holds only as long as these agree.

Closures, drive and rebound are functions; the solver's description of itself has them by their values at some
arguments (:meth:`lbm.spheres.Spheres.describe`). So a law, a record or the rules of a case may be rewritten at
will, as long as no number that reaches the solver changes.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from restitution.cases.case import Case
from restitution.runs.flow_pictures import AFTER_D, BEFORE_D, HALF_WIDTH_D, HEIGHT_D
from restitution.runs.setup import Setup, set_up

Entry = Sequence[float | str]

AGREE = 1e-9
"""Largest relative difference that counts as none: the libraries' last digits.

Measured between the oldest and the newest supported numpy and scipy: 2e-13. A change of a law's constant by 1e-6
is a thousand times larger.
"""
_NOTHING = 1e-13
"""What counts as zero, over the largest number of an entry."""
_DIGITS = 13
"""Digits kept of each number."""


def told(case: Case) -> dict[str, list[float | str]]:
    """Everything that decides the run of a case but the program, by name; nothing without ``[numerics]``."""
    if case.numerics is None:
        return {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of numbers that the solver doubts: said when the case is run
        setup = set_up(case)
    content: dict[str, list[float | str]] = {}
    for name, value in _named(_content(case, setup)):
        content.setdefault(name, []).append(value)
    return content


def departures(kept: Mapping[str, Entry], now: Mapping[str, Entry]) -> list[str]:
    """Names of the entries in which two cases differ: one is missing, or by more than :data:`AGREE`."""
    return [name for name in sorted({*kept, *now}) if not _agree(kept.get(name, []), now.get(name, []))]


def _content(case: Case, setup: Setup) -> dict[str, Any]:
    return setup.describe() | {
        "span: s after contact, s in all": [case.run.after_contact, case.run.duration],
        "floor, m": case.floor,
        "steps from row to row": setup.rows_apart,
        "pictures, d": [BEFORE_D, AFTER_D, HALF_WIDTH_D, HEIGHT_D],
    }


def _named(content: Any, name: str = "") -> Iterator[tuple[str, float | str]]:
    """Every number and word of a nested description under its name, in order."""
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield from _named(value, f"{name}.{key}" if name else key)
    elif isinstance(content, Sequence) and not isinstance(content, str):
        for value in content:
            yield from _named(value, name)
    elif content is None or isinstance(content, str):
        yield name, content or ""
    else:
        yield name, float(f"{content:.{_DIGITS}g}") + 0.0  # no minus before a zero


def _agree(one: Entry, other: Entry) -> bool:
    if [isinstance(v, str) for v in one] != [isinstance(v, str) for v in other]:
        return False
    nothing = _NOTHING * max((abs(v) for v in one if not isinstance(v, str)), default=0.0)
    pairs = zip(one, other, strict=True)
    return all(a == b if isinstance(a, str) else abs(a - b) <= AGREE * abs(a) + nothing for a, b in pairs)
