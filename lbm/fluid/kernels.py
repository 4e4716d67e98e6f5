"""The sweeps over the lattice: one time step, or two while the planes are in the cache."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from lbm.fluid.cache import kernel
from lbm.fluid.collision import collide
from lbm.fluid.lattice import give_back, lend, row_starts
from lbm.fluid.memory import line_length, load_cell, prefetch_cell, store_cell
from lbm.fluid.places import FACTORS, load_rates

_AHEAD = 6
"""How many cache lines ahead a row asks for its memory (benchmarks/README.md)."""


@njit(forceinline=True)
def exchange_pairs(f):
    """Each population in the place of its opposite."""
    return (
        f[0], f[2], f[1], f[4], f[3], f[6], f[5], f[8], f[7], f[10], f[9],
        f[12], f[11], f[14], f[13], f[16], f[15], f[18], f[17],
    )  # fmt: skip


@njit(forceinline=True)
def _step_cell(populations, starts, x, rates, force):
    f = collide(load_cell(populations, starts, x), rates, force)
    store_cell(populations, starts, x, exchange_pairs(f))


@njit(error_model="numpy", fastmath={"contract"})
def _step_rows(populations, grid, rows, parity, first, last, z, places, force):
    """Collide and stream rows first to last - 1 of plane z in place."""
    line = line_length(populations)
    whole = grid.nx - grid.nx % line
    if first < last:
        lend(populations, grid, rows, parity, first, z)
    for y in range(first, last):
        if y + 1 < last:
            # A row ahead: a vector load right behind the store of one of its elements would stall.
            lend(populations, grid, rows, parity, y + 1, z)
        starts = row_starts(grid, rows, parity, y, z)
        layer = places.rows[z, y] * places.kinds
        for first_x in range(0, whole, line):
            # What lies beyond the end of the row is the next row, so asking past the end is of use.
            prefetch_cell(populations, starts, first_x + _AHEAD * line)
            own = (layer + places.lines[first_x // line]) * FACTORS * line
            # a constant length: compiled to vectors without a remainder
            for i in range(line):
                _step_cell(populations, starts, first_x + i, load_rates(places.table, own, i), force)
        if whole < grid.nx:
            prefetch_cell(populations, starts, whole + _AHEAD * line)
            own = (layer + places.lines[whole // line]) * FACTORS * line
            for i in range(grid.nx - whole):
                _step_cell(populations, starts, whole + i, load_rates(places.table, own, i), force)
        give_back(populations, grid, rows, parity, y, z)


@kernel
def sweep(populations, grid, rows, parity, places, force, planes):
    """One time step of the ``planes`` of these numbers (none to compile only)."""
    for n in prange(planes.shape[0]):
        _step_rows(populations, grid, rows, parity, 0, grid.ny, planes[n], places, force)


@kernel
def sweep_two(populations, grid, rows, places, force, blocks, tile, planes, made):
    """Two time steps from parity 0 in one pass over memory; in planes that are ``made`` the even one is behind.

    The odd step of row (y, z) needs the even step of the rows around it. Each of ``blocks`` slabs of planes
    is swept in strips of ``tile`` rows; behind the even step of plane z follows the odd step of plane z - 1,
    one row behind as well, while its populations are still in the cache. Rows next to another slab or to the
    faces in y wait for the end. Every row is computed from the same values as by two sweeps: same result.

    An even step stays within its plane, so around a body it may go ahead: what the body changes between the two
    steps is then there before the odd step comes by.
    """
    ny = grid.ny
    for block_ in prange(blocks):
        block = np.int64(block_)
        low, high = planes * block // blocks, planes * (block + 1) // blocks
        for first in range(0, ny, tile):
            last = min(ny, first + tile)
            for z in range(low, high):
                if not made[z]:
                    _step_rows(populations, grid, rows, 0, first, last, z, places, force)
                if z - 1 > low:
                    _step_rows(populations, grid, rows, 1, max(1, first - 1), last - 1, z - 1, places, force)
        for z in range(low + 1, high - 1):
            _step_rows(populations, grid, rows, 1, ny - 1, ny, z, places, force)
            _step_rows(populations, grid, rows, 1, 0, 1, z, places, force)
    for half in prange(2 * blocks):
        block = np.int64(half)
        low, high = planes * (block // 2) // blocks, planes * (block // 2 + 1) // blocks
        if low < high - 1 or (low < high and block % 2 == 0):
            z = low if block % 2 == 0 else high - 1
            _step_rows(populations, grid, rows, 1, 0, ny, z, places, force)
