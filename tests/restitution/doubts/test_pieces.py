"""Records made of pieces: frame rates that change, recordings and spheres one after the other."""

import numpy as np
import pytest

from restitution import datasets
from restitution.doubts import of_track
from restitution.doubts.pieces import of_pieces
from restitution.tracks import contacts
from tests.flights import STEEL_IN_OIL, as_track, random_track
from tests.restitution.doubts.test_clock import D, filmed

FALL = STEEL_IN_OIL.free_fall
RATE = 1000.0


def found(times, gap):
    return of_pieces(as_track(times, gap), 0.0, D, FALL)


def counted(gap):
    """Times of frames that are counted at one rate."""
    return np.arange(len(gap)) / RATE


@pytest.mark.parametrize(
    "how",
    [{}, {"fps": 60.0}, {"fps": 1e4}, {"pixel": 2e-4}, {"pixel": 1e-4, "fps": 5e3}, {"noise": 0.0}, {"smooth": 9}],
)
def test_one_film_of_one_sphere_is_no_pieces(how):
    assert [seed for seed in range(12) if found(*filmed(seed, **how))] == []


def test_wakes_and_starts_with_a_speed_make_no_kink():
    tracks = (random_track(np.random.default_rng(seed))[0] for seed in range(40))
    assert [track for track in tracks if of_pieces(track, 0.0, D, FALL)] == []


@pytest.mark.parametrize("factor", [2, 4, 8])
@pytest.mark.parametrize("later", [True, False])
@pytest.mark.parametrize("pixel", [0.0, 5e-5])
def test_a_rate_that_changes_in_the_air_is_named_with_when_and_by_how_much(factor, later, pixel):
    """Slow motion that begins or ends in mid-fall: every k-th frame alone before or after, and all are counted."""
    fps = 4 * RATE
    for seed in range(6):
        _, gap = filmed(seed, fps=fps, pixel=pixel)
        at = int(np.flatnonzero(gap < 0.55 * gap[0])[0])
        keep = np.r_[np.arange(at), np.arange(at, len(gap), factor)]
        keep = keep if later else np.r_[np.arange(at % factor, at, factor), np.arange(at, len(gap))]
        (doubt,) = found(np.arange(len(keep)) / fps, gap[keep])
        assert doubt.name == "kink"
        begins = np.flatnonzero(keep == at)[0] / fps
        assert float(doubt.message.split("t = ")[1].split()[0]) == pytest.approx(begins, abs=5 / fps)
        said = doubt.message.split("goes on ")[1]
        ratio = float(said.split()[0]) if later else float(said.split("1/")[1].split()[0])
        assert ratio == pytest.approx(factor, rel=0.35)


def test_a_second_recording_or_sphere_is_named_and_no_speed_besides():
    """It begins at the top again, so that no speed between both is one of a sphere."""
    for seed in range(6):
        _, gap = filmed(seed)
        both = np.r_[gap, filmed(seed + 100)[1]]
        track = as_track(counted(both), both)
        (doubt,) = of_track(track, contacts(track), STEEL_IN_OIL)
        assert doubt.name == "moved"
        assert f"{(len(gap) - 1) / RATE:.6g} and" in doubt.message
        resting = np.r_[gap[:80], np.full(80, 0.03) + 2e-5 * np.random.default_rng(seed).standard_normal(80)]
        (doubt,) = found(counted(resting), resting)
        assert doubt.name == "moved"


def test_filled_and_lost_frames_and_a_wall_too_low_are_no_pieces():
    """Each leaves a jump or a kink behind it, and has its own name."""
    for seed in range(4):
        times, gap = filmed(seed)
        held = gap.copy()
        held[31:41] = gap[30]
        lost = np.delete(gap, np.arange(30, 40))
        low = gap[: int(0.6 * len(gap))] + D
        for values, name in ((held, "filled"), (lost, "renumbered"), (low, "centre")):
            track = as_track(times[: len(values)], values)
            assert [d.name for d in of_track(track, contacts(track), STEEL_IN_OIL)] == [name]


def test_shipped_records_are_no_pieces():
    for name in datasets.names():
        resource = datasets.resource(name)
        if resource.table != "trajectory" or resource.conditions is None:
            continue
        track, c = datasets.load_track(name), resource.conditions
        level = contacts(track).level or 0.0
        assert of_pieces(track, level, c.sphere.diameter, abs(c.free_fall)) == [], name
