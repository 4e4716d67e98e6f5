"""The XML of Excel 2003, which Kinovea exports and no library reads: rows of cells, by Python's own parser."""

from __future__ import annotations

from xml.parsers import expat

_NAMESPACE = b"urn:schemas-microsoft-com:office:spreadsheet"
_WIDEST = 1000
"""Columns of a sheet that are read."""
_MOST_LEFT_OUT = 1000
"""Empty rows in one place that are counted."""


def is_excel_2003(data: bytes) -> bool:
    """Whether bytes are such XML."""
    return _NAMESPACE in data[:2000]


def sheets_of(xml: bytes) -> dict[str, list[list[str]]]:
    """The rows of each sheet by its name; raises :class:`expat.ExpatError` where it is no whole XML."""
    sheets: dict[str, list[list[str]]] = {}
    name, cell, text, within = "", dict[str, str](), list[str](), False

    def begin(element: str, attributes: dict[str, str]) -> None:
        nonlocal name, cell, within
        short = element.rpartition(":")[2]
        own = {key.rpartition(":")[2]: value for key, value in attributes.items()}
        if short == "Worksheet":
            name = own.get("Name") or f"{len(sheets) + 1}"
        elif short == "Table":
            sheets[name] = []
        elif short == "Row" and name in sheets:
            left_out = int(at) - 1 - len(sheets[name]) if (at := own.get("Index", "")).isdigit() else 0
            sheets[name] += [[] for _ in range(min(max(left_out, 0), _MOST_LEFT_OUT) + 1)]
        elif short == "Cell" and sheets.get(name):
            cell, within = own, True
            text.clear()

    def word(data: str) -> None:
        if within:
            text.append(data)

    def end(element: str) -> None:
        nonlocal within
        if within and element.rpartition(":")[2] == "Cell":
            within = False
            _place(sheets[name][-1], cell, "".join(text).strip())

    def declared(*_: object) -> None:
        raise expat.ExpatError("declares a document type")

    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartDoctypeDeclHandler = declared
    parser.StartElementHandler, parser.CharacterDataHandler, parser.EndElementHandler = begin, word, end
    parser.Parse(xml, True)
    return sheets


def _place(row: list[str], cell: dict[str, str], text: str) -> None:
    """Put a cell where its index or its place says, with those that it is merged with."""
    at = int(cell["Index"]) - 1 if cell.get("Index", "").isdigit() else len(row)
    over = int(number) if (number := cell.get("MergeAcross", "0")).isdigit() else 0
    if not 0 <= at < _WIDEST:
        return
    row += [""] * (at - len(row))
    row[at:] = [text] + [""] * min(over, _WIDEST - at)
