"""Simulated rebounds on the page of Figure 1: made by a known law here, so that it must be found."""

import math

import numpy as np
import pandas as pd
import pytest

from restitution.report.fig1 import rebounds, rebounds_plot

SIGMA = 0.01


def table(folder, K=lambda ratio: 12.0, over_e=False):
    """Rebounds of two grids by the exponential form of Eq. (4), read with an error of 0.01."""
    rng = np.random.default_rng(3)
    rows = []
    for ratio in (1.5, 8.0):
        for e_dry in (0.97, 0.6):
            for St in (15.0, 30.0, 60.0, 120.0, 240.0):
                K_ = K(ratio) / (e_dry if over_e else 1.0)
                e = e_dry * math.exp(-K_ * (1 + e_dry) / St) + SIGMA * rng.standard_normal()
                for cells, off in ((10, 0.004), (15, 0.002)):
                    rows += [row(ratio, St, e_dry, cells, e + off, str(d)) for d in rebounds.DEFINITIONS]
    rows.append(row(1.5, 500.0, 0.97, 10, 0.9, "far"))  # the finer grid diverged
    rows.append({"density_ratio": 1.5, "stokes_of_drive": 500.0, "cells_per_diameter": 15, "outcome": "diverged"})
    pd.DataFrame(rows).to_csv(folder / "rebounds.csv", index=False)
    return rebounds.gather(str(folder / "rebounds.csv"))


def row(ratio, St, e_dry, cells, e, definition):
    return {
        "density_ratio": ratio, "stokes_of_drive": St, "cells_per_diameter": cells, "rates": "balanced",
        "record": f"r{ratio}{St}{e_dry}{cells}", "impact": 1, "kind": "simulated", "outcome": "rebound",
        "speed_definition": definition, "film_edge_d": 0.1 if definition == "far" else None,
        "stokes_convention": "st", "stokes": St, "stokes_sigma": 0.1, "e_dry": e_dry, "e_eff": e,
        "e_eff_sigma": SIGMA, "e_stokes_correlation": 0.0, "e_eff_upper": None,
    }  # fmt: skip


@pytest.fixture(scope="module")
def one_K(tmp_path_factory):
    return table(tmp_path_factory.mktemp("one"))


def test_the_form_and_its_one_K_are_found(one_K):
    for h in one_K.held:
        assert h.best.label == "eq4_exponential"
        low, high = h.best.fit.maximum.intervals[0.95][0]
        assert low < 12 < high
        assert h.every.p > 0.05
        assert h.every.freedom == 3
        assert len(h.by_group) == 4
    assert not any("no one K" in s for s in rebounds.in_words(one_K))


def test_a_rebound_is_that_of_the_finer_grid_with_the_error_of_first_order(one_K):
    far = one_K.of("far")
    assert len(far) == 20
    # 0.002 between 10 and 15 cells: an error that halves with half the cell leaves 0.002/(15/10 - 1).
    assert far.e_grid_sigma.to_numpy() == pytest.approx(np.full(20, 0.004))
    assert far.e_total_sigma.to_numpy() == pytest.approx(np.full(20, math.hypot(0.004, SIGMA)))
    assert far.stokes.max() < 500
    assert len(one_K.lost) == 1


def test_K_that_differs_with_the_density_ratio_is_said(tmp_path):
    found = table(tmp_path, lambda ratio: 9.0 if ratio < 2 else 15.0)
    for h in found.held:
        assert h.every.p < 1e-3
        assert h.at_a_ratio.p > 0.05
    assert any("no one K holds" in s for s in rebounds.in_words(found))


def test_e_dry_below_the_exponent_is_told_from_the_form_without(tmp_path):
    assert {h.best.label for h in table(tmp_path, over_e=True).held} == {"eq4_exponential_over_e"}


def test_the_drawing_is_the_same_twice(one_K):
    first, second = (rebounds_plot.draw(one_K, "far") for _ in range(2))
    assert first.svg == second.svg
