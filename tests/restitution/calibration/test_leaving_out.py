"""Weights of draws leave an impact out as a fit to the others does, and say where they cannot."""

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import multivariate_normal, norm
from scipy.stats import t as student

from restitution.calibration import Plan, model_of, read
from restitution.calibration.estimation import fitting
from restitution.calibration.estimation.parameters import log_prior
from restitution.calibration.result import influence, leaving_out, ranking


def test_weights_give_the_predictive_density_of_a_mean():
    """Normal data of known variance: without y_i, y_i ~ N(mean of the others, 1 + 1/(n - 1))."""
    rng = np.random.default_rng(8)
    y = rng.normal(2.0, 1.0, 50)
    draws = y.mean() + student.rvs(7, size=4000, random_state=rng) / np.sqrt(50)
    log_q = student.logpdf((draws - y.mean()) * np.sqrt(50), 7)
    log_p = norm.logpdf(draws, y.mean(), 1 / np.sqrt(50))
    elpd, k = leaving_out.weighed(norm.logpdf(y, draws[:, None], 1.0), log_p - log_q)
    others = (y.sum() - y) / 49
    np.testing.assert_allclose(elpd, norm.logpdf(y, others, np.sqrt(1 + 1 / 49)), atol=0.01)
    assert (k < leaving_out.TRUSTED).all()


def test_weights_that_cannot_be_trusted_say_so():
    """One point that nearly decides alone where the mean is: 40 standard deviations off the others."""
    y = np.array([0.0] * 9 + [40.0])
    rng = np.random.default_rng(3)
    draws = y.mean() + rng.standard_normal(4000) / np.sqrt(10)
    _, k = leaving_out.weighed(norm.logpdf(y, draws[:, None], 1.0), np.zeros(4000))
    assert k[-1] > leaving_out.TRUSTED


def impacts(tmp_path, n, sources):
    rng = np.random.default_rng([n, sources])
    St = np.exp(rng.uniform(np.log(15), np.log(500), n))
    offset = 0.03 * rng.standard_normal(sources)[np.arange(n) % sources]
    e = 0.97 * np.exp(-34 / St) + offset + 0.03 * rng.standard_normal(n)
    rows = "".join(
        f"s{k % sources},{St[k]:.5g},{e[k]:.5g},,0.02,0.97,st,far,rebound\n" if e[k] > 0.08
        else f"s{k % sources},{St[k]:.5g},,0.08,,0.97,st,far,no_rebound\n"
        for k in range(n)
    )  # fmt: skip
    path = tmp_path / "impacts.csv"
    heads = "source,stokes,e_eff,e_eff_upper,e_eff_sigma,e_dry,stokes_convention,speed_definition,outcome\n"
    path.write_text(heads + rows)
    return read(path)


@pytest.mark.parametrize("sources", [1, 12])
def test_the_density_given_the_others_is_a_ratio_of_likelihoods(sources, tmp_path):
    """p(y_i | y_-i, theta) = p(y | theta)/p(y_-i | theta), limits apart, which this density takes one by one."""
    o = impacts(tmp_path, 30, sources)
    o = o.take(~o.censored)
    likelihood = Plan(model_of("eq4_exponential"), offsets=sources > 1).likelihood(o)
    n = len(o)
    for K, tau, omega in ((17.0, 0.03, 0.02), (14.0, 0.05, 0.1)):
        values = np.array([K, tau, omega][: len(likelihood.parameters)])
        whole = -likelihood(values)
        for densities, groups in (
            (leaving_out._of_impacts, np.arange(n)), (leaving_out._of_sources, likelihood.sources),
        ):  # fmt: skip
            ratio = [
                whole + likelihood.of(o.take(groups != k))(values) if (groups != k).any() else whole
                for k in range(int(groups.max()) + 1)
            ]
            np.testing.assert_allclose(densities(likelihood, values), ratio, atol=1e-9)


def test_weights_give_the_integral_over_the_posterior(tmp_path, monkeypatch):
    """Against sums over a grid of K and scatter, each impact left out of the likelihood in turn."""
    o = impacts(tmp_path, 40, 1)
    plan = Plan(model_of("eq4_exponential"))
    likelihood = plan.likelihood(o)
    grid = [np.array([K, tau]) for K in np.linspace(14, 21, 60) for tau in np.linspace(0.005, 0.09, 60)]
    prior = np.array([log_prior(likelihood.parameters, values, every=True) for values in grid])
    f, v = (np.array(x) for x in zip(*(likelihood.moments(values)[:2] for values in grid), strict=True))
    z = np.where(o.censored, o.upper, o.e) - f
    density = np.where(o.censored, norm.logcdf(z / np.sqrt(v)), norm.logpdf(z, 0, np.sqrt(v)))
    rest = density.sum(axis=1, keepdims=True) - density + prior[:, None]
    exact = logsumexp(rest + density, axis=0) - logsumexp(rest, axis=0)
    monkeypatch.setattr(leaving_out, "FEWEST", 10)
    monkeypatch.setattr(leaving_out, "CHECKED", 0)
    found = ranking.score("law", plan, o, intervals=False)
    assert len(found.left_out.distrusted) < 4
    np.testing.assert_allclose(np.sort(found.loo)[4:], np.sort(exact)[4:], atol=0.05)
    assert found.elpd_loo == pytest.approx(exact.sum(), abs=0.5)


