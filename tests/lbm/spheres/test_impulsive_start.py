"""A sphere set moving at once: the impulse that it takes from the fluid, against exact unsteady Stokes flow."""

import math

import numpy as np
import pytest

from lbm.problems.impulsive_start import exact, excess


def test_the_lattice_gives_added_mass_and_history_and_the_closer_the_finer():
    coarse, fine = (np.abs(excess(n, 0.025, times=(0.1, 0.15), width=6)) for n in (8, 16))
    assert coarse.max() < 0.1  # of 0.76 to 0.82
    assert fine.max() < 0.03
    assert (fine < coarse).all()


def test_the_exact_impulse_against_its_force():
    # Force on a sphere that jumps to u, Stokes flow: 6 pi mu a u (1 + a/sqrt(pi nu t)), over m_f u and d(nu t/a^2)
    time = np.linspace(0.3, 0.7, 100_001)
    force = 4.5 * (1 + 1 / np.sqrt(math.pi * time))
    assert exact(0.7) - exact(0.3) == pytest.approx(np.trapezoid(force, time), rel=1e-8)
