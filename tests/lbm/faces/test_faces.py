import numpy as np
import pytest

from lbm import FixedBody, FreeSlip, Inlet, InputError, NoSlip, Outlet, OutsideRangeWarning, Rates, Simulation

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
    assert gradient == pytest.approx(drop / 3 / 24, rel=2e-3)


def test_flux_between_two_pressures_converges_with_the_square_of_the_cell():
    errors = []
    for n in (4, 8):  # cells from wall to wall, diffusive scaling
        length, drop = 5 * n // 2, 0.002 * (8 / n) ** 2
        faces = {"x-": Outlet(1 + drop / 2), "x+": Outlet(1 - drop / 2), "y": NoSlip()}
        flow = Simulation((length, n, 4), RATES, faces=faces)
        flow.run(30 * n * n)
        y = np.arange(n) + 0.5
        exact = np.sum(drop / 3 / length / (2 * 0.1) * y * (n - y))
        errors.append(np.abs(flow.velocity[0, :, :, 0].sum(axis=1) / exact - 1).max())
    assert errors[1] < 2e-3
    assert np.log2(errors[0] / errors[1]) > 1.8


def test_couette_flow_crosses_outlets_unchanged():
    faces = {"x": Outlet(0.9), "z-": NoSlip(), "z+": NoSlip((0.05, 0, 0))}
    flow = Simulation((8, 4, 8), RATES, faces=faces)
    flow.set_flow(0.9)
    flow.run(3001)
    exact = 0.05 * (np.arange(8) + 0.5) / 8
    assert np.abs(flow.velocity[0] - exact).max() < 1e-9


@pytest.mark.parametrize("steps", [400, 401])
def test_uniform_stream_along_open_sides_stays_uniform(steps):
    u = (0.05, 0.0, 0.0)
    flow = Simulation((9, 8, 5), RATES, faces={"x-": Inlet(u), "x+": "outlet", "y": "outlet", "z": "outlet"})
    flow.set_flow(1.0, u)
    flow.run(steps)
    assert np.abs(flow.velocity - np.reshape(u, (3, 1, 1, 1))).max() < 1e-12
    assert np.abs(flow.density - 1).max() < 1e-12


@pytest.mark.parametrize("rest", [0.8, 1.0, 1.2])
def test_walls_and_inlets_have_their_velocity_at_any_density(rest):
    couette = Simulation((4, 4, 8), RATES, faces={"z-": NoSlip(), "z+": NoSlip((0.05, 0, 0))})
    couette.set_flow(rest)
    couette.run(3001)
    assert couette.velocity[0, 0, 0] == pytest.approx(0.05 * (np.arange(8) + 0.5) / 8, rel=1e-9)
    assert couette.density.mean() == pytest.approx(rest, abs=1e-13)
    solid = np.zeros((4, 4, 8), dtype=bool)
    solid[:, :, [0, -1]] = True
    dragged = Simulation((4, 4, 8), RATES)
    dragged.add(FixedBody(solid, velocity=(0.02, -0.01, 0.0)))
    dragged.set_flow(rest)
    dragged.run(2001)
    assert dragged.velocity[0, :, :, 1:-1] == pytest.approx(np.full((4, 4, 6), 0.02), rel=1e-9)
    stream = Simulation((16, 4, 4), RATES, faces={"x-": Inlet((0.03, 0, 0)), "x+": Outlet(rest)})
    stream.set_flow(rest, (0.03, 0, 0))
    stream.run(500)
    assert stream.velocity[0] == pytest.approx(np.full((16, 4, 4), 0.03), rel=1e-9)


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