@pytest.mark.parametrize("sources", [1, 12])
def test_weights_agree_with_fits_to_the_others(sources, tmp_path, monkeypatch):
    """Fits to the others hold the scatter at its estimate, draws do not: outliers are a little less unlikely."""
    o, plan = impacts(tmp_path, 60, sources), Plan(model_of("eq4_exponential"))
    fits = ranking.score("law", plan, o, intervals=False)
    assert fits.refitted == 60
    monkeypatch.setattr(leaving_out, "FEWEST", 10)
    monkeypatch.setattr(leaving_out, "CHECKED", 0)
    weights = ranking.score("law", plan, o, intervals=False)
    assert len(weights.left_out.distrusted) < 6
    assert weights.elpd_loo == pytest.approx(fits.elpd_loo, abs=1.0)
    np.testing.assert_allclose(np.median(weights.loo - fits.loo), 0, atol=0.03)
    if sources > 1:
        assert weights.elpd_loso == pytest.approx(fits.elpd_loso, abs=2.0)


@pytest.mark.parametrize("law", ["eq4_exponential", "eq4_rational"])
def test_newtons_steps_come_to_rest_where_a_search_does(law, tmp_path, monkeypatch):
    """Also where the law misfits, and single impacts without a rebound weigh much."""
    o = impacts(tmp_path, 80, 4)
    fit = fitting.estimate(Plan(model_of(law)), o, intervals=False)
    masks = list(np.eye(80, dtype=bool)[::4])
    found = [influence.fit_without(fit, out).maximum for out in masks]
    assert sum(m.calls == 0 for m in found) > 15  # no search was made
    near = [ranking.predictive(influence.fit_without(fit, out), fit.likelihood, out) for out in masks]
    monkeypatch.setattr(fitting, "nearby", lambda *_: None)
    searched = [influence.fit_without(fit, out) for out in masks]
    for newton, search in zip(found, searched, strict=True):
        away = (newton.values - search.maximum.values) / search.maximum.sigma
        np.testing.assert_allclose(away, 0, atol=1e-3)
    far = [ranking.predictive(f, fit.likelihood, out) for f, out in zip(searched, masks, strict=True)]
    np.testing.assert_allclose(near, far, atol=1e-3)


@pytest.mark.parametrize("law", ["eq4_exponential", "eq4_rational"])
@pytest.mark.parametrize("sources", [1, 8])
def test_weights_are_as_near_to_fits_as_is_stated(law, sources, tmp_path, monkeypatch):
    """The error comes from a third of the impacts; the sum of all is held against fits for every one."""
    o, plan = impacts(tmp_path, 90, sources), Plan(model_of(law))
    exact = ranking.score("law", plan, o, intervals=False)
    assert exact.left_out.error == 0
    monkeypatch.setattr(leaving_out, "FEWEST", 10)
    monkeypatch.setattr(leaving_out, "CHECKED", 30)
    found = ranking.score("law", plan, o, intervals=False)
    assert 30 <= found.refitted < 50
    assert abs(found.elpd_loo - exact.elpd_loo) < 3 * found.left_out.error < 5
    np.testing.assert_array_equal(found.loo[found.left_out.refitted], exact.loo[found.left_out.refitted])


def test_many_impacts_that_a_law_misfits_are_weighed(tmp_path):
    """They know the scatter to a few per cent, which cells from nought on could not tell apart."""
    found = ranking.score("law", Plan(model_of("eq4_rational")), impacts(tmp_path, 600, 3), intervals=False)
    assert len(found.left_out.distrusted) < 6


def test_an_offset_is_known_from_the_impacts_that_stay(tmp_path):
    """Against the conditional of the joint normal of all impacts, written as matrices."""
    o = impacts(tmp_path, 40, 3)
    o = o.take(~o.censored)
    fit = fitting.estimate(Plan(model_of("eq4_exponential"), offsets=True), o, intervals=False)
    out = np.arange(len(o)) % 9 == 0
    rest, whole = influence.fit_without(fit, out), fit.likelihood
    f, v, omega = whole.moments(rest.maximum.values)
    J, C = whole.jacobian(rest.maximum.values)[:, :1], rest.maximum.covariance[:1, :1]
    K = np.diag(v) + omega**2 * (whole.sources[:, None] == whole.sources)
    gain = K[np.ix_(out, ~out)] @ np.linalg.inv(K[np.ix_(~out, ~out)])
    D = J[out] - gain @ J[~out]
    S = K[np.ix_(out, out)] - gain @ K[np.ix_(~out, out)] + D @ C @ D.T
    expected = multivariate_normal.logpdf(o.e[out], f[out] + gain @ (o.e - f)[~out], S)
    assert omega > 0.005
    assert ranking.predictive(rest, whole, out) == pytest.approx(expected, abs=1e-8)


def test_a_law_without_free_parameters_is_ranked_over_two_sources(tmp_path):
    """Offset and scatter alone are estimated: what the others tell of an impact is its source's offset."""
    St = np.geomspace(20, 300, 12)
    e = 0.97 * np.exp(-20 / St) + 0.02 * np.random.default_rng(4).standard_normal(len(St))
    rows = [f"{x:.4f},{y:.4f},0.01,{'ab'[i % 2]}" for i, (x, y) in enumerate(zip(St, e, strict=True))]
    path = tmp_path / "two.csv"
    path.write_text("stokes,e_eff,e_eff_sigma,source\n" + "\n".join(rows) + "\n")
    plan = Plan(model_of("eq4_exponential"), fixed={"K": 10.15}, e_dry=0.97)
    ranked = ranking.rank([("none free", plan)], read([str(path)], stokes="st", speed="far"))
    assert np.isfinite(ranked.scores[0].loo).all()
