"""Spreadsheets as text: Excel's .xlsx, .xlsb and .xls, LibreOffice's .ods, the XML of Excel 2003.

The sheet that has a table is written out line by line, cells between tabs, as if it had been saved as text; a line
of the text is a row of the sheet. Cells are read by calamine in a process of its own
(:mod:`~restitution.foreign.formats.spreadsheet_cells`).
"""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
import zipfile
import zlib
from typing import Any
from xml.parsers import expat

from restitution.errors import Defect, InputError
from restitution.foreign.formats import excel_2003
from restitution.inputs import MOST_TABLE

_ENCRYPTED = "EncryptedPackage".encode("utf-16-le")
ZIP, COMPOUND = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"
_PARTS = re.compile(r"xl/worksheets/[^/]+\.(xml|bin)|content\.xml")
_MOST_NAMED = 20
"""Sheets that a message names."""
_PATIENCE = 10.0
"""How much longer than its own time the process is waited for."""
_WRONG = {
    "password": "is a spreadsheet with a password; save it without one, or its sheet as CSV",
    "empty": "is a spreadsheet without a table",
    "several": "has several sheets with a table",
    "no sheet": "has no sheet of that name",
    "formulas": "has formulas without their values, as programs write them that do not compute: open it in a "
    "spreadsheet program and save it there",
    "size": "is a spreadsheet larger than what is read of a table, or has a cell far from its table; clear that "
    "one, or save the table as CSV",
    "damaged": "begins as a spreadsheet does, and cannot be read as one: is it whole, and without a password? "
    "Open it in a spreadsheet program and save the table as CSV",
}


def is_workbook(data: bytes) -> bool:
    """Whether bytes are a spreadsheet by what is packed in them, an old file of Office, or XML of Excel."""
    if data.startswith(COMPOUND) or excel_2003.is_excel_2003(data):
        return True
    return data.startswith(ZIP) and any(_PARTS.fullmatch(part.filename) for part in _packed(data))


def text_of_sheet(data: bytes, file: str, wanted: str | None = None) -> tuple[str, str]:
    """The sheet with a table, or the one ``wanted``, as text; which it is.

    Raises :class:`InputError` where none can be read, or several have tables.
    """
    if any(part.file_size > MOST_TABLE for part in _packed(data)):
        raise InputError(Defect(_WRONG["size"], file=file))
    if data.startswith(COMPOUND) and _ENCRYPTED in data:
        raise InputError(Defect(_WRONG["password"], file=file))
    found = _of_xml(data, wanted) if excel_2003.is_excel_2003(data) else _of_process(data, wanted)
    if (wrong := found.get("wrong")) in ("several", "no sheet"):
        names = ", ".join(found["sheets"][:_MOST_NAMED]) + (" ..." if len(found["sheets"]) > _MOST_NAMED else "")
        rule = f"{_WRONG[wrong]}; --sheet takes one of: {names}"
        raise InputError(Defect(rule, file=file, field=None if wanted is None else "--sheet", value=wanted))
    if wrong:
        raise InputError(Defect(_WRONG[wrong], file=file))
    rows = found["rows"]
    width = max(map(len, rows))
    text = "\n".join("\t".join(map(_cell, row + [""] * (width - len(row)))) for row in rows)
    several = f" of {len(found['sheets'])}" if len(found["sheets"]) > 1 else ""
    rounded = ", times of day to the millisecond" if found.get("rounded") else ""
    return text, f"sheet {found['sheet']!r}{several}{rounded}"


def _cell(text: str) -> str:
    """A cell as one between tabs: on one line, no quotation that goes on beyond it."""
    if text.isalnum():
        return text
    plain = re.sub(r"[\t\r\n]+", " ", text)
    return plain.replace('"', "''") if plain.lstrip().startswith('"') else plain


def _packed(data: bytes) -> list[zipfile.ZipInfo]:
    if not data.startswith(ZIP):
        return []
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return archive.infolist()
    except (zipfile.BadZipFile, zlib.error, OSError, EOFError, RuntimeError, ValueError, LookupError):
        return []


def _of_xml(data: bytes, wanted: str | None) -> dict[str, Any]:
    from restitution.foreign.formats.spreadsheet_cells import Sheet, chosen

    try:
        sheets = excel_2003.sheets_of(data)
    except (expat.ExpatError, ValueError, LookupError):
        return {"wrong": "damaged"}
    found = chosen([Sheet(name, rows) for name, rows in sheets.items()], wanted)
    if isinstance(found, dict):
        return found
    return {"sheet": found.name, "sheets": list(sheets), "rows": found.rows} if found.cells else {"wrong": "empty"}


def _of_process(data: bytes, wanted: str | None) -> dict[str, Any]:
    """What the process answers; how it ended where it does not: by an error of its own, or killed."""
    from restitution.foreign.formats import spreadsheet_cells

    command = [sys.executable, "-P", spreadsheet_cells.__file__, *([] if wanted is None else [wanted])]
    patience = _PATIENCE + spreadsheet_cells.MOST_SECONDS
    try:
        done = subprocess.run(command, input=data, capture_output=True, timeout=patience, check=False)
    except subprocess.TimeoutExpired:
        return {"wrong": "size"}
    if done.returncode == 0:
        return json.loads(done.stdout)
    beyond = done.returncode != 1 or b"MemoryError" in done.stderr
    return {"wrong": "size" if beyond else "damaged"}
