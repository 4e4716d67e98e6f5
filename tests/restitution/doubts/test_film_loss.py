"""Impacts whose Stokes number is of another definition lose in the film what no measured record does."""

import numpy as np
import pytest

from restitution.doubts import of_gain, of_impacts


def impacts(K, seed, n=12, e_dry=0.97):
    rng = np.random.default_rng(seed)
    St = np.exp(rng.uniform(np.log(20), np.log(200), n))
    return St, e_dry * np.exp(-K * (1 + e_dry) / St) + 0.015 * rng.standard_normal(n), e_dry


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("K", [7.0, 11.0, 18.0])
def test_what_is_measured_is_not_doubted(K, seed):
    assert of_impacts(*impacts(K, seed)) == []


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("factor", "word"), [(9.0, "st_d"), (1 / 9, "--stokes st)"), (1e3, "mPa s"), (1e-3, "mPa s")]
)
def test_another_stokes_number_is_named(factor, word, seed):
    St, e, e_dry = impacts(11.0, seed)
    (doubt,) = of_impacts(factor * St, e, e_dry, ["my.csv"])
    assert word in doubt.message
    assert doubt.where == "my.csv"


def test_a_few_or_nearly_dry_impacts_tell_nothing():
    St, e, e_dry = impacts(11.0, 1)
    assert of_impacts(9 * St[:2], e[:2], e_dry) == []
    assert of_impacts([1e4, 2e4, 3e4], [0.955, 0.96, 0.95], 0.97) == []
    assert of_impacts([50.0, 60.0, 80.0], [np.nan] * 3, 0.97) == []


def test_stated_conditions_are_asked_about_where_st_is_theirs():
    St, e, e_dry = impacts(11.0, 1)
    (doubt,) = of_impacts(9 * St, e, e_dry, ["my"], computed=True)
    assert "viscosity" in doubt.message


@pytest.mark.parametrize(
    ("e", "sigma", "number"), [([0.7, 1.3], [0.02, 0.02], "impact 4"), ([0.985, 0.6], [0.004, 0.02], "impact 2")]
)
def test_a_sphere_that_gains_speed_or_loses_less_than_dry_is_doubted(e, sigma, number):
    (doubt,) = of_gain([2, 4], e, sigma, 0.97)
    assert number in doubt.message


def test_an_error_explains_what_is_above_the_dry_one():
    assert of_gain([1, 2, 3], [0.99, 1.1, np.nan], [0.02, 0.1, np.nan], 0.97) == []
    assert of_gain([1], [0.9], [0.001], None) == []


@pytest.mark.parametrize("e", [0.93, 0.3])
def test_one_impact_is_enough_where_its_error_leaves_no_doubt(e):
    """At St 40 measured records lose a third; e_dry is known to a fiftieth."""
    St = 40.0 if e > 0.5 else 200.0
    assert of_impacts([St], [e], 0.97, sigma=[0.01])
    assert of_impacts([St], [e], 0.97, sigma=[0.2]) == []
    assert of_impacts([St], [e], 0.97) == []


def test_an_impact_that_may_well_be_says_nothing_against_a_wrong_fluid():
    assert of_impacts([40.0, 40.0], [0.93, 0.58], 0.97, sigma=[0.01, 0.01]) == []
    assert of_impacts([1e4, 5e4], [0.95, 0.93], 0.97, sigma=[0.002, 0.002]) == []  # e_dry is not that sure
