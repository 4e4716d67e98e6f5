import numpy as np
import pytest

from lbm import FreeSlip, Inlet, InputError, NoSlip, Outlet, Rates, Simulation

RATES = Rates.two_relaxation_times(0.1)
FACES = {"x": 0, "y": 1, "z": 2}


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1, -1])
def test_uniform_stream_from_inlet_to_outlet(axis, sign):
    shape = [5, 5, 5]
    shape[axis] = 16
    u = np.zeros(3)
    u[axis] = 0.03 * sign
    names = [name for name in FACES if FACES[name] != axis]
    low, high = (Inlet(tuple(u)), Outlet()) if sign > 0 else (Outlet(), Inlet(tuple(u)))
    own = "xyz"[axis]
    flow = Simulation(tuple(shape), RATES, faces={own + "-": low, own + "+": high, names[0]: FreeSlip()})
    flow.run(6001)
    assert np.abs(flow.velocity - u.reshape(3, 1, 1, 1)).max() < 3e-4
    assert np.abs(flow.density - 1).max() < 3e-3


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_pressure_difference_drives_poiseuille_flow(axis):
    across = (axis + 1) % 3
    shape = [4, 4, 4]
    shape[axis], shape[across] = 24, 10
    drop = 0.002
    own, wall = "xyz"[axis], "xyz"[across]
    faces = {own + "-": Outlet(1 + drop / 2), own + "+": Outlet(1 - drop / 2), wall: NoSlip()}
    flow = Simulation(tuple(shape), RATES, faces=faces)
    flow.run(6001)
    middle = [0, 0, 0]
    middle[axis], middle[across] = 12, slice(None)
    beside = [2, 2, 2]
    beside[axis] = slice(8, 17)
    pressure = flow.density[tuple(beside)] / 3
    gradient = (pressure[0] - pressure[-1]) / 8
    y = np.arange(10) + 0.5
    exact = gradient / (2 * 0.1) * y * (10 - y)
    assert flow.velocity[axis][tuple(middle)] == pytest.approx(exact, rel=2e-3)
    # the open faces leave out the viscous stress of the profile that crosses them
    assert gradient == pytest.approx(drop / 3 / 24, rel=0.05)


def test_lid_drives_a_vortex_and_loses_no_mass():
    n = 12
    faces = {"x": "no-slip", "y": "no-slip", "z-": "no-slip", "z+": NoSlip((0.05, 0, 0))}
    flow = Simulation((n, n, n), RATES, faces=faces)
    flow.run(1001)
    u = flow.velocity
    assert flow.density.mean() == pytest.approx(1, abs=1e-13)
    assert u[0, n // 2, n // 2, -1] > 0.02
    assert u[0, n // 2, n // 2, n // 3] < 0
    assert np.abs(u[1] + u[1, :, ::-1]).max() < 1e-14  # mirror symmetry across the lid's direction


def test_wall_velocity_may_vary_over_the_face():
    faces = {"z-": NoSlip(), "z+": NoSlip(np.broadcast_to([0.02, 0.0, 0.0], (4, 5, 3)))}
    flow = Simulation((4, 5, 8), RATES, faces=faces)
    flow.run(2000)
    assert flow.velocity[0, 0, 0] == pytest.approx(0.02 * (np.arange(8) + 0.5) / 8, rel=1e-6)


@pytest.mark.parametrize(
    ("faces", "named"),
    [
        ({"w": "no-slip"}, "'w'"),
        ({"x": "sticky"}, "sticky"),
        ({"x-": "no-slip"}, "x- and x+"),
        ({"x": NoSlip((0.1, 0.0))}, "shape"),
        ({"x": NoSlip(np.ones((3, 3, 3)))}, "shape"),
        ({"x": NoSlip((np.nan, 0, 0))}, "not finite"),
        ({"x": Outlet(-1.0)}, "density"),
    ],
)
def test_bad_faces_are_refused(faces, named):
    with pytest.raises(InputError, match=named):
        Simulation((6, 6, 6), RATES, faces=faces)
