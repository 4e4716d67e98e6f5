"""Task: the drag of a sphere that is held in a slow stream, with the solver alone.

A force density drives fluid through a periodic cube, one cell of a simple cubic array of spheres, until the flow
is steady.
Printed: the drag over Stokes' 6 pi mu a U, and what Hasimoto's series gives; the drag over the push.
Source: H. Hasimoto, J. Fluid Mech. 5 (1959) 317. Lattice units: of a flow this slow nothing but ratios matters.
"""

import math

import numpy as np

from lbm import Rates, Simulation
from lbm.spheres import Sphere, Spheres


def main():
    """Drag of one sphere of the array, in units of Stokes' law and of the push that drives the flow."""
    cells, radius, viscosity, push = 20, 4.0, 1 / 6, 1e-5
    flow = Simulation((cells,) * 3, Rates.two_relaxation_times(viscosity), force=(push, 0, 0), dtype="float32")
    held = Spheres([Sphere(radius, density=1.0, position=(cells / 2,) * 3)], drive=lambda step, gap: (0, 0, 0))
    flow.add(held)

    solid = 4 / 3 * math.pi * radius**3 / cells**3
    stokes_over_drag = 1 - 1.7601 * solid ** (1 / 3) + solid - 1.5593 * solid**2  # Hasimoto
    flow.run(round(12 * cells**3 / (6 * math.pi * viscosity * radius) * stokes_over_drag))  # twelve times it takes

    x, y, z = np.meshgrid(*(np.arange(cells) + 0.5 - cells / 2,) * 3, indexing="ij")
    mean_speed = flow.velocity[0][x**2 + y**2 + z**2 > radius**2].sum() / cells**3
    drag = held.forces[0, 0] + push * held.volumes[0]  # what is exchanged, and its share of the pressure gradient
    ratio = drag / (6 * math.pi * viscosity * radius * mean_speed)
    print(f"drag over Stokes' law: {ratio:.3f}, by Hasimoto's series {1 / stokes_over_drag:.3f}")
    print(f"drag over the push on the whole cube: {drag / (push * cells**3):.4f}")
    return {"drag": ratio, "hasimoto": 1 / stokes_over_drag, "drag_over_push": drag / (push * cells**3)}


if __name__ == "__main__":
    main()
