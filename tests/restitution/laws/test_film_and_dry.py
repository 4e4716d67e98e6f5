"""Film limits against independent numbers; the dry elastic-plastic restitution against its own contact model."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import restitution.laws as laws
from restitution.laws import REGISTRY, get
from restitution.laws.dry import yield_velocity
from restitution.laws.film import reduced_modulus

NAMES = laws.names("film") + laws.names("dry")
STEEL_ON_GLASS = {"mu": 0.01, "E_r": 55e9, "r": 1.5e-3}


@pytest.mark.parametrize("name", NAMES)
def test_check_values(name):
    checks = REGISTRY[name].checks
    assert checks, "a law needs a value from outside"
    for check in checks:
        law = get(name, **check.parameters)
        assert law(**check.inputs) == pytest.approx(check.value, abs=check.tolerance), check.source


@pytest.mark.parametrize("name", NAMES)
def test_derivative_is_that_of_the_value(name):
    law = get(name)
    usual = {"v": 0.5, "mu": 0.01, "E_r": 55e9, "r": 1.5e-3, "m": 1.1e-4, "v_over_vY": 3.0}
    first, *rest = law.variables
    fixed = {v: usual[v] for v in rest}
    x = usual[first] * np.array([0.1, 0.5, 2.0, 30.0])
    h = 1e-5 * x
    slope = (law(x + h, **fixed) - law(x - h, **fixed)) / (2 * h)
    np.testing.assert_allclose(law.derivative(x, **fixed), slope, rtol=1e-6, atol=1e-14)


def test_film_stops_at_whichever_comes_first():
    law, smooth = get("nijssen_2022"), get("yang_hunt_2008")
    v = np.geomspace(1e-3, 1e3, 50)
    film = law(v, **STEEL_ON_GLASS)
    np.testing.assert_array_equal(film, np.maximum(smooth(v, **STEEL_ON_GLASS), law.sigma))
    assert film[0] == law.sigma < film[-1]


def test_gondrets_bounces_in_the_thin_oil_are_limited_by_roughness_those_in_the_thick_oil_are_not():
    """0.02 to 0.05 um against 0.15 um at St 152 to 23; 0.18 um at St 27."""
    film, rough = get("yang_hunt_2008"), get("roughness")
    bounces = film(np.array([0.585, 0.3023, 0.1715, 0.0885]), **STEEL_ON_GLASS)
    assert np.all((bounces > 0.0195e-6) & (bounces < 0.0505e-6))
    assert bounces.max() < rough(1.5e-3) == pytest.approx(0.15e-6)
    assert film(0.518, mu=0.1, E_r=55e9, r=3e-3) == pytest.approx(0.18e-6, abs=0.005e-6)


def test_elastohydrodynamic_length_is_the_dent_of_a_hertz_contact_of_equal_energy():
    m, v, E, r = 1.1e-4, 0.585, 55e9, 1.5e-3

    def surplus(dent):
        work, _ = quad(lambda d: 4 / 3 * E * np.sqrt(r) * d**1.5, 0, dent, epsabs=0)
        return work - m * v**2 / 2

    dent = brentq(surplus, 1e-9, 1e-3, xtol=1e-16)
    assert get("ehd_length")(v, m, E, r) == pytest.approx(dent / (15 / 16) ** 0.4, rel=1e-6, abs=0)


def test_reduced_modulus():
    assert reduced_modulus(190e9, 0.27, 60e9, 0.23) == pytest.approx(48.4e9, rel=1e-3)  # steel on glass, by hand
    assert reduced_modulus(200e9, 0.3, 1e30, 0.3) == pytest.approx(200e9 / 0.91)  # rigid wall


# An elastic, perfectly plastic sphere: any numbers will do, the law knows only v/v_Y.
E, R, P_Y, M = 70e9, 2e-3, 1.2e9, 9e-5
DENT_Y = R * (np.pi * P_Y / (2 * E)) ** 2
"""Hertz: the peak pressure 2 E/pi sqrt(dent/R) reaches P_Y."""


def hertz(dent, radius):
    return 4 / 3 * E * np.sqrt(radius) * dent**1.5


def loading(dent):
    return hertz(dent, R) if dent < DENT_Y else hertz(DENT_Y, R) + np.pi * P_Y * R * (dent - DENT_Y)


def work(force, dent):
    kink = [DENT_Y] if dent > DENT_Y else None
    return quad(force, 0, dent, points=kink, epsabs=0, epsrel=1e-11)[0]


def restitution_by_energy(v):
    """Work recovered on unloading over work done on loading, each by quadrature of its force."""
    energy = M * v**2 / 2
    deepest = brentq(lambda d: work(loading, d) - energy, 1e-3 * DENT_Y, 1e6 * DENT_Y, xtol=1e-22, rtol=1e-14)
    flattened = R * hertz(deepest, R) / loading(deepest)
    recovered = (loading(deepest) / (4 / 3 * E * np.sqrt(flattened))) ** (2 / 3)
    returned = quad(lambda d: hertz(d, flattened), 0, recovered, epsabs=0, epsrel=1e-11)[0]
    return np.sqrt(returned / energy)


def test_yield_velocity_is_that_of_the_hertz_contact_that_just_yields():
    v_Y = yield_velocity(P_Y, E, R, M)
    assert M * v_Y**2 / 2 == pytest.approx(work(loading, DENT_Y), rel=1e-9, abs=0)
    # the coefficient as quoted in the literature: 3.194 [p_Y^5 r^3/(E^4 m)]^(1/2)
    assert v_Y == pytest.approx(3.194 * np.sqrt(P_Y**5 * R**3 / (E**4 * M)), rel=2e-4)


@pytest.mark.parametrize("ratio", [1.001, 1.5, 3.0, 10.0, 100.0, 1000.0])
def test_thornton_is_the_energy_balance_of_the_contact_model(ratio):
    by_energy = restitution_by_energy(ratio * yield_velocity(P_Y, E, R, M))
    assert get("thornton_1997")(ratio) == pytest.approx(by_energy, rel=1e-8)


def test_thornton_loses_nothing_below_yield_and_falls_as_the_fourth_root_above():
    law = get("thornton_1997")
    np.testing.assert_allclose(law(np.array([1e-3, 0.5, 1.0])), 1.0, rtol=1e-14)
    ratio = np.geomspace(1, 1e6, 60)
    assert np.all(np.diff(law(ratio)) < 0)
    assert law(1e6) * 1e6**0.25 == pytest.approx(1.185, abs=5e-4)
