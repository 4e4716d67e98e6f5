"""Impacts from tracks: the reference record, known truth with noise and gaps, and what the sampling hides."""

import numpy as np
import pytest

from restitution import datasets
from restitution.impacts import find_impacts
from restitution.tables import check_table
from restitution.tracks import noise
from tests.flights import STEEL_IN_OIL, as_track, film, fly, random_track


def shipped(name, speed, **options):
    conditions = datasets.resource(name).conditions
    return find_impacts(datasets.load_track(name), conditions, speed, record=name, **options)


def test_first_impact_of_the_reference_record_is_as_quoted():
    first = shipped("gondret2002_st152", "far").table().iloc[0]
    assert first.impact_speed_m_s == pytest.approx(0.585, abs=0.01)
    assert first.stokes == pytest.approx(152, abs=3)
    assert abs(first.time_s) < 0.5e-3


@pytest.mark.parametrize(
    ("speed", "e_eff"),
    # Slopes of two frames, and quadratic extrapolation, both by hand from the published points.
    [("window", (0.79, 0.64, 0.48, 0.17)), ("contact", (0.85, 0.69, 0.50, 0.21))],
)
def test_all_bounces_of_the_reference_record(speed, e_eff):
    table = shipped("gondret2002_st152", speed).table()
    rebounds = table[table.outcome == "rebound"]
    assert len(rebounds) == 4
    np.testing.assert_allclose(rebounds.time_s, [0, 0.0840, 0.130, 0.152], atol=1e-3)
    assert np.all(np.abs(rebounds.e_eff - np.array(e_eff)) < 2 * rebounds.e_eff_sigma)


def test_definitions_of_speed_differ_as_they_must():
    """The mean slope of a window lags behind the deceleration after the rebound, so it gives less."""
    contact, window = (shipped("gondret2002_st152", s).table() for s in ("contact", "window"))
    assert np.all(contact.e_eff.iloc[:3].to_numpy() > window.e_eff.iloc[:3].to_numpy())


def test_the_record_without_approach_uses_the_quoted_speed():
    first = shipped("gondret2002_st27", "contact").table().iloc[0]
    assert first.impact_speed_m_s == pytest.approx(0.518, abs=0.001)
    assert first.stokes == pytest.approx(27, abs=0.3)
    assert 0.42 < first.e_eff < 0.53
    assert first.e_eff_sigma > 0.03 * first.e_eff  # its time axis is known to 3 % only


def test_a_record_without_approach_and_without_quoted_speed_says_so():
    conditions = datasets.resource("gondret2002_st27").conditions.model_copy(update={"impact": None})
    found = find_impacts(datasets.load_track("gondret2002_st27"), conditions)
    assert not found.rows
    assert "impact" in found.notes[0]


@pytest.mark.parametrize(
    ("quantity", "speed", "most"),
    # On the safe side: of gap tracks e_eff and v_out have 0.77 to 0.78, as every rebound is allowed the brake that
    # history force and wake have by the point particle, which half of these flights lack; velocities 0.77 to 0.80.
    [("gap", "far", 0.80), ("gap", "contact", 0.80), ("velocity", "far", 0.82), ("velocity", "contact", 0.82)],
)
def test_intervals_cover_the_truth(quantity, speed, most):
    """68 % intervals of v_in, v_out and e_eff over 300 noisy impacts, frames missing at random, none invented."""
    rng = np.random.default_rng(1)
    inside, invented, resolved, true = np.zeros(3), 0, 0, 0
    while resolved < 300:
        track, truths = random_track(rng, quantity)
        true += len(truths)
        assert true < 900  # finds at least a third of what is there
        for row in find_impacts(track, STEEL_IN_OIL, speed).rows:
            truth = min(truths, key=lambda t: abs(t.time_s - row["time_s"]))
            if abs(truth.time_s - row["time_s"]) > 5e-3:
                invented += 1
            elif row["outcome"] == "rebound":
                errors = np.array([row["impact_speed_m_s"] - truth.v_in, row["rebound_speed_m_s"] - truth.v_out,
                                   row["e_eff"] - truth.v_out / truth.v_in])  # fmt: skip
                sigmas = [row[f"{name}_sigma{unit}"] for name, unit in SPEEDS_AND_E]
                inside += np.abs(errors) < sigmas
                resolved += 1
    assert invented == 0
    covered = dict(zip(("v_in", "v_out", "e_eff"), inside / resolved, strict=True))
    assert all(0.60 <= share <= most for share in covered.values()), covered


