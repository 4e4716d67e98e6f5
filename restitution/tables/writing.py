"""Tables as CSV text, all numbers to one number of digits: the only writer of tables.

A file appears whole or not at all by :mod:`restitution.files`; how tables are read stands in
:mod:`restitution.tables`.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd


def table_text(table: pd.DataFrame, digits: str | None = "%.6g") -> str:
    """A table; ``digits`` None: all of them. Missing values are empty cells."""
    return table.to_csv(index=False, float_format=digits, lineterminator="\n")


def rows_text(headings: Sequence[str], rows: Iterable[Sequence[Any]], digits: str = "%.6g") -> str:
    """Rows under ``headings``, each cell of a kind of its own; None and NaN are empty cells."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(headings)
    writer.writerows([_cell(value, digits) for value in row] for row in rows)
    return text.getvalue()


def records_text(records: Sequence[Mapping[str, Any]], digits: str = "%.6g") -> str:
    """Rows that have their headings with them, at least one, all alike."""
    headings = list(records[0])
    return rows_text(headings, ([record[name] for name in headings] for record in records), digits)


def _cell(value: Any, digits: str) -> Any:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return digits % value if isinstance(value, float) else value
