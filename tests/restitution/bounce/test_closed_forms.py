"""The point-particle model against closed forms, its order of convergence, its energy balance."""

import math

import numpy as np
import pytest
from scipy.special import wofz

from restitution import datasets, laws
from restitution.bounce import Closures, Release, bounce, terminal_speed
from restitution.bounce.forces import forces
from restitution.bounce.kernel import END, fly
from restitution.bounce.wake import NONE
from restitution.conditions import Conditions
from restitution.laws.history import Basset1888, MeiAdrian1992

NOTHING = Closures(drag=None, wall=None, added_mass=None, history=None, e_dry=0.8)
GONDRET = datasets.resource("gondret2002_st152").conditions


def conditions(rho_f=935.0, mu=0.01, d=3e-3, rho_p=7800.0, g=9.81):
    return Conditions.model_validate(
        {
            "fluid": {"density": rho_f, "viscosity": mu},
            "sphere": {"diameter": d, "density": rho_p, "e_dry": 0.8},
            "gravity": g,
        }
    )


def stokes_factor(c):
    return 6 * math.pi * c.fluid.viscosity * c.sphere.radius


def displaced(c):
    return c.fluid.density * math.pi * c.sphere.diameter**3 / 6


def test_fall_and_bounces_in_vacuum():
    c, h0, e = conditions(rho_f=1e-12, mu=1e-5), 0.02, 0.8
    path = bounce(c, Release(h0), NOTHING, end=0.5)
    touch = NOTHING.contact_gap(c)
    v = math.sqrt(2 * 9.81 * (h0 - touch))
    first, second = path.impacts[:2]
    assert first.time_s == pytest.approx(v / 9.81, rel=1e-10)
    assert first.v_in == pytest.approx(v, rel=1e-10)
    assert second.time_s - first.time_s == pytest.approx(2 * e * v / 9.81, rel=1e-9)
    assert path.apexes()[:3] - touch == pytest.approx([(h0 - touch) * e ** (2 * n) for n in (1, 2, 3)], rel=1e-8)
    assert path.gap(0.01) == pytest.approx(h0 - 9.81 * 0.01**2 / 2, rel=1e-9)


def test_stokes_relaxation():
    c = conditions(mu=1.0)
    only_drag = Closures(drag=laws.get("stokes_1851"), wall=None, added_mass=None, history=None)
    path = bounce(c, Release(1.0, 0.01), only_drag, end=0.02, tolerance=1e-9)
    tau = c.sphere.mass / stokes_factor(c)
    terminal = (c.sphere.mass - displaced(c)) * 9.81 / stokes_factor(c)
    t = np.linspace(0, 0.02, 50)
    expected = terminal + (0.01 - terminal) * np.exp(-t / tau)
    np.testing.assert_allclose(-path.velocity(t), expected, rtol=1e-6)


@pytest.mark.parametrize("name", ["stokes_1851", "schiller_naumann_1935", "brown_lawler_2003"])
def test_terminal_speed(name):
    law = laws.get(name)
    u = terminal_speed(GONDRET, law)
    d, rho = 3e-3, 935.0
    drag = law(u * d * rho / 0.01, out_of_range="ignore") * rho * u**2 / 2 * math.pi * d**2 / 4
    assert drag == pytest.approx((7800 - 935) * math.pi * d**3 / 6 * 9.81, rel=1e-12)
    path = bounce(GONDRET, Release(30.0), Closures(drag=law, wall=None, history=None), end=5.0)
    # The slowest to get there is Stokes' drag, whose relaxation time is 0.4 s.
    assert -path.velocity_m_s[-1] == pytest.approx(u, rel=1e-5)


def basset_fall(c, t, u0):
    """Downward speed of a sphere set going with u0 in a fluid at rest, in creeping flow with added mass.

    M u' + S u + S (r/sqrt(nu)) [history] = W; with x^2 M + x S r/sqrt(nu) + S = M (x + a_1)(x + a_2) the Laplace
    transform inverts to exp(a^2 t) erfc(a sqrt(t)) = w(i a sqrt(t)).
    """
    S, M = stokes_factor(c), c.sphere.mass + displaced(c) / 2
    W = (c.sphere.mass - displaced(c)) * c.gravity
    a1, a2 = (-np.roots([M, S * c.sphere.radius / math.sqrt(c.fluid.viscosity / c.fluid.density), S])).astype(
        complex
    )
    w1, w2 = (wofz(1j * a * np.sqrt(t)) for a in (a1, a2))
    fall = W / M * ((1 - w1) / a1 - (1 - w2) / a2) / (a2 - a1)
    return np.real(fall + u0 * (a2 * w2 - a1 * w1) / (a2 - a1))


