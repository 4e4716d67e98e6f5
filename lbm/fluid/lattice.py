"""Where the populations lie: one lattice, updated in place (AA pattern), with the faces folded into its map.

Source of the pattern: Bailey, Myre, Walsh, Lilja & Saar, Proc. ICPP 2009, 550.

Write ``local(k, x)`` for slot k of cell x, and ``remote(k, x)`` for the slot opposite to k of cell x - c_k.

* An even step (parity 0 to 1) reads population k from ``local(k)`` and leaves its result in ``local(k')``,
  k' being the opposite: nothing moves.
* An odd step (parity 1 to 0) reads k from ``remote(k)`` and leaves its result in ``remote(k')``.

Each cell thus writes the very slots it has read; population k' goes where k was. Where x - c_k lies beyond
a face, ``remote`` names instead the slot that holds what comes back:

==========  ==================================================================================
periodic    the same slot, cell wrapped around
free-slip   slot mirrored in the face, cell not shifted along its normal
bounce      slot k of x itself, into which x has sent k': half-way bounce-back at no cost
==========  ==================================================================================

Moving walls, inlets, outlets and bodies then change some populations between two steps. They speak of
:func:`incoming` and :func:`outgoing` populations and never learn the parity's meaning.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from lbm.fluid.cache import kernel
from lbm.fluid.memory import prefetch
from lbm.fluid.stencil import OPPOSITE, C, Q, mirrored

PERIODIC, SLIP, BOUNCE = 0, 1, 2
"""What ``remote`` does beyond a face."""

_MIRRORED = np.array([mirrored(axis) for axis in range(3)])
_ENDS = int(np.sum(C[:, 0] != 0))  # populations that enter a row at one of its ends
_ALIGN = 32  # bytes a row is aligned to
_LINE = 64  # bytes in a cache line
_SPREAD = 17  # lines from slot to slot modulo the page: multiples of 17 modulo 64 fill the cache's sets evenly
_PAGE = 4096  # addresses equal modulo this compete for the same cache set


class Grid(NamedTuple):
    """Shape, strides (in elements) and faces, as the kernels see them."""

    nx: int
    ny: int
    nz: int
    row: int
    slot: int
    origin: int
    x_low: int
    x_high: int
    y_low: int
    y_high: int
    z_low: int
    z_high: int

    @property
    def shape(self) -> tuple[int, int, int]:
        """Cells along x, y, z."""
        return (self.nx, self.ny, self.nz)

    @property
    def faces(self) -> tuple[int, int, int, int, int, int]:
        """What lies beyond the faces x-, x+, y-, y+, z-, z+."""
        return (self.x_low, self.x_high, self.y_low, self.y_high, self.z_low, self.z_high)

    @property
    def size(self) -> int:
        """Elements of the buffer."""
        return self.origin + Q * self.slot


def layout(shape: tuple[int, int, int], faces: tuple[int, ...], itemsize: int) -> Grid:
    """Strides for a grid: rows aligned, with pads for the neighbours of their ends; no cache conflicts."""
    nx, ny, nz = shape
    align = _ALIGN // itemsize
    row = -(-(nx + 2) // align) * align
    if row * itemsize % _PAGE == 0:
        row += align
    page, line = _PAGE // itemsize, _LINE // itemsize
    slot = ny * nz * row
    slot += (_SPREAD * line - slot) % page
    return Grid(nx, ny, nz, row, slot, align, *faces)


def allocate(grid: Grid, dtype) -> np.ndarray:
    """A zeroed flat buffer, aligned to a cache line: fluid at rest."""
    dtype = np.dtype(dtype)
    spare = _LINE // dtype.itemsize
    raw = np.zeros(grid.size + spare, dtype)
    shift = (-raw.ctypes.data % _LINE) // dtype.itemsize
    return raw[shift : shift + grid.size]


@njit(forceinline=True)
def local(grid, k, x, y, z):
    """Address of slot k of cell (x, y, z)."""
    return grid.origin + k * grid.slot + (z * grid.ny + y) * grid.row + x


@njit
def _behind(i, c, n, low, high):
    """Coordinate i - c on an axis of n cells, and what lies there: PERIODIC (also inside) or a face."""
    i -= c
    if i < 0:
        return i + n, low
    if i >= n:
        return i - n, high
    return i, PERIODIC


@njit
def remote(grid, k, x, y, z):
    """Address from which an odd step reads population k of cell (x, y, z); see the head of this module."""
    slot = OPPOSITE[k]
    i, on_x = _behind(x, C[k, 0], grid.nx, grid.x_low, grid.x_high)
    j, on_y = _behind(y, C[k, 1], grid.ny, grid.y_low, grid.y_high)
    l, on_z = _behind(z, C[k, 2], grid.nz, grid.z_low, grid.z_high)  # noqa: E741
    if on_x == BOUNCE or on_y == BOUNCE or on_z == BOUNCE:
        return local(grid, k, x, y, z)
    if on_x == SLIP:
        slot, i = _MIRRORED[0, slot], x
    if on_y == SLIP:
        slot, j = _MIRRORED[1, slot], y
    if on_z == SLIP:
        slot, l = _MIRRORED[2, slot], z  # noqa: E741
    return local(grid, slot, i, j, l)


@njit
def incoming(grid, parity, k, x, y, z):
    """Address of the population k that the next step will read at (x, y, z)."""
    return local(grid, k, x, y, z) if parity == 0 else remote(grid, k, x, y, z)


@njit
def outgoing(grid, parity, k, x, y, z):
    """Address of the population k that the last step has sent from (x, y, z)."""
    return remote(grid, OPPOSITE[k], x, y, z) if parity == 0 else local(grid, OPPOSITE[k], x, y, z)


class Rows(NamedTuple):
    """Addresses that a row of cells reads and writes, relative to the row's own address (slot 0, x = 0).

    They depend only on whether the row lies at a face in y and in z: nine cases (:func:`row_case`).
    ``starts[parity, case, k]`` holds for all x but the ends of the row, which an odd step must first fetch:
    element ``mates[case, i]`` is lent to ``pads[case, i]``, where the vectorised loop will look for it.
    """

    starts: np.ndarray
    pads: np.ndarray
    mates: np.ndarray


@kernel(parallel=False)
def _tabulate(grid, starts, pads, mates):
    for case in range(9):
        y, z = _at(case % 3, grid.ny), _at(case // 3, grid.nz)
        base = local(grid, 0, 0, y, z)
        end = 0
        for k in range(Q):
            for parity in range(2):
                # x = 1 stands for all cells away from the ends of the row
                starts[parity, case, k] = incoming(grid, parity, k, 1, y, z) - 1 - base
            if C[k, 0] != 0:
                x = 0 if C[k, 0] > 0 else grid.nx - 1
                pads[case, end] = starts[1, case, k] + x
                mates[case, end] = remote(grid, k, x, y, z) - base
                end += 1


@njit(forceinline=True)
def _at(where, n):
    return 0 if where == 0 else (1 if where == 1 else n - 1)


def tabulate(grid: Grid) -> Rows:
    """The table of addresses for ``grid``."""
    rows = Rows(np.empty((2, 9, Q), np.int64), np.empty((9, _ENDS), np.int64), np.empty((9, _ENDS), np.int64))
    _tabulate(grid, *rows)
    return rows


@njit(forceinline=True)
def row_case(grid, y, z):
    """Which of the nine cases of :class:`Rows` the row (y, z) is."""
    on_y = 0 if y == 0 else (2 if y == grid.ny - 1 else 1)
    on_z = 0 if z == 0 else (2 if z == grid.nz - 1 else 1)
    return 3 * on_z + on_y


@njit(forceinline=True)
def row_starts(grid, rows, parity, y, z):
    """The 19 addresses of row (y, z)."""
    base = local(grid, 0, 0, y, z)
    s = rows.starts[parity, row_case(grid, y, z)]
    return (
        base + s[0], base + s[1], base + s[2], base + s[3], base + s[4], base + s[5], base + s[6],
        base + s[7], base + s[8], base + s[9], base + s[10], base + s[11], base + s[12],
        base + s[13], base + s[14], base + s[15], base + s[16], base + s[17], base + s[18],
    )  # fmt: skip


@njit(forceinline=True)
def lend(populations, grid, rows, parity, y, z):
    """Copy what lies beyond the two ends of row (y, z) into the pads, and ask for the next row's."""
    if parity == 1:
        base, case = local(grid, 0, 0, y, z), row_case(grid, y, z)
        for i in range(_ENDS):
            populations[base + rows.pads[case, i]] = populations[base + rows.mates[case, i]]
            prefetch(populations, base + rows.mates[case, i] + grid.row)
            prefetch(populations, base + rows.pads[case, i] + grid.row)


