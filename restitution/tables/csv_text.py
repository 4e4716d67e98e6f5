"""A CSV file as text, read strictly: its header, its rows by line number, and all that keeps it from being read.

pandas would hide ragged rows, bad bytes and repeated column names; users' camera tracks have all of these.
"""

from __future__ import annotations

import codecs
import csv
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from restitution.errors import Defect, InputError
from restitution.inputs import read_bytes
from restitution.units import NUMBER

_SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", " ": "spaces"}


@dataclass
class CsvText:
    """The cells of a CSV file as text: header, rows by line number, and what kept the rest from being read."""

    path: str | Path
    header: list[str] = field(default_factory=list)
    rows: list[tuple[int, list[str]]] = field(default_factory=list)
    unreadable: int = 0
    defects: list[Defect] = field(default_factory=list)

    @classmethod
    def read(cls, path: str | Path) -> CsvText:
        """The text of a file; whatever keeps it from being read is a defect."""
        text = cls(path)
        try:
            data = read_bytes(path)
        except InputError as error:
            text.defects += error.defects
        else:
            if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
                text._defect("is UTF-16 text; save it as UTF-8", 1)
            elif not data.removeprefix(codecs.BOM_UTF8).strip():
                text._defect("is empty")
            else:
                text._read(data)
        return text

    def _defect(self, rule: str, row: int | None = None) -> None:
        self.defects.append(Defect(rule, file=str(self.path), row=row))

    def _read(self, data: bytes) -> None:
        bad: set[int] = set()
        reader = csv.reader(self._lines(data, bad), strict=True)
        first = 1  # a quoted cell may span lines; a record is named by its first
        try:
            for cells in reader:
                cells = [cell.strip() for cell in cells]
                lines, first = range(first, reader.line_num + 1), reader.line_num + 1
                if lines[0] == 1:
                    self.header = [] if 1 in bad else self._header(cells)
                elif bad.intersection(lines):
                    self.unreadable += 1
                else:
                    self.rows.append((lines[0], cells))
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

    def _lines(self, data: bytes, bad: set[int]) -> Iterator[str]:
        """Decoded lines; the numbers of those that are not text go into ``bad``."""
        offset = len(codecs.BOM_UTF8) if data.startswith(codecs.BOM_UTF8) else 0
        for number, line in enumerate(data[offset:].splitlines(keepends=True), 1):
            if b"\0" in line:
                bad.add(number)
                self._defect(f"has a NUL byte (byte {offset + line.index(0)} of the file)", number)
            try:
                yield line.decode()
            except UnicodeDecodeError as error:
                bad.add(number)
                where = f"byte {offset + error.start} of the file is 0x{line[error.start]:02x}"
                self._defect(f"is not UTF-8 text ({where}; Latin-1?); save it as UTF-8", number)
                yield line.decode("latin-1")
            offset += len(line)
