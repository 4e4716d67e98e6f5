"""Cut-off corrections and Eq. (3): where they act, that they dissipate, what they do to a sphere."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from restitution.errors import InputError
from restitution.laws import REGISTRY, get
from restitution.laws.cut_off import CutOffLaw
from restitution.laws.source_abstract_eq3 import lubrication_force

CUT_OFF = [name for name, law in REGISTRY.items() if issubclass(law, CutOffLaw)]
KAPPA = {"kappa": 0.7}

# Gondret's 3 mm steel sphere; the film acts from D0 = 0.4 r.
SPHERE = {"r": 1.5e-3, "mu": 0.010}
D0 = 0.4 * SPHERE["r"]
MASS = 7800 * 4 / 3 * np.pi * SPHERE["r"] ** 3


def others(law):
    return {v: KAPPA[v] for v in law.variables[1:]}


@pytest.mark.parametrize("name", CUT_OFF)
def test_zero_beyond_the_cut_off_and_constant_below_the_floor(name):
    law = get(name)
    beyond = law.eps_c * np.array([1.0, 1.001, 2.0, 50.0])
    assert np.all(law(beyond, **others(law)) == 0)
    assert np.all(law.derivative(beyond, **others(law)) == 0)
    below = law.eps_min * np.array([1e-6, 0.3, 1.0])
    assert np.all(law(below, **others(law)) == law(law.eps_min, **others(law)))
    assert np.all(law.derivative(below, **others(law)) == 0)


@pytest.mark.parametrize("name", [n for n in CUT_OFF if REGISTRY[n].subtracted])
def test_differences_set_in_without_a_jump(name):
    law = get(name)
    just_below = law(law.eps_c * (1 - 1e-9), **others(law))
    assert 0 < just_below < 1e-8 * law(law.eps_min, **others(law))


def test_biegert_sets_in_with_the_full_force():
    law = get("biegert_2017")
    assert law(law.eps_c * (1 - 1e-9)) == pytest.approx(1 / law.eps_c)


@pytest.mark.parametrize("name", CUT_OFF)
def test_floor_must_lie_below_the_cut_off(name):
    with pytest.raises(InputError, match="eps_min"):
        get(name, eps_c=0.01, eps_min=0.01)


@pytest.mark.parametrize(("eps", "percent"), [(0.01, -0.7), (0.1, -2.9), (0.2, -4.0), (0.3, -4.8)])
def test_difference_of_the_leading_term_against_the_exact_difference(eps, percent):
    """The percentages were found independently of this package, for a cut-off at 0.4 radii."""
    simple, exact = (get(n, eps_c=0.4)(eps) for n in ("nguyen_ladd_2002", "brenner_1961_difference"))
    assert 100 * (simple / exact - 1) == pytest.approx(percent, abs=0.051)


def test_brandle_de_motta_is_close_to_the_exact_difference():
    eps = np.geomspace(1e-3, 0.09, 30)
    exact = get("brenner_1961_difference", eps_c=0.1, eps_min=1e-3)(eps)
    np.testing.assert_allclose(get("brandle_de_motta_2013")(eps), exact, rtol=0.01)


def test_izard_is_finite_at_contact_and_taylor_away_from_it():
    law = get("izard_2014")
    assert law(1e-12) == pytest.approx(1 / law.eta, rel=1e-6)
    assert law(0.02) == pytest.approx(1 / 0.02, rel=0.006)


# Speed at the smallest gap over speed at D0 = 0.4 r: integrated independently when the readings were compared.
# St, h_min/r, classical difference, Eq. (3).
ARRIVALS = [
    (152, 1e-3, 0.9671, 0.9672),
    (50, 1e-3, 0.9001, 0.9003),
    (27, 1e-3, 0.8150, 0.8157),
    (27, 1e-4, 0.7298, 0.7306),
    (15, 1e-3, 0.6671, 0.6695),
    (10, 1e-3, 0.5006, 0.5063),
]


def arrival(St, h_min, force):
    """v(h_min)/v(D0) by integration of m v dv/dh = -F along the approach, in SI."""
    v0 = St * 6 * np.pi * SPHERE["mu"] * SPHERE["r"] ** 2 / MASS

    def slope(x, v):  # x = ln(h)
        h = np.exp(x)
        return -force(h, v[0], v0) * h / (MASS * v[0])

    ends = np.log([D0 * (1 - 1e-12), h_min * SPHERE["r"]])
    return solve_ivp(slope, ends, [v0], rtol=1e-10, atol=1e-12).y[0, -1] / v0


@pytest.mark.parametrize(("St", "h_min", "classical", "varying"), ARRIVALS)
def test_arrival_speeds_of_eq3_and_of_the_classical_difference(St, h_min, classical, varying):
    def eq3(h, v, v0):
        return lubrication_force(h, v, v0, D0=D0, h_min=1e-5 * SPHERE["r"], **SPHERE)

    law = get("nguyen_ladd_2002", eps_c=0.4, eps_min=1e-5)

    def nguyen_ladd(h, v, v0):
        return -6 * np.pi * SPHERE["mu"] * SPHERE["r"] * v * law(h / SPHERE["r"])

    assert arrival(St, h_min, eq3) == pytest.approx(varying, abs=1e-4)
    assert arrival(St, h_min, nguyen_ladd) == pytest.approx(classical, abs=1e-4)


def test_force_is_the_law_in_si():
    law, h_min = get("eq3_velocity_difference"), 1e-4 * SPHERE["r"]
    gap = np.geomspace(1e-5, 1.0, 40) * SPHERE["r"]
    v, v_onset = 0.3, 0.5
    expected = -6 * np.pi * SPHERE["mu"] * SPHERE["r"] * v * law(gap / SPHERE["r"], v_onset / v)
    force = lubrication_force(gap, v, v_onset, D0=D0, h_min=h_min, **SPHERE)
    np.testing.assert_allclose(force, expected, rtol=1e-12)
    # by hand at h = 0.1 r: 6 pi 0.01 (1.5e-3)^2 [0.3/1.5e-4 - 0.5/6e-4] = 4.2412e-7 * 1166.67
    assert lubrication_force(1.5e-4, v, v_onset, D0=D0, h_min=h_min, **SPHERE) == pytest.approx(
        -4.9480e-4, rel=1e-4
    )


def test_force_never_drives_the_sphere():
    rng = np.random.default_rng(3)
    gap = rng.uniform(-0.01, 0.6, 5000) * SPHERE["r"]
    v, v_onset = rng.uniform(-1, 1, (2, 5000))
    force = lubrication_force(gap, v, v_onset, D0=D0, h_min=1e-4 * SPHERE["r"], **SPHERE)
    assert np.all(np.isfinite(force))
    assert np.all(force * v <= 0)
    assert np.any((force == 0) & (gap < D0))  # the literal equation would attract there


@pytest.mark.parametrize("v_onset", [None, np.nan, 0.5, 0.0])
def test_on_the_way_out_it_is_the_classical_difference(v_onset):
    law = get("nguyen_ladd_2002", eps_c=0.4, eps_min=1e-4)
    gap = np.geomspace(1e-5, 0.5, 30) * SPHERE["r"]
    force = lubrication_force(gap, -0.2, v_onset, D0=D0, h_min=1e-4 * SPHERE["r"], **SPHERE)
    expected = 6 * np.pi * SPHERE["mu"] * SPHERE["r"] * 0.2 * law(gap / SPHERE["r"])
    np.testing.assert_allclose(force, expected, rtol=1e-12)


def test_force_is_capped_at_contact_and_zero_at_rest():
    at = {"D0": D0, "h_min": 1e-4 * SPHERE["r"], **SPHERE}
    capped = lubrication_force(at["h_min"], 0.3, 0.5, **at)
    assert np.all(lubrication_force(np.array([0.0, -1e-6, 1e-9]), 0.3, 0.5, **at) == capped)
    assert lubrication_force(1e-5, 0.0, 0.5, **at) == 0