def test_a_square_cavity_converges_at_second_order():
    """Extrema at Re 100: Botella & Peyret, Comput. Fluids 27 (1998) 421."""
    errors = []
    for n in (16, 32):
        faces = {"x": "no-slip", "z-": "no-slip", "z+": NoSlip((0.1, 0, 0))}
        flow = Simulation((n, 4, n), viscosity=0.1 * n / 100, faces=faces)
        flow.run(250 * n)
        middle, velocity = slice(n // 2 - 1, n // 2 + 1), flow.velocity[:, :, 0]
        u, w = velocity[0, middle].mean(0), velocity[2, :, middle].mean(1)
        found = np.array([u.min(), w.max(), w.min()]) / 0.1
        errors.append(np.abs(found / [-0.2140424, 0.1795728, -0.2538030] - 1).max())
    assert errors[1] < 0.03
    assert np.log2(errors[0] / errors[1]) > 1.7


def test_wall_velocity_may_vary_over_the_face():
    faces = {"z-": NoSlip(), "z+": NoSlip(np.broadcast_to([0.02, 0.0, 0.0], (4, 5, 3)))}
    flow = Simulation((4, 5, 8), RATES, faces=faces)
    flow.run(2000)
    assert flow.velocity[0, 0, 0] == pytest.approx(0.02 * (np.arange(8) + 0.5) / 8, rel=1e-6)


def _rolls(n, speed):
    """Stokes flow (u, w) on cells (x, z) over a wall at z = 0 with u = speed sin(kx), still wall at n = 2 pi/k.

    From psi = (B z cosh kz + (C + D z) sinh kz) sin kx, biharmonic, with psi = 0 on both walls.
    """
    k = 2 * np.pi / n
    ch, sh = np.cosh(k * n), np.sinh(k * n)
    conditions = [[1, k, 0], [n * ch, sh, n * sh], [ch + n * k * sh, k * ch, sh + n * k * ch]]
    b, c, d = np.linalg.solve(conditions, [speed, 0, 0])
    x, z = (np.arange(n) + 0.5)[:, None], (np.arange(n) + 0.5)[None]
    ch, sh = np.cosh(k * z), np.sinh(k * z)
    psi = b * z * ch + (c + d * z) * sh
    slope = b * ch + b * z * k * sh + d * sh + (c + d * z) * k * ch
    return slope * np.sin(k * x), -k * psi * np.cos(k * x)


def test_a_stretched_wall_is_second_order_and_keeps_the_mass():
    errors, nu, speed = [], 0.05, 1e-6  # slow: what the solution leaves out is of relative order Re = n speed/nu
    for n in (8, 16, 32):
        wall = np.zeros((n, 4, 3))
        wall[..., 0] = speed * np.sin(2 * np.pi * (np.arange(n) + 0.5) / n)[:, None]
        flow = Simulation((n, 4, n), Rates.two_relaxation_times(nu), faces={"z-": NoSlip(wall), "z+": "no-slip"})
        flow.run(round(0.5 * n * n / nu))
        exact = np.array(_rolls(n, speed))
        errors.append(np.linalg.norm(flow.velocity[[0, 2], :, 0] - exact) / np.linalg.norm(exact))
        assert abs(flow.density.mean() - 1) < 1e-15
    # the order still rises with the resolution: 1.82, 1.93
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("rest", [0.9, 1.0])
def test_a_lid_slower_towards_its_edges_loses_no_mass(rest):
    n = 10
    s = (np.arange(n) + 0.5) / n
    lid = np.zeros((n, n, 3))
    lid[..., 0] = 0.1 * (np.sin(np.pi * s) * (1 + s))[:, None]  # not symmetric
    faces = {"x": "no-slip", "y": "no-slip", "z-": "no-slip", "z+": NoSlip(lid)}
    flow = Simulation((n, n, n), RATES, faces=faces)
    flow.set_flow(rest)
    flow.run(1001)
    assert flow.density.mean() == pytest.approx(rest, abs=1e-13)
    assert np.ptp(flow.density) > 1e-3  # the density varies along the lid


@pytest.mark.parametrize("n", [6, 12])
def test_what_inlets_bring_between_still_walls(n):
    """A plug loses 1/(3n) at the walls, a parabola (n - 1)/(2n^3): sums over the links, by hand."""
    y = np.arange(n) + 0.5
    plug, parabola = np.full(n, 1e-3), 1e-5 * y * (n - y)
    fluxes = 1e-3 * n * (1 - 1 / (3 * n)), 1e-5 * n**3 / 6 * (1 - (n - 1) / (2 * n**3))
    for profile, flux in zip((plug, parabola), fluxes, strict=True):
        entering = np.zeros((n, 4, 3))
        entering[..., 0] = profile[:, None]
        flow = Simulation((12, n, 4), RATES, faces={"x-": Inlet(entering), "x+": "outlet", "y": "no-slip"})
        flow.run(3000)
        through = (flow.density * flow.velocity[0])[:-1].sum(axis=(1, 2)) / 4
        entered = flow.density[0].mean()  # the push goes with the density at the inlet
        assert through == pytest.approx(np.full(11, through[0]), rel=1e-6)
        assert through[0] == pytest.approx(flux * entered, rel=5e-4)


@pytest.mark.parametrize(
    ("faces", "named"),
    [
        ({"w": "no-slip"}, "'w'"),
        ({"x": "sticky"}, "sticky"),
        ({"x-": "no-slip"}, "x- and x+"),
        ({"x": NoSlip([[0.1], [0.0, 1]])}, "rows"),
        ({"x": NoSlip((0.1, 0.0))}, "shape"),
        ({"x": NoSlip(np.ones((3, 3, 3)))}, "shape"),
        ({"x": NoSlip((np.nan, 0, 0))}, "not finite"),
        ({"x": Outlet(-1.0)}, "density"),
        ({"x": Outlet("a")}, "'a'"),
        ({"x-": Inlet(0.05), "x+": "outlet"}, r"face x-.*shape \(\).*\(6, 6, 3\)"),
        ({"x-": Inlet(np.zeros((6, 3))), "x+": "outlet"}, r"shape \(6, 3\)"),
        ({"x-": Inlet(np.zeros((6, 1, 3))), "x+": "outlet"}, r"shape \(6, 1, 3\)"),
        ({"x": NoSlip(0.0)}, "shape"),
        ({"x": NoSlip(lambda t: 0.1)}, "shape"),
        ({"x": NoSlip("fast")}, "'fast'"),
        ({"y+": NoSlip((0.0, -0.1, 0.0)), "y-": "no-slip"}, r"face y\+.*normal component -0.1"),
        ({"x": "no-slip", "x-": "outlet"}, "given twice"),
        ({"x": None}, "None"),
        ({"x": NoSlip}, r"NoSlip\(...\)"),
        ({"x": 5}, "5"),
        ({"y-": NoSlip((0.0, 0.0, 5.0)), "y+": "no-slip"}, r"y-: velocity: speed 5"),
        ({"x-": Inlet((2.0, 0.0, 0.0)), "x+": "outlet"}, "speed 2"),
        ({"x": Outlet(1000)}, "density: 1000"),
        ({"x": NoSlip((0, 1j, 0))}, "real"),
        ("no-slip", "mapping"),
    ],
)
def test_bad_faces_are_refused(faces, named):
    with pytest.raises(InputError, match=named):
        Simulation((6, 6, 6), RATES, faces=faces)


def test_inlets_that_fill_the_box_are_warned_of():
    with pytest.warns(OutsideRangeWarning, match="net volume of 1.8 per step"):
        Simulation((6, 6, 6), RATES, faces={"x-": Inlet((0.05, 0, 0)), "x+": "no-slip"})
    u = (0.05, 0, 0)
    Simulation((6, 6, 6), RATES, faces={"x-": Inlet(u), "x+": Inlet(u)})  # what enters leaves
