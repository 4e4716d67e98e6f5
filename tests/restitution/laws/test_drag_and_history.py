"""Drag and history laws of the registry: limits, order, derivative, check values."""

import numpy as np
import pytest

from restitution import laws

DRAG, HISTORY = laws.names("drag"), laws.names("history")


@pytest.mark.parametrize("name", DRAG + HISTORY)
def test_check_values(name):
    law = laws.get(name)
    assert law.checks, "a law needs a value from outside"
    for check in law.checks:
        value = law(**check.inputs, out_of_range="ignore")
        assert value == pytest.approx(check.value, abs=check.tolerance), check.source


@pytest.mark.parametrize("name", [n for n in DRAG if n != "abraham_1970"])
def test_drag_tends_to_stokes(name):
    assert laws.get(name)(1e-4) * 1e-4 / 24 == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize("name", DRAG)
def test_drag_force_rises_with_speed(name):
    law = laws.get(name)
    Re = np.geomspace(1e-3, min(law.validity[1], 5e3), 2000)
    force = law(Re, out_of_range="ignore") * Re**2
    # The pieces of the standard curve meet within 1 %, and may step down there.
    assert np.all(np.diff(force) > -0.01 * force[1:])
    assert np.all(law(Re, out_of_range="ignore") >= 24 / Re * 0.999) or name == "abraham_1970"


@pytest.mark.parametrize("name", DRAG)
def test_drag_derivative(name):
    law = laws.get(name)
    Re = np.array([0.13, 3.1, 47.0, 410.0])
    numeric = (law(Re * (1 + 1e-5), out_of_range="ignore") - law(Re * (1 - 1e-5), out_of_range="ignore")) / (
        2e-5 * Re
    )
    np.testing.assert_allclose(law.derivative(Re, out_of_range="ignore"), numeric, rtol=1e-6)


@pytest.mark.parametrize("name", HISTORY)
def test_kernels_are_bassets_at_short_lags_and_never_stronger(name):
    law, basset = laws.get(name), laws.get("basset_1888")
    tau = np.geomspace(1e-12, 1e3, 100)
    assert law(1e-14, 100.0) == pytest.approx(basset(1e-14, 100.0), rel=1e-3)
    assert np.all(law(tau, 50.0) <= basset(tau, 50.0))
    assert np.all(np.diff(law(tau, 50.0)) < 0)


@pytest.mark.parametrize("name", [n for n in HISTORY if n != "basset_1888"])
def test_finite_reynolds_kernels_forget_as_the_inverse_square_of_the_lag(name):
    law = laws.get(name)
    assert law(2e6, 100.0) / law(1e6, 100.0) == pytest.approx(0.25, rel=1e-2)
