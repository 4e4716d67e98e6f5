"""The line that names the columns, among titles, comments, names of tracks and rows of units.

The first row of data is the first whose cells are numbers where the body has numbers. The names are the nearest
line above it, comments too, with one cell for each column and most of them words; a row of units between the two
is read as such. Names above the names, each over several columns, are those of the tracks: ``mass_A/x``.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass, field

from restitution.errors import Defect, InputError
from restitution.foreign.file_text import mistaken
from restitution.foreign.layout import Layout, Row, cuts, split, vector_names
from restitution.foreign.number_text import is_lost, is_number
from restitution.foreign.programs import program_of
from restitution.units import UnitError, quantity

_NUMERIC = 0.5
"""Part of the filled cells of a column of numbers that are numbers; the others are defects, named one by one."""
FRAMES = {
    "frame": "frame", "frames": "frame", "fr": "frame", "pixel": "px", "pixels": "px", "px": "px",
    "sec": "s", "msec": "ms", "micron": "um", "microns": "um",
    "кадр": "frame", "кадры": "frame", "帧": "frame", "幀": "frame", "フレーム": "frame", "コマ": "frame",
    "프레임": "frame", "καρέ": "frame", "пиксель": "px", "пиксели": "px", "пикс": "px", "像素": "px",
    "画素": "px", "ピクセル": "px", "픽셀": "px",
}  # fmt: skip
"""Units that are none of SI, or have other names there."""
_LATTICE = ("d", "sqrt(d/g)")
"""Units of the sphere's own."""
_SUFFIX = re.compile(r"(?P<name>.+)_(?P<unit>s|ms|us|m|mm|cm|um|px)")
_BRACKETS = re.compile(r"(?P<name>.*?)\s*[(\[](?P<unit>[^()\[\]]+|sqrt\(d/g\))[)\]](?P<run>[^()\[\]]*)")
_SLASH = re.compile(r"(?P<name>[^/]+?)\s*/\s*(?P<unit>[^/]+|sqrt\(d/g\))")
_COMMA = re.compile(r"(?P<name>[^,]+?)\s*[,、]\s*(?P<unit>[^,]+)")


@dataclass
class Heading:
    """Names of the columns that have any content, by position; ``units`` are those that the file states."""

    names: dict[int, str]
    units: dict[int, str] = field(default_factory=dict)
    line: int | None = None
    """Line of the names; None where the file has none, and columns are called by their number."""
    commented: bool = False
    first_row: int = 0
    """Which of the rows of the layout is the first of data."""


def heading_of(layout: Layout) -> Heading:
    """The heading of a text; raises :class:`InputError` where no line has one name a column."""
    first = _first_data(layout)
    data = layout.rows[first:]
    if not data:  # a header and nothing below it
        first = len(layout.rows)
    width = max(layout.width, 1)
    filled = [i for i in range(width) if any(i < len(row.cells) and row.cells[i] for row in data)]
    above = [(row.line, row.cells) for row in layout.rows[:first]]
    heading = Heading({i: str(i + 1) for i in filled}, first_row=first)
    units: dict[int, str] = {}
    for at in range(len(above) - 1, -1, -1):
        line, cells = above[at]
        if layout.vectors:
            cells = next(iter(vector_names(layout.lines[line - 1], layout)), cells)
        placed = _placed(cells, width, filled)
        if placed is None and data:
            placed = _beside_row_names(cells, line, data[0], layout)
        if placed is None and layout.separator == " ":
            placed = _of_words(layout.lines[line - 1], width)
        if placed is None or not are_words(placed):
            continue
        if are_units(placed) and at > 0 and not units:
            units = {i: unit_of(text) for i, text in placed.items() if _is_unit(text)}
            continue
        if any(not placed.get(i) for i in filled) and any(_is_whole(c, width, filled) for _, c in above[:at]):
            continue  # remarks on the columns, as Origin has them below names and units
        known = next((j for j in range(at) if program_of(above[j][1]) and _placed(above[j][1], width, filled)), at)
        line, placed = above[known][0], _placed(above[known][1], width, filled) or placed
        heading.line, heading.names = line, _with_tracks(placed, [cells for _, cells in above[:known]])
        if not units:  # rows below the names that are no data are for the strict reader to name
            heading.first_row = at + 1
            while heading.first_row < first and _is_title(layout.rows[heading.first_row].cells, width):
                heading.first_row += 1
        break
    else:
        units = _from_comments(heading, layout, width, filled, data[0].line if data else len(layout.lines) + 1)
    if heading.line is None and above and not _are_settings([cells for _, cells in above]):
        _refuse(layout, above[-1], width)
    heading.names = {i: name for i, name in heading.names.items() if name or i in filled}
    heading.units = {i: unit for i, name in heading.names.items() if (unit := unit_in(name))} | units
    return heading


