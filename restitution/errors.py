"""What can be wrong with a user's input, said so that it can be mended: file, row, field, value, rule.

Everything that a user can get wrong raises :class:`InputError` (or a subclass); the command line turns it
into one line a defect and exit status 2. Any other exception is a defect of this package.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass, replace

MOST_LINES = 20
"""Defects that are printed; of more, how many there are."""
LONGEST_VALUE, LONGEST_PLACE, LONGEST_RULE = 80, 300, 600
"""Characters of what is printed of one defect."""
MOST_APART = 100
"""Rows with one defect that are told apart; of more, how many there are, for a file may have millions."""


def printable(text: str, most: int | None = None, keep: str = "") -> str:
    r"""A text of a user's as it can be printed on one line: no control characters but those to ``keep``.

    They are shown as Python writes them, ``\x1b``; a text longer than ``most`` characters is cut, which is said.
    """
    if most is not None and len(text) > most:
        text = f"{text[: most - 20]}... ({len(text)} characters)"
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() or c in keep else c.encode("unicode_escape", "surrogatepass").decode() for c in text
    )


@dataclass(frozen=True)
class Defect:
    """One thing wrong at one place. ``row`` is the line number in the file, the header being row 1.

    ``others`` are further rows with the same one, in order.
    """

    rule: str
    _: KW_ONLY
    file: str | None = None
    row: int | None = None
    field: str | None = None
    value: str | None = None
    others: tuple[int, ...] = ()

    def __str__(self) -> str:
        place = printable(":".join(str(p) for p in (self.file, self.row) if p is not None), LONGEST_PLACE)
        what = [
            printable(self.field, LONGEST_VALUE) if self.field is not None else "",
            f"= '{printable(self.value, LONGEST_VALUE)}'" if self.value is not None else "",
        ]
        subject = " ".join(w for w in what if w)
        rule = printable(self.rule, LONGEST_RULE)
        if self.others:
            more = "row" if len(self.others) == 1 else "rows"
            rule += f" (and {len(self.others)} more {more}, the last {self.others[-1]})"
        return ": ".join(part for part in (place, subject, rule) if part)


Rule = str | Callable[[int], str]
"""What is wrong in some rows, by the index into them where it differs from row to row."""


def of_rows(
    rule: Rule,
    rows: Sequence[int],
    values: Callable[[int], str] | None = None,
    *,
    file: str | None = None,
    field: str | None = None,
) -> Iterator[Defect]:
    """One thing wrong in many rows of a file: a defect each of the first :data:`MOST_APART`, one for all others.

    What differs from row to row, ``rule`` or ``values``, is told by the index into ``rows``.
    """
    for i, row in enumerate(rows[:MOST_APART]):
        here = rule if isinstance(rule, str) else rule(i)
        value = None if values is None else values(i)
        others = tuple(rows[MOST_APART:]) if i == MOST_APART - 1 else ()
        yield Defect(here, file=file, row=row, field=field, value=value, others=others)


def by_cause(defects: Iterable[Defect]) -> list[Defect]:
    """One defect a cause: of those that differ by row and value alone, the first, with how many rows have it."""
    causes: dict[tuple, list[Defect]] = {}
    for number, defect in enumerate(defects):
        own = number if defect.row is None else None
        key = (defect.file, defect.field, re.sub(r"\d+(\.\d+)?", "#", defect.rule), own)
        causes.setdefault(key, []).append(defect)
    return [_joined(group) for group in causes.values()]


def _joined(group: Sequence[Defect]) -> Defect:
    first, *rest = group
    if not rest:
        return first
    return replace(
        first, others=tuple(sorted([*first.others, *(row for d in rest for row in (d.row or 0, *d.others))]))
    )


def first_of(defects: Iterable[Defect]) -> list[Defect]:
    """What is to be printed: one defect a cause, of many causes the first, and how many more there are."""
    causes = by_cause(defects)
    if len(causes) <= MOST_LINES:
        return causes
    return [*causes[: MOST_LINES - 1], Defect(f"and {len(causes) - MOST_LINES + 1} more")]


class InputError(ValueError):
    """The input cannot be used. ``defects`` lists everything found wrong, in the order of the file."""

    def __init__(self, *defects: Defect | str):
        self.defects = tuple(d if isinstance(d, Defect) else Defect(d) for d in defects)
        super().__init__(*self.defects)

    def __str__(self) -> str:
        return "\n".join(str(d) for d in self.defects)


class ConventionError(InputError):
    """A Stokes number or an impact speed of one definition was given where another is needed."""


class OutOfRangeError(InputError):
    """A law was evaluated outside its validity range and the caller asked to be told by an error."""


class OutOfRangeWarning(UserWarning):
    """A law was evaluated outside its validity range."""


class StoppedError(RuntimeError):
    """A run could not go on; what it has is written. The message says why, in one line."""


class DivergedError(StoppedError):
    """A run whose flow has diverged: it would do so again."""
