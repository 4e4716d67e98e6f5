"""Invariants of every rebound law in the registry, and the check values that come from outside."""

import numpy as np
import pytest

from restitution import laws
from restitution.conditions import Conditions
from restitution.errors import InputError, OutOfRangeError, OutOfRangeWarning
from restitution.laws.elastohydrodynamic import NODES_E, NODES_ST
from restitution.stokes import StokesNumber

REBOUND = laws.names("rebound")
WATER = Conditions.model_validate(
    {"fluid": {"density": 1000, "viscosity": 0.001}, "sphere": {"diameter": 3e-3, "density": 2500}}
)


def evaluate(law, St, e_dry=0.97):
    return law(StokesNumber(St, law.convention, law.speed), e_dry, out_of_range="ignore")


@pytest.mark.parametrize("name", REBOUND)
@pytest.mark.parametrize("e_dry", [0.3, 0.83, 0.97, 1.0])
def test_between_zero_and_dry_rising_to_dry(name, e_dry):
    law = laws.get(name)
    e = evaluate(law, np.geomspace(1e-3, 1e9, 4000), e_dry)
    assert np.all((e >= 0) & (e <= e_dry))
    assert np.all(np.diff(e) >= -1e-15)
    assert e[-1] == pytest.approx(e_dry, rel=1e-5)
    assert e[0] < 1e-3


@pytest.mark.parametrize("name", REBOUND)
def test_check_values_from_outside(name):
    law = laws.get(name)
    assert law.checks
    for check in law.checks:
        value = evaluate(law.replace(**check.parameters), check.inputs["St"], check.inputs["e_dry"])
        assert abs(value - check.value) <= check.tolerance, check.source


@pytest.mark.parametrize("name", REBOUND)
def test_derivative_against_finite_differences(name):
    law = laws.get(name)
    St = np.geomspace(11.3, 480.0, 57)
    step = 1e-5 * St
    numeric = (evaluate(law, St + step) - evaluate(law, St - step)) / (2 * step)
    exact = law.derivative(StokesNumber(St, law.convention, law.speed), 0.97, out_of_range="ignore")
    np.testing.assert_allclose(exact, numeric, rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("name", REBOUND)
def test_scalar_and_vector_agree(name):
    law = laws.get(name)
    St = np.array([[15.0, 30.0], [90.0, 400.0]])
    e_dry = np.array([0.9, 0.97])
    both = evaluate(law, St, e_dry)
    assert both.shape == (2, 2)
    for i, j in np.ndindex(2, 2):
        assert evaluate(law, St[i, j], e_dry[j]) == pytest.approx(both[i, j], rel=1e-14, abs=1e-300)


@pytest.mark.parametrize("name", [n for n, law in laws.REGISTRY.items()])
def test_every_law_says_where_it_comes_from(name):
    law = laws.get(name)
    assert law.reference
    assert law.status in laws.Status
    assert law.latex()
    for f in law.parameter_fields():
        low, high = f.metadata["bounds"]
        assert low <= f.default <= high
        assert f.metadata["source"]
        assert f.metadata["unit"]


def test_out_of_range_is_the_callers_choice():
    law = laws.get("legendre_2005")
    far_out = StokesNumber(5000.0, "st_star")
    with pytest.warns(OutOfRangeWarning, match="1000"):
        law(far_out, 0.97)
    with pytest.raises(OutOfRangeError):
        law(far_out, 0.97, out_of_range="raise")
    assert law(far_out, 0.97, out_of_range="clip") == law(StokesNumber(1000.0, "st_star"), 0.97)


@pytest.mark.parametrize("St", [0.0, -3.0, np.nan])
def test_a_stokes_number_that_is_none_is_refused(St):
    with pytest.raises(InputError, match="positive"):
        laws.get("eq4_exponential")(StokesNumber(St), 0.97)


def test_parameters_outside_their_bounds_and_unknown_names_are_refused():
    with pytest.raises(InputError, match="beta"):
        laws.get("legendre_2005", beta=-1)
    with pytest.raises(InputError, match="gamma"):
        laws.get("legendre_2005", gamma=1)
    with pytest.raises(InputError, match="legendre_2005"):
        laws.get("legendre2005")
    with pytest.raises(InputError, match="h_min"):
        laws.get("two_way_lubrication", h0=1e-3, h_min=1e-2)


def test_readings_differ_as_the_catalogue_says():
    """At St = 10 the exponential reading is practically zero, the rational one is not (Joseph et al. 2001)."""
    assert evaluate(laws.get("eq4_exponential"), 10.0) < 0.03
    assert evaluate(laws.get("eq4_rational"), 10.0) > 0.2
    assert evaluate(laws.get("eq4_linear"), 27.0) == 0


def test_legendre_in_two_conventions_differs_by_the_added_mass():
    """rho_p/rho_f = 2.5: St* = 1.2 St, so the two codes' readings differ by exp(-35/St (1/1.2 - 1))."""
    St = StokesNumber(70.0, "st")
    ratio = laws.get("legendre_2005")(St, 0.97, WATER) / laws.get("legendre_2006_plain_st")(St, 0.97, WATER)
    assert ratio == pytest.approx(np.exp(0.5 * (1 - 1 / 1.2)), rel=1e-12)


@pytest.mark.parametrize("left_out", range(1, len(NODES_ST) - 1))
def test_interpolation_of_the_elastohydrodynamic_table(left_out, monkeypatch):
    """Each inner point is predicted from the others within 0.02: an upper bound of the interpolation error."""
    from restitution.laws import elastohydrodynamic as ehd

    keep = [i for i in range(len(NODES_ST)) if i != left_out]
    monkeypatch.setattr(ehd, "NODES_ST", tuple(NODES_ST[i] for i in keep))
    monkeypatch.setattr(ehd, "NODES_E", tuple(NODES_E[i] for i in keep))
    ehd._loss.cache_clear()
    try:
        assert ehd._e_ehd(np.array(NODES_ST[left_out]))[0] == pytest.approx(NODES_E[left_out], abs=0.02)
    finally:
        ehd._loss.cache_clear()
