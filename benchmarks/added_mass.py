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

from lbm import Rates, Simulation
from lbm.contact import lattice_added_mass
from lbm.spheres import Sphere, Spheres

VISCOSITY, SPEED = 1e-4, 1e-3
WIDTH, HEIGHT = 6, 5


class _Held(Spheres):
    """Spheres that keep place and speed."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.felt: list[float] = []

    def _move(self, s, step, grid):
        self.felt.append(self.forces[s, 2])


def impulse(diameter: int, gap: float) -> float:
    """Mean impulse over displaced mass and speed between 2 and 4 d/c_s after the start."""
    n = diameter
    flow = Simulation(
        (WIDTH * n, WIDTH * n, HEIGHT * n), Rates.two_relaxation_times(VISCOSITY), faces={"z": "no-slip"}
    )
    centre = (WIDTH * n / 2, WIDTH * n / 2, gap + n / 2)
    held = _Held([Sphere(n / 2, 8.0, centre, velocity=(0.0, 0.0, SPEED))])
    flow.add(held)
    flow.run(round(4 * n * 3**0.5))
    taken = -np.cumsum(held.felt) / (SPEED * held.volumes[0])
    return float(np.mean(taken[round(2 * n * 3**0.5) :]))


def main() -> None:
    """Print the table."""
    print("cells a diameter   lattice   lattice_added_mass()")
    for n in (8, 10, 12, 16, 20, 24):
        found = 0.5 + impulse(n, 5e-5 * n) - impulse(n, 2.0 * n)
        print(f"{n:16d} {found:9.3f} {lattice_added_mass(n):11.3f}", flush=True)


if __name__ == "__main__":
    main()
