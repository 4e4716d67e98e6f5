"""What an experiment can reach: the speed of a sphere after a fall, against the equation of motion."""

import math

import pytest
from scipy.integrate import solve_ivp

from restitution import laws
from restitution.bounce import terminal_speed
from restitution.calibration.result.release import fall_speed
from tests.flights import STEEL_IN_OIL


@pytest.mark.parametrize("height", [1e-3, 1e-2, 5e-2])
def test_a_fall_from_rest_obeys_the_equation_of_motion(height):
    fluid, sphere, drag = STEEL_IN_OIL.fluid, STEEL_IN_OIL.sphere, laws.get("clift_grace_weber_1978")
    displaced = fluid.density * math.pi * sphere.diameter**3 / 6

    def motion(_, state):
        _, v = state
        Re = max(v, 1e-12) * sphere.diameter * fluid.density / fluid.viscosity
        force = (sphere.mass - displaced) * STEEL_IN_OIL.gravity
        force -= drag(Re, out_of_range="ignore") * fluid.density * v**2 / 2 * math.pi * sphere.diameter**2 / 4
        return [v, force / (sphere.mass + displaced / 2)]

    def arrived(_, state):
        return state[0] - height

    arrived.terminal = True
    fall = solve_ivp(motion, (0, 10), [0.0, 0.0], events=arrived, rtol=1e-9, atol=1e-12)
    assert fall_speed(STEEL_IN_OIL, height) == pytest.approx(fall.y[1, -1], rel=1e-5)


def test_a_long_fall_ends_at_the_terminal_speed_of_the_point_particle():
    assert fall_speed(STEEL_IN_OIL, 10.0) == pytest.approx(terminal_speed(STEEL_IN_OIL), rel=1e-8)


def test_a_sphere_that_does_not_sink_has_no_speed():
    light = STEEL_IN_OIL.model_copy(update={"sphere": STEEL_IN_OIL.sphere.model_copy(update={"density": 900.0})})
    assert fall_speed(light, 1.0) == 0.0
