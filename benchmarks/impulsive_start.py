"""The impulse that a sphere set moving at once takes from the fluid, against the exact unsteady Stokes flow.

After a jump of the velocity by u the fluid has taken up, in Stokes flow without walls (Boussinesq 1885; Basset
1888; Landau & Lifshitz, Fluid Mechanics, section 24, problem 5)::

    J/(m_f u) = 1/2 + (9/sqrt(pi)) sqrt(T) + (9/2) T,   T = nu t/a^2

added mass, history and steady drag, m_f being the displaced mass. It is what a rebound asks of the lattice: right
after it the layer that has been set moving is thinner than a cell. Viscosity and times are those of the rebound at
St 152 and Re 164. Means over d/c_s, for sound goes to and fro; later it comes back from the periodic images.

    python -m benchmarks.impulsive_start
"""

from __future__ import annotations

import math

import numpy as np
from rich.console import Console
from rich.table import Table

from lbm import Rates, Simulation
from lbm.spheres import Sphere, Spheres

REYNOLDS = 164.0
SPEED = 1e-3
"""Cells a step; so low that convection does not enter."""
GRIDS = ((10, 0.025), (16, 0.025), (20, 0.025), (10, 0.0125), (20, 0.0125))
"""Cells a diameter, and the lattice speed of the rebound that goes with the viscosity."""
TIMES = (0.1, 0.15, 0.25, 0.4, 0.6)
"""In diameters of way of the rebound, t U/d."""


class HeldSphere(Spheres):
    """Spheres that keep place and speed; ``felt``: the force along z, step by step."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.felt: list[float] = []

    def _move(self, s, step, grid):
        self.felt.append(self.forces[s, 2])


def impulse(diameter: int, viscosity: float, gap: float, steps: int, width=8, height=8) -> np.ndarray:
    """J/(m_f u), step by step, of a sphere set moving away from a wall at ``gap`` cells; box in diameters."""
    n = diameter
    flow = Simulation(
        (width * n, width * n, height * n), Rates.two_relaxation_times(viscosity), faces={"z": "no-slip"}
    )
    sphere = Sphere(n / 2, 8.0, (width * n / 2, width * n / 2, gap + n / 2), velocity=(0.0, 0.0, SPEED))
    held = HeldSphere([sphere])
    flow.add(held)
    flow.run(steps)
    return -np.cumsum(held.felt) / (SPEED * held.volumes[0])


def exact(time):
    """J/(m_f u) at T = nu t/a^2."""
    return 0.5 + 9 / math.sqrt(math.pi) * np.sqrt(time) + 4.5 * np.asarray(time)


def excess(diameter: int, lattice_speed: float, times=TIMES, width=8) -> list[float]:
    """Lattice less exact, far from walls, at the ``times``, means over d/c_s."""
    n = diameter
    viscosity, half = lattice_speed * n / REYNOLDS, round(n * math.sqrt(3) / 2)
    at = [round(t * n / lattice_speed) for t in times]
    found = impulse(n, viscosity, (width - 1) / 2 * n, at[-1] + half, width, width)
    difference = found - exact(viscosity * (np.arange(len(found)) + 1) / (n / 2) ** 2)
    return [float(np.mean(difference[t - half : t + half])) for t in at]


def main() -> None:
    """Print the table."""
    table = Table("cells a diameter", "lattice speed", "viscosity", *(f"t U/d = {t:g}" for t in TIMES))
    for n, speed in GRIDS:
        row = (f"{e:+.3f}" for e in excess(n, speed))
        table.add_row(f"{n}", f"{speed:g}", f"{speed * n / REYNOLDS:.2g}", *row)
    table.add_row("exact J", "", "", *(f"{exact(4 * t / REYNOLDS):.3f}" for t in TIMES))
    Console(width=110).print(table)


if __name__ == "__main__":
    main()
