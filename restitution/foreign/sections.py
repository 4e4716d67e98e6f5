"""Tables one below another in one file, each under its own names: curves of a digitizer, tracks, runs of a log.

Two rows of data with other lines between them belong to different tables where those lines have

- names of the columns that are not those above, and begin alike or follow an empty line (two, in a comment);
- the same names once more, under a title, or before a time that goes back;
- names, a title or an empty line before a time that goes back.

Time is the first column that never falls between such lines. Names that a program repeats every so many rows,
comments and empty lines amid the frames of one track divide nothing.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from itertools import pairwise

from restitution.foreign.heading import are_units, are_words, numeric_columns
from restitution.foreign.layout import Layout, Row, cuts, layout_of
from restitution.foreign.number_text import is_lost, is_number, plain

_LONGEST = 40
"""Characters of a title; longer lines are prose."""


@dataclass(frozen=True)
class Section:
    """One table: its lines from ``begin`` up to ``end``, counted from 1, and how many are data."""

    name: str
    begin: int
    end: int
    rows: int
    names: list[str] | None
    """Of its columns; None where no line names them."""
    repeated: frozenset[int]
    """Lines within it that name the columns once more."""
    head: int
    """Up to which line what is above the first table is above this one: its names, or the mark of a program."""

    def layout(self, of: Layout) -> Layout:
        """Its own layout, lines counted as in the whole file."""
        own = (n for n in range(max(self.begin, self.head), self.end) if n not in self.repeated)
        return layout_of(of.lines[: self.end - 1], of.file, of.decimal, [*range(1, self.head), *own], of.kept)


@dataclass(frozen=True)
class _Break:
    """The lines between two rows of data, the second of which is the ``at``-th, or before the first."""

    at: int
    begin: int
    """The first of these lines; that of the row where they name no columns."""
    names: list[str] | None
    named_in: frozenset[int]
    title: str
    empty: int


def sections(layout: Layout) -> list[Section]:
    """The tables of a text with their names; one alone, or none, where it is a single table."""
    numeric = numeric_columns(layout)
    lost = {cell for cell in layout.odd if is_lost(cell)}
    words = {cell for cell in layout.odd if not is_number(cell)}
    data = [row for row in layout.rows if _is_data(row, numeric, lost, words)]
    breaks = _breaks(layout, data)
    if len(breaks) < 2:
        return []
    ends = [b.at for b in breaks[1:]] + [len(data)]
    clock = _clock([data[b.at : end] for b, end in zip(breaks, ends, strict=True)], numeric, layout)
    parts, names, repeated = [breaks[0]], breaks[0].names, set[int]()
    for here in breaks[1:]:
        back = clock is not None and _time(data[here.at], clock, layout) < _time(data[here.at - 1], clock, layout)
        divides = back
        if here.names is not None and names is not None and here.names != names:
            divides |= here.names[0] == names[0] or here.empty > 0
        elif here.names is not None:
            divides |= bool(here.title) or clock is None
        if divides:
            parts.append(here)
            names = here.names or names
        elif here.names is not None and here.names == names:
            repeated |= here.named_in
    if len(parts) == 1 and not repeated:
        return []
    first, ends = parts[0], [b.begin for b in parts[1:]] + [len(layout.lines) + 1]
    mark = 2 if first.names and 1 not in first.named_in else 0
    counts = [b - a for a, b in pairwise([*(b.at for b in parts), len(data)])]
    return [
        Section(name, b.begin, end, n, b.names, frozenset(repeated), mark if b.names else data[0].line)
        for name, b, end, n in zip(_called(parts), parts, ends, counts, strict=True)
    ]


def _is_data(row: Row, numeric: list[int], lost: set[str], words: set[str]) -> bool:
    """Whether a row has numbers where the body has them, for the most part."""
    width = len(row.cells)
    if width < 2:
        return False
    filled = [cell for i in numeric if i < width and (cell := row.cells[i]) not in lost]
    return bool(filled) and 2 * sum(cell in words for cell in filled) < len(filled)


def _breaks(layout: Layout, data: list[Row]) -> list[_Break]:
    """Where something else than frames stands: what is above the first row of data, and between others."""
    if not data:
        return []
    known = {row.line for row in data}
    others = [(row.line, row.cells, "") for row in layout.rows if row.line not in known]
    others = sorted([*others, *((line, [], text) for line, text in layout.comments)])
    found, k = [], 0
    for at, row in enumerate(data):
        before = data[at - 1].line if at else 0
        if at and row.line == before + 1:
            continue
        mine = []
        while k < len(others) and others[k][0] < row.line:
            mine.append(others[k])
            k += 1
        empty = sum(not line.strip() for line in layout.lines[before : row.line - 1])
        if not at or mine or empty:
            found.append(_break(at, before + 1, mine, empty, row, found[0].names if found else None, layout))
    return found


def _break(
    at: int,
    begin: int,
    lines: list[tuple[int, list[str], str]],
    empty: int,
    row: Row,
    first: list[str] | None,
    layout: Layout,
) -> _Break:
    """What the lines before a row of data are: names of its columns, units of them, a title."""
    named: dict[int, list[str]] = {}
    titles, units = dict[int, str](), set[int]()
    for line, cells, comment in lines:
        ways = cuts(comment, layout) if comment else [cells]
        whole = next((w for w in ways if len(w) == len(row.cells) and all(w) and are_words(_by_place(w))), None)
        if whole is not None and are_units(_by_place(whole)):
            units.add(line)
            continue
        if whole is not None:
            named[line] = whole
        text = comment or " ".join(filter(None, cells))
        if 0 < len(text) <= _LONGEST and not any(map(is_number, cells)):
            titles[line] = text
    alike = [line for line, names in named.items() if first is not None and names[0] == first[0]]
    comments = {number for number, _, text in lines if text}
    line = (alike or [n for n in named if n not in comments] or list(named) or [0])[-1]
    if line in comments and first is not None and not alike and empty < 2:
        line = 0  # a title or a remark of as many words as there are columns
    title = next((text for at_line, text in reversed(titles.items()) if at_line != line), "")
    return _Break(at, begin if line else row.line, named.get(line), frozenset({line, *units}), title, empty)


def _by_place(cells: list[str]) -> dict[int, str]:
    return dict(enumerate(cells))


def _clock(segments: list[list[Row]], numeric: list[int], layout: Layout) -> int | None:
    """The first column of numbers that never falls within a segment, and is not the same throughout."""
    for i in numeric:
        rises = False
        for rows in segments:
            times = [t for row in rows if not math.isnan(t := _time(row, i, layout))]
            if any(b < a for a, b in pairwise(times)):
                break
            rises |= bool(times) and times[0] < times[-1]
        else:
            if rises:
                return i
    return None


def _time(row: Row, column: int, layout: Layout) -> float:
    cell = plain(row.cells[column], layout.decimal) if column < len(row.cells) else ""
    return float(cell) if is_number(cell) else math.nan


def _called(parts: list[_Break]) -> list[str]:
    """Names of tables: those of the columns that are theirs alone, else their titles, else their numbers."""
    columns = [part.names or [] for part in parts]
    shared = set(columns[0]).intersection(*columns[1:])
    own = [", ".join(name for name in names if name not in shared) for names in columns]
    numbers = [f"{k}" for k in range(1, len(parts) + 1)]
    titles = [part.title or k for part, k in zip(parts, numbers, strict=True)]
    for names in (own, titles):
        if all(names):
            alike = {name for name, n in Counter(names).items() if n > 1}
            return [f"{name} ({k})" if name in alike else name for name, k in zip(names, numbers, strict=True)]
    return numbers
