"""Estimates themselves: exact derivatives, where the search begins, and when its result is doubted."""

import contextlib
import dataclasses
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from restitution.calibration import estimate, model_of, result_of
from restitution.calibration.estimation.curvature import Curvature
from restitution.calibration.estimation.small_sample import Restriction
from restitution.calibration.reading.observations import join
from restitution.calibration.result.chained import earlier_of
from restitution.calibration.trajectories.fit import values_of
from restitution.errors import InputError
from tests.fits import E_DRY, draw, observations, plan

TRUTHS = {"K": 17.0, "e_dry": 0.9, "scatter": 0.025, "source_offset": 0.02, "a": 30.0, "n": 1.0}


LAWS = (
    "eq4_exponential",
    "e_dry*exp(-(a/St)**n) + 0*sin(a)",
    "min(0.99, max(abs(n - a/St), 0.05, 0.1)*e_dry, 2 + gamma(n)*abs(0.2 - a*n/St)*erf(tanh(a)))",
)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("limit", [0.0, 0.2])
def test_exact_derivatives_are_those_of_differences(law, limit):
    """Gradient and Hessian with errors of St, their correlation, scatter, two sources, limits, a prior."""
    o = draw(30, np.random.default_rng(1), scatter=0.03, St_error=0.05, limit=limit, offset=0.03)
    o = dataclasses.replace(o, correlation=np.full(30, -0.3))
    bounds = {} if law == LAWS[0] else {"a": (5.0, 100.0), "n": (0.3, 3.0)}
    likelihood = plan(law, bounds=bounds).likelihood(o)
    values = np.array([TRUTHS[p.name] for p in likelihood.parameters])
    term = Restriction.at(likelihood, values)
    exact = Curvature.of(likelihood, term)(values)

    def total(x):
        return likelihood(x) + term(x)

    steps = np.diag(3e-4 * values)
    scale = np.sqrt(np.diag(exact.hessian))
    for a, da in enumerate(steps):
        slope = (total(values + da) - total(values - da)) / (2 * da[a])
        assert exact.gradient[a] == pytest.approx(slope, abs=2e-5 * scale[a])
        for b, db in enumerate(steps):
            corners = total(values + da + db) - total(values + da - db) - total(values - da + db)
            mixed = (corners + total(values - da - db)) / (4 * da[a] * db[b])
            assert exact.hessian[a, b] == pytest.approx(mixed, abs=5e-5 * scale[a] * scale[b])


@pytest.mark.parametrize(
    "formula", ["e_dry/(a - a)", "max(log(0), a/St)", "St*a*gamma(0)", "min(0/0, a*St)", "a*exp(1/0)/St"]
)
def test_a_formula_with_an_infinite_part_is_refused(formula):
    o = draw(12, np.random.default_rng(1))
    with pytest.raises(InputError):
        estimate(plan(formula + " + 0*St", bounds={"a": (5.0, 100.0)}), o)


@settings(max_examples=60)
@given(st.recursive(
    st.sampled_from(["St", "a", "e_dry", "0.5", "2"]),
    lambda inner: st.one_of(
        st.builds("{}({})".format, st.sampled_from(["exp", "sqrt", "tanh", "atan", "erf", "abs", "gamma"]), inner),
        st.builds("({}{}{})".format, inner, st.sampled_from("+-*/"), inner),
        st.builds("{}({}, {})".format, st.sampled_from(["min", "max"]), inner, inner),
    ), max_leaves=6,
))  # fmt: skip
def test_every_formula_of_the_grammar_has_derivatives_or_is_refused(formula):
    """Whatever functions are within one another; none is passed over in silence."""
    o = draw(6, np.random.default_rng(1), St_error=0.05)
    likelihood = plan(f"{formula} + a/St", bounds={"a": (5.0, 100.0)}).likelihood(o)
    values = np.array([TRUTHS.get(p.name, 0.02) for p in likelihood.parameters])
    with contextlib.suppress(InputError):
        exact = Curvature.of(likelihood, None)(values)
        assert exact is None or np.isfinite(exact.hessian).all()


def test_the_standard_error_of_a_line_is_the_textbooks():
    """To six digits, where second differences leave percents."""
    x = np.linspace(1, 10, 12)
    y = 0.3 + 0.04 * x + 0.02 * np.random.default_rng(0).standard_normal(12)
    line = plan("a + b*St", bounds={"a": (-5.0, 5.0), "b": (-2.0, 2.0)}, e_dry=1.0, scatter=False)
    found = estimate(line, observations(x, y, 0.02)).maximum
    C = np.linalg.inv(np.stack([np.ones(12), x]) @ np.stack([np.ones(12), x], axis=1)) * 0.02**2
    np.testing.assert_allclose(found.covariance, C, rtol=1e-6)


