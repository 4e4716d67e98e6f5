"""Copied rows are found, and rows that are equal by rounding are not: chances of tables drawn here."""

import numpy as np
import pytest

from restitution.doubts.copies import of_copies


def drawn(seed, St, sigma=0.02, digits=2):
    """One e_eff each at the Stokes numbers, read to so many digits."""
    rng = np.random.default_rng([9, seed])
    e = 0.97 * np.exp(-10 * 1.97 / St) + sigma * rng.standard_normal(len(St))
    return np.round(e, digits), np.full(len(St), sigma)


@pytest.mark.parametrize("digits", [1, 2, 3, 6])
@pytest.mark.parametrize("nominal", [True, False])
def test_series_at_nominal_stokes_numbers_are_no_copies(digits, nominal):
    """Thirty repetitions at each of four drops, St as set or as measured."""
    doubted = 0
    for seed in range(200):
        St = np.repeat([40.0, 80.0, 150.0, 300.0], 30)
        if not nominal:
            St = np.round(St * (1 + 0.02 * np.random.default_rng(seed).standard_normal(len(St))), 1)
        e, sigma = drawn(seed, St, digits=digits)
        doubted += bool(of_copies(St, e, sigma))
    assert doubted == 0


@pytest.mark.parametrize("copies", [3, 12])
def test_one_row_filled_down_is_found(copies):
    St = np.array([30.0, 60.0, 120.0, 240.0])
    e, sigma = drawn(0, St, digits=3)
    which = np.array([0, 1, 2, 3, *[1] * copies])
    (doubt,) = of_copies(
        St[which], e[which], sigma[which], [("a.csv", i + 2) for i in range(len(which))], ["a.csv"]
    )
    assert f"as {copies + 1} with St 60" in doubt.message
    assert "a.csv:3" in doubt.message
    assert doubt.where == "a.csv"


def test_a_table_pasted_twice_is_found_whatever_its_order():
    St = np.geomspace(20, 400, 12)
    e, sigma = drawn(1, St)
    which = np.concatenate([np.arange(12), np.random.default_rng(0).permutation(12)])
    (doubt,) = of_copies(St[which], e[which], sigma[which])
    assert doubt.message.startswith("12 impacts are equal")
    assert of_copies(St, e, sigma) == []


def test_errors_of_the_size_of_a_digit_explain_equal_rows():
    St, e = np.full(10, 60.0), np.full(10, 0.5)
    St[0], e[0] = 120.0, 0.72
    assert of_copies(St, e, np.full(10, 0.002)) == []
    assert len(of_copies(St, e, np.full(10, 0.05))) == 1


def test_impacts_without_a_rebound_are_alike():
    St, e = np.full(8, 6.0), np.full(8, np.nan)
    assert of_copies(St, e, np.full(8, 0.01)) == []
