import numpy as np
import pytest

from lbm import FixedBody, InputError, Rates, Simulation
from lbm.stencil import Q

RATES = Rates.two_relaxation_times(0.1)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("steps", [400, 401])
def test_a_half_way_slab_is_the_wall_of_a_face(axis, steps):
    """Two solid layers in a periodic box act on the fluid between them as no-slip faces do."""
    n, direction = 8, (axis + 1) % 3
    force = tuple(1e-5 if d == direction else 0.0 for d in range(3))
    shape, thick = [4, 4, 4], [4, 4, 4]
    shape[axis], thick[axis] = n, n + 2
    faces = Simulation(tuple(shape), RATES, faces={"xyz"[axis]: "no-slip"}, force=force)
    slab = Simulation(tuple(thick), RATES, force=force)
    solid = np.zeros(thick, dtype=bool)
    ends, inside = [slice(None)] * 3, [slice(None)] * 3
    ends[axis], inside[axis] = [0, n + 1], slice(1, n + 1)
    solid[tuple(ends)] = True
    slab.add(FixedBody(solid))
    faces.run(steps)
    slab.run(steps)
    assert np.abs(slab.velocity[direction][tuple(inside)] - faces.velocity[direction]).max() < 1e-15


def test_moving_surface_drags_the_fluid():
    n = 8
    solid = np.zeros((4, 4, n + 2), dtype=bool)
    solid[:, :, [0, -1]] = True
    flow = Simulation((4, 4, n + 2), RATES)
    flow.add(FixedBody(solid, velocity=(0.02, -0.01, 0.0)))
    flow.run(3001)
    assert flow.velocity[0, :, :, 1:-1] == pytest.approx(np.full((4, 4, n), 0.02), rel=1e-9)
    assert flow.velocity[1, :, :, 1:-1] == pytest.approx(np.full((4, 4, n), -0.01), rel=1e-9)


@pytest.mark.parametrize("q", [0.0, -0.2, 1.2, np.nan])
def test_fractions_outside_the_link_are_refused(q):
    solid = np.zeros((8, 8, 8), dtype=bool)
    solid[3:5, 3:5, 3:5] = True
    with pytest.raises(InputError, match="fraction"):
        Simulation((8, 8, 8), RATES).add(FixedBody(solid, np.full((Q, 8, 8, 8), q)))


def test_body_of_another_grid_is_refused():
    solid = np.zeros((8, 8, 8), dtype=bool)
    solid[3:5, 3:5, 3:5] = True
    flow = Simulation((8, 8, 9), RATES)
    with pytest.raises(InputError, match="grid"):
        flow.add(FixedBody(solid))
