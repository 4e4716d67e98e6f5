"""The statistics against solutions from elsewhere: published, by other libraries, by numerical integration."""

import dataclasses
import warnings

import numpy as np
import pytest
from scipy import integrate, optimize, special, stats

from restitution import laws
from restitution.calibration import estimate, predict, result_of
from restitution.calibration.estimation.likelihood import STUDENT
from restitution.calibration.estimation.maximum import Thresholds, maximise
from restitution.calibration.estimation.parameters import Normal, Parameter
from restitution.calibration.estimation.plan import TYPICAL_SCATTER
from restitution.calibration.estimation.posterior import sample
from restitution.calibration.estimation.small_sample import threshold
from restitution.calibration.result.ranking import predictive
from restitution.errors import InputError
from tests.fits import E_DRY, K, draw, observations, plan

# Pearson's data (1901) with York's weights (1966); solution as in York et al., Am. J. Phys. 72, 367 (2004).
X = np.array([0.0, 0.9, 1.8, 2.6, 3.3, 4.4, 5.2, 6.1, 6.5, 7.4])
Y = np.array([5.9, 5.4, 4.4, 4.6, 3.5, 3.7, 2.8, 2.8, 2.4, 1.5])
X_WEIGHT = np.array([1000.0, 1000, 500, 800, 200, 80, 60, 20, 1.8, 1.0])
Y_WEIGHT = np.array([1.0, 1.8, 4, 8, 20, 20, 70, 70, 100, 500])
LINE = {"law": "a + b*St", "bounds": {"a": (0.0, 10.0), "b": (-5.0, 5.0)}, "e_dry": 1.0, "scatter": False}


def pearson():
    likelihood = plan(**LINE).likelihood(observations(X, Y, Y_WEIGHT**-0.5, X_WEIGHT**-0.5))
    return dataclasses.replace(likelihood, log_variance=False)


def test_york_line_through_pearsons_data():
    likelihood = pearson()
    found = maximise(likelihood, likelihood.parameters, np.array([5.0, -0.4]))
    np.testing.assert_allclose(found.values, [5.47991022, -0.480533407], atol=2e-4)
    # York's normal equations are of the minimum itself: there no other line has a lower chi square.
    published = 2 * likelihood(np.array([5.47991022, -0.480533407]))
    assert published == pytest.approx(11.86635, abs=1e-5)  # his S
    assert 2 * found.negative_log == pytest.approx(published, abs=1e-5)


@pytest.fixture(scope="module")
def odr():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from scipy import odr
    return odr


def test_a_line_by_odrpack(odr):
    likelihood = pearson()
    found = maximise(likelihood, likelihood.parameters, np.array([5.0, -0.4]))
    data = odr.Data(X, Y, wd=X_WEIGHT, we=Y_WEIGHT)
    other = odr.ODR(data, odr.Model(lambda p, x: p[0] + p[1] * x), [5.0, -0.4]).run()
    np.testing.assert_allclose(found.values, other.beta, rtol=2e-4)


def test_a_law_by_odrpack(odr):
    """With the log-variance term off and errors of St that are small against the curvature, the two are one."""
    rng = np.random.default_rng(3)
    o = draw(60, rng, St_error=0.02)
    likelihood = dataclasses.replace(plan(scatter=False).likelihood(o), log_variance=False)
    found = maximise(likelihood, likelihood.parameters, np.array([K, E_DRY]))
    data = odr.RealData(o.St, o.e, sx=o.St_sigma, sy=o.e_sigma)
    model = odr.Model(lambda p, x: p[1] * np.exp(-p[0] * (1 + p[1]) / x))
    other = odr.ODR(data, model, [K, E_DRY]).run()
    assert np.all(np.abs(found.values - other.beta) < 0.05 * found.sigma)
    np.testing.assert_allclose(found.sigma, np.sqrt(np.diag(other.cov_beta)), rtol=0.03)


def test_sampling_a_gaussian_gives_what_minuit_gives():
    C = np.array([[0.04, 0.03, 0.0], [0.03, 0.09, -0.02], [0.0, -0.02, 0.16]])
    inverse, centre = np.linalg.inv(C), np.array([1.0, 2.0, 3.0])

    def negative_log(x):
        return 0.5 * (x - centre) @ inverse @ (x - centre)

    parameters = [Parameter(name, 0.5, (-50.0, 50.0)) for name in "abc"]
    rise = {0.68: [threshold(0.68, np.inf)] * 3}
    found = maximise(negative_log, parameters, thresholds=Thresholds(rise))
    np.testing.assert_allclose(found.covariance, C, atol=1e-4)
    half = stats.norm.ppf(0.84) * np.sqrt(np.diag(C))
    np.testing.assert_allclose(found.intervals[0.68], np.stack([centre - half, centre + half], axis=1), atol=2e-3)
    drawn = sample(negative_log, found, seed=1)
    error = 4 * found.sigma / np.sqrt(len(drawn.draws) / 2)
    assert np.all(np.abs(drawn.median - found.values) < 1.3 * error)
    np.testing.assert_allclose(np.cov(drawn.draws.T), C, atol=0.01)
    np.testing.assert_allclose(drawn.interval(0.68), found.intervals[0.68], atol=0.04)


