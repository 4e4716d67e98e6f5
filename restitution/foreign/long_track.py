"""A long track in the project's own columns: nothing but plain numbers below its names, read at once.

What is in any way different (another column, a lost frame, a defect, a comment) is left to the general reader that
says what it is; the numbers are the same to the last bit.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from restitution import datasets
from restitution.conditions import LARGEST, SMALLEST
from restitution.foreign.settings import Settings
from restitution.foreign.track import COLUMNS, ForeignTrack, Quantity
from restitution.inputs import read_bytes

if TYPE_CHECKING:
    import pandas as pd

    from restitution.tables.schema import Constraints

LONG = 2**20
"""Bytes from which it is worth a look."""
_PLAIN = b"0123456789+-.eE,\n"


def read_long_track(path: str | Path, settings: Settings) -> ForeignTrack | None:
    """The track, or None where the general reader must look at the file."""
    found = _names_and_numbers(path, settings)
    if found is None:
        return None
    quantity, names, body = found
    import pandas as pd

    rows = body.count(b"\n") + 1
    try:
        table = pd.read_csv(
            io.BytesIO(body), header=None, names=names, index_col=False, float_precision="round_trip", dtype=float
        )
    except ValueError:
        return None
    numbers = table.to_numpy()
    whole = len(table) == rows and body.count(b",") == rows and np.isfinite(numbers).all()
    sizes = np.abs(numbers).max(axis=0, initial=0.0)
    whole = whole and bool(((sizes == 0) | ((sizes >= SMALLEST) & (sizes <= LARGEST))).all())
    if not whole or not (np.diff(table.time_s.to_numpy()) > 0).all():
        return None
    schema = datasets.schema("trajectory" if quantity == "gap" else "settling")
    if not all(_within(table[field.name], field.constraints) for field in schema.fields if field.name in names):
        return None
    others = {field.name: np.nan for field in schema.fields if field.name not in names}
    return ForeignTrack(table.assign(**others)[list(schema.columns)], "", (), 1.0)


def _names_and_numbers(path: str | Path, settings: Settings) -> tuple[Quantity, list[str], bytes] | None:
    if settings.stated() or Path(path).is_dir() or len(data := read_bytes(path)) < LONG:
        return None
    heading, _, body = data.partition(b"\n")
    names = [name.strip() for name in heading.decode("latin-1").split(",")]
    quantity = next((q for q, own in COLUMNS.items() if sorted(names) == sorted(("time_s", own))), None)
    body = body.replace(b"\r\n", b"\n").rstrip(b"\n")
    if quantity is None or not body or body.translate(None, _PLAIN):
        return None
    return quantity, names, body


def _within(column: pd.Series, bounds: Constraints) -> bool:
    low, high = column.min(), column.max()
    return not (
        (bounds.minimum is not None and low < bounds.minimum)
        or (bounds.maximum is not None and high > bounds.maximum)
        or (bounds.exclusive_minimum is not None and low <= bounds.exclusive_minimum)
        or (bounds.exclusive_maximum is not None and high >= bounds.exclusive_maximum)
    )
