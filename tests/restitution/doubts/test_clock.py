"""Frames that a camera does not take so: repeated, renumbered, smoothed. Flights integrated in tests/flights."""

from dataclasses import replace

import numpy as np
import pytest

from restitution import datasets
from restitution.doubts.clock import of_frames
from tests.flights import STEEL_IN_OIL, as_track, film, fly

D = STEEL_IN_OIL.sphere.diameter
E = (0.8, 0.7, 0.55)


def filmed(seed, fps=1000.0, e=E, noise=2e-5, pixel=0.0, smooth=1):
    """Times and gaps of a sphere that falls from 20 mm, as a camera sees it."""
    rng = np.random.default_rng([4, seed])
    flights, _ = fly(rng.uniform(15e-3, 25e-3), 0.0, e, rng.uniform(0.45, 0.7))
    times = np.arange(rng.uniform(0, 1 / fps), flights[-1].end, 1 / fps)
    gap = film(flights, times)[0]
    gap = np.convolve(np.pad(gap, smooth // 2, mode="edge"), np.ones(smooth) / smooth, "valid")
    gap = gap + noise * rng.standard_normal(len(gap))
    return times, pixel * np.round(gap / pixel) if pixel else gap


def names(times, gap):
    return [doubt.name for doubt in of_frames(as_track(times, gap), 0.0, D)]


@pytest.mark.parametrize(
    "how", [{}, {"fps": 300.0}, {"fps": 1e4}, {"pixel": 2e-4}, {"pixel": 1e-4, "fps": 5e3}, {"noise": 0.0}]
)
def test_what_a_camera_takes_is_not_doubted(how):
    assert [seed for seed in range(12) if names(*filmed(seed, **how))] == []


@pytest.mark.parametrize("times_each", [2, 3, 4, 8])
@pytest.mark.parametrize("noise", [0.0, 2e-5, 1e-4])
def test_pictures_that_were_tracked_more_than_once_are_counted(times_each, noise):
    for seed in range(4):
        times, gap = filmed(seed, noise=noise)
        (doubt,) = of_frames(as_track(times, np.repeat(gap[::times_each], times_each)[: len(gap)]), 0.0, D)
        assert doubt.name == "repeated"
        assert float(doubt.message.split("tracked ")[1].split()[0]) == pytest.approx(times_each, rel=0.2)


@pytest.mark.parametrize("lost", [3, 10, 25])
def test_lost_frames_that_are_not_counted_are_found_where_they_are(lost):
    found = 0
    for seed in range(12):
        times, gap = filmed(seed)
        first = int(np.random.default_rng(seed).integers(20, 55 - lost // 2))
        keep = np.setdiff1d(np.arange(len(gap)), np.arange(first, first + lost))
        doubts = of_frames(as_track(times[: len(keep)], gap[keep]), 0.0, D)
        found += [d.name for d in doubts] == ["renumbered"] and f"t = {times[first - 1]:.6g} and" in doubts[
            0
        ].message
    assert found >= 11


def test_lost_frames_that_are_counted_are_none():
    for seed in range(12):
        times, gap = filmed(seed)
        keep = np.setdiff1d(np.arange(len(gap)), np.arange(40, 50))
        assert names(times[keep], gap[keep]) == []


@pytest.mark.parametrize(("fps", "smooth"), [(1000.0, 9), (1000.0, 15), (1000.0, 25), (5000.0, 61)])
@pytest.mark.parametrize("noise", [0.0, 5e-6])
def test_a_moving_average_rounds_the_contacts(fps, smooth, noise):
    for seed in range(4):
        assert names(*filmed(seed, fps=fps, smooth=smooth, noise=noise)) == ["smoothed"]


def test_shipped_records_are_as_taken():
    for name in datasets.names():
        resource = datasets.resource(name)
        if resource.table == "trajectory" and resource.conditions is not None:
            track = datasets.load_track(name)
            assert of_frames(track, 0.0, resource.conditions.sphere.diameter) == [], name
            assert of_frames(replace(track, value=track.value[::-1]), 0.0, 1e-9) is not None
