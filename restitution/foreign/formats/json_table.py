"""The one table in a JSON text, however deep it lies: lists by name, records, rows, tracks, forms of pandas.

A table is looked for from the outside in. It is, in this order,

- what ``DataFrame.to_json`` writes as ``split``, ``table``, ``columns``, ``index``;
- tables under names of tracks, all of the same columns: one, with the track in a column more;
- lists of one length by name, which may lie in objects: ``{"t": [...], "pos": {"x": [...]}}`` has t and pos.x;
- a list of records, likewise; of records that have a table each (tracks of points, frames of objects), with what
  else the record says beside each of its rows; or a list of rows.

Short lists of numbers are vectors: ``"pos": [1, 2]`` has pos_x and pos_y.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from restitution.errors import Defect, InputError
from restitution.foreign.layout import part_of
from restitution.foreign.number_text import is_number
from restitution.foreign.programs import PARTICLES
from restitution.inputs import json_of

_DEEPEST = 6
"""Objects and lists within one another in which a table is looked for."""
_WIDEST = 200
"""Columns that are read."""
_VECTOR = 4
"""Numbers of a vector, of a box or a quaternion at most."""
_ALIKE = 0.5
"""Part of the rows of the longest table from which on it is not clear which of two is meant."""
_SINGULAR = {"frames": "frame", "particles": "particle", "trajectories": "trajectory", "objects": "particle"}
_FORMS = "lists of one length by name, a list of records, tracks with a list of points each"


@dataclass
class _Table:
    names: list[str]
    rows: list[list[Any]]
    """Values of JSON; None where there is none."""
    key: str = ""
    of_lists: bool = False
    """Of lists, which may be vectors where they are short."""


def text_of_json(data: bytes, file: str) -> str:
    """The table as text, names in its first line.

    Raises
    ------
    InputError : where it is no JSON, has no table, or several of about one length.
    """
    found = _tables(_parsed(data, file), "", 0)
    longest = max((len(table.rows) for table in found), default=0)
    likely = [table for table in found if len(table.rows) >= _ALIKE * longest]
    if not likely:
        raise InputError(Defect(f"is JSON, no table that is read ({_FORMS}); export the table as CSV", file=file))
    if len(likely) > 1:
        keys = ", ".join(f"{table.key} ({len(table.rows)} rows)" for table in likely[:5])
        rule = f"is JSON, no table alone but several: {keys}; export the one that is meant as CSV"
        raise InputError(Defect(rule, file=file))
    (table,) = likely
    lines = ["\t".join(" ".join(name.split()) for name in table.names)] if table.names else []
    return "\n".join([*lines, *("\t".join(map(_cell, row)) for row in table.rows)])


def _parsed(data: bytes, file: str) -> Any:
    """The content; of JSON Lines the list of all."""
    lines = [line.strip() for line in data.splitlines() if line.strip()]
    if len(lines) > 1 and all(line[:1] + line[-1:] in (b"{}", b"[]") for line in lines):
        return [json_of(line, file) for line in lines]
    return json_of(data, file)


def _cell(value: Any) -> str:
    return "" if value is None else " ".join(value.split()) if isinstance(value, str) else str(value)


def _tables(node: Any, key: str, depth: int) -> list[_Table]:
    """The tables in a value: itself, or those within."""
    if depth > _DEEPEST or not isinstance(node, list | dict):
        return []
    inner: dict[str, list[_Table]] = {}
    if isinstance(node, list):
        table = _of_list(node, key, depth)
    elif (table := _of_pandas(node)) is None:
        inner = {name: _tables(value, name, depth + 1) for name, value in node.items()}
        apart = any(inner.values()) and not any(isinstance(value, list) for value in node.values())
        table = _of_names(inner) or (None if apart else _of_columns(node))
    if table is None:
        return [found for some in inner.values() for found in some]
    table.key = table.key or key or "the whole"
    return [table]


def _of_pandas(node: dict[str, Any]) -> _Table | None:
    names, data, index = node.get("columns"), node.get("data"), node.get("index")
    if all(isinstance(value, list) for value in (names, data, index)) and len(data) == len(index):
        rows = [dict(zip(map(str, names), row, strict=False)) for row in data if isinstance(row, list)]
        return _indexed(rows, index)
    if isinstance(node.get("schema"), dict) and isinstance(data, list) and all(map(_is_object, data)):
        return _of_records(data)
    inner = list(node.values())
    if not inner or not all(_is_object(value) and value.keys() == inner[0].keys() for value in inner):
        return None
    if any(isinstance(x, list | dict) for value in inner for x in value.values()):
        return None
    if len(node) > 1 and all(map(is_number, node)):
        return _indexed(inner, list(node))
    if len(inner[0]) > 1 and all(map(is_number, inner[0])):
        return _indexed([{name: column[i] for name, column in node.items()} for i in inner[0]], list(inner[0]))
    return None


def _indexed(rows: list[dict[str, Any]], index: list[Any]) -> _Table | None:
    """Records with their index, where that is more than their number."""
    if [str(i) for i in index] == [str(i) for i in range(len(rows))]:
        return _of_records(rows)
    return _of_records([{"index": i, **row} for i, row in zip(index, rows, strict=True)])


def _of_names(inner: dict[str, list[_Table]]) -> _Table | None:
    """Tables of the same columns, each under the name of its track."""
    tables = {name: found[0] for name, found in inner.items() if len(found) == 1}
    names = [table.names for table in tables.values()]
    if len(tables) < 2 or any(own != names[0] for own in names) or not names[0]:
        return None
    rows = [[name, *row] for name, table in tables.items() for row in table.rows]
    return _Table(["track", *names[0]], rows)


def _of_columns(node: dict[str, Any]) -> _Table | None:
    """Lists of numbers or texts that are as long as the longest, without the name of what they all lie in."""
    found: dict[str, list[Any]] = {}
    for name, value in _leaves(node):
        if isinstance(value, list) and (width := _width(value)):
            found |= {_named(name, k, width): [_at(x, k) for x in value] for k in range(width)}
    longest = max(map(len, found.values()), default=0)
    columns = {name: values for name, values in found.items() if len(values) == longest > 1}
    if not 1 < len(columns) <= _WIDEST:
        return None
    names = list(columns)
    while len({name.partition(".")[0] for name in names}) == 1 and all("." in name for name in names):
        names = [name.partition(".")[2] for name in names]
    return _Table(names, [list(row) for row in zip(*columns.values(), strict=True)], of_lists=True)


def _of_list(node: list[Any], key: str, depth: int) -> _Table | None:
    if len(node) < 1:
        return None
    if all(map(_is_object, node)):
        return _of_groups(node, key, depth) or _of_records(node)
    if len(node) > 1 and _width(node, _WIDEST) > 1:
        return _Table([], [list(row) for row in node], of_lists=True)
    return None


def _of_groups(node: list[dict[str, Any]], key: str, depth: int) -> _Table | None:
    """Records that have a table each: its rows, beside what else the record says."""
    parts = [[t for name, value in record.items() for t in _tables(value, name, depth + 1)] for record in node]
    parts = parts if any(parts) else [[t for t in [_of_columns(record)] if t is not None] for record in node]
    parts = [[t for t in found if not t.of_lists or len(t.rows) > _VECTOR] for found in parts]
    if not any(parts) or any(len(found) > 1 for found in parts):
        return None
    first = next(found[0] for found in parts if found)
    if any(t.names != first.names or len(t.rows[0]) != len(first.rows[0]) for found in parts for t in found):
        return None
    own = first.names or [f"{first.key}_{k + 1}" for k in range(len(first.rows[0]))]
    said = [{k: v for k, v in _leaves(record) if not isinstance(v, list)} for record in node]
    beside = [name for name in said[0] if all(name in record for record in said)]
    group = _SINGULAR.get(key, "track")
    counted = group not in beside and not {name.lower() for name in beside} & set(PARTICLES)
    names = [*([group] if counted else []), *(f"outer.{name}" if name in own else name for name in beside), *own]
    rows = []
    for n, (record, found) in enumerate(zip(said, parts, strict=True), group != "frame"):
        head = [*([n] if counted else []), *(record[name] for name in beside)]
        rows += [[*head, *row] for table in found for row in table.rows]
    return _Table(names, rows) if len(names) <= _WIDEST else None


def _of_records(records: list[dict[str, Any]]) -> _Table | None:
    """Records of values, vectors and objects of these, under the names of the first that has all."""
    flat = [dict(_leaves(record)) for record in records]
    names: list[str] = []
    getters: list[tuple[str, int]] = []
    for name in dict.fromkeys(name for record in flat for name in record):
        width = _width([value for record in flat if (value := record.get(name)) is not None])
        names += [_named(name, k, width) for k in range(width)]
        getters += [(name, k) for k in range(width)]
    if not 1 < len(names) <= _WIDEST:
        return None
    return _Table(names, [[_at(record.get(name), k) for name, k in getters] for record in flat])


def _leaves(node: dict[str, Any], prefix: str = "", depth: int = 0) -> Iterator[tuple[str, Any]]:
    """What is no object in an object and those within, by names with dots."""
    for name, value in node.items():
        if isinstance(value, dict) and depth < _DEEPEST:
            yield from _leaves(value, f"{prefix}{name}.", depth + 1)
        elif not isinstance(value, dict):
            yield f"{prefix}{name}", value


def _width(values: list[Any], most: int = _VECTOR) -> int:
    """1 for values that are no lists, n for vectors of n numbers; 0 for none, anything else, and unlike ones."""
    some = [value for value in values if value is not None]
    if not any(isinstance(value, list | dict) for value in some):
        return 1 if some else 0
    widths = {len(value) if isinstance(value, list) else 0 for value in some}
    flat = all(not isinstance(x, list | dict) for value in some if isinstance(value, list) for x in value)
    return widths.pop() if len(widths) == 1 and flat and max(widths) <= most else 0


def _named(name: str, k: int, width: int) -> str:
    return name if width == 1 else part_of(name, k, width)


def _at(value: Any, k: int) -> Any:
    return value[k] if isinstance(value, list) else value


def _is_object(value: Any) -> bool:
    return isinstance(value, dict)
