"""What a sphere's surface adds to the fluid or takes from it is counted and goes back."""

import numpy as np
import pytest

from lbm import Rates, Simulation
from lbm.spheres import Sphere, Spheres

RADIUS = 3.0


def held_or_moved(shape, centre, drive, faces=None, viscosity=0.01, **given):
    flow = Simulation(shape, Rates.two_relaxation_times(viscosity), faces=faces)
    ball = Spheres([Sphere(RADIUS, 8.0, centre)], drive=drive, **given)
    flow.add(ball)
    return flow, ball


def deviations(flow, ball):
    """Sum of rho - 1 over the cells that the sphere does not cover."""
    offsets = [np.arange(n) + 0.5 - c for n, c in zip(flow.shape, ball.centres[0], strict=True)]
    x, y, z = np.meshgrid(*offsets, indexing="ij")
    return float((flow.density - 1)[x**2 + y**2 + z**2 >= RADIUS**2].sum())


@pytest.mark.parametrize("scheme", ["linear", "central-linear"])
def test_the_account_is_what_the_fluid_has_gained(scheme):
    """Along an oblique way, past cells that are covered and uncovered."""
    flow, ball = held_or_moved(
        (18, 18, 40),
        (9.3, 9.1, 31.0),
        lambda step, gap: (0.01, 0.02, -0.06),
        {"z": "no-slip"},
        interpolation=scheme,
    )
    flow.run(200)
    assert ball.surplus[0] == pytest.approx(deviations(flow, ball), abs=1e-10)


def test_a_sphere_leaves_the_mass_of_a_closed_box_as_it_is():
    """Within 0.1 % of the volume swept over 17 diameters; without the account 1.5 % of it are lost."""
    flow, ball = held_or_moved(
        (18, 18, 30), (9.3, 9.1, 24.0), lambda step, gap: (0.0, 0.0, -0.05), {"z": "no-slip"}
    )
    flow.run(300)
    swept = np.pi * RADIUS**2 * 2 * RADIUS * 17
    assert abs(deviations(flow, ball)) < 1e-3 * swept


def test_what_goes_back_pushes_the_sphere_nowhere():
    """The sum of w_k c_k over the links of a closed surface is zero."""
    flow, ball = held_or_moved((18, 18, 18), (9.3, 9.1, 8.8), lambda step, gap: (0.0, 0.0, 0.0))
    ball.surplus[:] = 2.0
    flow.run(1)
    assert np.abs(ball.forces).max() < 1e-15
    first = ball.surplus[0]
    assert 0 < first < 2
    flow.run(300)
    assert ball.surplus[0] < 0.02
    assert deviations(flow, ball) == pytest.approx(ball.surplus[0] - 2.0, abs=1e-12)
