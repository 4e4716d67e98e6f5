"""Flights taken apart and put together again, and emulated, against flights in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import qmc
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, DotProduct, Matern, WhiteKernel

from restitution.emulation.emulator import emulate, scale_of_design
from restitution.emulation.emulator_check import check
from restitution.emulation.flown import flown
from restitution.emulation.registered import Registration
from restitution.tracks import Track

from .parabolas import CONDITIONS, END, D, V, acceleration, design, gap

TIME = np.arange(-0.02, END, 4e-4)


@pytest.fixture(scope="module")
def flights():
    points = design(14)
    return points, [
        flown(str(k), Track(TIME, gap(e, C, TIME), "gap", 1e-7), CONDITIONS) for k, (e, C) in enumerate(points)
    ]


@pytest.fixture(scope="module")
def registered(flights):
    registration = Registration.of(flights[1], CONDITIONS, 0.015)
    return registration, np.array([registration.vector(f) for f in flights[1]])


def test_durations_heights_and_e_are_those_of_parabolas(flights, registered):
    r, q = registered
    found = r.quantities(q)
    for k, (e, C) in enumerate(flights[0]):
        for n in range(1, r.flights + 1):
            assert found[f"flight {n}, ms"][k] == pytest.approx(2e3 * e**n * V / acceleration(C), abs=0.02)
            assert found[f"apex {n}, mm"][k] == pytest.approx(500 * (e**n * V) ** 2 / acceleration(C), rel=2e-3)


def test_a_flight_put_together_again_is_the_flight(flights, registered):
    r, q = registered
    for (e, C), one in zip(flights[0], q, strict=True):
        time = np.linspace(-0.014, 0.99 * r.ends_s(one), 300)
        # Straight lines between rows 0.4 ms apart cut parabolas short by g' dt^2/8, and kinks by v dt at most.
        away = np.abs(r.gaps(one[None], time[None])[0] - gap(e, C, time))
        assert np.max(away) < 0.01 * D
        assert np.median(away) < 1e-3 * D


def test_the_emulator_predicts_flights_it_has_not_seen(flights, registered):
    (points, _), (r, q) = flights, registered
    emulator = emulate(("e", "C"), points, q, r.weight)
    theta = np.array([[0.74, 0.4], [0.80, 1.2], [0.77, 0.8]])
    mean, variance = emulator.scores(theta)
    found = r.quantities(emulator.flight(mean))
    expected = 2e3 * theta[:, 0] * V / acceleration(theta[:, 1])
    np.testing.assert_allclose(found["flight 1, ms"], expected, atol=0.1)
    assert np.all(variance > 0)
    c = check(("e", "C"), points, q, r)
    told = [k for k, label in enumerate(c.labels) if not label.startswith("e ")]
    assert np.all(c.q2[told] > 0.99)
    assert c.coverage > 0.8


def test_its_numbers_are_scikit_learns(flights, registered):
    (points, _), (r, q) = flights, registered
    emulator = emulate(("e", "C"), points, q, r.weight)
    p = emulator.processes[0]
    kernel = ConstantKernel(p.matern) * Matern(p.lengths, nu=2.5) + ConstantKernel(p.trend) * DotProduct(
        0.0, "fixed"
    )
    w = np.linalg.lstsq((emulator.components * r.weight).T, ((q - emulator.mean) * r.weight).T, rcond=None)[0][0]
    other = GaussianProcessRegressor(kernel + WhiteKernel(p.scatter), optimizer=None).fit(emulator.runs, w)
    theta = np.array([[0.74, 0.4], [0.80, 1.2]])
    mean, sigma = other.predict(emulator.place(theta), return_std=True)
    own, variance = emulator.scores(theta)
    np.testing.assert_allclose(own[:, 0], mean, atol=1e-6)
    np.testing.assert_allclose(variance[:, 0], (p.widened * sigma) ** 2, rtol=1e-4, atol=1e-8)


def test_noise_is_not_predicted(registered):
    r, q = registered
    rng = np.random.default_rng(0)
    c = check(("x", "y"), rng.random((len(q), 2)), q, r)
    assert np.all(c.q2 < 0.5)


def test_the_scale_is_the_one_the_design_is_even_on():
    assert scale_of_design(np.geomspace(1e-6, 5e-5, 20)) == "log"
    assert scale_of_design(np.linspace(1e-6, 5e-5, 20)) == "linear"
    assert scale_of_design(np.linspace(-1, 1, 20)) == "linear"


def test_the_error_covers_runs_that_had_no_say():
    """Functions drawn from a known process: sixteen runs hardly tell the numbers of its kernel."""
    wide, bare = [], []
    kernel, n = Matern([0.6, 2.0], nu=2.5) + WhiteKernel(1e-3), 16
    for seed in range(5):
        rng = np.random.default_rng(seed)
        x = np.concatenate([qmc.LatinHypercube(2, rng=rng).random(n), rng.random((40, 2))])
        q = GaussianProcessRegressor(kernel, optimizer=None).sample_y(x, 3, random_state=seed)
        ends = np.array([[0.0, 1.0]] * 2)
        e = emulate(("x", "y"), x[:n], q[:n], np.ones(3), ends, ("linear", "linear"))
        as_fitted = replace(e, processes=tuple(replace(p, widened=1.0) for p in e.processes))
        w = np.linalg.lstsq(e.components.T, (q[n:] - e.mean).T, rcond=None)[0].T
        for emulator, errors in ((e, wide), (as_fitted, bare)):
            mean, variance = emulator.scores(x[n:])
            errors.append((w - mean) / np.sqrt(variance))
    within = [np.mean(np.abs(errors) < 1.96) for errors in (wide, bare)]
    assert 0.9 < within[0] < 0.99
    assert within[1] < 0.9
