"""Spring and dashpot: closed forms against the equation of motion integrated, and against programs as measured."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from restitution.errors import InputError
from restitution.export.dashpot import Dashpot, End, Spring, damping_ratio, dashpot, restitution, typed

E = (0.97, 0.77, 0.5, 0.2, 0.05)


def bounced(contact: Dashpot, speed: float) -> tuple[float, float]:
    """Restitution and contact time of one impact, the equation of motion being integrated as it stands."""
    m, k, c = contact.mass, contact.stiffness, contact.damping
    hertz = contact.spring is Spring.HERTZ

    def force(x, v):
        x = max(x, 0.0)
        return k * x**1.5 + c * x**0.25 * v if hertz else k * x + c * v

    def motion(t, state):
        return state[1], -force(*state) / m

    def ended(t, state):
        if t == 0:
            return 1.0
        return force(*state) if contact.end is End.FORCE else state[0]

    ended.terminal, ended.direction = True, -1
    period = (m / k) ** 0.5 if not hertz else (m**2 / (k**2 * speed)) ** 0.2
    size = speed * period
    # A Hertz contact starts where its force is not yet smooth: a touch inside.
    start = [1e-9 * size if hertz else 0.0, speed]
    run = solve_ivp(motion, (0, 200 * period), start, events=ended, rtol=1e-11, atol=[1e-14 * size, 1e-14 * speed])
    assert len(run.t_events[0]) == 1
    return -run.y_events[0][0][1] / speed, run.t_events[0][0]


@pytest.mark.parametrize("spring", Spring)
@pytest.mark.parametrize("end", End)
@pytest.mark.parametrize("e", E)
def test_delivers_the_restitution_asked_for_at_any_speed(e, end, spring):
    contact = dashpot(e, mass=1.1e-4, stiffness=3e4, end=end, spring=spring)
    for speed in (0.02, 1.3):
        # A Hertz contact that pulls reaches zero overlap along a tangent: the integration is good to 1e-4 there.
        assert bounced(contact, speed)[0] == pytest.approx(e, rel=2e-4 if spring is Spring.HERTZ else 1e-7)


@pytest.mark.parametrize("end", End)
@pytest.mark.parametrize("e", E)
def test_contact_lasts_as_long_as_asked(e, end):
    contact = dashpot(e, mass=2e-3, contact_time=1e-4, end=end)
    assert contact.contact_time() == pytest.approx(1e-4, rel=1e-12)
    assert bounced(contact, 0.5)[1] == pytest.approx(1e-4, rel=1e-6)


def test_undamped_hertz_contact_time():
    contact = dashpot(1.0, mass=2e-3, stiffness=1e6, spring="hertz")
    assert contact.contact_time(0.5) == pytest.approx(bounced(contact, 0.5)[1], rel=1e-3)


def test_a_contact_may_be_overdamped_and_still_part_where_the_force_ends():
    """e below exp(-2) needs zeta > 1; the overlap rule would have the spheres stick."""
    contact = dashpot(0.05, mass=1.0, stiffness=1.0, end="force")
    assert contact.ratio > 1
    assert bounced(contact, 1.0)[0] == pytest.approx(0.05, rel=1e-7)
    assert restitution(contact.ratio, "overlap") == 0.0


@pytest.mark.parametrize(
    ("asked", "measured"),
    [(0.97, 0.9702), (0.77, 0.7808), (0.5, 0.5504), (0.2, 0.3250), (0.05, 0.2138)],
)
def test_what_programs_that_cut_the_tension_deliver(asked, measured):
    """LAMMPS of 22 July 2025, granular, coeff_restitution with limit_damping, one sphere on a wall."""
    assert restitution(damping_ratio(asked), End.FORCE) == pytest.approx(measured, abs=2e-4)
    assert typed(measured) == pytest.approx(asked, abs=6e-4)


@pytest.mark.parametrize("end", End)
def test_inverse_of_the_inverse(end):
    for e in (1.0, 1 - 1e-9, 0.999, math.exp(-2), math.exp(-math.pi), 1e-3):
        assert restitution(damping_ratio(e, end), end) == pytest.approx(e, rel=1e-12)
    zeta = np.array([1 - 2e-6, 1 - 5e-7, 1 + 5e-7, 1 + 2e-6])  # across the series at 1
    e = np.array([restitution(z, "force") for z in zeta])
    np.testing.assert_allclose(np.diff(e) / np.diff(zeta), -4 / 3 * math.exp(-2), rtol=1e-3)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"e": 0.0, "mass": 1.0, "stiffness": 1.0}, "e"),
        ({"e": 1.1, "mass": 1.0, "stiffness": 1.0}, "e"),
        ({"e": math.nan, "mass": 1.0, "stiffness": 1.0}, "e"),
        ({"e": 0.5, "mass": -1.0, "stiffness": 1.0}, "mass"),
        ({"e": 0.5, "mass": 1.0}, "stiffness"),
        ({"e": 0.5, "mass": 1.0, "stiffness": 1.0, "contact_time": 1.0}, "either"),
        ({"e": 0.5, "mass": 1.0, "contact_time": 1.0, "spring": "hertz"}, "contact_time"),
    ],
)
def test_bad_input_is_named(arguments, named):
    with pytest.raises(InputError, match=named):
        dashpot(**arguments)


def test_no_e_typed_delivers_less_than_the_least():
    assert typed(0.1354) < 1e-3
    with pytest.raises(InputError, match=r"0\.135"):
        typed(0.13)
