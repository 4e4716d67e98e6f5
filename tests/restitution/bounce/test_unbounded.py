"""The point particle's forces without a wall against references: towed spheres, a sphere that oscillates."""

import numpy as np
import pytest

from restitution import laws
from restitution.bounce import Closures
from restitution.bounce.unbounded import (
    amplitudes,
    drag_errors,
    measured_drag,
    oscillation,
    oscillation_errors,
    reference_oscillation,
)

SCATTER = 0.035
"""Of the towed spheres about a smooth curve at Re 5 to 1000, relative: nothing can be told below it."""
DRAG, HISTORY = Closures().drag.name, Closures().history.name


def test_the_drag_that_nobody_chose_is_the_measured_one_within_its_scatter():
    errors = {e.law: e for e in drag_errors()}
    assert errors[DRAG].points == 72
    assert errors[DRAG].rms < SCATTER
    assert abs(errors[DRAG].bias) < SCATTER / np.sqrt(72)
    others = [e.rms for name, e in errors.items() if name != DRAG]
    # 1.69 times the variance with 72 points each: beyond what scatter makes (F test, 98 %).
    assert min(others) > 1.3 * errors[DRAG].rms


def test_a_smooth_curve_through_the_towed_spheres_leaves_the_scatter():
    Re, C_D = measured_drag()
    x, y = np.log(Re), np.log(C_D)
    left = y - np.polynomial.Polynomial.fit(x, y, 4)(x)
    assert np.std(left, ddof=5) == pytest.approx(SCATTER, abs=0.006)


def test_the_reference_oscillation_is_near_the_exact_one_of_creeping_flow():
    """Stokes' 0.600 and Basset's 2.400 in phase with u, 2.400 and the added mass 2.133 with du/dt, by hand."""
    phase = np.arange(500) / 500
    exact = amplitudes(phase, oscillation(laws.get("stokes_1851"), laws.get("basset_1888"), phase, 40.0, 3.2))
    assert exact == pytest.approx((3.000, 4.533), abs=1e-3)
    assert amplitudes(*reference_oscillation()) == pytest.approx((3.217, 4.435), abs=2e-3)


def test_the_history_that_nobody_chose_is_nearest_to_the_oscillating_sphere():
    """Nearer in all than the exact answer of creeping flow, 3.000 and 4.533 (rms 0.032)."""
    errors = {e.history: e for e in oscillation_errors()}
    in_velocity, in_acceleration = amplitudes(*reference_oscillation())
    best = errors[HISTORY]
    assert best.in_velocity == pytest.approx(in_velocity, rel=0.067)
    assert best.in_acceleration == pytest.approx(in_acceleration, rel=0.022)
    assert best.rms < 0.032
    assert min(e.rms for name, e in errors.items() if name != HISTORY) > 1.5 * best.rms
    # Full drag and all of Basset's memory count part of the resistance twice.
    assert errors["basset_1888"].in_velocity > 1.2 * in_velocity
