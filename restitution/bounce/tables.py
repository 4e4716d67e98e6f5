"""Laws as tables that compiled code can read: cubic Hermite interpolation on an equidistant grid of ln(x).

Value and slope are those of one and the same interpolant, so that a force and the energy that it comes from
agree exactly.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Table(NamedTuple):
    """y and dy/d ln(x) at ln(x) = start + i step; ``per_step`` = 1/step. Constant beyond both ends."""

    start: float
    per_step: float
    y: NDArray
    slope: NDArray


def tabulate(
    function: Callable[[NDArray], NDArray],
    low: float,
    high: float,
    step: float,
    slope: Callable[[NDArray], NDArray],
) -> Table:
    """``function`` between x = ``low`` and ``high``, and its ``slope`` dy/d ln(x)."""
    s = np.log(low) + step * np.arange(int(np.ceil(np.log(high / low) / step)) + 1)
    x = np.exp(s)
    return Table(float(s[0]), 1 / step, np.asarray(function(x), float), np.asarray(slope(x), float))


def constant(y: float) -> Table:
    """A table that is ``y`` everywhere."""
    return Table(0.0, 1.0, np.full(2, y), np.zeros(2))


def scaled(table: Table, factor: float) -> Table:
    """``factor`` times a table."""
    return table if factor == 1 else table._replace(y=factor * table.y, slope=factor * table.slope)


def look(table: Table, x: NDArray) -> NDArray:
    """The interpolant at ``x``; the compiled kernel has the same in one place."""
    at = np.clip((np.log(x) - table.start) * table.per_step, 0, len(table.y) - 1)
    i = np.minimum(at.astype(int), len(table.y) - 2)
    t, h = at - i, 1 / table.per_step
    y0, y1, d0, d1 = table.y[i], table.y[i + 1], h * table.slope[i], h * table.slope[i + 1]
    return y0 + t * (d0 + t * (3 * (y1 - y0) - 2 * d0 - d1 + t * (2 * (y0 - y1) + d0 + d1)))
