"""The cells of a spreadsheet (.xlsx, .xlsb, .xls, .ods) by calamine, in a process of its own: a file in, JSON out.

``python spreadsheet_cells.py [SHEET] < FILE``. The library keeps a sheet as a full rectangle and ends its process
where that does not fit into memory, which two cells far apart bring about (calamine issue 693), or where a file is
damaged in ways it does not know. So :mod:`~restitution.foreign.formats.workbook` runs it apart, within bounds.

Excel keeps a time as days and says by its format that it is one. The library rounds it to milliseconds, too coarse
for a camera; read once more without the formats, it is the number that the file has.
"""

from __future__ import annotations

import datetime
import io
import json
import math
import re
import sys
import zipfile
from dataclasses import dataclass
from typing import Any

import python_calamine as calamine

MOST_MEMORY, MOST_SECONDS = 2**32, 120
"""Of the process; a sheet as large as is read of a table needs a quarter of either."""
_DAY = 86400
_WIDEST = 1000
"""Columns of a sheet that are read."""
_ALIKE = 0.5
"""Part of the rows of numbers of the longest sheet from which on it is not clear which of two is meant."""
_NUMBER = re.compile(r"\s*[-+−]?\d+([.,]\d*)?([eE][-+]?\d+)?\s*")
_WHOLE = 1e15
"""Up to here a float without a fraction is written as a whole number."""
_STYLES = re.compile(r"xl/styles\.(xml|bin)")
_SHEET = re.compile(r"xl/worksheets/[^/]+\.xml")
_NO_VALUE = re.compile(rb"<f\b[^>]*(?:/>|>[^<]*</f>)\s*(?:<v\s*/>|<v></v>|</c>)")
"""A formula whose value the file does not have."""


@dataclass
class Sheet:
    """A sheet's name, whether it is hidden, and its rows from the first on."""

    name: str
    rows: list[list[Any]]
    hidden: bool = False

    @property
    def cells(self) -> int:
        """How many have any content."""
        return sum(cell != "" for row in self.rows for cell in row)

    @property
    def numbers(self) -> int:
        """Rows that have two numbers or more."""
        return sum(sum(map(_is_number, row)) > 1 for row in self.rows)


def chosen(sheets: list[Sheet], wanted: str | None) -> Sheet | dict[str, Any]:
    """The sheet that is ``wanted``, else the one with a table, a hidden one only where no other has any.

    Else what is ``wrong``: "no sheet" (of that name), "empty", "several" (with tables of about one length).
    """
    if wanted is not None:
        found = next((sheet for sheet in sheets if sheet.name == wanted), None)
        return found or {"wrong": "no sheet", "sheets": [sheet.name for sheet in sheets]}
    filled = [sheet for sheet in sheets if sheet.cells]
    filled = [sheet for sheet in filled if not sheet.hidden] or filled
    if not filled:
        return {"wrong": "empty"}
    best = max(filled, key=lambda sheet: sheet.cells)
    most = max(sheet.numbers for sheet in filled)
    rivals = [sheet for sheet in filled if most and sheet.numbers >= _ALIKE * most]
    if len(rivals) > 1:
        return {"wrong": "several", "sheets": [f"{sheet.name} ({sheet.numbers} rows)" for sheet in rivals]}
    return rivals[0] if rivals else best


def answer_to(data: bytes, wanted: str | None) -> dict[str, Any]:
    """The sheet that is ``wanted`` or :func:`chosen`.

    Keys: ``sheet``, ``sheets`` (all names), ``rows`` (texts), ``rounded`` (times are to the millisecond); or
    ``wrong``, which may be "formulas" (without values) too.
    """
    book = calamine.load_workbook(io.BytesIO(data))
    about = [m for m in book.sheets_metadata if m.typ == calamine.SheetTypeEnum.WorkSheet]
    visible = calamine.SheetVisibleEnum.Visible
    here = chosen([Sheet(m.name, _rows(book, m.name), m.visible != visible) for m in about], wanted)
    if isinstance(here, dict):
        return {"wrong": "formulas"} if here["wrong"] == "empty" and _without_values(data) else here
    if _has_empty_column(here.rows) and 2 * _without_values(data) > len(here.rows):
        return {"wrong": "formulas"}
    rounded = False
    if any(isinstance(cell, datetime.time | datetime.datetime) for row in here.rows for cell in row):
        rounded = not _sharpen(here, data)
    return {"sheet": here.name, "sheets": [m.name for m in about], "rows": _texts(here.rows), "rounded": rounded}


