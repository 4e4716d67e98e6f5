"""Frames that no flight passes through are found, and none that one does."""

from dataclasses import replace

import numpy as np
import pytest

from restitution import datasets
from restitution.doubts.mistracked import cleaned, mistracked
from restitution.impacts import find_impacts
from tests.flights import STEEL_IN_OIL, random_track


@pytest.mark.parametrize("run", [1, 2, 3])
def test_frames_that_jump_are_found_wherever_they_are(run):
    """By two diameters: farther than the sphere moves within two frames."""
    found, missed, wrong = 0, 0, 0
    for seed in range(40):
        rng = np.random.default_rng([run, seed])
        track, _ = random_track(rng)
        first = int(rng.integers(6, len(track.value) - 6 - run))
        value = track.value.copy()
        value[first : first + run] += rng.choice([-1, 1]) * 2 * STEEL_IN_OIL.sphere.diameter
        lost = set(mistracked(replace(track, value=value)).tolist())
        jumped = set(range(first, first + run))
        found, missed, wrong = found + len(lost & jumped), missed + len(jumped - lost), wrong + len(lost - jumped)
    assert missed <= 0.03 * (found + missed)
    assert wrong <= 2


def test_a_jump_of_a_few_errors_is_found_far_from_the_wall():
    found = 0
    for seed in range(20):
        track, _ = random_track(np.random.default_rng([5, seed]))
        at = int(np.argmax(track.value[len(track.value) // 4 :])) + len(track.value) // 4
        value = track.value.copy()
        value[at] += 40 * track.sigma
        found += mistracked(replace(track, value=value)).tolist() == [at]
    assert found >= 12


def test_no_frame_of_an_ordinary_record_is_lost():
    for seed in range(100):
        assert not len(mistracked(random_track(np.random.default_rng([7, seed]))[0]))
    for name in datasets.names():
        if datasets.resource(name).table == "trajectory":
            assert not len(mistracked(datasets.load_track(name)))


def test_impacts_are_those_without_the_frames():
    track, truths = random_track(np.random.default_rng(11))
    value = track.value.copy()
    third = len(value) // 5
    value[third : third + 2] -= 4e-3
    found, plain = (find_impacts(t, STEEL_IN_OIL).rows for t in (replace(track, value=value), track))
    assert len(found) == len(plain)
    for row, other in zip(found, plain, strict=True):
        assert row["impact_speed_m_s"] == pytest.approx(
            other["impact_speed_m_s"], abs=other["impact_speed_sigma_m_s"]
        )
    assert truths
    clean = cleaned(replace(track, value=value), "t.csv")
    assert (clean.doubts[0].name, clean.doubts[0].where) == ("mistracked", "t.csv")


def test_what_is_no_exception_is_left_as_it_is():
    """Where many frames jump the record is of something else."""
    track, _ = random_track(np.random.default_rng(12))
    rng = np.random.default_rng(13)
    noise = np.where(rng.random(len(track.value)) < 0.4, rng.normal(0, 6e-3, len(track.value)), 0.0)
    assert not len(mistracked(replace(track, value=track.value + noise)))