@njit(forceinline=True)
def give_back(populations, grid, rows, parity, y, z):
    """Undo :func:`lend` after the loop has written the pads."""
    if parity == 1:
        base, case = local(grid, 0, 0, y, z), row_case(grid, y, z)
        for i in range(_ENDS):
            populations[base + rows.mates[case, i]] = populations[base + rows.pads[case, i]]


class Lattice:
    """The populations of a box of cells, and whether the next step is even or odd.

    ``populations`` is the flat buffer, ``grid`` its layout, ``parity`` 0 or 1. Code that changes populations
    between steps finds them by :func:`incoming` and :func:`outgoing`.
    """

    def __init__(self, shape: tuple[int, int, int], faces: tuple[int, ...], dtype):
        self.dtype = np.dtype(dtype)
        self.grid = layout(shape, faces, self.dtype.itemsize)
        self.rows = tabulate(self.grid)
        self.populations = allocate(self.grid, self.dtype)
        self.parity = 0

    def slots(self) -> np.ndarray:
        """View of the slots without the pads, shape (19, nz, ny, nx); at parity 0, what comes in."""
        g = self.grid
        slots = self.populations[g.origin :].reshape(Q, g.slot)[:, : g.nz * g.ny * g.row]
        return slots.reshape(Q, g.nz, g.ny, g.row)[..., : g.nx]
