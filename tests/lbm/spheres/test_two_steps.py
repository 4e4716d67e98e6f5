"""Two steps in one pass over memory around a sphere are two steps: the same numbers to the last bit."""

import numba
import numpy as np
import pytest

from lbm import Rates, Simulation
from lbm.spheres import DryRebound, Sphere, Spheres

RADIUS = 3.0
WHOLE = (17, 16, 40), (8.3, 8.1)
pytestmark = pytest.mark.filterwarnings("ignore:grid Reynolds number")
BOXES = {
    "between walls": (*WHOLE, {"z": "no-slip"}),
    "periodic": (*WHOLE, {}),
    "quarter": ((9, 8, 40), (0, 0), {"x": "free-slip", "y": "free-slip", "z": "no-slip"}),
}


def fall(box, at_once, dtype="float32", threads=1):
    shape, place, faces = BOXES[box]
    flow = Simulation(shape, Rates.two_relaxation_times(0.01), faces=faces, dtype=dtype, threads=threads)
    spheres = [
        Sphere(RADIUS, 8.0, (*place, RADIUS + 2.4), velocity=(0, 0, -0.08)),
        Sphere(2.5, 6.0, (*place, 24.2)),
    ]
    ball = Spheres(spheres, gravity=(0.0, 0.0, -4e-4), contact=DryRebound(0.9, 60.0, 10.0, 0.0))
    flow.add(ball)
    for steps in (80,) if at_once else (1,) * 80:
        flow.run(steps)
    return flow, ball


@pytest.mark.parametrize("box", BOXES)
def test_two_steps_around_spheres_are_two_steps(box):
    """Past cells covered and uncovered, a contact, a box that joins its ends."""
    (at_once, its), (singly, mine) = (fall(box, at_once) for at_once in (True, False))
    assert bool(its.impacts) == (box != "periodic")
    assert (at_once.lattice.slots() == singly.lattice.slots()).all()
    for sphere in range(2):
        for name, values in its.track(sphere).items():
            assert np.array_equal(values, mine.track(sphere)[name], equal_nan=True), name


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="needs two threads")
def test_they_do_not_depend_on_the_threads():
    one, two = (fall("between walls", True, threads=n)[0] for n in (1, 2))
    assert (one.lattice.slots() == two.lattice.slots()).all()
