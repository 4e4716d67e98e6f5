"""Trajectories bounce by bounce: ballistic flights with known answers, and a published comparison."""

import numpy as np
import pytest

from restitution import datasets
from restitution.bounce import Closures, Release, bounce
from restitution.bounce.agreement import agreement, distance_from_contact_d
from restitution.impacts.bounces import bounces, filmed, frame_velocity
from restitution.tracks import Track

G = 8.0


def ballistic(speeds, step=1e-3):
    """Time, gap and contact times of free flights that begin with ``speeds``, after an approach of 10 ms."""
    starts = np.cumsum([0.0, *(2 * v / G for v in speeds)])
    time = np.arange(-0.01, starts[-1], step)
    gap = np.where(time < 0, -time, 0.0)
    for v, start, end in zip(speeds, starts[:-1], starts[1:], strict=True):
        t = time - start
        gap = np.where((time >= start) & (time < end), v * t - G / 2 * t**2, gap)
    return time, gap, starts[:-1]


def test_apexes_and_intervals_of_free_flights():
    time, gap, contacts = ballistic([0.4, 0.2, 0.1])
    found = bounces(time, gap, contacts)
    np.testing.assert_allclose(found.apexes_m, [0.01, 0.0025, 0.000625], rtol=1e-9)
    np.testing.assert_allclose(found.intervals_s, [0.1, 0.05])


def test_flights_too_low_to_count_end_the_list():
    time, gap, contacts = ballistic([0.4, 0.2, 0.1])
    found = bounces(time, gap, contacts, resolution_m=1e-3)
    assert len(found.apexes_m) == 2
    assert len(found.contacts_s) == 3


def test_error_of_a_trajectory_that_is_scaled():
    conditions = datasets.resource("gondret2002_st152").conditions
    time, gap, contacts = ballistic([0.4])
    record = bounces(time, gap, contacts)
    model = bounces(time + 0.3, gap + 0.1 * conditions.sphere.diameter, contacts + 0.3)
    assert distance_from_contact_d(model, record, conditions) == pytest.approx(0.1, rel=1e-6)


def test_a_model_that_ends_early_has_no_error():
    conditions = datasets.resource("gondret2002_st152").conditions
    time, gap, contacts = ballistic([0.4])
    half = time < 0.05
    assert np.isnan(
        distance_from_contact_d(bounces(time[half], gap[half], contacts), bounces(time, gap, contacts), conditions)
    )


def test_a_contact_that_lasts_is_an_error_by_the_clock_of_the_approach_alone():
    """The record is the model's own flight, its rebound 1 ms late: v times 1 ms apart, or nothing."""
    conditions, late = datasets.resource("gondret2002_st152").conditions, 1e-3
    path = bounce(conditions, Release(9e-3, 0.586), Closures(measured=(0.8,)), end=0.2)
    touch = path.impacts[0].time_s
    time = np.arange(0.0, touch + 0.1, 5e-4)
    gap = np.where(time < touch, path.gap(time), path.gap(np.maximum(time - late, touch)))
    record = bounces(time, gap, np.array([touch + late]))
    fine = np.linspace(0.0, 0.2, 4001)
    model = bounces(fine, path.gap(fine), np.array([touch]))
    assert distance_from_contact_d(model, record, conditions) < 1e-3
    found = agreement(path, Track(time, gap, "gap", 1e-6))
    after = found.time_s + touch
    apart = path.gap(after) - path.gap(np.maximum(after - late, touch))
    assert found.rms_d == pytest.approx(np.sqrt(np.mean(apart**2)) / conditions.sphere.diameter, rel=0.02)
    assert found.rms_d > 0.03


@pytest.mark.parametrize(("case", "rms", "apex"), [("st152", 0.046, -0.018), ("st27", 0.0070, -0.006)])
def test_published_simulation_is_as_far_from_the_record_as_was_found_independently(case, rms, apex):
    """Root mean square and first apex of Biegert et al. 2017 against Gondret et al. 2002, computed elsewhere."""
    record, published = (datasets.resource(f"{name}_{case}") for name in ("gondret2002", "biegert2017"))
    measured = filmed(datasets.load_track(record.name), record.conditions)
    simulated = filmed(datasets.load_track(published.name), record.conditions, 0.0)
    assert distance_from_contact_d(simulated, measured, record.conditions) == pytest.approx(rms, abs=5e-4)
    assert simulated.apexes_m[0] / record.quoted["apex_m"][0] - 1 == pytest.approx(apex, abs=0.003)


def test_contacts_of_a_drop_without_a_resolved_approach():
    record = datasets.resource("li2012_drop6")
    found = filmed(datasets.load_track(record.name), record.conditions)
    assert len(found.apexes_m) >= 2
    assert found.apexes_m[0] == pytest.approx(record.quoted["apex_m"][0], rel=0.02)


def test_velocities_by_differences_leave_out_contacts():
    time, gap, contacts = ballistic([0.4, 0.2], step=2.1e-3)
    track = Track(time, gap, "gap", 1e-5)
    at, velocity, error = frame_velocity(track, contacts)
    assert len(at) == len(time) - 1 - len(contacts)
    flight = (at > 0) & (at < 0.1)
    np.testing.assert_allclose(velocity[flight], 0.4 - G * at[flight], atol=1e-9)
    assert error == pytest.approx(np.sqrt(2) * 1e-5 / 2.1e-3)