SPEEDS_AND_E = (("impact_speed", "_m_s"), ("rebound_speed", "_m_s"), ("e_eff", ""))


@pytest.mark.parametrize("quantity", ["gap", "velocity"])
@pytest.mark.parametrize("dt", [1e-4, 2e-3])
def test_a_record_that_ends_in_flight_has_no_impact_at_its_end(quantity, dt):
    """Falling frames next to each other lie close together, but they do not lie still."""
    flights, truths = fly(8e-3, -0.4, (0.8,), 0.6)
    rng = np.random.default_rng(4)
    for end in truths[0].time_s + np.array([0.03, 0.05, 0.08]):
        times = np.arange(0, end, dt)
        gap, velocity = film(flights, times)
        seen = gap if quantity == "gap" else velocity
        noisy = seen + (1e-5 if quantity == "gap" else 5e-3) * rng.standard_normal(len(times))
        (row,) = find_impacts(as_track(times, noisy, quantity), STEEL_IN_OIL, "contact").rows
        assert row["time_s"] == pytest.approx(truths[0].time_s, abs=1e-3)


def test_a_sphere_at_rest_has_no_impacts():
    flights, truths = fly(4e-3, -0.2, (0.6, 0.4), 0.6)
    times = np.arange(0, 1.0, 2e-4)
    gap = np.where(times < flights[-1].end, film(flights, np.minimum(times, flights[-1].end))[0], 0.0)
    noisy = gap + 1e-5 * np.random.default_rng(5).standard_normal(len(times))
    for speed in ("contact", "window"):
        found = find_impacts(as_track(times, noisy), STEEL_IN_OIL, speed)
        assert len(found.rows) + len(found.notes) == len(truths) + 1  # and the last, after which it stays


@pytest.mark.parametrize("offset", [-1e-4, 1e-4])
def test_a_wrong_zero_is_taken_from_the_sphere_at_rest(offset):
    flights, truths = fly(8e-3, -0.4, (0.75, 0.6), 0.6)
    times = np.arange(0, flights[-1].end + 0.1, 1e-3)
    gap = np.where(times < flights[-1].end, film(flights, np.minimum(times, flights[-1].end))[0], 0.0)
    noisy = gap + offset + 1e-5 * np.random.default_rng(6).standard_normal(len(times))
    found = find_impacts(as_track(times, noisy), STEEL_IN_OIL, "contact")
    assert any("rests at" in note for note in found.notes)
    for row, truth in zip(found.rows, truths, strict=False):
        assert abs(row["e_eff"] - truth.v_out / truth.v_in) < 3 * row["e_eff_sigma"]


def test_pixel_locked_positions_have_the_noise_of_their_grid():
    flights, truths = fly(8e-3, -0.4, (0.75,), 0.6)
    times = np.arange(0, flights[-1].end, 1e-3)
    grid = 20e-6
    gap = grid * np.round(film(flights, times)[0] / grid)
    track = as_track(times, gap)
    assert track.sigma == pytest.approx(grid / np.sqrt(12), rel=0.3)
    row = find_impacts(track, STEEL_IN_OIL, "contact").rows[0]
    assert abs(row["e_eff"] - 0.75) < 3 * row["e_eff_sigma"]
    assert truths


