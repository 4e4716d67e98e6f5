"""How fast is a sphere braked after a rebound? By the point particle, in the terms of the prior of the impacts.

The flight outside the film, to a time T = sqrt(d/g) from where it leaves it, is fitted by a polynomial of order 5,
as ``restitution impacts`` does with frames. Printed is k! c_k T^(k-1)/v_in, of k = 2 beyond free fall, for the
fluids and spheres of the shipped records, falls of 3 and 10 d, e of 0.5 and 0.8, with the wake of the approach and
without, history force times 0.5 and 1.5; below it the means of products of two, which the prior takes
(:class:`restitution.impacts.branch.Prior`).

    python -m benchmarks.after_rebound
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
from numpy.polynomial import Polynomial

from restitution import datasets
from restitution.bounce import Closures, OwnWake, Release, bounce
from restitution.conditions import Conditions
from restitution.stokes import H_FILM

RECORDS = ("gondret2002_st152", "gondret2002_st27", "li2012_drop3")
"""Drop 5 of Li et al. is of the same fluid and sphere as drop 3."""
FALLS_D, RESTITUTIONS, WAKES, HISTORIES = (3.0, 10.0), (0.5, 0.8), (None, OwnWake()), (0.5, 1.5)
SHORTEST = 0.5
"""Flights shorter than this, in T, are left out."""


def coefficients(c: Conditions, fall: float, e: float, wake: OwnWake | None, history: float) -> np.ndarray | None:
    """k! c_k T^(k-1)/v_in for k = 2 to 5; None where there is no such flight."""
    d = c.sphere.diameter
    T = math.sqrt(d / c.gravity)
    closures = Closures(measured=(e, 0.4, 0.3, 0.2), wake=wake, history_factor=history)
    flight = bounce(c, Release(gap=fall * d), closures, end=40 * T)
    if len(flight.impacts) < 2:
        return None
    first, second = flight.impacts[:2]
    outside = (flight.time_s > first.time_s) & (flight.gap_m > H_FILM * d)
    start = flight.time_s[outside][0]
    if second.time_s - start < SHORTEST * T:
        return None
    time = np.linspace(start, min(start + T, second.time_s), 200)
    c_k = Polynomial.fit(time - start, flight.gap(time), 5).convert().coef
    found = np.array([math.factorial(k) * c_k[k] for k in range(2, 6)])
    found[0] += c.free_fall
    return found * T ** np.arange(1, 5) / first.v_in


def main() -> None:
    rows = []
    print("| record | fall, d | e | wake | history | k = 2 | 3 | 4 | 5 |\n|---|---|---|---|---|---|---|---|---|")
    for name, fall, e, wake, history in product(RECORDS, FALLS_D, RESTITUTIONS, WAKES, HISTORIES):
        row = coefficients(datasets.resource(name).conditions, fall, e, wake, history)
        if row is None:
            continue
        rows.append(row)
        numbers = " | ".join(f"{x:.2f}" for x in row)
        print(f"| {name} | {fall:g} | {e} | {'yes' if wake else 'no'} | {history} | {numbers} |")
    print("\nmeans of products of two of them:")
    print(np.array2string(np.einsum("ni,nj->ij", rows, rows) / len(rows), precision=3))


if __name__ == "__main__":
    main()
