"""How the rows of a text are cut into cells: which sign stands between columns, which in numbers.

Each way of cutting is tried on the body of the file. It must give rows of one width, of two columns or more; of
those that do, the one whose cells are numbers most is taken, tabs before semicolons, commas and spaces.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from restitution.errors import Defect, InputError
from restitution.foreign.number_text import Decimal, decimal_of, has_thousands, is_lost, is_number
from restitution.tables.csv_text import Cells
from restitution.units import NUMBER

SEPARATORS = {"\t": "tabs", ";": "semicolons", "|": "bars", ",": "commas", " ": "spaces"}
COMMENTS = ("#", "%", "//")
_SAMPLE = 200
"""Lines of the body that are tried."""
_SAME_WIDTH = 0.8
"""Part of the rows that must have as many cells as most have."""
_SEPARATOR_LINE = re.compile(r'"?sep=.{0,2}"?', re.IGNORECASE)
_WORD = re.compile(r'"[^"]*"|\S+')
_BRACKETS = re.compile(r"[()]")
_VECTOR = re.compile(r"\([^()]*\)")


class Row(NamedTuple):
    """One line that is no comment, as cells; ``line`` counts from 1."""

    line: int
    cells: list[str]


@dataclass
class Layout:
    """A text cut into rows. ``comments`` are the lines that begin with # or %, without that sign."""

    file: str
    separator: str
    rows: list[Row]
    comments: list[tuple[int, str]]
    width: int
    decimal: Decimal = "."
    vectors: bool = False
    lines: Sequence[str] = field(default=(), repr=False)
    odd: frozenset[str] = field(default=frozenset(), repr=False)
    """All cells that are no plain numbers, each once."""
    kept: str = ""
    """How it was kept where that was no text: "JSON", which sheet of a spreadsheet."""

    @property
    def body(self) -> list[Row]:
        """The last rows, which are data if any are."""
        return self.rows[-_SAMPLE:]


def layout_of(
    lines: Sequence[str],
    file: str,
    decimal: Decimal | None = None,
    only: Sequence[int] | None = None,
    kept: str = "",
) -> Layout:
    """Cut the lines of a file, or ``only`` those of these numbers; ``decimal`` overrides what its numbers say."""
    plain_lines, comments = [], []
    for number, line in enumerate(lines, 1) if only is None else ((n, lines[n - 1]) for n in only):
        text = line.lstrip()
        if text.startswith(COMMENTS):
            mark = next(mark for mark in COMMENTS if text.startswith(mark))
            comments.append((number, text.lstrip(mark).strip()))
        elif text and not (text[0] in 'sS"' and _SEPARATOR_LINE.fullmatch(text.rstrip())):
            plain_lines.append((number, line))
    vectors = any(_VECTOR.search(line) for _, line in plain_lines[-3:]) and _all_vectors(plain_lines[-_SAMPLE:])
    separator = " " if vectors else _separator([line for _, line in plain_lines[-_SAMPLE:]])
    known = Cells()
    rows = _cut(plain_lines, separator, file, known)
    width = _width([row.cells for row in rows[-_SAMPLE:]])[0]
    odd = frozenset(cell for cell in known.values() if not NUMBER.fullmatch(cell))
    layout = Layout(file, separator, rows, comments, width, vectors=vectors, lines=lines, odd=odd, kept=kept)
    layout.decimal = decimal or _decimal(layout)
    return layout


def split(line: str, separator: str) -> list[str]:
    """One line as cells."""
    if separator == " ":
        return [word.strip('"') for word in _WORD.findall(line)]
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]


def _all_vectors(lines: Sequence[tuple[int, str]]) -> bool:
    """Whether rows are numbers and brackets of numbers, as OpenFOAM writes them."""
    numbers = [all(is_number(word) for word in _BRACKETS.sub(" ", line).split()) for _, line in lines]
    return sum(numbers) >= _SAME_WIDTH * len(numbers)


def _separator(lines: Sequence[str]) -> str:
    lines = lines[len(lines) // 2 :]  # the head of a file is cut in other ways than its body
    best, best_score = ",", (0.0, 0)
    for separator in SEPARATORS:
        try:
            rows = [split(line, separator) for line in lines]
        except csv.Error:
            continue
        width, share = _width(rows)
        cells = [cell for row in rows if len(row) == width for cell in row if cell]
        if width < 2 or share < _SAME_WIDTH or not cells:
            continue
        numbers = sum(is_number(cell) or has_thousands(cell) for cell in cells)
        score = (round(numbers / len(cells), 2), separator != " ")
        if score > best_score:
            best, best_score = separator, score
    return best


def _width(rows: Sequence[list[str]]) -> tuple[int, float]:
    """The most frequent number of cells, and the part of the rows that have it."""
    if not rows:
        return 0, 0.0
    width, count = Counter(map(len, rows)).most_common(1)[0]
    return width, count / len(rows)


def _cut(lines: Sequence[tuple[int, str]], separator: str, file: str, known: Cells) -> list[Row]:
    if separator == " ":
        return [
            Row(number, [known[cell] for cell in split(_BRACKETS.sub(" ", line), " ")]) for number, line in lines
        ]
    reader = csv.reader(
        (line + "\n" for _, line in lines), delimiter=separator, skipinitialspace=True, strict=True
    )
    rows, first = [], 0  # a quoted cell may span lines; a row is named by its first
    try:
        for cells in reader:
            rows.append(Row(lines[first][0], [known[cell] for cell in cells]))
            first = reader.line_num
    except csv.Error as error:
        rule = f"is not a table separated by {SEPARATORS[separator]} from here on: {error}"
        raise InputError(Defect(rule, file=file, row=lines[first][0])) from None
    return rows


def _decimal(layout: Layout) -> Decimal:
    """The decimal sign of the body; raises where it is not clear."""
    rows = [row for row in layout.rows if len(row.cells) == layout.width]
    thousands = {cell for cell in layout.odd if has_thousands(cell)}
    for row in rows if thousands else ():
        for cell in row.cells:
            if cell in thousands and _beside_numbers(row, cell):
                rule = "has thousands separators: write the number without them"
                raise InputError(Defect(rule, file=layout.file, row=row.line, value=cell))
    if not any("," in cell for cell in layout.odd):
        return "."
    decimal, doubt = decimal_of(dict.fromkeys(cell for row in rows for cell in row.cells))
    if decimal is None:
        raise InputError(Defect(f"{doubt} (decimal = ',' or '.' in a settings file says so)", file=layout.file))
    return decimal


def _beside_numbers(row: Row, cell: str) -> bool:
    """Whether the other cells of a row are numbers, so that this one is meant to be."""
    return all(is_number(other) or is_lost(other) or has_thousands(other) for other in row.cells if other != cell)
