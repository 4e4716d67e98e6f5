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
_RULE = re.compile(r"[|+\s]*:?[-=]{3,}:?([|+\s]+:?[-=]{3,}:?)*[|+\s]*")
"""A line drawn in a table for readers: of Markdown, of databases, of reports."""
_WORD = re.compile(r'"[^"]*"|\S+')
_BRACKETS = re.compile(r"[()]")
_VECTOR = re.compile(r"\([^()]*\)")
_IN_CELL = re.compile(r"[(\[]([^()\[\]]*)[)\]]")
_OF_NUMPY = re.compile(r"(?:np|numpy)\.\w+\(([^()]*)\)")


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
        elif text and not (
            (text[0] in 'sS"' and _SEPARATOR_LINE.fullmatch(text.rstrip()))
            or (text[0] in "|+-=:" and _RULE.fullmatch(text.rstrip()))
        ):
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


def cuts(text: str, layout: Layout) -> list[list[str]]:
    """Ways to cut a comment into names, the separator of the data first; brackets stay with their word."""
    if layout.vectors:
        return vector_names(text, layout)
    together = re.sub(r"\s+([(\[])", r"\1", text)
    wide = [re.split(r"\s{2,}", text.strip())] if layout.separator == " " else []  # names of several words
    ways = [layout.separator, *(s for s in SEPARATORS if s != layout.separator)]
    cuts = [split(line, separator) for separator in ways for line in (text, together)]
    return [
        cells for cells in (*cuts[:2], *wide, *cuts[2:]) if len(cells) > 1 and not cells[0].endswith((",", ";"))
    ]


def vector_names(text: str, layout: Layout) -> list[list[str]]:
    """Names of a row of vectors: "position" over (1 2 3) becomes position_x, position_y, position_z."""
    groups = re.findall(r"\([^()]*\)|[^\s()]+", next(line for line in reversed(layout.lines) if line.strip()))
    sizes = [len(group.strip("()").split()) for group in groups]
    words = re.findall(r"\([^()]*\)|[^\s()]+", text)
    words = ["Time", *words[1:]] if words[:1] == ["Probe"] else words
    if len(words) != len(sizes):
        return []
    names: list[str] = []
    for word, size in zip(words, sizes, strict=True):
        parts = word.strip("()").split()
        names += parts if len(parts) == size else [part_of(word, k, size) for k in range(size)]
    return [names]


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


def vectors_apart(
    names: list[str], rows: list[tuple[int, list[str]]]
) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Columns of vectors, "(320, 456.25)" or "[320. 456.25]" as Python prints them, as one for each number."""
    for at in reversed(range(len(names))):
        cells = [row[at] for _, row in rows if len(row) == len(names)]
        if len(cells) < len(rows) or not (told := [cell for cell in cells if not is_lost(cell)]):
            continue
        width = len(_numbers_in(told[0]))
        if width < 2 or any(len(_numbers_in(cell)) != width for cell in told):
            continue
        lost = [""] * width
        rows = [(line, [*row[:at], *(_numbers_in(row[at]) or lost), *row[at + 1 :]]) for line, row in rows]
        names = [*names[:at], *(part_of(names[at], k, width) for k in range(width)), *names[at + 1 :]]
    return names, rows


def part_of(name: str, k: int, width: int) -> str:
    """The column of a vector's ``k``-th number: _x, _y, _z where there are no more, else by number."""
    return f"{name}_{'xyz'[k] if width <= 3 else k + 1}"


def _numbers_in(cell: str) -> list[str]:
    """The numbers of a vector; none where the cell is another thing."""
    match = _IN_CELL.fullmatch(_OF_NUMPY.sub(r"\1", cell.strip())) if cell[:1] in ("(", "[") else None
    parts = re.split(r"\s*[,;]\s*|\s+", match[1].strip()) if match else []
    return parts if all(map(is_number, parts)) else []
