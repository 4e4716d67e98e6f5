"""The added mass that the lattice gives a sphere touching a wall, by resolution
(:mod:`lbm.problems.impulsive_start`).

Potential flow past the touching sphere gives (3/2) zeta(3) - 1 = 0.803. The lattice has less: where the film is
thinner than half a cell no fluid is reversed. Run ``python -m benchmarks.added_mass``.
"""

from __future__ import annotations

from lbm.problems.impulsive_start import added_mass
from lbm.spheres import lattice_added_mass


def main() -> None:
    """Print the table."""
    print("cells a diameter   lattice   lattice_added_mass()")
    for n in (8, 10, 12, 16, 20, 24):
        print(f"{n:16d} {added_mass(n):9.3f} {lattice_added_mass(n):11.3f}", flush=True)


if __name__ == "__main__":
    main()
