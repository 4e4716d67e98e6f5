"""Coordinates that do not move, walls that are passed, flights that were not filmed."""

from dataclasses import replace

import numpy as np
import pytest

from restitution.doubts import holes, of_track
from restitution.doubts.place import below, still, unsigned
from restitution.impacts import find_impacts
from restitution.tracks import contacts
from tests.flights import STEEL_IN_OIL, as_track, random_track
from tests.restitution.doubts.test_clock import D, filmed


def track_of(seed, **how):
    return as_track(*filmed(seed, **how))


@pytest.mark.parametrize("quantity", ["gap", "velocity"])
@pytest.mark.parametrize("noise", [0.0, 1e-5])
def test_a_coordinate_along_the_wall_is_named(quantity, noise):
    rng = np.random.default_rng(1)
    times = np.arange(0, 0.2, 1e-3)
    across = as_track(
        times, (0.01 if quantity == "gap" else 0.0) + noise * rng.standard_normal(len(times)), quantity
    )
    assert [d.name for d in of_track(across, contacts(across), STEEL_IN_OIL)] == ["still"]
    if quantity == "gap":
        drifting = as_track(times, 0.01 + 0.02 * times + noise * rng.standard_normal(len(times)))
        assert [d.name for d in of_track(drifting, contacts(drifting), STEEL_IN_OIL)] == ["still"]
    assert still(random_track(np.random.default_rng(2), quantity)[0]) == []


@pytest.mark.parametrize("shift_d", [0.2, 0.33, 1.0])
def test_a_wall_that_is_too_high_is_named_and_by_how_much(shift_d):
    for seed in range(6):
        track = track_of(seed)
        shifted = replace(track, value=track.value - shift_d * D)
        (doubt,) = below(shifted, contacts(shifted), D)
        assert float(doubt.message.split(" m, ")[1].split()[0]) == pytest.approx(
            shift_d, abs=0.1
        )  # the lowest frame is above
        assert below(track, contacts(track), D) == []


def test_the_overlap_of_a_soft_contact_is_no_wall_too_high():
    """Half a period of a spring of 2 ms at 0.4 m/s: an overlap of 0.25 mm, 0.04 of 6 mm."""
    t = np.arange(-0.03, 0.03, 2e-4)
    gap = np.where(
        t < 0, -0.4 * t, np.where(t < 2e-3, -0.4 * 2e-3 / np.pi * np.sin(np.pi * t / 2e-3), 0.3 * (t - 2e-3))
    )
    track = as_track(t, gap)
    assert contacts(track).contacts
    assert below(track, contacts(track), 6e-3) == []


def test_a_flight_that_was_not_filmed_is_named_and_gives_no_impact():
    """Frames are missing from a little after the first contact to a little after the second."""
    for seed in range(8):
        times, gap = filmed(seed)
        (first, second, *_) = [c.nearest for c in contacts(as_track(times, gap)).contacts]
        for begin, end in ((first + 1, second + 5), (first - 4, second + 7), (first, second + 2)):
            keep = np.setdiff1d(np.arange(len(gap)), np.arange(begin, end))
            track = as_track(times[keep], gap[keep])
            found = contacts(track)
            (hole,) = holes(track, found, STEEL_IN_OIL)
            assert hole.comes == pytest.approx(times[first], abs=4e-3)
            assert hole.leaves == pytest.approx(times[second], abs=4e-3)
            rows = find_impacts(track, STEEL_IN_OIL).rows
            assert all(row["time_s"] > times[second] + 0.01 for row in rows)


def test_a_hole_about_one_contact_or_within_a_flight_is_none():
    for seed in range(8):
        times, gap = filmed(seed)
        first = contacts(as_track(times, gap)).contacts[0].nearest
        for begin, end in ((first - 10, first + 10), (first - 4, first + 4), (first + 15, first + 50), (20, 60)):
            keep = np.setdiff1d(np.arange(len(gap)), np.arange(begin, end))
            track = as_track(times[keep], gap[keep])
            assert holes(track, contacts(track), STEEL_IN_OIL) == []


def speeds(seed, rng):
    """Velocities of a fall and its rebounds, at 1 kHz with 4 mm/s of noise."""
    track, _ = random_track(np.random.default_rng(seed), "velocity")
    return track, 4e-3 * rng.standard_normal(len(track.value))


def test_speeds_without_their_sign_are_named_and_velocities_are_not():
    rng = np.random.default_rng(3)
    for seed in range(12):
        track, noise = speeds(seed, rng)
        assert unsigned(as_track(track.time_s, track.value + noise, "velocity")) == []
        for sign in (1, -1):
            alone = as_track(track.time_s, sign * np.abs(track.value + noise), "velocity")
            (doubt,) = of_track(alone, contacts(alone), STEEL_IN_OIL)
            assert doubt.name == "unsigned"


def test_a_fall_that_sticks_has_velocities_of_one_sign():
    t = np.arange(0, 0.2, 1e-3)
    v = np.where(t < 0.05, -8 * t, 0.0) + 2e-3 * np.random.default_rng(5).standard_normal(len(t))
    assert unsigned(as_track(t, v, "velocity")) == []


def test_a_wall_in_another_unit_than_the_positions_is_asked_for():
    track = track_of(1)
    shifted = replace(track, value=track.value - 15 * D)
    (doubt,) = below(shifted, replace(contacts(track), level=None), D)
    assert "unit" in doubt.message
