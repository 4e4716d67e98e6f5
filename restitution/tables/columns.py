"""The cells of one column as numbers or texts, and every one that is not what its field in the schema says.

A column is read as a whole, each rule in one pass: a file may have millions of cells, all of them wrong.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterable, Sequence
from itertools import compress, repeat

from restitution.errors import Rule
from restitution.tables.schema import Constraints, Field
from restitution.units import NUMBER

LONGEST_TEXT = 500
"""Characters of a cell: a longer one is no name of anything."""
MOST_DIGITS = 18
"""Of a whole number: more do not fit into eight bytes."""
_WHOLE = re.compile(r"[+-]?\d+(\.0*)?", re.ASCII)


class Column:
    """The filled cells that no rule has been broken by so far, ``at`` their places; ``wrong`` are the others."""

    def __init__(self, cells: Sequence[str]):
        self.cells = cells
        self.at = [i for i, cell in enumerate(cells) if cell]
        self.items: list = [cell for cell in cells if cell]
        self.wrong: list[tuple[Rule, list[int]]] = []

    def empty(self) -> None:
        """Those that are empty are wrong."""
        if len(self.at) < len(self.cells):
            self.wrong.append(("must not be empty", [i for i, cell in enumerate(self.cells) if not cell]))

    def keep(self, right: Iterable[object], rule: str | Callable[[str], str]) -> None:
        """Keep the items that are right; what the others break may depend on what stands in the cell."""
        keep = list(map(bool, right))
        if all(keep):
            return
        places = [i for i, kept in zip(self.at, keep, strict=True) if not kept]
        whole: Rule = rule if isinstance(rule, str) else lambda i: rule(self.cells[places[i]])
        self.wrong.append((whole, places))
        self.at, self.items = list(compress(self.at, keep)), list(compress(self.items, keep))


def read_column(f: Field, cells: Sequence[str], scale: float = 1.0) -> tuple[list, list[tuple[Rule, list[int]]]]:
    """The values of a column, ``None`` where a cell is empty or wrong, and the places of the cells that are wrong.

    Parameters
    ----------
    f : type and constraints of the column.
    cells : as text, without blanks about them.
    scale : factor of a number before it is checked.
    """
    column = Column(cells)
    if f.constraints.required:
        column.empty()
    {"number": _numbers, "integer": _whole_numbers, "string": _texts}[f.type](column, f.constraints, scale)
    values: list = [None] * len(cells)
    for i, value in zip(column.at, column.items, strict=True):
        values[i] = value
    return values, column.wrong


def _texts(column: Column, c: Constraints, _: float) -> None:
    """Names, of a list where the schema has one."""
    if c.enum:
        *names, last = map(repr, c.enum)
        listed = f"{', '.join(names)} or {last}" if names else last
        column.keep(map(frozenset(c.enum).__contains__, column.items), f"must be one of {listed}")
    else:
        lengths = map(len, column.items)
        column.keep((n <= LONGEST_TEXT for n in lengths), f"is longer than {LONGEST_TEXT} characters")


def _numbers(column: Column, c: Constraints, scale: float) -> None:
    """Finite numbers within bounds, in SI."""
    column.keep(map(NUMBER.fullmatch, column.items), _no_number)
    column.items = [float(cell) * scale for cell in column.items]
    column.keep(map(math.isfinite, column.items), "must be finite")
    _bound(column, c)


def _whole_numbers(column: Column, c: Constraints, _: float) -> None:
    """Whole numbers within bounds."""
    column.keep(map(NUMBER.fullmatch, column.items), _no_number)
    column.keep(map(_WHOLE.fullmatch, column.items), "must be a whole number")
    column.items = [cell.partition(".")[0] for cell in column.items]
    digits = (len(cell.lstrip("+-0")) for cell in column.items)
    column.keep((n <= MOST_DIGITS for n in digits), f"is a whole number of more than {MOST_DIGITS} digits")
    column.items = [int(cell) for cell in column.items]
    _bound(column, c)


def _no_number(cell: str) -> str:
    point = cell.replace(",", ".", 1)
    return f"is not a number; write {point}" if NUMBER.fullmatch(point) else "is not a number"


def _bound(column: Column, c: Constraints) -> None:
    for limit, within, rule in (
        (c.minimum, operator.ge, "must be at least"),
        (c.maximum, operator.le, "must be at most"),
        (c.exclusive_minimum, operator.gt, "must be greater than"),
        (c.exclusive_maximum, operator.lt, "must be less than"),
    ):
        if limit is not None:
            column.keep(map(within, column.items, repeat(limit)), f"{rule} {limit:g}")
