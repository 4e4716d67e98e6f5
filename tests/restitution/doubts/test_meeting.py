"""Frames at contacts: lost and renumbered, repeated, filled by the tracking program, or of the mirror image."""

import numpy as np
import pytest

from restitution import datasets
from restitution.conditions import Conditions
from restitution.impacts import find_impacts
from tests.flights import STEEL_IN_OIL, as_track, film, fly

D = STEEL_IN_OIL.sphere.diameter
FPS = 1000.0


def recorded(seed=1, e=(0.75, 0.6), rest=True, tail=0.1, begin=(8e-3, -0.4)):
    """Positions of a fall with two rebounds, frame by frame, and the frame before the first contact."""
    flights, truths = fly(*begin, e, 0.6)
    times = np.arange(0, flights[-1].end + (tail if rest else 0.0), 1 / FPS)
    gap = np.where(times < flights[-1].end, film(flights, np.minimum(times, flights[-1].end))[0], 0.0)
    gap = gap + 8e-6 * np.random.default_rng(seed).standard_normal(len(gap))
    return (gap if rest else gap[:-1]), int(truths[0].time_s * FPS)


def names(gap, conditions=STEEL_IN_OIL, speed="far"):
    return [d.name for d in find_impacts(as_track(np.arange(len(gap)) / FPS, gap), conditions, speed).doubts]


@pytest.mark.parametrize("rest", [True, False])
@pytest.mark.parametrize("lost", [1, 2, 4, 7])
def test_frames_lost_at_a_contact_and_numbered_on_are_named(lost, rest):
    for seed in range(5):
        gap, at = recorded(seed, rest=rest)
        begin = at + 1 - lost // 2
        assert names(np.delete(gap, range(begin, begin + lost))) == ["renumbered"]


def test_their_number_is_named():
    gap, at = recorded()
    gap = np.delete(gap, range(at - 1, at + 3))
    (doubt,) = find_impacts(as_track(np.arange(len(gap)) / FPS, gap), STEEL_IN_OIL).doubts
    assert "about 4 frames" in doubt.message
    assert "impact 1" in doubt.message


@pytest.mark.parametrize("rest", [True, False])
@pytest.mark.parametrize("speed", ["far", "contact"])
def test_the_same_frames_missing_with_their_numbers_are_no_matter(rest, speed):
    for seed in range(5):
        gap, at = recorded(seed, rest=rest)
        times = np.delete(np.arange(len(gap)) / FPS, range(at - 2, at + 4))
        kept = np.delete(gap, range(at - 2, at + 4))
        assert find_impacts(as_track(times, kept), STEEL_IN_OIL, speed).doubts == []


def test_frames_repeated_at_a_contact_are_named():
    gap, at = recorded()
    noise = 8e-6 * np.random.default_rng(7).standard_normal(4)
    assert names(np.insert(gap, at + 1, gap[at] + noise)) == ["delayed"]


@pytest.mark.parametrize("how", ["line", "held"])
def test_frames_that_the_program_filled_are_named(how):
    for seed in range(5):
        gap, at = recorded(seed)
        a, b = at - 3, at + 4
        gap[a : b + 1] = np.linspace(gap[a], gap[b], b - a + 1) if how == "line" else gap[a]
        assert names(gap) == ["filled"]


def test_filled_frames_of_a_file_of_few_digits_are_named():
    gap, at = recorded()
    a, b = at - 4, at + 5
    gap[a : b + 1] = np.linspace(gap[a], gap[b], b - a + 1)
    assert names(np.round(gap, 6)) == ["filled"]


@pytest.mark.parametrize("step", [2e-6, 2e-5, 1e-4])
def test_pixels_are_no_filled_frames(step):
    for seed in range(5):
        assert names(step * np.round(recorded(seed)[0] / step)) == []


def test_a_mirror_image_in_the_wall_is_named():
    gap, at = recorded()
    back = at + 5 + int(np.argmin(gap[at + 5 : at + 120]))
    gap[at + 1 : back] *= -1
    assert "mirrored" in names(gap)


@pytest.mark.parametrize("level", [-2e-4, 2e-4])
def test_a_wall_a_little_beside_is_none_of_them(level):
    for seed in range(5):
        assert names(recorded(seed, rest=False)[0] + level) == []


def test_a_sphere_held_before_its_release_is_not_lost():
    for seed in range(20):
        gap, _ = recorded(seed, begin=(20e-3, 0.0))
        held = gap[0] + 8e-6 * np.random.default_rng([seed, 1]).standard_normal(200)
        assert names(np.concatenate([held, gap])) == []


def test_half_the_diameter_is_named_by_the_place_of_rest():
    """Heights of the centre, less half of twice the diameter."""
    gap, _ = recorded()
    sphere = STEEL_IN_OIL.sphere.model_copy(update={"diameter": 2 * D})
    assert "diameter" in names(gap - D / 2, STEEL_IN_OIL.model_copy(update={"sphere": sphere}))


@pytest.mark.parametrize("name", [n for n in datasets.names() if datasets.resource(n).table == "trajectory"])
def test_no_shipped_record_is_doubted(name):
    conditions = datasets.resource(name).conditions
    assert isinstance(conditions, Conditions)
    for speed in ("far", "contact"):
        assert find_impacts(datasets.load_track(name), conditions, speed).doubts == []


def test_lengths_a_tenth_too_small_are_named_by_free_fall():
    for seed in range(5):
        gap, _ = recorded(seed, e=(0.85, 0.75))
        (doubt,) = find_impacts(as_track(np.arange(len(gap)) / FPS, 0.9 * gap), STEEL_IN_OIL).doubts
        assert doubt.name == "clock"


def test_a_gravity_in_another_unit_is_named():
    track = as_track(np.arange(len(recorded()[0])) / FPS, recorded()[0])
    (doubt,) = find_impacts(track, _with_gravity(981.0)).doubts
    assert "981" in doubt.message


def _with_gravity(g):
    return STEEL_IN_OIL.model_copy(update={"gravity": g})
