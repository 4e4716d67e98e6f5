"""Moving spheres against exact solutions, invariances and measurements, at low resolution.

``benchmarks/sphere.py`` measures the same at the resolutions that matter.
"""

import math

import numba
import numpy as np
import pytest
from scipy.integrate import quad

from lbm import Rates, Simulation
from lbm.errors import DivergenceError, InputError
from lbm.problems import bouncing_spheres as bouncing
from lbm.problems import spheres as flows
from lbm.spheres import RESOLVED, SoftContact, Sphere, Spheres, lost_to_grid
from lbm.spheres.wall_motion import FRACTION, motion_at_wall

RATES = Rates.two_relaxation_times(0.1)
STILL = (0.0, 0.0, 0.0)


def test_drag_in_a_periodic_array_converges_in_second_order():
    """K = 4.292 at a solid fraction of 1/8 (Zick & Homsy 1982)."""
    coarse, fine = (
        abs(np.mean([flows.array_drag(cells, 0.125, shift) for shift in flows.SHIFTS[1:2]]) / 4.292 - 1)
        for cells in (10, 20)
    )
    assert coarse < 0.1
    assert math.log2(coarse / fine) > 1.8


@pytest.mark.parametrize("direction", [(1, 0, 0), (1, 0.62, 0.37)])
def test_force_on_a_sphere_that_crosses_the_grid_is_smooth(direction):
    found = flows.translation(8, direction, width=4, crossings=16)
    assert found.noise < 0.02
    assert found.lateral < 0.02


def test_drag_is_the_same_in_all_frames():
    still = flows.drag_in_frame(8, (0.04, 0, 0), STILL, width=3)
    for sphere, fluid in ((STILL, (-0.04, 0, 0)), ((0.05, 0.03, -0.02), (0.01, 0.03, -0.02))):
        assert flows.drag_in_frame(8, sphere, fluid, width=3) == pytest.approx(still, rel=0.015)


def test_a_sphere_in_shear_turns_at_half_the_shear_rate():
    """Jeffery, Proc. R. Soc. A 102 (1922) 161, for Re -> 0 in an unbounded shear."""
    found = flows.shear(8, width=4, height=5)
    assert found.turning == pytest.approx(1, abs=0.015)
    assert found.torque == pytest.approx(1, abs=0.05)


@pytest.mark.parametrize("ratio", [1.2, 2.0, 10.0])
def test_light_and_heavy_spheres_fall_without_oscillation(ratio):
    flow = Simulation((24, 24, 24), RATES)
    ball = Spheres([Sphere(3.0, ratio, (12.0, 12.3, 12.1))], gravity=(0.0, 0.0, -1e-4 / (ratio - 1)))
    flow.add(ball)
    flow.run(400)
    v = ball.track()["vz"]
    assert (np.diff(v[:100]) < 0).all()
    assert np.diff(v)[50:].max() < 0.01 * abs(v[-1])


@pytest.mark.filterwarnings("ignore:grid Reynolds number")
@pytest.mark.parametrize(("ratio", "radius"), [(1.2, 5.0), (2.17, 3.0)])
def test_spin_of_a_light_sphere_in_fluid_of_low_viscosity_dies_out(ratio, radius):
    flow = Simulation((24, 24, 24), Rates.two_relaxation_times(0.0017))
    ball = Spheres([Sphere(radius, ratio, (12.0, 12.3, 12.1), spin=(0.0, 0.004, 0.0))])
    flow.add(ball)
    flow.run(400)
    spin = ball.track()["wy"]
    assert 0 < spin[-1] < 0.9 * 0.004
    assert np.abs(np.diff(spin)[-100:]).max() < 0.02 * 0.004


def test_slow_changes_of_spin_follow_the_torque_alone():
    """I (omega_n - omega_0) is the sum of the torques, but for the last change of spin times I of the fluid."""
    flow = Simulation((20, 20, 20), RATES)
    ball = Spheres([Sphere(4.0, 2.0, (10.0, 10.0, 10.0), spin=(0.0, 0.0, 0.002))])
    flow.add(ball)
    flow.run(150)
    track = ball.track()
    inertia = 0.4 * ball.masses[0] * 16
    gained = inertia * (track["wz"][-1] - 0.002)
    fluid = 0.4 * ball.volumes[0] * 16 * (track["wz"][-1] - track["wz"][-2])
    assert gained + fluid == pytest.approx(track["tz"].sum(), rel=1e-9)


@pytest.mark.parametrize(
    "start",
    [
        {"gravity": (0.0, 0.0, -1e3)},
        {"gravity": (1e300, 0.0, 0.0)},
        {"drive": lambda step, gap: (0.0, 0.0, -1e12)},
    ],
    ids=["to the wall", "overflow", "drive"],
)
def test_a_sphere_that_runs_away_is_stopped_in_the_step_in_which_it_does(start):
    """Near a wall its sub-steps would have no end; far away its place would be no number."""
    flow = Simulation((16, 16, 16), viscosity=0.1, faces={"z": "no-slip"})
    flow.add(Spheres([Sphere(3.0, 8.0, (8.0, 8.0, 3.4))], **start))
    with pytest.raises(DivergenceError, match="sphere 0") as stopped:
        flow.run(100)
    assert stopped.value.step <= 2


def test_sub_steps_and_place_of_contact_do_not_decide_the_rebound():

    def e(**options):
        return bouncing.restitution(*bouncing.rebound(8, width=3, start=1.2, **options))

    assert e(fraction=FRACTION / 2) == pytest.approx(e(), abs=2e-3)


