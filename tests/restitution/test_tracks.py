"""Contacts of a track are those of the sphere, however many frames a second show them."""

import numpy as np
import pytest
from scipy.signal import find_peaks

from restitution.tracks import begins_on_rebound, contacts, lowest_points, noise
from tests.flights import as_track, film, fly

RATES = (250.0, 1000.0, 5000.0, 20000.0)


def record(fps, seed, start=(9e-3, -0.3), e=(0.75, 0.6), begin=0.0, held=0.0, sigma=2e-5):
    """A track of two bounces from ``begin`` on, held for some time before, and its truths."""
    rng = np.random.default_rng([int(fps), seed])
    flights, truths = fly(*start, e, 0.6)
    times = np.arange(begin, flights[-1].end, 1 / fps)
    gap = film([f for f in flights if f.end > begin], times)[0]
    before = np.arange(-held, 0, 1 / fps)
    times, gap = np.append(before, times), np.append(np.full(len(before), start[0]), gap)
    return as_track(times, gap + sigma * rng.standard_normal(len(times))), truths


@pytest.mark.parametrize("fps", RATES)
def test_every_bounce_is_a_contact_and_nothing_else(fps):
    for seed in range(10):
        track, truths = record(fps, seed)
        found = contacts(track)
        assert found.hovering == ()
        times = [track.time_s[c.nearest] for c in found.contacts if c.nearest is not None]
        assert times == pytest.approx([t.time_s for t in truths], abs=max(1.5e-3, 1.5 / fps))


@pytest.mark.parametrize("fps", RATES)
def test_a_rebound_at_the_beginning_is_told_from_a_release(fps):
    """Whether the sphere is let go at the first frame, held before, or falls already: noise does not decide."""
    flights, truths = fly(9e-3, -0.3, (0.75, 0.6), 0.6)
    begun = 0
    for seed in range(20):
        track, _ = record(fps, seed, begin=truths[0].time_s + 0.3 / fps)
        begun += begins_on_rebound(track, contacts(track))
        for others in ({}, {"start": (9e-3, 0.0)}, {"start": (9e-3, 0.0), "held": 0.04}):
            track, _ = record(fps, seed, **others)
            assert not begins_on_rebound(track, contacts(track))
    assert begun == 20
    assert len(flights) == 3


def test_a_sphere_that_is_lifted_is_not_on_a_rebound():
    """Slowly at first, as a hand does it."""
    time = np.arange(0, 0.4, 2e-3)
    gap = np.where(time < 0.3, 0.02 * (time / 0.3) ** 2, 0.02 - 4 * (time - 0.3) ** 2)
    track = as_track(time, gap + 1e-5 * np.random.default_rng(0).standard_normal(len(time)))
    assert not begins_on_rebound(track, contacts(track))


def test_lowest_points_are_the_peaks_by_prominence_of_scipy():
    rng = np.random.default_rng(8)
    for n in (5, 50, 1000):
        for _ in range(20):
            value = np.cumsum(rng.standard_normal(n))
            peaks, _ = find_peaks(-value, prominence=2.0)
            assert lowest_points(value, 2.0) == peaks.tolist()


def test_lowest_points_of_a_long_record_take_no_time():
    """Linear in the frames: a million noisy ones well within a second or two."""
    import time

    value = np.random.default_rng(9).standard_normal(1_000_000)
    begin = time.process_time()
    lowest_points(value, 20.0)
    assert time.process_time() - begin < 5


@pytest.mark.parametrize("fps", [1000.0, 20000.0])
def test_a_contact_of_velocities_that_lasts_leaves_its_frames_out(fps):
    """Half a sine of 4 ms between two flights: no frame of it belongs to approach or rebound."""
    last, v_in, e, g = 4e-3, 0.4, 0.7, 8.0
    time = np.arange(-0.1, 0.12, 1 / fps)
    push = -v_in + v_in * (1 + e) * (1 - np.cos(np.pi * np.clip(time / last, 0, 1))) / 2
    velocity = np.where(time < 0, -v_in - g * time, np.where(time < last, push, e * v_in - g * (time - last)))
    velocity += 2e-4 * np.random.default_rng(1).standard_normal(len(time))
    (contact,) = contacts(as_track(time, velocity, "velocity")).contacts
    left_out = time[contact.approach[-1] + 1 : contact.rebound[0]]
    assert left_out[0] <= 0.15 * last
    assert left_out[-1] >= 0.85 * last
    assert len(left_out) <= last * fps + 6


def test_noise_of_frames_that_lie_far_apart_is_not_taken_for_a_grid():
    time = np.arange(8) * 2e-3
    gap = 9e-3 - 0.58 * time + 1e-5 * np.random.default_rng(2).standard_normal(8)
    assert noise(time, gap) < 5e-5
