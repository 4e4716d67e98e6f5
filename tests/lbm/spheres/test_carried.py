"""The motion under an effective law on its own, without a fluid: free fall in the film, in and out, and rest."""

import math

import pytest

from lbm.spheres import FilmRebound
from lbm.spheres.wall_motion import FRACTION, motion_at_wall

MASS, FALL, EDGE, E = 900.0, 1e-4, 1.0, 0.8
WEIGHT = -0.07


def _motion(e=E, edge=EDGE):
    return motion_at_wall(None, FilmRebound(lambda speed, count: e * speed, edge, FALL), FRACTION)


def _fly(motion, gap, v, steps, fluid=0.0, weight=WEIGHT):
    """Gap, velocity and impacts after each of ``steps`` steps; ``fluid`` is the force on the sphere."""
    rows = []
    for n in range(steps):
        gap, v, new = motion.step(float(n), gap, v, fluid, weight, MASS)
        rows.append((gap, v, new))
    return rows


@pytest.mark.parametrize("fluid", [0.0, 5.0])
def test_in_the_film_the_sphere_falls_freely_in_and_out_whatever_the_fluid_does(fluid):
    rows = _fly(_motion(), 0.999 * EDGE, -0.05, 60, fluid)
    (impact,) = [i for *_, new in rows for i in new]
    assert impact.speed_in == pytest.approx(math.sqrt(0.05**2 + 2 * FALL * 0.999 * EDGE), rel=1e-12)
    assert impact.speed_out == pytest.approx(E * impact.speed_in, rel=1e-12)
    gap, v, _ = next(row for row in rows if row[0] > 0.9 * EDGE and row[1] > 0)
    assert v**2 + 2 * FALL * gap == pytest.approx(impact.speed_out**2, rel=1e-12)


def test_outside_the_film_the_fluid_and_the_weight_move_it():
    rows = _fly(_motion(), 3.0, -0.05, 10, fluid=0.02)
    assert rows[-1][1] == pytest.approx(-0.05 + 10 * (0.02 + WEIGHT) / MASS, rel=1e-12)
    assert not any(new for *_, new in rows)


def test_bounces_within_the_film_take_as_long_as_free_flights_and_end_in_rest():
    """Flights of 2 v/g each, v a fifth of the one before: all of them last 2 v_1/g/(1 - 1/5)."""
    rows = _fly(_motion(e=0.2), 0.5, -0.05, 800)
    impacts = [i for *_, new in rows for i in new]
    first, last = impacts[0], impacts[-1]
    assert last.speed_out == 0.0
    whole = 2 * 0.2 * first.speed_in / FALL / (1 - 0.2)
    assert last.step - first.step == pytest.approx(whole, abs=3.0)
    assert len(impacts) < 8
    assert rows[-1] == (0.0, 0.0, [])


def test_a_resting_sphere_has_no_impacts_until_the_fluid_lifts_it():
    motion = _motion(e=0.0)
    _fly(motion, 0.5, -0.05, 50)
    assert _fly(motion, 0.0, 0.0, 100, fluid=-0.9 * WEIGHT)[-1] == (0.0, 0.0, [])
    gap, v, _ = _fly(motion, 0.0, 0.0, 10, fluid=-1.5 * WEIGHT)[-1]
    assert v == pytest.approx(10 * -0.5 * WEIGHT / MASS, rel=1e-12)
    assert gap > 0


def test_a_sphere_lifted_for_a_moment_and_pressed_down_again_lies_as_before():
    """A fluid that pulsates about the weight must not press it into the wall, from where there is no fall."""
    motion, gap, v = _motion(e=0.0), *_fly(_motion(e=0.0), 0.5, -0.05, 50)[-1][:2]
    for n, fluid in enumerate((-0.9, -0.9, -1.01, -0.2, -0.9, -1.001, 3.0, -0.9, -0.9)):
        gap, v, new = motion.step(float(n), gap, v, fluid * WEIGHT, WEIGHT, MASS)
        assert gap >= 0
        assert not new or new[0].speed_out == 0
    assert (gap, v) == (0.0, 0.0)
