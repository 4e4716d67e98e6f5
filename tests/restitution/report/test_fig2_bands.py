"""The band of what is not known: the envelope of the runs that vary it."""

import numpy as np
import pandas as pd
import pytest

from restitution import cases
from restitution.report.fig2.bands import band


class Run:
    """A kept run that falls off at ``slope`` diameters a second, ``end`` s long."""

    def __init__(self, name, slope, end=1.0):
        time = np.linspace(0, end, 11)
        self.case = cases.read_case(name)
        self.trajectory = pd.DataFrame({"time_s": time, "gap_m": slope * time})


class Report:
    """Nothing but runs."""

    def __init__(self, **runs):
        self.runs = runs


MAIN, LOW, HIGH = "gondret_st152_10_imposed", "gondret_st152_10_k_low", "gondret_st152_10_k_high"


def test_it_spans_the_run_and_those_that_vary_what_is_unknown():
    report = Report(**{MAIN: Run(MAIN, 2.0), LOW: Run(LOW, 3.0), HIGH: Run(HIGH, 1.0, end=0.5)})
    about = band(report, MAIN)
    assert set(about.cases) == {LOW, HIGH}
    assert about.time_s.max() == pytest.approx(0.5)  # as far as all of them go
    np.testing.assert_allclose(about.low_m, about.time_s)
    np.testing.assert_allclose(about.high_m, 3 * about.time_s)


def test_what_varies_the_grid_is_no_part_of_it():
    grid = "gondret_st152_16_imposed"
    assert band(Report(**{MAIN: Run(MAIN, 2.0), grid: Run(grid, 9.0)}), MAIN) is None


def test_there_is_none_without_the_run_itself():
    assert band(Report(**{LOW: Run(LOW, 3.0)}), MAIN) is None