def test_window_slope_is_that_of_the_frames_with_the_error_of_the_noise():
    """Two frames: sigma sqrt(2)/dt, and the slope itself to the Monte Carlo error."""
    sigma, dt = 1e-5, 1e-3
    flights, truths = fly(8e-3, -0.4, (0.7,), 0.6)
    times = np.arange(0, flights[-1].end, dt)
    gap, _ = film(flights, times)
    row = find_impacts(as_track(times, gap, sigma=sigma), STEEL_IN_OIL, "window").rows[0]
    k = np.searchsorted(times, truths[0].time_s)
    assert row["impact_speed_m_s"] == pytest.approx(-(gap[k - 1] - gap[k - 2]) / dt, abs=1e-3)
    assert row["rebound_speed_m_s"] == pytest.approx((gap[k + 1] - gap[k]) / dt, abs=1e-3)
    assert row["impact_speed_sigma_m_s"] == pytest.approx(sigma * np.sqrt(2) / dt, rel=0.1)


def test_without_noise_the_truth_is_found():
    flights, truths = fly(8e-3, -0.4, (0.8, 0.7), 0.6)
    times = np.arange(0, flights[-1].end, 0.5e-3)
    gap, _ = film(flights, times)
    rows = find_impacts(as_track(times, gap, sigma=1e-9), STEEL_IN_OIL, "contact").rows
    for row, truth in zip(rows, truths, strict=False):
        assert row["impact_speed_m_s"] == pytest.approx(truth.v_in, rel=1e-3)
        assert row["rebound_speed_m_s"] == pytest.approx(truth.v_out, rel=1e-3)
        assert row["time_s"] == pytest.approx(truth.time_s, abs=1e-6)


def test_far_is_not_slowed_by_a_resolved_film_but_contact_is():
    """v(h) = v0 [1 - ln(h0/h)/St] below h0 = 0.05 d: lubrication theory, sampled finely."""
    d, v0, St = STEEL_IN_OIL.sphere.diameter, 0.5, 40.0
    gap, h0, h_min, dt = [4e-3], 0.05 * d, 1e-6, 2e-6
    while gap[-1] > h_min:
        h = gap[-1]
        gap.append(h - dt * v0 * (1 - np.log(h0 / h) / St if h < h0 else 1))
    down = np.array(gap[:-1])
    record = np.concatenate([down, 0.7 * down[::-1]])[::10]  # comes back along the same path, 0.7 as fast
    times = dt * 10 * np.arange(len(record))
    found = {
        s: find_impacts(as_track(times, record, sigma=1e-8), STEEL_IN_OIL, s).rows[0] for s in ("far", "contact")
    }
    assert found["far"]["impact_speed_m_s"] == pytest.approx(v0, rel=1e-3)
    assert found["far"]["e_eff"] == pytest.approx(0.7, rel=1e-3)
    assert found["contact"]["impact_speed_m_s"] < 0.95 * v0


@pytest.mark.parametrize("onset", [0.2, 0.5])
def test_far_keeps_what_a_thicker_film_has_taken(onset):
    """A film from h0 > 0.1 d on has slowed the sphere by ln(h0/0.1 d)/St there: that much is in ``far``."""
    d, v0, St = STEEL_IN_OIL.sphere.diameter, 0.5, 60.0
    gap, h0, dt = [4e-3], onset * d, 2e-6
    while gap[-1] > 1e-6:
        h = gap[-1]
        gap.append(h - dt * v0 * (1 - np.log(h0 / h) / St if h < h0 else 1))
    down = np.array(gap[:-1])
    record = np.concatenate([down, down[::-1]])[::10]
    row = find_impacts(as_track(dt * 10 * np.arange(len(record)), record, sigma=1e-7), STEEL_IN_OIL, "far").rows[0]
    expected = 1 - np.log(onset / 0.1) / St
    assert row["impact_speed_m_s"] / v0 == pytest.approx(expected, abs=0.4 * (1 - expected) + 0.005)