def unit_in(name: str) -> str | None:
    """The unit that the name of a column ends with: "t (s)", "gap [mm]", "y / mm", "y_mm", "gap/d", "h, mm"."""
    return _apart(name)[1]


def without_unit(name: str) -> str:
    """The name of a column without the unit that it ends with."""
    return _apart(name)[0]


def _apart(name: str) -> tuple[str, str | None]:
    plain_name = unicodedata.normalize("NFKC", name)  # brackets of full width
    for pattern in (_BRACKETS, _SLASH, _COMMA, _SUFFIX):
        if (match := pattern.fullmatch(plain_name)) and _is_unit(match["unit"]):
            return match["name"] + match.groupdict().get("run", ""), unit_of(match["unit"])
    return name, None


def _first_data(layout: Layout) -> int:
    """Which row is the first of data; the number of rows where none is."""
    numeric = numeric_columns(layout)
    for at, row in enumerate(layout.rows):
        cells = [row.cells[i] for i in numeric if i < len(row.cells)]
        numbers = sum(map(is_number, cells))
        filled = sum(1 for cell in cells if not is_lost(cell))
        if numbers and 2 * numbers > filled and len(row.cells) > 1:
            return at
    return len(layout.rows)


def numeric_columns(layout: Layout) -> list[int]:
    """Columns whose cells are mostly numbers in the later half of the body."""
    rows = [row.cells for row in layout.body if len(row.cells) == layout.width]
    rows = rows[len(rows) // 2 :]
    columns = []
    for i in range(layout.width):
        cells = [row[i] for row in rows if not is_lost(row[i])]
        if cells and sum(map(is_number, cells)) >= _NUMERIC * len(cells):
            columns.append(i)
    return columns


def _placed(cells: list[str], width: int, filled: list[int]) -> dict[int, str] | None:
    """Cells of a line above the data by column: one for each column, or one for each that has any content."""
    while len(cells) > width and not cells[-1]:
        cells = cells[:-1]
    if len(cells) == width:
        return dict(enumerate(cells))
    named = list(cells)
    while named and not named[-1]:
        named.pop()
    if len(named) == len(filled) and filled:
        return dict(zip(filled, named, strict=True))
    enough = 1 < len(named) <= width and set(filled) <= set(range(len(named)))
    return dict(enumerate(named)) if enough else None


def _of_words(text: str, width: int) -> dict[int, str] | None:
    """Names of several words above columns that spaces separate: each ends with two spaces, a tab, or its unit."""
    apart = re.split(r"\s{2,}|\t", text.strip())
    if len(apart) != width:
        apart, name = [], []
        for word in text.split():
            name.append(word)
            if unit_in(" ".join(name)) is not None:
                apart.append(" ".join(name))
                name = []
        apart += [" ".join(name)] if name else []
    return dict(enumerate(apart)) if len(apart) == width > 1 else None


def _beside_row_names(cells: list[str], line: int, first: Row, layout: Layout) -> dict[int, str] | None:
    """Names by column where the rows have names of their own, above which there is none: R quotes these, pandas
    leaves room above them.
    """
    head, body = layout.lines[line - 1], layout.lines[first.line - 1]
    apart = body.lstrip().startswith('"') or (layout.separator == " " and head[:1].isspace())
    short = len(cells) == layout.width - 1 == len(first.cells) - 1
    return dict(enumerate(["", *cells])) if apart and short and all(cells) else None


def _are_settings(above: list[list[str]]) -> bool:
    """Whether all lines are a name and its value, some of these numbers, as of Qualisys: none names columns."""
    return all(len(cells) == 2 for cells in above) and sum(is_number(cells[1]) for cells in above) > 1


def _is_whole(cells: list[str], width: int, filled: list[int]) -> bool:
    """Whether a line has a word for each column that has any content."""
    placed = _placed(cells, width, filled)
    return placed is not None and are_words(placed) and all(placed.get(i) for i in filled)


def _is_title(cells: list[str], width: int) -> bool:
    """Whether a line below the names is a title of what follows: one cell where there are several columns."""
    return len(cells) == 1 < width - 1 and not is_number(cells[0]) and not is_lost(cells[0])


def are_words(placed: dict[int, str]) -> bool:
    """Whether most cells of a line are no numbers."""
    texts = [text for text in placed.values() if text]
    return len(texts) > 0 and sum(map(is_number, texts)) < 0.5 * len(texts)


def are_units(placed: dict[int, str]) -> bool:
    """Whether cells are units: each is one, or all are in brackets and some are, as (mm) beside (counts)."""
    filled = [text for text in placed.values() if text]
    bracketed = all(text[0] in "([" and text[-1] in ")]" for text in filled)
    return all(map(_is_unit, filled)) or (bracketed and any(map(_is_unit, filled)))


def _from_comments(heading: Heading, layout: Layout, width: int, filled: list[int], before: int) -> dict[int, str]:
    """Names in the last comment above the data that has one for each column, however that line is separated.

    Returns the units of a comment below them.
    """
    units: dict[int, str] = {}
    for line, text in reversed([c for c in layout.comments if c[0] < before]):
        placed = _names_in(text, layout, width, filled)
        if placed is None:
            continue
        if not units and all(_is_unit(name) for name in placed.values()):
            units = {i: unit_of(name) for i, name in placed.items()}
            continue
        above = [
            cells for n, title in reversed(layout.comments) if n < line for cells in _wide(title, layout, width)
        ]
        heading.names, heading.line, heading.commented = _with_tracks(placed, above[::-1]), line, True
        return units
    return {}


def _wide(text: str, layout: Layout, width: int) -> list[list[str]]:
    """A comment cut as the columns are, where it has a cell for each."""
    cells = split(text, layout.separator)
    return [cells] if len(cells) == width else []


def _names_in(text: str, layout: Layout, width: int, filled: list[int]) -> dict[int, str] | None:
    """The names in a comment by column; its sign may be the first of them. None if it has none."""
    for cells in cuts(text, layout):
        for named in (cells, ["#", *cells]):
            placed = _placed(named, width, filled)
            if placed is not None and are_words(placed) and all(placed.get(i) for i in filled):
                return placed
    return None


def _with_tracks(names: dict[int, str], above: list[list[str]]) -> dict[int, str]:
    """Names of columns under those of tracks, the nearest line first, until no name stands for two columns.

    The first column is the time that all share, or that of the first track; it keeps its name.
    """
    result = dict(names)
    for cells in reversed(above):
        named = [name for name in result.values() if name]
        if len(set(named)) == len(named) or any(map(is_number, filter(None, cells))):
            break
        track = ""
        for i, name in result.items():
            track = cells[i] if i < len(cells) and cells[i] else track
            result[i] = f"{track}/{name}" if track and name and i else name
    return result


def _is_unit(text: str) -> bool:
    text = unit_of(text)
    if not text or text.lower() in FRAMES or text in FRAMES.values() or text in _LATTICE:
        return True
    return not text[0].isdigit() and (_is_quantity(text) or text.lower() in ("-", "1", "quality"))


def _is_quantity(text: str) -> bool:
    try:
        quantity(text)
    except UnitError:
        return False
    return True


def unit_of(text: str) -> str:
    """A unit without brackets and full stop, by the name that it has here."""
    bare = unicodedata.normalize("NFKC", text).strip()
    if bare in _LATTICE:
        return bare
    bare = bare.strip("()[]").strip().removesuffix(".")
    if not bare.isascii() and not _is_quantity(bare):  # two letters do not tell the code page of a file
        bare = next((known for known in mistaken(bare) if not known.isascii() and _is_quantity(known)), bare)
    low = bare.lower()
    return FRAMES.get(low) or (low if len(low) > 3 and not _is_quantity(bare) and _is_quantity(low) else bare)


def _refuse(layout: Layout, last: tuple[int, list[str]], width: int) -> None:
    """One line for all rows whose width is not that of the names."""
    line, cells = last
    named = [cell for cell in cells if cell]
    hint = ""
    if layout.separator == "," and width > len(named):
        hint = "; is the decimal sign a comma?" if width == 2 * len(named) else "; commas within numbers?"
    rule = f"names {len(named)} columns where the rows below have {width} values{hint}"
    raise InputError(Defect(rule, file=layout.file, row=line))


def data_rows(layout: Layout, heading: Heading) -> list[Row]:
    """The rows of data."""
    return layout.rows[heading.first_row :]
