"""Impacts of a simulated trajectory as a camera would have them."""

import numpy as np
import pandas as pd
import pytest

from restitution import cases
from restitution.runs.filmed import simulated_impacts

NYLON = """
title = "a nylon sphere that bounces once"
[fluid]
density = 998
viscosity = 0.0025
[sphere]
diameter = 0.006
density = 1140
e_dry = 0.9
roughness = 1e-6
[release]
kind = "rest"
gap_d = 3.0
[film]
form = "none"
[contact]
mode = "effective"
law = "eq4_exponential"
[run]
after_contact = 0.3
"""
FALL, SPEED = 0.85, 0.1  # m/s2, m/s


def flights(*restitutions):
    """Parabola after parabola, a frame every ms: an approach, then flights with these restitutions, then rest."""
    t = np.arange(-0.1, 0.5, 1e-3)
    gap = np.where(t < 0, -SPEED * t - 0.5 * FALL * t**2, 0.0)
    begin, speed = 0.0, SPEED
    for e in restitutions:
        speed *= e
        s = t - begin
        gap = np.where((s >= 0) & (s < 2 * speed / FALL), speed * s - 0.5 * FALL * s**2, gap)
        begin += 2 * speed / FALL
    return pd.DataFrame({"time_s": t, "gap_m": gap})


def test_what_the_fluid_stirs_of_a_sphere_at_rest_is_no_impact(tmp_path):
    """Flights up to 5 um of a sphere of 6 mm at rest have no e_eff; the bounce before has its own."""
    (tmp_path / "nylon.toml").write_text(NYLON)
    case = cases.read_case(tmp_path / "nylon.toml")
    impacts, _ = simulated_impacts(flights(0.3, 0.1, 0.95, 0.95, 0.95), case)
    contact = impacts[impacts["speed_definition"] == "contact"]
    assert contact["e_eff"].dropna().tolist() == [pytest.approx(0.3, abs=0.01)]
    assert contact["outcome"].tolist() == ["rebound", "not_resolved"]
