"""The added mass that the lattice gives a sphere touching a wall, by resolution.

A sphere in fluid at rest is set moving at once, away from the wall that it touches or far from walls, and the
impulse of the fluid's force is taken once sound has passed it: between 2 and 4 d/c_s, the mean. The viscosity
is so low that friction hardly enters, and what does enter, with the lattice's own skin of one cell, is the same
far from the wall, where potential flow gives 1/2 (of the displaced mass)::

    C = 1/2 + (J_wall - J_far)/(m_f u)

Potential flow past the touching sphere gives (3/2) zeta(3) - 1 = 0.803. The lattice has less: where the film is
thinner than half a cell no fluid is reversed. Run ``python -m benchmarks.added_mass``.
"""

from __future__ import annotations

import numpy as np

from benchmarks import impulsive_start
from lbm.contact import lattice_added_mass

VISCOSITY = 1e-4
WIDTH, HEIGHT = 6, 5


def impulse(diameter: int, gap: float) -> float:
    """Mean impulse over displaced mass and speed between 2 and 4 d/c_s after the start."""
    sound = diameter * 3**0.5
    taken = impulsive_start.impulse(diameter, VISCOSITY, gap, round(4 * sound), WIDTH, HEIGHT)
    return float(np.mean(taken[round(2 * sound) :]))


def main() -> None:
    """Print the table."""
    print("cells a diameter   lattice   lattice_added_mass()")
    for n in (8, 10, 12, 16, 20, 24):
        found = 0.5 + impulse(n, 5e-5 * n) - impulse(n, 2.0 * n)
        print(f"{n:16d} {found:9.3f} {lattice_added_mass(n):11.3f}", flush=True)


if __name__ == "__main__":
    main()
