"""Which relaxation rates hold in which cell: by its layer, counted from the nearest no-slip wall.

Along a row the layer changes only near walls normal to x. All other cells of the row share one set of rates, which
the sweep keeps in registers; at the ends of the row each cell reads its own from a table, in cache lines as it
does the populations, so that both loops are compiled to vectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit, types
from numba.extending import intrinsic

from lbm.fluid.memory import rates_scopes

_LINE = 64  # bytes in a cache line
FACTORS = 18
"""Length of :meth:`lbm.rates.Rates.scaled`."""


class Places(NamedTuple):
    """Scaled rates by layer, as the kernels see them.

    ``table[l]`` are the rates of layer l, ``rows[z, y]`` is the layer of row (y, z) as far as walls normal to y
    and z decide. From ``first`` to ``plain`` - 1 it holds for all x, in whole cache lines to ``last`` - 1; for the
    others ``along``, flat of shape (layers, 18, nx), has the rates cell by cell.
    """

    table: np.ndarray
    rows: np.ndarray
    along: np.ndarray
    first: int
    last: int
    plain: int


def places(table: np.ndarray, walls: Sequence[bool], shape: tuple[int, int, int]) -> Places:
    """Scaled rates by layer, (layers, 18), counted from the faces x-, x+, ..., z+ that are ``walls``.

    The last ones are for all cells beyond.
    """
    farthest = len(table) - 1
    x, y, z = (_layer(n, walls[2 * axis : 2 * axis + 2], farthest) for axis, n in enumerate(shape))
    rows = np.minimum(z[:, None], y[None, :]).astype(np.uint8)
    along = table[np.minimum(np.arange(len(table))[:, None], x[None, :])]  # (layers, nx, factors)
    line, nx = _LINE // table.itemsize, shape[0]
    first = min(-(-farthest // line) * line, nx // line * line) if walls[0] else 0
    end = nx - farthest if walls[1] else nx
    last = max(first, end // line * line)
    within_low_wall = walls[0] and first < farthest
    plain = last if within_low_wall else max(last, end)
    return Places(table, rows, np.ascontiguousarray(along.transpose(0, 2, 1)).ravel(), first, last, plain)


def _layer(cells: int, walls: Sequence[bool], farthest: int) -> np.ndarray:
    """Layer of each cell along one axis with walls at its low and its high end."""
    layer, up = np.full(cells, farthest), np.arange(cells)
    if walls[0]:
        layer = np.minimum(layer, up)
    if walls[1]:
        layer = np.minimum(layer, up[::-1])
    return layer


@njit(forceinline=True)
def row_rates(places, layer):
    """The rates of a layer."""
    t = places.table[layer]
    return (
        t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7], t[8],
        t[9], t[10], t[11], t[12], t[13], t[14], t[15], t[16], t[17],
    )  # fmt: skip


@intrinsic
def load_rates(typingctx, along, start, stride, x):
    """The 18 values ``along[start + i * stride + x]``."""
    result = types.UniTuple(along.dtype, FACTORS)

    def codegen(context, builder, signature, args):
        along, start, stride, x = args
        data = context.make_array(signature.args[0])(context, builder, along).data
        own, others = rates_scopes(builder.module)
        values, row = [], start
        for _ in range(FACTORS):
            value = builder.load(builder.gep(data, [builder.add(row, x)], inbounds=True))
            value.set_metadata("alias.scope", own)
            value.set_metadata("noalias", others)
            values.append(value)
            row = builder.add(row, stride)
        return context.make_tuple(builder, result, values)

    return result(along, types.int64, types.int64, types.int64), codegen
