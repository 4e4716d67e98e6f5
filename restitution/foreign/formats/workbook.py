"""Spreadsheets as text: Excel's .xlsx, LibreOffice's .ods, the XML of Excel 2003 that Kinovea exports.

The sheet with the most cells is written out line by line, cells between tabs, so that it is read as if it had
been saved as text. Cells that a file leaves out, or counts once for several, stay where they are.
"""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Iterator
from xml.parsers import expat

from restitution.errors import Defect, InputError
from restitution.inputs import MOST_TABLE

ZIP = b"PK\x03\x04"
_SHARED = "xl/sharedStrings.xml"
_SHEETS = re.compile(r"xl/worksheets/[^/]+\.xml|content\.xml")
_DAMAGED = (
    zipfile.BadZipFile, zlib.error, expat.ExpatError, OSError, EOFError, RuntimeError, ValueError, LookupError,
)  # fmt: skip
_WIDEST = 1000
"""Columns of a sheet that are read; LibreOffice fills rows to their end with empty ones."""
_REFERENCE = re.compile(r"([A-Z]{1,3})\d+")


def is_workbook(data: bytes) -> bool:
    """Whether bytes are a spreadsheet by what is packed in them, or its XML."""
    if b"urn:schemas-microsoft-com:office:spreadsheet" in data[:2000]:
        return True
    return data.startswith(ZIP) and any(_SHEETS.fullmatch(name) for name in _names(data))


def text_of_sheet(data: bytes, file: str) -> str:
    """The sheet with the most cells, as text; raises :class:`InputError` where none can be read."""
    try:
        sheets = list(_sheets(data, file))
    except InputError:
        raise
    except _DAMAGED:
        raise InputError(
            Defect("is a spreadsheet that cannot be read; save the table as CSV", file=file)
        ) from None
    best = max(sheets, key=lambda rows: sum(map(len, rows)), default=[])
    if not any(map(len, best)):
        raise InputError(Defect("is a spreadsheet without a table", file=file))
    width = max(map(len, best))
    best = [row + [""] * (width - len(row)) for row in best]
    return "\n".join("\t".join(re.sub(r"[\t\r\n]+", " ", cell) for cell in row) for row in best)


def _names(data: bytes) -> list[str]:
    try:
        return zipfile.ZipFile(io.BytesIO(data)).namelist()
    except _DAMAGED:
        return []


def _sheets(data: bytes, file: str) -> Iterator[list[list[str]]]:
    if not data.startswith(ZIP):
        yield from _rows(data, [])
        return
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        shared = _strings(_part(archive, _SHARED, file)) if _SHARED in archive.namelist() else []
        for name in archive.namelist():
            if _SHEETS.fullmatch(name):
                yield from _rows(_part(archive, name, file), shared)


def _part(archive: zipfile.ZipFile, name: str, file: str) -> bytes:
    with archive.open(name) as stream:
        content = stream.read(MOST_TABLE + 1)
    if len(content) > MOST_TABLE:
        raise InputError(Defect("is a spreadsheet larger than what is read of a table", file=file))
    return content


def _parser() -> expat.XMLParserType:
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def declared(*_: object) -> None:
        raise expat.ExpatError("declares a document type")

    parser.StartDoctypeDeclHandler = declared
    return parser


def _strings(xml: bytes) -> list[str]:
    """The texts that cells of a sheet point to."""
    found: list[str] = []
    within: list[str] = []

    def begin(name: str, _: dict[str, str]) -> None:
        within.append(name)
        if name == "si":
            found.append("")

    def word(text: str) -> None:
        if found and within[-1:] == ["t"]:
            found[-1] += text

    parser = _parser()
    parser.StartElementHandler, parser.CharacterDataHandler = begin, word
    parser.EndElementHandler = lambda _: within.pop() and None
    parser.Parse(xml, True)
    return found


def _rows(xml: bytes, shared: list[str]) -> list[list[list[str]]]:
    """The rows of each sheet in a part, whichever of the three wrote it."""
    sheets: list[list[list[str]]] = []
    cell: dict[str, str] = {}
    text: list[str] = []
    open_cell = False

    def begin(name: str, attributes: dict[str, str]) -> None:
        nonlocal cell, open_cell
        short = name.rpartition(":")[2]
        own = {key.rpartition(":")[2]: value for key, value in attributes.items()}
        if short in ("sheetData", "Table", "table"):
            sheets.append([])
        elif short in ("row", "Row", "table-row") and sheets:
            sheets[-1].append([])
        elif short in ("c", "Cell", "table-cell", "covered-table-cell") and sheets and sheets[-1]:
            cell, open_cell = own, True
            text.clear()

    def word(data: str) -> None:
        if open_cell:
            text.append(data)

    def end(name: str) -> None:
        nonlocal open_cell
        if open_cell and name.rpartition(":")[2] in ("c", "Cell", "table-cell", "covered-table-cell"):
            open_cell = False
            _place(sheets[-1][-1], cell, "".join(text).strip(), shared)

    parser = _parser()
    parser.StartElementHandler, parser.CharacterDataHandler, parser.EndElementHandler = begin, word, end
    parser.Parse(xml, True)
    return [[row for row in rows if any(row)] for rows in sheets]


def _place(row: list[str], cell: dict[str, str], text: str, shared: list[str]) -> None:
    """Put a cell where its reference, index or its place says, as often as it is repeated."""
    value = cell.get("value", text)  # LibreOffice shows fewer digits than it has
    if cell.get("t") == "s":
        value = shared[int(text)] if text.isdigit() and int(text) < len(shared) else ""
    at = len(row)
    if match := _REFERENCE.fullmatch(cell.get("r", "")):
        at = 0
        for letter in match[1]:
            at = 26 * at + ord(letter) - ord("A") + 1
        at -= 1
    elif cell.get("Index", "").isdigit():
        at = int(cell["Index"]) - 1
    often = int(number) if (number := cell.get("number-columns-repeated", "1")).isdigit() else 1
    over = int(number) if (number := cell.get("MergeAcross", "0")).isdigit() else 0
    if at + often + over > _WIDEST:
        often, over = (1, 0) if value and at < _WIDEST else (0, 0)
    if not often or at > _WIDEST:
        return
    row += [""] * (at - len(row))
    row[at:] = [value] * often + [""] * over
