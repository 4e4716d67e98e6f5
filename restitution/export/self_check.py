"""The table that a generated file checks itself by: arguments and what this package computes there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restitution.export.closure import Closure

TOLERANCE = 1e-12
"""Relative; another compiler's exp, log and pow differ in the last digits of the double."""
_DRY = (0.97, 0.6)
_ACROSS = 12
"""Points across the validity range, at each dry restitution."""
_OPEN_LOW, _OPEN_HIGH = 1e-3, 1e3
"""Where a range is open; the second over the lower end, where that is given."""


@dataclass(frozen=True)
class CheckTable:
    """``rows``: the arguments; ``values`` and ``slopes`` what belongs to them."""

    rows: tuple[tuple[float, ...], ...]
    values: tuple[float, ...]
    slopes: tuple[float, ...]


def check_table(closure: Closure) -> CheckTable:
    """Twelve points or more: across the range and beyond its ends, for e_eff also where there is no impact."""
    low, high = closure.validity
    low = low if low > 0 else min(_OPEN_LOW, high / 100)
    high = high if high < np.inf else _OPEN_HIGH * low
    # Not the ends themselves, where formulas may have their kinks.
    first = [*np.geomspace(low, high, _ACROSS + 2)[1:-1], low / 3, 3 * high]
    if closure.rebound:
        first += [0.0, -1.0]
    others = [_DRY if name == "e_dry" else closure.typical[name] for name in closure.variables[1:]]
    rows = [
        (float(f"{x:.9g}"), *(choice[which] for choice in others))
        for which in range(2 if others else 1)
        for x in first
    ]
    arrays = np.array(rows).T
    return CheckTable(
        tuple(rows), tuple(map(float, closure.value(*arrays))), tuple(map(float, closure.derivative(*arrays)))
    )
