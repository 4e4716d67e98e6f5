"""Added mass at a wall, the history force as a sum of exponentials, tables of laws."""

import numpy as np
import pytest

from restitution import laws
from restitution.bounce import forces, history
from restitution.bounce.added_mass import CONTACT, added_mass, added_mass_slope
from restitution.bounce.tables import look

RADIUS, NU = 1.5e-3, 1.07e-5


def added_mass_by_images(eps, count=20_000):
    """The images one by one: strength and place of each follow from the one before (no closed form used)."""
    H, x, strength, total = 1 + eps, 0.0, 1.0, 0.0
    for _ in range(count):
        distance = 2 * H - x
        x, strength = 1 / distance, strength / distance**3
        total += strength
    return 0.5 + 1.5 * total


@pytest.mark.parametrize("eps", [1e-3, 0.03, 0.4, 3.0])
def test_added_mass_against_the_row_of_images(eps):
    assert added_mass(eps) == pytest.approx(added_mass_by_images(eps), rel=1e-12)


def test_added_mass_at_contact_and_far():
    from scipy.special import zeta

    assert pytest.approx(1.5 * zeta(3) - 1, rel=1e-15) == CONTACT
    assert added_mass(0.0) == pytest.approx(CONTACT, rel=1e-9)
    eps = 30.0
    assert added_mass(eps) - 0.5 == pytest.approx(3 / 16 / (1 + eps) ** 3, rel=1e-3)


@pytest.mark.parametrize("eps", [1e-6, 1e-3, 0.1, 2.0])
def test_added_mass_slope(eps):
    h = 1e-4 * eps
    assert added_mass_slope(eps) == pytest.approx((added_mass(eps + h) - added_mass(eps - h)) / (2 * h), rel=1e-5)


@pytest.mark.parametrize("name", laws.names("history"))
@pytest.mark.parametrize("Re", [1.0, 30.0, 160.0])
def test_sum_of_exponentials_is_the_kernel(name, Re):
    law = laws.get(name)
    terms = history.modes(RADIUS, NU, slowest=0.01, fastest=1e7)
    time = np.geomspace(1e-6, 1.0, 200)
    exact = law(time * NU / RADIUS**2, Re)
    basset = laws.get("basset_1888")(time * NU / RADIUS**2, Re)
    error = history.approximation(law, terms, RADIUS, NU, time, Re) - exact
    # Of what the force may be at that lag; relative to a kernel that has forgotten nearly all it is more.
    assert np.max(np.abs(error) / basset) < 5e-6


def test_lagged_velocities_give_the_direct_sum():
    """Basset's integral of a given motion with a jump, by the modes and by quadrature of the integral itself."""
    from scipy.integrate import quad

    terms = history.modes(RADIUS, NU, slowest=0.05, fastest=1e7)
    end, jump, omega = 0.1, 0.7, 130.0
    acceleration = lambda s: omega * np.cos(omega * s)  # noqa: E731
    # int K(t - s) v'(s) ds with s = t - x^2, which takes out the singularity, and the jump at s = 0
    unit = np.sqrt(RADIUS**2 / (np.pi * NU))
    smooth = quad(lambda x: 2 * acceleration(end - x**2), 0, np.sqrt(end), limit=400, epsabs=1e-12)[0]
    direct = unit * (smooth + jump / np.sqrt(end))
    # v - Z_j = int exp(-lambda (t - s)) v'(s) ds + jump exp(-lambda t), in closed form for v' = omega cos(omega s)
    rate = terms.rates
    lagging = omega / (rate**2 + omega**2) * (
        rate * np.cos(omega * end) + omega * np.sin(omega * end) - rate * np.exp(-rate * end)
    ) + jump * np.exp(-rate * end)
    by_modes = history.BASSET * (np.sum(terms.weights * lagging) + terms.tail * acceleration(end))
    assert by_modes == pytest.approx(direct, rel=1e-5)


@pytest.mark.parametrize("name", ["brenner_1961", "bevan_prieve_2000"])
def test_wall_table_is_the_law(name):
    law, eps = laws.get(name), np.geomspace(2e-8, 5e3, 3000)
    table = forces.wall_table(law)
    np.testing.assert_allclose(1 + look(table, eps) / eps, law(eps), rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [("schiller_naumann_1935", 1e-6), ("brown_lawler_2003", 1e-6), ("clift_grace_weber_1978", 0.01)],
)
def test_drag_table_is_the_law(name, tolerance):
    law, Re = laws.get(name), np.geomspace(1e-6, 900, 3000)
    np.testing.assert_allclose(look(forces.drag_table(law), Re), law(Re) * Re / 24, rtol=tolerance)


def test_added_mass_table_is_the_series():
    eps = np.geomspace(1e-8, 500, 1000)
    np.testing.assert_allclose(look(forces.added_mass_table("wall"), eps), added_mass(eps), rtol=1e-7)