def peak(x):
    """A narrow line far from the middle of the bounds, which see none of it."""
    return 0.05 + 0.8 * np.exp(-0.5 * ((x - 452.0) / 4.0) ** 2)


PEAK = "b + h*exp(-0.5*((St - m)/w)**2)"
PEAK_BOUNDS = {"b": (0.0, 1.0), "h": (0.01, 5.0), "m": (100.0, 1000.0), "w": (1.0, 100.0)}


def peaked():
    x = np.linspace(400, 500, 35)
    return observations(x, peak(x) + 0.005 * np.random.default_rng(2).standard_normal(35))


def test_a_likelihood_that_is_flat_in_the_middle_of_the_bounds_is_searched_elsewhere():
    found = estimate(plan(PEAK, bounds=PEAK_BOUNDS, e_dry=1.0), peaked())
    own = dict(zip([p.name for p in found.maximum.parameters], found.maximum.values, strict=True))
    assert own["m"] == pytest.approx(452.0, abs=0.2)
    assert own["w"] == pytest.approx(4.0, abs=0.2)


def test_a_start_of_the_callers_is_taken():
    begun = plan(PEAK, bounds=PEAK_BOUNDS, e_dry=1.0, starts={"b": 0.1, "h": 0.5, "m": 450.0, "w": 5.0})
    anywhere = plan(PEAK, bounds=PEAK_BOUNDS, e_dry=1.0)
    a, b = (estimate(p, peaked()).maximum.values for p in (begun, anywhere))
    np.testing.assert_allclose(a, b, rtol=1e-7)
    for starts in ({"m": 3000.0}, {"q": 1.0}, {"e_dry": 0.9}):
        with pytest.raises(InputError, match=next(iter(starts))):
            estimate(plan(PEAK, bounds=PEAK_BOUNDS, e_dry=1.0, starts=starts), peaked())


LANCZOS_3 = [
    2.5134, 2.0443, 1.6684, 1.3664, 1.1232, 0.9269, 0.7679, 0.6389, 0.5338, 0.4479, 0.3776, 0.3197, 0.2720, 0.2325,
    0.1997, 0.1723, 0.1493, 0.1301, 0.1138, 0.1, 0.0883, 0.0783, 0.0698, 0.0624,
]  # fmt: skip
"""NIST StRD Lanczos3: three exponentials that are hardly told apart, at x = 0, 0.05, ..., 1.15."""


def test_parameters_that_can_hardly_be_told_apart_have_nists_errors_or_a_doubt():
    """Certified values and standard deviations; whatever intervals do not agree with them are doubted."""
    text = "(b1*exp(-b2*St) + b3*exp(-b4*St) + b5*exp(-b6*St))/10"
    starts = {"b1": 1.2, "b2": 0.3, "b3": 5.6, "b4": 5.5, "b5": 6.5, "b6": 7.6}
    bounds = dict.fromkeys(starts, (0.01, 80.0))
    o = observations(0.05 * np.arange(24), np.array(LANCZOS_3) / 10)
    fit = estimate(plan(text, bounds=bounds, e_dry=1.0, starts=starts), o)
    value = [0.086816414977, 0.95498101505, 0.84400777463, 2.9515951832, 1.5825685901, 4.9863565084]
    sigma = [0.017197908859, 0.097041624475, 0.041488663282, 0.10766312506, 0.058371576281, 0.034436403035]
    names = [p.name for p in fit.maximum.parameters]
    order = [names.index(name) for name in starts]
    assert np.max(np.abs(fit.maximum.values[order] - value) / sigma) < 1e-3
    np.testing.assert_allclose(fit.maximum.sigma[order], sigma, rtol=0.05)
    half = 0.5 * np.diff(fit.maximum.intervals[0.68][order], axis=1)[:, 0]
    agree = np.all((half > 0.7 * np.array(sigma)) & (half < 1.5 * np.array(sigma)))
    assert agree or {d.name for d in fit.doubts} & {"sigma", "intervals", "curvature"}


BENNETT_5 = Path(__file__).parents[3] / "benchmarks" / "nist_strd" / "Bennett5.dat"
"""NIST StRD Bennett5: its valley is 50 000 times as long as it is wide, and bends."""


