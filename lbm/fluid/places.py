"""Which relaxation rates hold in which cell: by its layer, counted from the nearest no-slip wall.

A row of cells has a layer as far as walls normal to y and z decide; along it each cache line has a kind, which
says how far its cells are from walls normal to x. ``table[layer, kind, j, lane]`` is the j-th of the scaled rates
of a cell, lanes being the cells of a line: rates are read as vectors, as populations are, and one loop serves
rows near walls and far from them, and uniform rates, which are one layer and one kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from lbm.fluid.memory import LINE_BYTES, rates_scopes

FACTORS = 18
"""Length of :meth:`lbm.rates.Rates.scaled`."""


class Places(NamedTuple):
    """The ``table``, flat; the layers of ``rows`` (nz, ny); the kinds of the ``lines`` of a row, and how many."""

    table: np.ndarray
    rows: np.ndarray
    lines: np.ndarray
    kinds: int


def places(scaled: np.ndarray, walls: Sequence[bool], shape: tuple[int, int, int]) -> Places:
    """Scaled rates by layer, (layers, 18), counted from the faces x-, x+, ..., z+ that are ``walls``.

    The last ones are for all cells beyond.
    """
    farthest, line = len(scaled) - 1, LINE_BYTES // scaled.itemsize
    x, y, z = (_layer(n, walls[2 * axis : 2 * axis + 2], farthest) for axis, n in enumerate(shape))
    rows = np.minimum(z[:, None], y[None, :]).astype(np.int64)
    padded = np.concatenate([x, np.full(-shape[0] % line, farthest)]).reshape(-1, line)
    lanes, lines = np.unique(padded, axis=0, return_inverse=True)
    cells = np.minimum(np.arange(len(scaled))[:, None, None], lanes[None])  # (layers, kinds, lanes)
    table = np.ascontiguousarray(scaled[cells].transpose(0, 1, 3, 2)).ravel()
    return Places(table, rows, lines.reshape(-1).astype(np.int64), len(lanes))


def _layer(cells: int, walls: Sequence[bool], farthest: int) -> np.ndarray:
    """Layer of each cell along one axis with walls at its low and its high end."""
    layer, up = np.full(cells, farthest), np.arange(cells)
    if walls[0]:
        layer = np.minimum(layer, up)
    if walls[1]:
        layer = np.minimum(layer, up[::-1])
    return layer


@intrinsic
def load_rates(typingctx, table, start, lane):
    """The 18 values ``table[start + j * line + lane]``, line being the length of a cache line."""
    result = types.UniTuple(table.dtype, FACTORS)

    def codegen(context, builder, signature, args):
        table, start, lane = args
        data = context.make_array(signature.args[0])(context, builder, table).data
        line = LINE_BYTES // context.get_abi_sizeof(context.get_data_type(signature.args[0].dtype))
        own, others = rates_scopes(builder.module)
        values = []
        for j in range(FACTORS):
            place = builder.add(builder.add(start, cgutils.intp_t(j * line)), lane)
            value = builder.load(builder.gep(data, [place], inbounds=True))
            value.set_metadata("alias.scope", own)
            value.set_metadata("noalias", others)
            values.append(value)
        return context.make_tuple(builder, result, values)

    return result(table, types.int64, types.int64), codegen