def test_a_bounce_below_the_film_gives_a_limit():
    fourth = shipped("gondret2002_st152", "far").table().iloc[3]
    assert fourth.outcome == "not_resolved"
    assert "0.3 mm" in fourth.note
    assert 0.3 < fourth.e_eff_upper < 1


def test_impacts_are_numbered_as_in_the_record():
    """The first impact of this record has one frame of approach: no row, but the second stays the second."""
    found = shipped("li2012_drop6", "contact")
    assert list(found.table().impact) == [2, 3]
    assert "impact 1" in found.notes[0]


def test_a_flight_not_seen_to_come_down_is_not_limited():
    """Two frames after the contact, both rising: too few for a speed, and no reason to exclude a high one."""
    flights, truths = fly(8e-3, -0.4, (0.75,), 0.6)
    times = np.append(np.arange(0, truths[0].time_s, 4e-3), truths[0].time_s + np.array([1e-3, 2e-3]))
    found = find_impacts(as_track(times, film(flights, times)[0], sigma=1e-5), STEEL_IN_OIL, "far")
    assert not found.rows
    assert "rebound" in found.notes[0]


def test_no_rebound_gives_an_upper_limit():
    flights, truths = fly(8e-3, -0.4, (), 0.6)
    fall = np.arange(0, flights[0].end, 1e-3)
    rest = fall[-1] + 1e-3 * np.arange(1, 20)
    rng = np.random.default_rng(2)
    gap = np.concatenate([film(flights, fall)[0], np.zeros(len(rest))]) + 1e-5 * rng.standard_normal(
        len(fall) + 19
    )
    (row,) = find_impacts(as_track(np.concatenate([fall, rest]), gap), STEEL_IN_OIL, "contact").rows
    assert row["outcome"] == "not_resolved"
    assert 0 < row["e_eff_upper"] < 0.3
    assert "e_eff" not in row
    assert not truths


def test_noise_is_that_of_the_record_not_of_its_bounces():
    rng = np.random.default_rng(3)
    estimates = []
    for _ in range(20):
        flights, _ = fly(8e-3, -0.4, (0.8, 0.7), 0.6)
        times = np.arange(0, flights[-1].end, 1e-3)
        estimates.append(noise(times, film(flights, times)[0] + 1e-5 * rng.standard_normal(len(times))))
    assert np.mean(estimates) == pytest.approx(1e-5, rel=0.1)


def test_stokes_number_of_the_impact_follows_the_convention():
    st, star = (shipped("gondret2002_st152", "far", stokes=key).table() for key in ("st", "st_star"))
    np.testing.assert_allclose(star.stokes / st.stokes, 1 + 935 / (2 * 7800), rtol=1e-12)


def test_the_table_obeys_the_impact_schema(tmp_path):
    path = tmp_path / "impacts.csv"
    shipped("li2012_drop2", "contact").table().to_csv(path, index=False)
    assert check_table(path, datasets.schema("impact")) == []


@pytest.mark.parametrize("fps", [2000.0, 5000.0, 20000.0])
def test_a_grid_of_pixels_gives_values_at_any_frame_rate(fps):
    """Many frames show the same pixel, those of a low bounce all of them: a value or a note, never nothing."""
    grid, held, seen = 1e-4, 0, 0
    for seed in range(6):
        rng = np.random.default_rng([int(fps), seed])
        flights, truths = fly(9e-3, -0.3, (0.75, 0.6), 0.6)
        times = np.arange(rng.uniform(0, 1 / fps), flights[-1].end, 1 / fps)
        gap = grid * np.round((film(flights, times)[0] + 1e-5 * rng.standard_normal(len(times))) / grid)
        found = find_impacts(as_track(times, gap), STEEL_IN_OIL, "far")
        assert found.doubts == []
        first = found.rows[0]
        seen += first["outcome"] == "rebound"
        held += abs(first["impact_speed_m_s"] - truths[0].v_in) < 3 * first["impact_speed_sigma_m_s"]
    assert seen == 6
    assert held >= 5
