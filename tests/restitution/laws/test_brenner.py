"""The exact wall resistance against its series summed with 40 digits, and against the published table."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from restitution.laws import get
from restitution.laws.brenner_1961 import HIGH, LOW, series

# Brenner, Chem. Eng. Sci. 16, 242 (1961): gap/radius and the drag multiplier as printed.
PUBLISHED = {
    "0.4": "3.73562",
    "0.3": "4.61072",
    "0.2": "6.34089",
    "0.1": "11.4592",
    "0.05": "21.5858",
    "0.025": "41.7176",
    "0.01": "101.896",
}


def summed(eps: mpmath.mpf) -> mpmath.mpf:
    """Brenner's eq. 2.19 term by term as printed, until a term no longer counts in 30 digits."""
    alpha = mpmath.acosh(1 + eps)
    sinh, sinh_2 = mpmath.sinh(alpha), mpmath.sinh(2 * alpha)
    step = mpmath.exp(2 * alpha)
    grown = mpmath.exp(alpha)  # exp(N alpha) by recurrence
    total, n = mpmath.mpf(0), 1
    while True:
        grown *= step
        N = 2 * n + 1
        twice_sinh_N, twice_cosh_N = grown - 1 / grown, grown + 1 / grown
        bracket = (twice_sinh_N + N * sinh_2) / (twice_cosh_N - 2 - (N * sinh) ** 2) - 1
        term = mpmath.mpf(n * (n + 1)) / ((2 * n - 1) * (2 * n + 3)) * bracket
        total += term
        if abs(term) < mpmath.mpf(10) ** -30 * total:
            return mpmath.mpf(4) / 3 * sinh * total
        n += 1


@pytest.fixture(autouse=True)
def _digits():
    with mpmath.workdps(40):
        yield


@pytest.mark.parametrize(("eps", "printed"), PUBLISHED.items())
def test_published_values_to_all_printed_digits(eps, printed):
    decimals = len(printed.partition(".")[2])
    assert f"{get('brenner_1961')(float(eps)):.{decimals}f}" == printed


@pytest.mark.parametrize("eps", [1e-4, 3.3e-4, 1e-3, 7e-3, 0.05, 0.123, 0.4, 1.0, 2.7, 30.0, 100.0, 777.0, 1e3])
def test_value_and_derivative_agree_with_the_series_in_40_digits(eps):
    law, h = get("brenner_1961"), mpmath.mpf(eps) * mpmath.mpf(10) ** -9
    slope = (summed(eps + h) - summed(eps - h)) / (2 * h)  # its own error is of order 1e-18
    assert law(eps) == pytest.approx(float(summed(mpmath.mpf(eps))), rel=1e-14, abs=0)
    assert law.derivative(eps) == pytest.approx(float(slope), rel=1e-14, abs=0)


@pytest.mark.parametrize("eps", [3e-5, 1.1e-6, 0.9e-6, 4e-7])
def test_the_small_gap_expansion_joins_and_is_exact_below(eps):
    assert get("brenner_1961")(eps) == pytest.approx(float(summed(mpmath.mpf(eps))), rel=1e-14, abs=0)


@pytest.mark.parametrize("eps", [1.1e3, 1e4, 1e6])
def test_the_large_gap_expansion_is_exact_in_what_exceeds_one(eps):
    law = get("brenner_1961")
    excess = float(summed(mpmath.mpf(eps)) - 1)
    assert law(eps) == pytest.approx(1 + excess, rel=1e-15, abs=0)
    assert -(eps**2) * law.derivative(eps) == pytest.approx(
        eps * excess, rel=2 / eps, abs=0
    )  # 9/8 to leading order


def test_a_hundred_thousand_gaps_in_one_call_agree_with_the_series():
    law, rng = get("brenner_1961"), np.random.default_rng(1961)
    eps = np.exp(rng.uniform(np.log(1e-4), np.log(1e3), 100_000))
    value, slope = law(eps), law.derivative(eps)
    assert value.shape == slope.shape == eps.shape
    exact = np.array([series(e) for e in eps[:200]])
    np.testing.assert_allclose(value[:200], 1 + exact[:, 0], rtol=1e-14)
    np.testing.assert_allclose(slope[:200], exact[:, 1], rtol=1e-14)
    assert np.all(np.diff(value[np.argsort(eps)]) < 0)


@pytest.mark.parametrize("joint", [LOW, HIGH])
def test_value_and_slope_do_not_jump_where_the_representations_meet(joint):
    law = get("brenner_1961")
    below, above = np.nextafter(joint, 0), np.nextafter(joint, np.inf)
    assert law(below) == pytest.approx(law(above), rel=5e-15, abs=0)
    assert law.derivative(below) == pytest.approx(law.derivative(above), rel=1e-14, abs=0)


def test_limits_and_shapes():
    law = get("brenner_1961")
    assert law(np.inf) == 1.0
    assert law.derivative(np.inf) == 0.0
    assert 1e-12 * law(1e-12) == pytest.approx(1.0, rel=1e-10, abs=0)
    assert np.ndim(law(0.1)) == 0
    assert law(np.full((2, 3), 0.1)).shape == (2, 3)
