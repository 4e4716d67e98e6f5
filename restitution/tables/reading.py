"""Tables: a CSV file read strictly against its Table Schema, every defect named by row, column, value and rule.

The JSON schema (:mod:`restitution.tables.schema`) is the only statement of the rules. Three points are stricter
here than in the standard: numbers must be finite, column order is free, and a column that is not required may
be absent. pandas is imported only once the text of a table has been checked.
"""

from __future__ import annotations

import operator
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restitution.errors import Defect, InputError, Rule, of_rows
from restitution.tables.columns import read_column
from restitution.tables.csv_text import CsvText
from restitution.tables.schema import Rules, Schema

if TYPE_CHECKING:
    import pandas as pd


def check_table(
    path: str | Path | CsvText,
    schema: Schema,
    columns: Mapping[str, str] | None = None,
    scale: Mapping[str, float] | None = None,
) -> list[Defect]:
    """Every defect of a CSV file, in the order of the file; empty if it is valid.

    Parameters
    ----------
    path : the file, or its text as another reader made it plain.
    schema : columns with type, unit and constraints.
    columns : the file's own names of the schema's columns; others are then ignored, while without it an unknown
        column is a defect.
    scale : factor of a column before it is checked (mm to m: 1e-3).
    """
    return _check(path, schema, columns, scale)[0]


def read_table(
    path: str | Path | CsvText,
    schema: Schema,
    columns: Mapping[str, str] | None = None,
    scale: Mapping[str, float] | None = None,
) -> pd.DataFrame:
    """The table with the columns of the schema, in SI; raises :class:`InputError` with all defects.

    Arguments as in :func:`check_table`. Empty cells and absent columns are NaN (missing, for text).
    """
    defects, values, lines = _check(path, schema, columns, scale)
    if defects:
        raise InputError(*defects)
    return _frame(schema, values, lines).reset_index(drop=True)


def examine_table(
    path: str | Path | CsvText,
    schema: Schema,
    columns: Mapping[str, str] | None = None,
    scale: Mapping[str, float] | None = None,
) -> tuple[list[Defect], pd.DataFrame]:
    """Every defect and what can be read in spite of them: wrong cells are empty, the index is ``row``.

    For readers with rules of their own, so that their defects can be named together with those found here.
    Arguments as in :func:`check_table`.
    """
    defects, values, lines = _check(path, schema, columns, scale)
    return defects, _frame(schema, values, lines).rename_axis("row")


def _frame(schema: Schema, values: Mapping[str, list], lines: list[int]) -> pd.DataFrame:
    import pandas as pd

    kinds = {"number": "float64", "integer": "Int64", "string": "str"}
    series = {}
    for f in schema.fields:
        cells = values.get(f.name, [None] * len(lines))
        kind = "int64" if f.type == "integer" and None not in cells else kinds[f.type]
        series[f.name] = pd.Series(cells, lines, dtype=kind)
    return pd.DataFrame(series)


def read_header(path: str | Path) -> list[str]:
    """The column names of a CSV file; raises :class:`InputError` if it has none that can be read."""
    text = CsvText.read(path)
    if not text.header:
        raise InputError(*text.defects)
    return text.header


def _check(
    path: str | Path | CsvText,
    schema: Schema,
    columns: Mapping[str, str] | None,
    scale: Mapping[str, float] | None,
) -> tuple[list[Defect], dict[str, list], list[int]]:
    """All defects, in the order of the file, the values by column (``None`` for an empty cell), and their rows."""
    text = path if isinstance(path, CsvText) else CsvText.read(path)
    if not text.header:
        return text.defects, {}, []
    file, header, columns, scale = str(text.path), text.header, columns or {}, scale or {}
    wanted = {name: columns.get(name, name) for name in schema.columns}
    found = [*text.defects, *_header_defects(file, schema, header, columns, scale)]

    rows = [row for row in text.rows if len(row[1]) == len(header)]
    lines = [number for number, _ in rows]
    if len(rows) < len(text.rows):
        found += _width_defects(file, header, [row for row in text.rows if len(row[1]) != len(header)])
    total, needed = len(text.rows) + text.unreadable, schema.rules.minimum_rows
    if total < needed:
        rule = f"has {total} rows below the header; at least {needed} are needed"
        found.append(Defect(rule, file=file))

    cells: dict[str, list[str]] = {}
    values: dict[str, list] = {}
    bad: set[int] = set()
    for f in schema.fields:
        if (own := wanted[f.name]) in header:
            position = header.index(own)
            cells[f.name] = [row[position] for _, row in rows]
            values[f.name], wrong = read_column(f, cells[f.name], scale.get(f.name, 1.0))
            for rule, at in wrong:
                bad.update(at)
                found += _at(rule, at, lines, cells[f.name], file, own)
    good = [i for i in range(len(rows)) if i not in bad] if bad else list(range(len(rows)))
    for rule, at, name in _row_defects(schema.rules, values, lines, good):
        found += _at(rule, at, lines, cells.get(name or ""), file, wanted.get(name or ""))

    order = {own: i for i, own in enumerate(header)}
    found.sort(key=lambda d: (d.row or 0, order.get(d.field, -1)))
    return found, values, lines


