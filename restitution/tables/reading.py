"""Tables: a CSV file read strictly against its Table Schema, every defect named by row, column, value and rule.

The JSON schema (:mod:`restitution.tables.schema`) is the only statement of the rules. Three points are stricter
here than in the standard: numbers must be finite, column order is free, and a column that is not required may
be absent. pandas is imported only once the text of a table has been checked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, TypeAdapter, ValidationError
from pydantic import Field as PydanticField
from pydantic_core import PydanticCustomError

from restitution.errors import Defect, InputError
from restitution.tables.csv_text import CsvText
from restitution.tables.schema import Field, Rules, Schema
from restitution.units import NUMBER

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

    rows = []
    for number, cells in text.rows:
        if len(cells) == len(header):
            rows.append((number, cells))
        elif not any(cells):
            found.append(Defect("is an empty line", file=file, row=number))
        else:
            hint = "; is the decimal sign a comma?" if len(cells) == 2 * len(header) else ""
            rule = f"has {len(cells)} values where the header names {len(header)} columns{hint}"
            found.append(Defect(rule, file=file, row=number))
    total, needed = len(text.rows) + text.unreadable, schema.rules.minimum_rows
    if total < needed:
        rule = f"has {total} rows below the header; at least {needed} are needed"
        found.append(Defect(rule, file=file))

    values: dict[str, list] = {}
    bad: set[int] = set()
    for f in schema.fields:
        if (own := wanted[f.name]) in header:
            position = header.index(own)
            cells = [row[position] for _, row in rows]
            values[f.name], wrong = _column(f, cells, scale.get(f.name, 1.0))
            bad.update(index for index, _ in wrong)
            found += [Defect(rule, file=file, row=rows[i][0], field=own, value=cells[i]) for i, rule in wrong]

    lines = [number for number, _ in rows]
    for i, name, rule in _row_defects(schema.rules, values, lines, [i for i in range(len(rows)) if i not in bad]):
        own = wanted.get(name)
        found.append(
            Defect(
                rule,
                file=file,
                row=lines[i],
                field=own,
                value=rows[i][1][header.index(own)] if own in header else None,
            )
        )

    order = {own: i for i, own in enumerate(header)}
    found.sort(key=lambda d: (d.row or 0, order.get(d.field, -1)))
    return found, values, lines


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
    for i, name in enumerate(header):
        if name in header[:i] and (name in wanted or not columns):
            yield Defect("appears more than once in the header", file=file, row=1, field=name)
        elif name not in wanted and not columns:
            yield Defect(known, file=file, row=1, field=name or f"column {i + 1}")


def _row_defects(
    rules: Rules, values: Mapping[str, list], lines: list[int], good: list[int]
) -> Iterator[tuple[int, str | None, str]]:
    """(row index, column, rule) for every rule between rows or fields that is broken among the ``good`` rows."""
    for name in rules.strictly_increasing:
        for before, here in pairwise(good if name in values else ()):
            first, second = values[name][before], values[name][here]
            if second == first:
                yield here, name, f"repeats the value of row {lines[before]}"
            elif second < first:
                yield here, name, f"must be greater than in row {lines[before]} ({first})"
    for names in rules.unique:
        keys = [name for name in names if name in values]
        seen: dict[tuple, int] = {}
        for i in good if keys else ():
            first = seen.setdefault(tuple(values[name][i] for name in keys), i)
            if first != i:
                yield i, None, f"repeats row {lines[first]} in {', '.join(keys)}"
    for rule in rules.required_when:
        for i in good:
            applies = all(name in values and values[name][i] == given for name, given in rule.when.items())
            if applies and (rule.field not in values or values[rule.field][i] is None):
                condition = ", ".join(f"{name} is {given}" for name, given in rule.when.items())
                yield i, rule.field, f"must not be empty where {condition}"


def _column(f: Field, cells: list[str], scale: float) -> tuple[list, list[tuple[int, str]]]:
    """The values of one column and (index, rule) of every cell that is wrong."""
    filled = [i for i, cell in enumerate(cells) if cell]
    wrong: dict[int, str] = {}
    if f.constraints.required:
        wrong = dict.fromkeys((i for i, cell in enumerate(cells) if not cell), "must not be empty")
    column = _column_type(f, scale)
    try:
        checked = column.validate_python([cells[i] for i in filled])
    except ValidationError as error:
        wrong |= {filled[e["loc"][0]]: _rule(e) for e in error.errors(include_url=False)}
        filled = [i for i in filled if i not in wrong]
        checked = column.validate_python([cells[i] for i in filled])
    values: list[Any] = [None] * len(cells)
    for i, value in zip(filled, checked, strict=True):
        values[i] = value
    return values, list(wrong.items())


LONGEST_TEXT = 500
"""Characters of a cell: a longer one is no name of anything."""
_Text = Annotated[str, PydanticField(max_length=LONGEST_TEXT)]


@cache
def _column_type(f: Field, scale: float) -> TypeAdapter:
    """The type of the filled cells of a column, made from the field's type and constraints."""
    c = f.constraints
    if f.type == "string":
        return TypeAdapter(list[Literal[c.enum] if c.enum else _Text])  # type: ignore[misc]  # made at run time

    def number(cell: str) -> float | str:
        if not NUMBER.fullmatch(cell):
            point = cell.replace(",", ".", 1)
            hint = f"; write {point}" if NUMBER.fullmatch(point) else ""
            raise PydanticCustomError("not_a_number", "is not a number{hint}", {"hint": hint})
        return cell if f.type == "integer" else float(cell) * scale

    bounds = PydanticField(ge=c.minimum, le=c.maximum, gt=c.exclusive_minimum, lt=c.exclusive_maximum)
    if f.type == "integer":
        return TypeAdapter(list[Annotated[int, bounds, BeforeValidator(number)]])
    finite = PydanticField(allow_inf_nan=False)
    return TypeAdapter(list[Annotated[float, bounds, finite, BeforeValidator(number)]])


_RULES = {
    "finite_number": "must be finite",
    "int_parsing": "must be a whole number",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than": "must be less than {lt:g}",
    "less_than_equal": "must be at most {le:g}",
    "string_too_long": "is longer than {max_length} characters",
    "literal_error": "must be one of {expected}",
}


def _rule(error: Mapping[str, Any]) -> str:
    """What a cell should have been, from pydantic's finding."""
    rule = _RULES.get(error["type"])
    return rule.format(**error["ctx"]) if rule and "ctx" in error else rule or error["msg"]
