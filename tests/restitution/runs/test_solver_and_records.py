"""The solver against what the toolkit knows: a measured settling sphere, the exact resistance of a wall."""

import numpy as np
import pytest

from lbm.problems import bouncing_spheres as bouncing
from lbm.problems import spheres as flows
from lbm.spheres import lost_to_grid
from restitution import datasets
from restitution.laws.brenner_1961 import Brenner1961


def test_peak_speed_of_a_measured_settling_sphere():
    """ten Cate et al. 2002, E3: u_max/u_inf = 0.959, at half the resolution that gives 1.5 %."""
    record = datasets.resource("tencate2002_e3_gap")
    terminal = record.quoted["terminal_speed_m_s"]
    run = bouncing.settling(record.conditions, 7.5, speed=0.04, terminal=terminal, duration=0.95, dtype="float32")
    assert -run.velocity.min() / terminal == pytest.approx(0.959, rel=0.04)


def test_film_and_lattice_together_are_brenners_resistance():
    """At a tenth of a cell nine tenths of the resistance are the film's; nothing in it is fitted."""
    run = flows.approach(10, width=4, height=3, start=0.25, speed=2e-3, dtype="float32")
    exact = Brenner1961()(eps=run.gap / run.radius)
    film = run.radius * np.array([lost_to_grid(h) for h in run.gap])
    alone, together = run.resistance / exact, (run.resistance + film) / exact
    assert together[(run.gap > 1.9) & (run.gap < 2.1)].mean() == pytest.approx(1, abs=0.04)
    assert together[(run.gap < 0.5) & (run.gap > 0.2)].mean() == pytest.approx(1, abs=0.07)
    near = (run.gap < 0.2) & (run.gap > 0.05)
    assert alone[near].mean() < 0.3
    assert together[near].mean() == pytest.approx(1, abs=0.04)