def _at(
    rule: Rule, at: Sequence[int], lines: Sequence[int], cells: Sequence[str] | None, file: str, own: str | None
) -> Iterator[Defect]:
    values = None if cells is None else lambda i: cells[at[i]]
    return of_rows(rule, [lines[i] for i in at], values, file=file, field=own)


def _width_defects(file: str, header: list[str], rows: list[tuple[int, list[str]]]) -> Iterator[Defect]:
    """Rows that have not as many cells as the header has names."""
    yield from of_rows("is an empty line", [number for number, cells in rows if not any(cells)], file=file)
    for twice, hint in ((False, ""), (True, "; is the decimal sign a comma?")):
        other = [row for row in rows if any(row[1]) and (len(row[1]) == 2 * len(header)) == twice]
        counts = [len(cells) for _, cells in other]
        rule = _by_row(counts, f"has {{}} values where the header names {len(header)} columns{hint}")
        yield from of_rows(rule, [number for number, _ in other], file=file)


def _by_row(values: Sequence[Any], rule: str) -> Rule:
    """A rule into which the value of each row is put."""
    return lambda i: rule.format(values[i])


def _header_defects(
    file: str, schema: Schema, header: list[str], columns: Mapping[str, str], scale: Mapping[str, float]
) -> Iterator[Defect]:
    known = f"is not a column of the {schema.name} table: {', '.join(schema.columns)}"
    for name in dict.fromkeys((*columns, *scale)):
        if name not in schema.columns:
            yield Defect(known, field=name)
    wanted = {columns.get(name, name): name in schema.required or name in columns for name in schema.columns}
    for own, needed in wanted.items():
        if needed and own not in header:
            yield Defect(f"is missing; the header names {', '.join(header)}", file=file, row=1, field=own)
    seen: set[str] = set()
    for i, name in enumerate(header):
        if name in seen and (name in wanted or not columns):
            yield Defect("appears more than once in the header", file=file, row=1, field=name)
        elif name not in wanted and not columns:
            yield Defect(known, file=file, row=1, field=name or f"column {i + 1}")
        seen.add(name)


def _row_defects(
    rules: Rules, values: Mapping[str, list], lines: list[int], good: list[int]
) -> Iterator[tuple[Rule, list[int], str | None]]:
    """(rule, row indices, column) for every rule between rows or fields that is broken among the ``good`` rows."""
    for name in rules.strictly_increasing:
        column = values.get(name, [])
        pairs = [] if _increasing([column[i] for i in good] if column else []) else list(pairwise(good))
        same = [(before, here) for before, here in pairs if column[here] == column[before]]
        back = [(before, here) for before, here in pairs if column[here] < column[before]]
        rows = [lines[before] for before, _ in same]
        yield _by_row(rows, "repeats the value of row {}"), [here for _, here in same], name
        larger = [(lines[before], column[before]) for before, _ in back]
        yield _by_row(larger, "must be greater than in row {0[0]} ({0[1]})"), [here for _, here in back], name
    for names in rules.unique:
        keys = [name for name in names if name in values]
        seen: dict[tuple, int] = {}
        again = []
        for i in good if keys else ():
            first = seen.setdefault(tuple(values[name][i] for name in keys), i)
            if first != i:
                again.append((first, i))
        rows = [lines[first] for first, _ in again]
        yield _by_row(rows, f"repeats row {{}} in {', '.join(keys)}"), [i for _, i in again], None
    for rule in rules.required_when:
        applies = good if rule.when.keys() <= values.keys() else []
        for name, given in rule.when.items():
            applies = [i for i in applies if values[name][i] == given]
        column = values.get(rule.field)
        condition = ", ".join(f"{name} is {given}" for name, given in rule.when.items())
        empty = [i for i in applies if column is None or column[i] is None]
        yield f"must not be empty where {condition}", empty, rule.field


def _increasing(numbers: list) -> bool:
    return all(map(operator.lt, numbers, islice(numbers, 1, None)))
