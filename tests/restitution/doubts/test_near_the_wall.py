"""Near the wall the added mass is larger, so that light spheres fall slower there than free fall has it."""

import numpy as np
import pytest
from scipy.special import zeta

from restitution.conditions import Conditions
from restitution.doubts import of_track
from restitution.tracks import contacts
from tests.flights import as_track

D, RHO_F, G = 6e-3, 1000.0, 9.81
TOUCHING = 1.5 * zeta(3) - 1  # over the displaced mass, Lamb's images in the wall


def _bounces(density, slower=1.0, noise=1e-6):
    """Bounces of 0.08, 0.06, 0.04 d on the wall, fallen freely with the added mass of a touching sphere."""
    fall = G * (density - RHO_F) / (density + TOUCHING * RHO_F)
    times, gaps, begin = [], [], 0.0
    for apex in (0.08 * D, 0.06 * D, 0.04 * D):
        v = np.sqrt(2 * fall * apex)
        t = np.arange(0.0, 2 * v / fall, v / fall / 40)
        times.append(begin + t)
        gaps.append(v * t - fall * t**2 / 2)
        begin += 2 * v / fall
    rng = np.random.default_rng(5)
    gap = np.concatenate(gaps) + noise * rng.standard_normal(sum(map(len, gaps)))
    conditions = Conditions.model_validate(
        {"fluid": {"density": RHO_F, "viscosity": 2.5e-3}, "sphere": {"diameter": D, "density": density}}
    )
    return as_track(slower * np.concatenate(times), gap), conditions


def _doubts(track, conditions):
    return [doubt.name for doubt in of_track(track, contacts(track), conditions)]


@pytest.mark.parametrize("density", [1080.0, 1140.0, 1400.0, 2500.0, 7800.0])
def test_what_falls_with_the_added_mass_at_the_wall_is_not_doubted(density):
    assert "clock" not in _doubts(*_bounces(density))


@pytest.mark.parametrize("density", [1080.0, 1140.0, 1400.0, 2500.0, 7800.0])
def test_a_clock_that_is_a_tenth_slow_is_doubted_all_the_same(density):
    assert "clock" in _doubts(*_bounces(density, slower=1.1))
