"""What a branch is fitted to: frames, means of frames, and frames that show the same pixel."""

import numpy as np
import pytest

from restitution.impacts.branch import MOST_SINGLE, points

PIXEL = 1e-4


@pytest.mark.parametrize(("frames", "noise"), [(3, 0.0), (6, 0.0), (20, 0.0), (3, 0.03), (6, 0.03), (3, 0.1)])
def test_pixels_that_are_crossed_within_many_frames_have_the_error_that_their_middles_have(frames, noise):
    """The place of a sphere that goes steadily is known better than to a pixel, and its error says how well."""
    rng = np.random.default_rng(frames)
    ratios, speed = [], PIXEL / frames
    for _ in range(40):
        n = np.arange(max(3 * MOST_SINGLE, 20 * frames))
        place = rng.uniform(0, PIXEL) + speed * n
        seen = PIXEL * np.round((place + noise * PIXEL * rng.standard_normal(len(n))) / PIXEL)
        made = points(n * 1e-3, seen, PIXEL / np.sqrt(12), False)
        near = slice(2, 20)  # the first of the branch may be cut
        away = made.value - np.interp(made.tau, n * 1e-3, place)
        ratios.append(np.mean(away[near] ** 2) / np.mean(made.sigma[near] ** 2))
    assert 0.3 < np.mean(ratios) < 2.0  # neighbours share an edge, so that theirs are half as large, but alike


def test_the_place_within_a_pixel_where_a_sphere_turns_stays_open():
    t = np.arange(400) * 1e-3
    seen = PIXEL * np.round((8.4 * PIXEL - 3e-2 * (t - 0.2) ** 2) / PIXEL)
    made = points(t, seen, PIXEL / np.sqrt(12), False)
    top = np.argmax(made.value)
    assert made.sigma[top] == pytest.approx(PIXEL / np.sqrt(12))
    assert np.min(made.sigma) < 0.2 * made.sigma[top]
