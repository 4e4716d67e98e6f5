"""Which populations come back from a face, cell by cell.

A link through an edge of the box belongs to the no-slip walls before the inlet before the outlet, and among
inlets and among outlets to x before y before z. Where two no-slip walls meet, both push: each slides along the
other, so that neither lets mass through.
"""

from __future__ import annotations

from typing import NamedTuple

from numba import njit

from lbm.fluid.stencil import C


class Side(NamedTuple):
    """A face as the kernels see it: normal to ``axis``, at its ``high`` end or the low one.

    The others say of each of the six faces whether it goes before this one.
    """

    axis: int
    high: bool
    x_low: bool
    x_high: bool
    y_low: bool
    y_high: bool
    z_low: bool
    z_high: bool

    @property
    def number(self) -> int:
        """Place among the six faces."""
        return 2 * self.axis + self.high


@njit
def face_cell(grid, side, line, n):
    """Cell number (line, n) of a face, the two counted along the other axes in the order x, y, z."""
    if side.axis == 0:
        return (grid.nx - 1 if side.high else 0), line, n
    if side.axis == 1:
        return line, (grid.ny - 1 if side.high else 0), n
    return line, n, (grid.nz - 1 if side.high else 0)


@njit
def returns(grid, k, side, x, y, z):
    """Whether population k comes back to the cell from this face, and not from one that goes before it."""
    if C[k, side.axis] != (-1 if side.high else 1):
        return False
    if (x == 0 and C[k, 0] == 1 and side.x_low) or (x == grid.nx - 1 and C[k, 0] == -1 and side.x_high):
        return False
    if (y == 0 and C[k, 1] == 1 and side.y_low) or (y == grid.ny - 1 and C[k, 1] == -1 and side.y_high):
        return False
    return not ((z == 0 and C[k, 2] == 1 and side.z_low) or (z == grid.nz - 1 and C[k, 2] == -1 and side.z_high))