def test_a_prior_is_an_independent_measurement():
    """Two normal measurements of one quantity: the weighted mean, by hand."""
    p = Parameter("x", 1.0, (-10.0, 10.0), prior=Normal(2.0, 0.5))
    found = maximise(lambda x: 0.5 * ((x[0] - 1.0) / 1.0) ** 2, [p])
    assert found.values[0] == pytest.approx((1.0 + 4 * 2.0) / 5, abs=1e-3)
    assert found.sigma[0] == pytest.approx(5**-0.5, rel=1e-3)


def test_a_chain_that_does_not_converge_gives_no_answer():
    found = maximise(lambda x: 0.5 * float(x @ x), [Parameter("x", 0.5, (-5.0, 5.0))])
    with pytest.raises(InputError, match="not converged"):
        sample(lambda x: 0.5 * float(x @ x), found, most_steps=500)


@pytest.mark.parametrize("name", [n for n in laws.names("rebound") if laws.get(n).parameter_fields()])
def test_parameters_are_recovered_as_noise_vanishes(name):
    law = laws.get(name)
    St = np.geomspace(25, 400, 40)
    model = plan(name, e_dry=0.97).model
    defaults = {p.name: p.start for p in model.parameters}
    truth = {n: v if n in model.chosen else v * 0.8 for n, v in defaults.items()}
    rng = np.random.default_rng(1)
    ratio = 1.06 if law.convention == "st_star" else 1.0
    e = model(St * ratio, 0.97, truth)[0] + 1e-9 * rng.standard_normal(len(St))
    o = dataclasses.replace(observations(St * ratio, e, 1e-9), convention=law.convention)
    fit = estimate(plan(name, e_dry=0.97, scatter=False), o, intervals=False)
    for p, value in zip(fit.maximum.parameters, fit.maximum.values, strict=True):
        assert value == pytest.approx(truth[p.name], rel=1e-6), p.name


@pytest.mark.parametrize("robust", [False, True])
def test_offset_and_limits_against_numerical_integration(robust):
    """The marginal likelihood of three sources, with limits, by adaptive quadrature over each offset."""
    rng = np.random.default_rng(5)
    o = draw(18, rng, scatter=0.03, limit=0.15, offset=0.05)
    o = dataclasses.replace(o, labels={"source": np.array([f"s{i % 3}" for i in range(18)], object)})
    assert o.censored.any()
    likelihood = plan(robust=robust).likelihood(o)
    one = stats.t(STUDENT) if robust else stats.norm()
    for tau, omega in ((0.03, 0.05), (0.01, 0.2), (0.1, 0.001)):
        values = np.array([17.0, 0.92, tau, omega])
        f, variance, _ = likelihood.moments(values)
        each = [np.flatnonzero(likelihood.sources == source) for source in range(3)]
        total = sum(np.log(_marginal(o, f, np.sqrt(variance), here, omega, one)) for here in each)
        assert -likelihood(values) == pytest.approx(total, abs=1e-6)


def _marginal(o, f, s, here, omega, one):
    """Integral over the offset of one source of the densities of its impacts and the normal of the offset."""

    def density(b):
        below = one.cdf((o.upper - f - b)[here] / s[here])
        at = one.pdf((o.e - f - b)[here] / s[here]) / s[here]
        return np.prod(np.where(o.censored[here], below, at)) * stats.norm.pdf(b, scale=omega)

    grid = np.linspace(-6 * omega, 6 * omega, 2001)
    peak = grid[np.argmax([density(b) for b in grid])]
    reach = min(8 * omega, 0.5)
    return integrate.quad(density, peak - reach, peak + reach, points=[peak], limit=400, epsabs=0)[0]


def test_student_intervals_of_a_straight_line():
    """Errors wholly unknown: restricted likelihood and profile give the textbook's t interval of a regression."""
    rng = np.random.default_rng(11)
    x = np.linspace(1, 10, 9)
    y = 2 + 0.5 * x + 0.3 * rng.standard_normal(9)
    o = observations(x, y)
    fit = estimate(plan(**{**LINE, "scatter": True}), o)
    book = stats.linregress(x, y)
    t = stats.t(7)
    assert fit.freedom[:2] == pytest.approx([7, 7], rel=1e-6)
    assert fit.maximum.values[1] == pytest.approx(book.slope, abs=1e-4)
    residual = y - book.intercept - book.slope * x
    assert fit.maximum.values[2] == pytest.approx(np.sqrt(residual @ residual / 7), rel=1e-3)
    for level in (0.68, 0.95):
        half = t.ppf(0.5 * (1 + level)) * book.stderr
        expected = [book.slope - half, book.slope + half]
        np.testing.assert_allclose(fit.maximum.intervals[level][1], expected, atol=5e-4)


