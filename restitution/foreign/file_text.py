"""The lines of a text file whoever wrote it: UTF-8, UTF-16 of spreadsheets, Latin-1 of old programs."""

from __future__ import annotations

import codecs
from pathlib import Path

from restitution.errors import Defect, InputError
from restitution.inputs import read_bytes

_BINARY = {
    b"PK\x03\x04": "is a spreadsheet or an archive, no text; save the table as CSV",
    b"\xd0\xcf\x11\xe0": "is an old spreadsheet, no text; save the table as CSV",
    b"\x89HDF": "is HDF5, no text; export the table as CSV",
    b"\x1f\x8b": "is compressed; unpack it first",
}


_MARKUP = {"{": "JSON", "<": "XML"}


def read_lines(path: str | Path) -> list[str]:
    """The lines of a file without their ends; raises :class:`InputError` where it has no text."""
    file = str(path)
    data = read_bytes(path)
    for mark, rule in _BINARY.items():
        if data.startswith(mark):
            raise InputError(Defect(rule, file=file))
    if not data.removeprefix(codecs.BOM_UTF8).strip():
        raise InputError(Defect("is empty", file=file))
    text = _decoded(data, file)
    if kind := _MARKUP.get(text.lstrip()[:1]):
        raise InputError(Defect(f"is {kind}, no table; export the table as CSV", file=file))
    if "\0" in text:
        row = text[: text.index("\0")].count("\n") + 1
        raise InputError(Defect("has a NUL byte", file=file, row=row))
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _decoded(data: bytes, file: str) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError:
            raise InputError(Defect("is not UTF-16 text, as its first bytes say", file=file)) from None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")
