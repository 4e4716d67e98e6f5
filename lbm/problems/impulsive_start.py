"""A sphere set moving at once, on the lattice and exactly: what a rebound asks of the fluid.

After a jump of the velocity by u the fluid has taken up, in Stokes flow without walls (Boussinesq 1885; Basset
1888; Landau & Lifshitz, Fluid Mechanics, section 24, problem 5)::

    J/(m_f u) = 1/2 + (9/sqrt(pi)) sqrt(T) + (9/2) T,   T = nu t/a^2

added mass, history and steady drag, m_f being the displaced mass. Right after the jump the layer that has been set
moving is thinner than a cell.
"""

from __future__ import annotations

import math

import numpy as np

from lbm.rates import Rates
from lbm.simulation import Simulation
from lbm.spheres.spheres import Sphere, Spheres

REYNOLDS = 164.0
"""U d/nu of the rebound that viscosity and times are those of, at St 152."""
SPEED = 1e-3
"""Cells a step; so low that convection does not enter."""
TIMES = (0.1, 0.15, 0.25, 0.4, 0.6)
"""In diameters of way of the rebound, t U/d."""
TOUCHING = 5e-5
"""Gap in diameters of a sphere that touches a wall."""
FAR = 2.0
"""Gap in diameters of one that does not feel it."""


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


def added_mass(diameter: int, viscosity: float = 1e-4, width: int = 6, height: int = 5) -> float:
    """The added mass of a sphere that touches a wall, over the displaced mass.

    The impulse is taken once sound has passed the sphere, the mean between 2 and 4 d/c_s. The viscosity is so low
    that friction hardly enters, and what does enter, with the lattice's own skin of one cell, is the same far from
    the wall, where potential flow gives 1/2::

        C = 1/2 + (J_wall - J_far)/(m_f u)
    """
    sound = diameter * 3**0.5
    wall, far = (
        impulse(diameter, viscosity, gap * diameter, round(4 * sound), width, height) for gap in (TOUCHING, FAR)
    )
    return 0.5 + float(np.mean(wall[round(2 * sound) :]) - np.mean(far[round(2 * sound) :]))
