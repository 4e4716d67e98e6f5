"""A CSV file as text, read strictly: its header, its rows by line number, and all that keeps it from being read.

pandas would hide ragged rows, bad bytes and repeated column names; users' camera tracks have all of these.
"""

from __future__ import annotations

import codecs
import csv
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from restitution.errors import Defect, InputError, of_rows
from restitution.inputs import lists_only, read_bytes
from restitution.tables.widths import check_widths
from restitution.units import NUMBER

_SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", " ": "spaces"}
_BINARY = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0", b"\x89HDF", b"\x93NUMPY", b"MATLAB 5.0")
"""How files begin that are no text at all, of which no line is worth a defect of its own."""


class Cells(dict[str, str]):
    """Cells without the blanks about them, each text held once, by what stands in the file."""

    def __missing__(self, cell: str) -> str:
        bare = cell.strip()
        self[cell] = bare if bare == cell else self[bare]
        return self[cell]


@dataclass
class CsvText:
    """The cells of a CSV file as text: header, rows by line number, and what kept the rest from being read."""

    path: str | Path
    header: list[str] = field(default_factory=list)
    rows: list[tuple[int, list[str]]] = field(default_factory=list)
    unreadable: int = 0
    defects: list[Defect] = field(default_factory=list)

    @classmethod
    @lists_only()
    def read(cls, path: str | Path) -> CsvText:
        """The text of a file; whatever keeps it from being read is a defect."""
        text = cls(path)
        try:
            data = read_bytes(path)
            if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
                text._defect("is UTF-16 text; save it as UTF-8", 1)
            elif data.startswith(_BINARY):
                text._defect("is no text, but a spreadsheet or binary file; save the table as CSV in UTF-8")
            elif not data.removeprefix(codecs.BOM_UTF8).strip():
                text._defect("is empty")
            else:
                text._read(data)
        except InputError as error:
            text.defects += error.defects
        return text

    def _defect(self, rule: str, row: int | None = None) -> None:
        self.defects.append(Defect(rule, file=str(self.path), row=row))

    def _read(self, data: bytes) -> None:
        lines, bad = self._lines(data)
        check_widths(lines, str(self.path))
        known = Cells()
        reader = csv.reader(lines, strict=True)
        first = 1  # a quoted cell may span lines; a record is named by its first
        try:
            for cells in reader:
                cells = [known[cell] for cell in cells]
                after = reader.line_num + 1
                if first == 1:
                    self.header = [] if 1 in bad else self._header(cells)
                elif bad and not bad.isdisjoint(range(first, after)):
                    self.unreadable += 1
                else:
                    self.rows.append((first, cells))
                first = after
        except csv.Error as error:
            self._defect(f"is not CSV from here on: {error}", first)
        while self.rows and not any(self.rows[-1][1]) and len(self.rows[-1][1]) <= 1:
            self.rows.pop()  # blank lines at the end

    def _header(self, cells: list[str]) -> list[str]:
        """The column names, or nothing where this cannot be a header: then one defect says why."""
        if not any(cells):
            self._defect("the first line must name the columns", 1)
        elif all(NUMBER.fullmatch(cell) for cell in cells):
            self._defect("has no header; the first line must name the columns", 1)
        elif len(cells) == 1 and (sign := next((s for s in _SEPARATORS if s in cells[0]), None)):
            self._defect(f"has its columns separated by {_SEPARATORS[sign]}; commas are needed", 1)
        else:
            return cells
        return []

    def _lines(self, data: bytes) -> tuple[Sequence[str], set[int]]:
        """Decoded lines, and the numbers of those that are not text, each of which is a defect."""
        start = len(codecs.BOM_UTF8) if data.startswith(codecs.BOM_UTF8) else 0
        raw = data[start:].splitlines(keepends=True)
        nuls, strange, offset = list[tuple[int, int]](), list[tuple[int, str]](), start
        if b"\0" not in data and _is_utf8(data):
            return [line.decode() for line in raw], set()
        lines = []
        for number, line in enumerate(raw, 1):
            if b"\0" in line:
                nuls.append((number, offset + line.index(0)))
            try:
                lines.append(line.decode())
            except UnicodeDecodeError as error:
                at = f"byte {offset + error.start} of the file is 0x{line[error.start]:02x}"
                strange.append((number, at))
                lines.append(line.decode("latin-1"))
            offset += len(line)
        file = str(self.path)
        self.defects += of_rows(
            lambda i: f"has a NUL byte (byte {nuls[i][1]} of the file)", [number for number, _ in nuls], file=file
        )
        self.defects += of_rows(
            lambda i: f"is not UTF-8 text ({strange[i][1]}; Latin-1?); save it as UTF-8",
            [number for number, _ in strange],
            file=file,
        )
        return lines, {number for number, _ in (*nuls, *strange)}


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True