@pytest.mark.parametrize("u0", [0.0, 0.02])
@pytest.mark.parametrize("rho_p", [1200.0, 7800.0])
def test_basset_relaxation(u0, rho_p):
    c = conditions(mu=0.1, rho_p=rho_p)
    creeping = Closures(drag=laws.get("stokes_1851"), wall=None, added_mass="free", history=Basset1888())
    path = bounce(c, Release(1.0, u0, developed=False), creeping, end=0.5, tolerance=1e-8)
    t = np.geomspace(1e-4, 0.5, 40)
    expected = basset_fall(c, t, u0)
    np.testing.assert_allclose(-path.velocity(t), expected, atol=1e-5 * expected.max())


def test_logarithmic_deceleration_in_the_film():
    c, v0, eps0 = conditions(g=1e-9), 0.3, 0.1
    film = Closures(
        drag=laws.get("stokes_1851"),
        wall=laws.get("taylor_1925"),
        added_mass=None,
        history=None,
        contact=1.5e-8,
        film=0,
    )
    r = c.sphere.radius
    path = bounce(c, Release(eps0 * r, v0), film, end=1e-3, tolerance=1e-10)
    St = c.sphere.mass * v0 / (stokes_factor(c) * r)
    before = path.time_s <= path.impacts[0].time_s
    h, v = path.gap_m[before][:-1], -path.velocity_m_s[before][:-1]
    assert h.min() < 2e-5 * r
    np.testing.assert_allclose(v, v0 * (1 - np.log(eps0 * r / h) / St), rtol=1e-6)
    assert path.impacts[0].v_in == pytest.approx(v0 * (1 - math.log(eps0 * r / 1.5e-8) / St), rel=1e-6)


def test_slow_drag_near_the_wall_is_brenners():
    """A sphere sinking slowly at the gap h falls with the Stokes speed over lambda(h/r)."""
    c = conditions(mu=50.0)
    path = bounce(c, Release(3e-3), Closures(history=None), end=20.0)
    u = terminal_speed(c, laws.get("stokes_1851"))
    for h in (2e-3, 5e-4, 5e-5):
        i = np.argmin(np.abs(path.gap_m - h))
        lam = laws.get("brenner_1961")(path.gap_m[i] / c.sphere.radius)
        assert -path.velocity_m_s[i] == pytest.approx(u / lam, rel=1e-3)


RESOLVED = Closures()
BLACK_BOX = Closures(rebound=laws.get("legendre_2005"))


@pytest.mark.parametrize("closures", [RESOLVED, BLACK_BOX, Closures(history=MeiAdrian1992(), added_mass="free")])
def test_energy_balance(closures):
    path = bounce(GONDRET, Release(9e-3, 0.586), closures, end=0.2, tolerance=2e-10)
    assert len(path.impacts) >= 4
    assert path.imbalance < 1e-8
    assert np.all(np.diff(path.lost[:, 0]) >= 0)  # drag and wall only take
    assert np.all(np.diff(path.lost[:, 1]) >= 0)


def final_velocity(closures, speed, steps, T=0.03):
    """Velocity after T by ``steps`` equal steps."""
    f = forces(GONDRET, closures, T)
    Z = np.full(len(f.rates), -speed)
    out, works = np.empty((steps + 2, 3)), np.zeros((steps + 2, 3))
    n, why = fly(
        f, NONE, False, 0.0, T, 0.02, -speed, Z, 0.0, math.inf, T / steps * (1 + 1e-12), 1.0, math.inf, out, works
    )
    assert why == END
    return out[n - 1, 2]


@pytest.mark.parametrize("closures", [Closures(history=None), Closures(history=Basset1888()), Closures()])
def test_fourth_order(closures):
    exact = final_velocity(closures, 0.3, 10_000)
    errors = np.array([abs(final_velocity(closures, 0.3, n) - exact) for n in (4, 8, 16)])
    assert np.all(np.log2(errors[:-1] / errors[1:]) > 3.8)


def test_error_follows_the_tolerance():
    def apexes(tolerance):
        return bounce(GONDRET, Release(9e-3, 0.586), RESOLVED, end=0.2, tolerance=tolerance).apexes()[:3]

    exact = apexes(1e-11)
    errors = [np.max(np.abs(apexes(t) - exact)) for t in (1e-4, 1e-6, 1e-8)]
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert errors[1] < 1e-4 * GONDRET.sphere.diameter


def test_runs_are_identical():
    one, two = (bounce(GONDRET, Release(9e-3, 0.586), end=0.2) for _ in range(2))
    assert np.array_equal(one.gap_m, two.gap_m)
    assert np.array_equal(one.time_s, two.time_s)