@pytest.mark.parametrize(
    "starts", [{"b1": -2000.0, "b2": 50.0, "b3": 0.8}, {"b1": -1500.0, "b2": 45.0, "b3": 0.85}]
)
def test_a_narrow_valley_that_bends_is_followed_to_its_lowest_place(starts):
    """Certified values and standard deviations, from NIST's two starts."""
    y, St = np.loadtxt(BENNETT_5, skiprows=60).T
    bounds = {"b1": (-20000.0, -150.0), "b2": (4.5, 500.0), "b3": (0.08, 8.5)}
    fit = estimate(
        plan("b1*(b2 + St)**(-1/b3)/100", bounds=bounds, e_dry=1.0, starts=starts), observations(St, y / 100)
    )
    order = [[p.name for p in fit.maximum.parameters].index(name) for name in starts]
    value, sigma = [-2523.5058043, 46.736564644, 0.93218483193], [297.15410404, 1.2448871856, 0.020272299378]
    assert np.max(np.abs(fit.maximum.values[order] - value) / sigma) < 1e-5
    np.testing.assert_allclose(fit.maximum.sigma[order], sigma, rtol=0.05)


def test_functions_of_a_formula_have_their_slopes():
    St = np.array([0.4, 1.3, 2.7])
    for text in ("sin(a*St)", "cos(a*St)", "atan(a/St)", "erf(a*St)", "gamma(1 + a*St)"):
        model = model_of(text, {"a": (0.1, 2.0)})
        above, below = (model(St + h, 1.0, {"a": 0.7})[0] for h in (1e-6, -1e-6))
        value, slope = model(St, 1.0, {"a": 0.7})
        assert np.isfinite(value).all()
        np.testing.assert_allclose(slope, (above - below) / 2e-6, rtol=1e-7)


def test_a_chain_of_fits_is_nearly_the_fit_to_all():
    """Correlated parameters, known errors: the second half, with the first as its prior."""
    rng = np.random.default_rng(3)
    first, second = draw(40, rng), draw(40, rng)
    whole = estimate(plan(scatter=False), join([first, second]))
    earlier = earlier_of(result_of(estimate(plan(scatter=False), first)), "first.json")
    chained = estimate(plan(scatter=False, earlier=earlier), second)
    assert np.all(np.abs(chained.maximum.values - whole.maximum.values) < 0.02 * whole.maximum.sigma)
    np.testing.assert_allclose(chained.maximum.covariance, whole.maximum.covariance, rtol=0.02)
    assert "prior of K, e_dry: the fit first.json" in chained.notes


def test_a_prior_by_the_same_data_is_refused_or_doubted():
    first, other = (draw(12, np.random.default_rng(seed), scatter=0.03) for seed in (1, 2))
    named = dataclasses.replace(first, files={"a.csv": "0" * 64})
    earlier = earlier_of(result_of(estimate(plan(), named)), "a.json")
    with pytest.raises(InputError, match=r"a\.csv.*twice"):
        estimate(plan(earlier=earlier), named)
    again = estimate(plan(earlier=earlier), join([other, first.take(np.arange(3))]))
    assert [d.name for d in again.doubts] == ["twice"]
    with pytest.raises(InputError, match="another law"):
        estimate(plan("eq4_rational", earlier=earlier), other)
    with pytest.raises(InputError, match="impact speed"):
        estimate(plan(earlier=dataclasses.replace(earlier, speed="contact")), other)


def test_an_impact_that_is_off_is_the_one_that_moves_the_law():
    o = draw(20, np.random.default_rng(4), scatter=0.01)
    middle = int(np.argmin(np.abs(o.St - 60)))
    e = o.e.copy()
    e[middle] -= 0.15
    points = result_of(estimate(plan(), dataclasses.replace(o, e=e)), influence=True).points
    moved = [abs(p.influence["K"]) for p in points]
    assert int(np.argmax(moved)) == middle
    assert points[middle].influence["K"] > 0.5  # a lower e asks for a greater K


def test_yorks_line_by_option():
    """Without ln of the variances, as York et al. (2004) have it for Pearson's data with York's weights."""
    x = np.array([0.0, 0.9, 1.8, 2.6, 3.3, 4.4, 5.2, 6.1, 6.5, 7.4])
    y = np.array([5.9, 5.4, 4.4, 4.6, 3.5, 3.7, 2.8, 2.8, 2.4, 1.5])
    sx = np.array([1000.0, 1000, 500, 800, 200, 80, 60, 20, 1.8, 1.0]) ** -0.5
    sy = np.array([1.0, 1.8, 4, 8, 20, 20, 70, 70, 100, 500]) ** -0.5
    line = {"law": "a + b*St", "bounds": {"a": (0.0, 10.0), "b": (-5.0, 5.0)}, "e_dry": 1.0, "log_variance": False}
    found = estimate(plan(**line, scatter=False), observations(x, y, sy, sx)).maximum
    np.testing.assert_allclose(found.values, [5.47991022, -0.480533407], atol=2e-5)
    with pytest.raises(InputError, match="--no-scatter"):
        estimate(plan(**line), observations(x, y, sy, sx))


