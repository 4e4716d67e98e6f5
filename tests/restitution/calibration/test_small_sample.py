"""Sums over sources stand for dense matrices, and cost no more than there are impacts."""

import numpy as np
import pytest

from restitution.calibration.estimation.small_sample import Restriction


def dense(J, variance, sources, precision, wanted, tau, omega):
    """Log of the determinant and Satterthwaite's nu with whole matrices, as the formulas are written."""
    n = len(J)
    same = (sources[:, None] == sources).astype(float)
    V = np.diag(variance + tau**2) + omega**2 * same
    Vi = np.linalg.inv(V)
    M = J.T @ Vi @ J + precision
    C = np.linalg.inv(M)
    P = Vi - Vi @ J @ C @ J.T @ Vi
    parts = [part for part, want in zip((np.eye(n), same), wanted, strict=True) if want]
    information = np.array([[0.5 * np.trace(P @ a @ P @ b) for b in parts] for a in parts])
    slopes = np.stack([np.diag(C @ J.T @ Vi @ part @ Vi @ J @ C) for part in parts], axis=1)
    spread = np.einsum("jk,kl,jl->j", slopes, np.linalg.pinv(information, rcond=1e-10, hermitian=True), slopes)
    return 0.5 * np.linalg.slogdet(M)[1], np.maximum(2 * np.diag(C) ** 2 / spread, 1.0)


@pytest.mark.parametrize("places", [(2, 3), (2, None), (None, 2)])
@pytest.mark.parametrize("sources", [1, 3, 12])
@pytest.mark.parametrize(("tau", "omega"), [(0.03, 0.05), (0.0, 0.04), (0.02, 0.0)])
def test_sums_over_sources_are_the_matrices(places, sources, tau, omega):
    rng = np.random.default_rng([sources, 5])
    J, variance = rng.normal(size=(12, 2)), rng.uniform(1e-4, 4e-4, 12)
    group = rng.permutation(np.arange(12) % sources)
    precision = np.diag([0.0, 3.0])
    restriction = Restriction(J, variance, group, precision, places)
    values = np.array([1.0, 2.0, 0.0, 0.0])
    deviations = [0.0 if place is None else x for place, x in zip(places, (tau, omega), strict=True)]
    for place, x in zip(places, deviations, strict=True):
        if place is not None:
            values[place] = x
    wanted = [place is not None for place in places]
    term, nu = dense(J, variance, group, precision, wanted, *deviations)
    assert restriction(values) == pytest.approx(term, rel=1e-10)
    np.testing.assert_allclose(restriction.degrees_of_freedom(values), nu, rtol=1e-8)