def _is_number(cell: Any) -> bool:
    return _NUMBER.fullmatch(cell) is not None if isinstance(cell, str) else not isinstance(cell, bool)


def _rows(book: calamine.CalamineWorkbook, name: str) -> list[list[Any]]:
    """Its rows as in the sheet, from the first on, without the columns beyond all that are read."""
    sheet = book.get_sheet_by_name(name)
    return [row[:_WIDEST] for row in sheet.to_python(skip_empty_area=False)]


def _has_empty_column(rows: list[list[Any]]) -> bool:
    """Whether a column has a name, and nothing below."""
    return any(sum(cell != "" for cell in column) == 1 for column in zip(*rows, strict=True))


def _without_values(data: bytes) -> int:
    if not zipfile.is_zipfile(io.BytesIO(data)):
        return 0
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        parts = [archive.read(name) for name in archive.namelist() if _SHEET.fullmatch(name)]
    return sum(len(_NO_VALUE.findall(part)) for part in parts)


def _sharpen(sheet: Sheet, data: bytes) -> bool:
    """Replace times by what the file has to the last digit; False where it is not told: in .xls."""
    if data.startswith(b"PK"):
        stripped = io.BytesIO()
        with zipfile.ZipFile(io.BytesIO(data)) as archive, zipfile.ZipFile(stripped, "w") as bare:
            if not any(map(_STYLES.fullmatch, archive.namelist())):
                return True  # .ods has times as texts
            for name in archive.namelist():
                if not _STYLES.fullmatch(name):
                    bare.writestr(name, archive.read(name))
        plain = _rows(calamine.load_workbook(io.BytesIO(stripped.getvalue())), sheet.name)
        for row, numbers in zip(sheet.rows, plain, strict=True):
            for k, (cell, number) in enumerate(zip(row, numbers, strict=True)):
                if isinstance(number, int | float) and not isinstance(number, bool):
                    row[k] = _sharp(cell, number)
        return True
    return not any(getattr(cell, "microsecond", 0) for row in sheet.rows for cell in row)


def _sharp(cell: Any, days: float) -> Any:
    """A time to the microsecond, whichever day its calendar begins with."""
    if isinstance(cell, datetime.time):
        cell = datetime.datetime.combine(datetime.date(1, 1, 2), cell)
        return (cell + _correction(cell, days)).time()
    return cell + _correction(cell, days) if isinstance(cell, datetime.datetime) else cell


def _correction(cell: datetime.datetime, days: float) -> datetime.timedelta:
    midnight = cell.replace(hour=0, minute=0, second=0, microsecond=0)
    late = days % 1 * _DAY - (cell - midnight).total_seconds()
    return datetime.timedelta(seconds=(late + _DAY / 2) % _DAY - _DAY / 2)


def _texts(rows: list[list[Any]]) -> list[list[str]]:
    """As they would be saved as text; a day in a column of days and times has a time too."""
    timed = {k for row in rows for k, cell in enumerate(row) if isinstance(cell, datetime.datetime)}
    return [[_text(cell, k in timed) for k, cell in enumerate(row)] for row in rows]


def _text(cell: Any, timed: bool) -> str:
    if isinstance(cell, bool):
        return str(int(cell))
    if isinstance(cell, float):
        if not math.isfinite(cell):
            return ""
        return str(int(cell)) if cell.is_integer() and abs(cell) < _WHOLE else repr(cell)
    if isinstance(cell, datetime.timedelta):
        hours, rest = divmod(cell, datetime.timedelta(hours=1))
        return f"{hours}:{(datetime.datetime.min + rest).time().isoformat()[3:]}"
    if isinstance(cell, datetime.datetime):
        return cell.isoformat(" ")
    if isinstance(cell, datetime.date):
        return f"{cell.isoformat()} 00:00:00" if timed else cell.isoformat()
    return str(cell)


def _keep_within_bounds() -> None:
    try:
        import resource
    except ImportError:  # Windows has none
        return
    for what, most in ((resource.RLIMIT_AS, MOST_MEMORY), (resource.RLIMIT_CPU, MOST_SECONDS)):
        hard = resource.getrlimit(what)[1]
        resource.setrlimit(what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))


def main() -> None:
    """Answer what stands on the standard input."""
    _keep_within_bounds()
    data = sys.stdin.buffer.read()
    answer = answer_to(data, sys.argv[1] if len(sys.argv) > 1 else None)
    sys.stdout.buffer.write(json.dumps(answer).encode("utf-8", "surrogatepass"))


if __name__ == "__main__":
    main()