def test_prediction_intervals_of_a_straight_line():
    """Errors wholly unknown: given the scatter all is normal, and the scatter is integrated out by a fine sum."""
    rng = np.random.default_rng(11)
    x = np.linspace(1, 10, 9)
    y = 0.2 + 0.05 * x + 0.03 * rng.standard_normal(9)
    at = np.array([2.0, 5.5, 9.0])
    found = predict(result_of(estimate(plan(**{**LINE, "scatter": True}), observations(x, y))), at)
    book = stats.linregress(x, y)
    squares = np.sum((y - book.intercept - book.slope * x) ** 2)
    leverage = 1 / 9 + (at - x.mean()) ** 2 / np.sum((x - x.mean()) ** 2)
    tau = np.linspace(1e-4, 0.6, 6000)
    log_p = -7 * np.log(tau) - squares / (2 * tau**2) - 0.5 * (tau / TYPICAL_SCATTER) ** 2
    weight = np.exp(log_p - log_p.max())
    weight /= weight.sum()
    for level, name in ((0.68, "68%"), (0.95, "95%")):
        for ends, more in ((found.law[name], 0.0), (found.impact[name], 1.0)):
            for width, h in zip(np.ptp(ends, axis=1), leverage, strict=True):
                half = optimize.brentq(
                    lambda z, h=h, more=more, level=level: (
                        weight @ special.erf(z / tau / np.sqrt(2 * (more + h))) - level
                    ),
                    0,
                    2,
                )
                assert width / 2 == pytest.approx(half, rel=0.05)


def test_bands_are_those_of_the_chain():
    """Draws weighted about the maximum and emcee are of one posterior: widths within 10 %, at both levels."""
    o = draw(10, np.random.default_rng(5), scatter=0.03, offset=0.03)
    fit = estimate(plan(e_dry=E_DRY), o)
    St = np.array([20.0, 60.0, 300.0])
    chain = sample(fit.likelihood, fit.maximum, seed=1)
    for source in (None, "lab 0"):
        ours, theirs = (predict(result_of(fit, x), St, E_DRY, source=source) for x in (None, chain))
        for level in ("68%", "95%"):
            np.testing.assert_allclose(
                np.ptp(ours.impact[level], axis=1), np.ptp(theirs.impact[level], axis=1), rtol=0.1
            )
            np.testing.assert_allclose(
                np.ptp(ours.law[level], axis=1), np.ptp(theirs.law[level], axis=1), rtol=0.1
            )


def test_a_band_does_not_jump_where_an_offset_vanishes():
    """Two sources are moved past one another in steps of 0.005: the estimated offset is zero for some."""
    o = draw(12, np.random.default_rng(8), scatter=0.02)
    labs = np.array([f"lab {i % 2}" for i in range(12)], object)
    widths, offsets = [], []
    for shift in np.arange(-0.03, 0.05, 0.005):
        moved = dataclasses.replace(o, e=o.e + shift * (np.arange(12) % 2 - 0.5), labels={"source": labs})
        fit = estimate(plan(e_dry=E_DRY), moved)
        offsets.append(fit.maximum.values[-1])
        widths.append(float(np.ptp(predict(result_of(fit), 60.0, E_DRY).impact["95%"])))
    assert min(offsets) < 1e-3 < 0.015 < max(offsets)
    assert np.max(np.abs(np.diff(np.log(widths)))) < 0.15


def test_many_stokes_numbers_have_the_bands_of_few():
    o = draw(10, np.random.default_rng(5), scatter=0.03, offset=0.03)
    result = result_of(estimate(plan(), o))
    St = np.geomspace(10, 600, 3000)
    many, few = predict(result, St), predict(result, St[::300])
    for level in ("68%", "95%"):
        for a, b in ((many.impact, few.impact), (many.law, few.law)):
            assert np.all(np.abs(a[level][::300] - b[level]) < 0.01 * np.ptp(b[level], axis=1)[:, None])


def test_predictive_density_of_what_was_left_out():
    """With parameters known, ln p(out | others) = ln p(all) - ln p(others)."""
    rng = np.random.default_rng(2)
    o = draw(12, rng, scatter=0.03, offset=0.05)
    fit = estimate(plan(), o, intervals=False)
    known = dataclasses.replace(fit.maximum, covariance=np.zeros_like(fit.maximum.covariance))
    fit = dataclasses.replace(fit, maximum=known)
    for out in (np.arange(12) == 4, np.arange(12) % 2 == 0):
        inside = fit.likelihood.of(o.take(~out))
        expected = inside(known.values) - fit.likelihood(known.values)
        assert predictive(dataclasses.replace(fit, likelihood=inside), fit.likelihood, out) == pytest.approx(
            expected
        )
