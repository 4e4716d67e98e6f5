"""The compiled sweeps in place against the method written plainly."""

import numpy as np
import pytest

from lbm import Rates, RatesByPlace, Simulation
from tests.lbm import reference

BOXES = {
    "periodic": ("periodic", "periodic", "periodic"),
    "walls": ("no-slip", "no-slip", "no-slip"),
    "slip and walls": ("free-slip", "no-slip", "free-slip"),
    "channel": ("periodic", "free-slip", "no-slip"),
    "slip": ("free-slip", "free-slip", "free-slip"),
}
RATES = Rates(nu=1.7, e=1.1, eps=1.3, q=1.2, pi=1.5, m=1.9)
BY_PLACE = RatesByPlace(Rates(nu=1.7, e=1.5, eps=1.2, q=0.7, pi=1.1, m=0.4), RATES, reach=2, blend=1)
SHAPE = (21, 6, 9)  # one row longer than the vectorised strips, and a remainder


def _started(kinds, dtype=np.float64, force=None, threads=None, rates=RATES, shape=SHAPE):
    flow = Simulation(
        shape, rates, faces=dict(zip("xyz", kinds, strict=True)), force=force, dtype=dtype, threads=threads
    )
    start = 0.01 * np.random.default_rng(3).standard_normal(flow.lattice.slots().shape)
    flow.lattice.slots()[...] = start
    return flow, flow.lattice.slots().astype(float).transpose(0, 3, 2, 1)


@pytest.mark.parametrize("steps", [1, 2, 5, 6])
@pytest.mark.parametrize("force", [None, (1e-3, -2e-3, 5e-4)], ids=["no force", "force"])
@pytest.mark.parametrize("kinds", BOXES.values(), ids=BOXES)
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 2e-15), (np.float32, 2e-7)])
def test_same_flow_as_the_plain_method(kinds, force, steps, dtype, tolerance):
    flow, f = _started(kinds, dtype, force)
    flow.run(steps, guard=None)
    half_force = np.array(force or (0, 0, 0)).reshape(3, 1, 1, 1) / 2
    for _ in range(steps):
        f = reference.stream(reference.collide(f, RATES, force or (0, 0, 0)), kinds)
    rho = 1 + f.sum(axis=0)
    u = (np.tensordot(reference.C.T.astype(float), f, axes=1) + half_force) / rho
    assert np.abs(flow.density - rho).max() < tolerance
    assert np.abs(flow.velocity - u).max() < tolerance


@pytest.mark.parametrize("kinds", BOXES.values(), ids=BOXES)
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 2e-15), (np.float32, 2e-7)])
def test_each_cell_relaxes_as_its_distance_to_the_walls_says(kinds, dtype, tolerance):
    shape = (39, 7, 9)  # whole strips, strips of cells with rates of their own, and a remainder
    flow, f = _started(kinds, dtype, rates=BY_PLACE, shape=shape)
    distance = np.full(shape, 3)
    for axis, kind in enumerate(kinds):
        if kind == "no-slip":
            cells = np.arange(shape[axis])
            layer = np.minimum(cells, cells[::-1]).reshape([-1 if a == axis else 1 for a in range(3)])
            distance = np.minimum(distance, layer)
    flow.run(3, guard=None)
    for _ in range(3):
        by_layer = [reference.collide(f, rates, (0, 0, 0)) for rates in BY_PLACE.layers()]
        f = reference.stream(np.choose(distance, by_layer), kinds)
    assert np.abs(flow.density - 1 - f.sum(axis=0)).max() < tolerance


def test_exchanged_axes_give_the_exchanged_flow():
    u = 0.01 * np.random.default_rng(5).standard_normal((3, 21, 8, 10))
    for a, b in ((0, 1), (1, 2), (0, 2)):
        order = [0, 1, 2]
        order[a], order[b] = b, a
        found = []
        for way in (slice(None), order):
            velocity = u[way].transpose(0, *(np.arange(1, 4)[way]))
            flow = Simulation(velocity.shape[1:], BY_PLACE, faces=dict.fromkeys("xyz", "no-slip"))
            flow.set_flow(1.0, velocity)
            flow.run(5, guard=None)
            found.append(flow.velocity)
        np.testing.assert_allclose(found[1], found[0][order].transpose(0, *(1 + np.array(order))), atol=1e-15)


@pytest.mark.parametrize("kinds", BOXES.values(), ids=BOXES)
def test_two_steps_in_one_sweep_are_two_steps(kinds):
    at_once, _ = _started(kinds)
    singly, _ = _started(kinds)
    at_once.run(8, guard=None)
    for _ in range(8):
        singly.run(1, guard=None)
    assert (at_once.lattice.slots() == singly.lattice.slots()).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize(("steps", "kinds"), [(20, "channel"), (21, "walls")])
def test_result_does_not_depend_on_the_threads(steps, kinds, dtype):
    results = []
    for threads in (1, 2):
        flow, _ = _started(BOXES[kinds], dtype, threads=threads, rates=BY_PLACE)
        flow.run(steps, guard=None)
        results.append(flow.lattice.slots().copy())
    assert (results[0] == results[1]).all()


@pytest.mark.parametrize(("n", "dtype"), [(128, "float64"), (128, "float32"), (192, "float64"), (192, "float32")])
def test_memory_is_little_more_than_the_populations(n, dtype):
    from lbm.fluid.lattice import layout

    itemsize = np.dtype(dtype).itemsize
    assert layout((n, n, n), (0,) * 6, itemsize).size <= 1.1 * 19 * n**3


@pytest.mark.filterwarnings("ignore:grid Reynolds number")
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_mass_and_momentum_are_conserved_over_ten_thousand_steps(dtype):
    shape = (12, 10, 8)
    flow = Simulation(shape, Rates.two_relaxation_times(0.01), dtype=dtype)
    rng = np.random.default_rng(0)
    velocity = 0.02 * rng.standard_normal((3, *shape)) + np.array([0.03, -0.02, 0.01]).reshape(3, 1, 1, 1)
    flow.set_flow(1 + 0.01 * rng.standard_normal(shape), velocity)

    def totals():
        rho, u = (field.astype(float) for field in flow.fields())
        return np.array([rho.sum(), *(rho * u).sum(axis=(1, 2, 3))])

    before = totals()
    flow.run(10_000)
    relative = 1e-12 if dtype == np.float64 else 1e-4
    assert np.abs(totals() / before - 1).max() < relative
