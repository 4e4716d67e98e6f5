"""Weights of draws leave an impact out as a fit to the others does, and say where they cannot."""

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import norm
from scipy.stats import t as student

from restitution.calibration import Plan, model_of, read
from restitution.calibration.estimation.parameters import log_prior
from restitution.calibration.result import leaving_out, ranking


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
    found = ranking.score("law", plan, o, intervals=False)
    assert found.refitted < 4
    np.testing.assert_allclose(np.sort(found.loo)[4:], np.sort(exact)[4:], atol=0.05)
    assert found.elpd_loo == pytest.approx(exact.sum(), abs=0.5)


@pytest.mark.parametrize("sources", [1, 12])
def test_weights_agree_with_fits_to_the_others(sources, tmp_path, monkeypatch):
    """Fits to the others hold the scatter at its estimate, draws do not: outliers are a little less unlikely."""
    o, plan = impacts(tmp_path, 60, sources), Plan(model_of("eq4_exponential"))
    fits = ranking.score("law", plan, o, intervals=False)
    assert fits.refitted == 60
    monkeypatch.setattr(leaving_out, "FEWEST", 10)
    weights = ranking.score("law", plan, o, intervals=False)
    assert weights.refitted < 6
    assert weights.elpd_loo == pytest.approx(fits.elpd_loo, abs=1.0)
    np.testing.assert_allclose(np.median(weights.loo - fits.loo), 0, atol=0.03)
    if sources > 1:
        assert weights.elpd_loso == pytest.approx(fits.elpd_loso, abs=2.0)
