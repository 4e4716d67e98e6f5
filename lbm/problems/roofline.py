"""How much of the memory's speed a step of the fluid gets, measured in one run: the machine drops out."""

from __future__ import annotations

import time

import numpy as np
from numba import njit, prange

from lbm.fluid.stencil import Q
from lbm.rates import Rates
from lbm.simulation import Simulation


@njit(parallel=True)
def read_and_write(a, factor):
    """Reads and writes an array once, in place: what the memory can do at best."""
    for i in prange(a.size):
        a[i] *= factor


def share_of_roofline(cells: int = 96, rounds: int = 9, dtype: str = "float64") -> float:
    """Cell updates a second over those that the memory could feed, median of the rounds' own ratios.

    Each cell's 19 populations would be read and written once. Two steps a sweep need not fetch them twice, so the
    share may exceed 1.
    """
    flow = Simulation((cells,) * 3, Rates.dhumieres2002(0.02), dtype=dtype)
    flow.compile()
    populations = flow.lattice.populations
    one = populations.dtype.type(1)
    ideal = 2 * cells**3 * 2 * Q * populations.itemsize  # bytes that two steps move
    shares = []
    for turn in range(rounds + 1):
        begin = time.perf_counter()
        read_and_write(populations, one)
        between = time.perf_counter()
        flow.run(2, guard=None)
        end = time.perf_counter()
        if turn > 0:  # the first round warms up
            at_best = (between - begin) * ideal / (2 * populations.nbytes)
            shares.append(at_best / (end - between))
    return float(np.median(shares))