def _falling(centre, shape=(20, 20, 20), **options):
    flow = Simulation(shape, RATES, threads=options.pop("threads", None))
    ball = Spheres([Sphere(3.31, 3.0, centre, **options)], gravity=(1e-5, 2e-5, -1e-4))
    flow.add(ball)
    flow.run(200)
    return flow, ball


def test_a_sphere_that_crosses_a_periodic_face_does_not_notice():
    _, middle = _falling((10.2, 10.1, 9.7), spin=(1e-3, 0.0, 2e-3))
    _, corner = _falling((0.2, 20.1, -0.3), spin=(1e-3, 0.0, 2e-3))
    for name in ("fx", "fy", "fz", "tx", "ty", "tz", "vx", "vz", "wy"):
        assert corner.track()[name] == pytest.approx(middle.track()[name], abs=1e-12)


def test_two_spheres_an_image_apart_feel_the_same():
    """A box with two spheres is two boxes with one each."""
    alone = _falling((10.2, 10.1, 9.7))[1].track()
    flow = Simulation((40, 20, 20), RATES)
    pair = Spheres([Sphere(3.31, 3.0, (x, 10.1, 9.7)) for x in (10.2, 30.2)], gravity=(1e-5, 2e-5, -1e-4))
    flow.add(pair)
    flow.run(200)
    for s in range(2):
        assert pair.track(s)["fz"] == pytest.approx(alone["fz"], abs=1e-12)
        assert pair.track(s)["ty"] == pytest.approx(alone["ty"], abs=1e-12)


def test_what_a_sphere_at_rest_takes_the_fluid_loses():
    flow = Simulation((16, 16, 16), RATES)
    flow.set_flow(velocity=(0.02, -0.01, 0.005))
    ball = Spheres([Sphere(3.31, 3.0, (8.1, 8.3, 7.9))], drive=lambda step, gap: STILL)
    flow.add(ball)
    fluid = ~flows.inside(flow.shape, (8.1, 8.3, 7.9), 3.31)

    def momentum():
        rho, u = flow.fields()
        return (rho * u)[:, fluid].sum(axis=1)

    flow.run(1)
    before, begun = momentum(), len(ball.track()["step"])
    flow.run(101)
    force = np.array([ball.track()[f][begun:].sum() for f in ("fx", "fy", "fz")])
    assert momentum() - before == pytest.approx(-force, abs=1e-10)


def test_sphere_and_fluid_gain_the_momentum_that_its_weight_gives():
    flow, ball = _falling((10.2, 10.1, 9.7))
    fluid = ~flows.inside(flow.shape, ball.centres[0], 3.31)
    rho, u = flow.fields()
    total = (rho * u)[:, fluid].sum(axis=1) + ball.masses[0] * ball.velocities[0]
    weight = (ball.masses[0] - ball.volumes[0]) * ball.gravity
    assert total == pytest.approx(200 * weight, rel=0.02)


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="needs two threads")
def test_threads_do_not_change_a_bit():
    one, two = (_falling((0.2, 20.1, -0.3), shape=(24, 24, 24), threads=n) for n in (1, 2))
    assert np.array_equal(one[0].velocity, two[0].velocity)
    for name, values in one[1].track().items():
        assert np.array_equal(values, two[1].track()[name], equal_nan=True), name


def test_a_sphere_at_rest_in_fluid_at_rest_feels_nothing():
    flow = Simulation((16, 16, 16), RATES, faces={"z": "no-slip"})
    ball = Spheres([Sphere(3.31, 3.0, (8.1, 8.3, 3.31))], drive=lambda step, gap: STILL)
    flow.add(ball)
    flow.run(20)
    assert not ball.forces.any()
    assert not ball.torques.any()


@pytest.mark.parametrize("gap", [0.01, 0.024, 0.026, 0.2, 0.499])
def test_what_the_grid_lacks_of_a_film_is_the_integral_of_its_pressure(gap):
    c = RESOLVED
    share, _ = quad(lambda H: 2 * (H - c) ** 2 / ((H - gap) * H**3), c, math.inf, epsabs=1e-12)
    assert lost_to_grid(gap) == pytest.approx(1 / gap - share, rel=1e-9)


@pytest.mark.parametrize(
    ("spheres", "names"),
    [
        ([], "list of Sphere"),
        (Sphere(4.0, 2.0, (12.0, 12.0, 12.0)), "list of Sphere"),
        ([3], "no Sphere"),
        ([Sphere(4.0, 2.0, (12.0, 12.0, 12.0), velocity=(0.0, 0.0, 0.6))], "above that of sound"),
        ([Sphere(4.0, 2.0, (12.0, 12.0, 12.0), spin=(0.0, 0.2, 0.0))], "above that of sound"),
    ],
)
def test_what_is_no_list_of_spheres_or_outruns_sound_is_refused(spheres, names):
    with pytest.raises(InputError, match=names):
        Spheres(spheres)


def test_a_soft_contact_without_a_film_rebounds_in_a_few_sub_steps():
    """The linear spring and dashpot of e_dry, the fluid left out: exactly e_dry at the end of the contact."""
    contact = SoftContact.linear(0.8, mass=1.0, duration=20.0)
    motion, sub_steps = motion_at_wall(None, contact, FRACTION), 0
    counted = motion._substep

    def count(*state):
        nonlocal sub_steps
        sub_steps += 1
        return counted(*state)

    motion._substep = count
    gap, v, impacts = 0.05, -0.02, []
    for step in range(60):
        gap, v, found = motion.step(step, gap, v, 0.0, 0.0, 1.0)
        impacts += found
    assert v / 0.02 == pytest.approx(0.8, abs=0.05)
    assert len(impacts) == 1
    assert sub_steps < 5000