def test_the_same_fit_is_the_same_to_the_last_digit():
    o = draw(12, np.random.default_rng(9), scatter=0.03, offset=0.03)
    assert result_of(estimate(plan(), o)).to_json() == result_of(estimate(plan(), o)).to_json()


def with_shared_errors(n=8):
    """Impacts of two records whose errors of St and e have three common causes in each."""
    rng = np.random.default_rng(0)
    o = draw(n, rng, scatter=0.01, offset=0.03)
    shared = np.stack([0.5 * rng.standard_normal((n, 3)), 0.02 * rng.standard_normal((n, 3))], axis=1)
    St_sigma, e_sigma = np.sqrt((shared**2).sum(axis=2)).T
    correlation = (shared[:, 0] * shared[:, 1]).sum(axis=1) / (St_sigma * e_sigma)
    return dataclasses.replace(o, shared=shared, St_sigma=St_sigma, e_sigma=e_sigma, correlation=correlation)


def test_errors_that_a_record_shares_are_those_of_one_dense_normal():
    o, (K, tau, omega) = with_shared_errors(), (17.0, 0.02, 0.03)
    likelihood = plan(e_dry=E_DRY).likelihood(o)
    f, slope = likelihood.model(o.St, E_DRY, {"K": K})
    g = o.shared[:, 1] - slope[:, None] * o.shared[:, 0]
    same = likelihood.sources[:, None] == likelihood.sources
    V = (g @ g.T + omega**2) * same + tau**2 * np.eye(len(o))
    expected = stats.multivariate_normal(f, V).logpdf(o.e)
    assert -likelihood(np.array([K, tau, omega])) == pytest.approx(expected, abs=1e-9)


def test_shared_errors_stay_with_their_impacts():
    """Joined with impacts that share none, taken in part, and fitted: another K than without them."""
    o = with_shared_errors()
    both = join([o, draw(5, np.random.default_rng(1))])
    assert both.shared.shape == (13, 2, 3)
    assert not both.shared[8:].any()
    np.testing.assert_array_equal(both.take(np.array([7, 2])).shared, o.shared[[7, 2]])
    alone = dataclasses.replace(o, shared=None)
    with_them, without = (estimate(plan(e_dry=E_DRY), x, intervals=False).maximum for x in (o, alone))
    assert abs(with_them.values[0] - without.values[0]) > 0.05 * without.sigma[0]


def test_a_record_flies_with_its_own_level_of_a_separate_parameter():
    """K of each record; of one without an impact of its own nothing is known."""
    o = draw(12, np.random.default_rng(6), scatter=0.02, offset=0.02)
    fit = estimate(plan(e_dry=E_DRY, separate={"K": "source"}, offsets=False), o, intervals=False)
    names = [p.name for p in fit.maximum.parameters]
    for record in ("lab 0", "lab 1"):
        assert values_of(fit, record)["K"] == fit.maximum.values[names.index(f"K[{record}]")]
    with pytest.raises(InputError, match="lab 2"):
        values_of(fit, "lab 2")


def test_impacts_that_follow_the_law_to_rounding_are_doubted():
    St = np.geomspace(20, 300, 12)
    exact = np.array([0.97 * np.exp(-17 / x) for x in St])
    noisy = exact + 0.01 * np.random.default_rng(2).standard_normal(len(St))
    names = [{d.name for d in estimate(plan(), observations(St, e)).own_doubts} for e in (exact.round(9), noisy)]
    assert "scatter" in names[0]
    assert names[1] == set()
    with pytest.raises(InputError, match="as computed ones do"):
        estimate(plan(), observations(St, exact))


def test_one_valley_of_many_is_doubted():
    """A wave of unknown period has a maximum at many periods; told where to begin, it has the right one."""
    St = np.linspace(20, 300, 60)
    e = 0.6 + 0.1 * np.sin(0.9 * St) + 0.01 * np.random.default_rng(3).standard_normal(len(St))
    law, bounds = "b + 0.1*sin(w*St)", {"b": (0.1, 1.0), "w": (0.5, 1.5)}
    found = estimate(plan(law, bounds=bounds, e_dry=1.0), observations(St, e))
    right = abs(found.maximum.values[1] - 0.9) < 0.01
    assert right or "starts" in {d.name for d in found.own_doubts}
    told = estimate(plan(law, bounds=bounds, e_dry=1.0, starts={"b": 0.6, "w": 0.9}), observations(St, e))
    assert told.maximum.values[1] == pytest.approx(0.9, abs=0.01)
    assert "starts" not in {d.name for d in told.own_doubts}
