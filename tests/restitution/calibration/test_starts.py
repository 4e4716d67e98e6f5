"""How a record starts: guesses that cover what is known, and what is stated."""

from dataclasses import replace

import numpy as np
import pytest

from restitution import datasets
from restitution.calibration.reading.reading import Reading
from restitution.calibration.trajectories.recordings import recording, stated_release
from restitution.cli import main
from restitution.errors import InputError
from restitution.foreign.settings import Settings
from restitution.tracks import Track, noise


def as_file(name, **conditions):
    """A shipped record as a user has it: its frames, fluid and sphere alone."""
    r, track = datasets.resource(name), datasets.load_track(name)
    own = r.conditions.model_copy(update={"impact": None, **conditions})
    return Track(track.time_s, track.value, "gap", noise(track.time_s, track.value)), own


@pytest.mark.parametrize("name", ["li2012_drop2", "li2012_drop5", "li2012_drop6"])
def test_a_guessed_release_covers_the_true_one(name):
    """Of drop 6 a single frame of the fall is left: its rebound tells the height."""
    start = recording(name, *as_file(name)).start
    truth = datasets.resource(name).quoted["release_gap_m"]
    assert start.kind == "height"
    assert abs(start.prior.mean - truth) < 1.5 * start.prior.sigma
    assert start.prior.sigma < 0.4 * truth


def test_a_sphere_that_is_held_before_its_release_starts_from_rest():
    track, conditions = as_file("li2012_drop5")
    step = float(np.median(np.diff(track.time_s)))
    held = 30
    time = np.r_[track.time_s[0] - step * np.arange(held, 0, -1), track.time_s]
    gap = np.r_[np.full(held, track.value[0]), track.value]  # let go where the frames begin
    start = recording("held", Track(time, gap, "gap", track.sigma), conditions).start
    assert start.kind == "height"
    assert start.prior.mean == pytest.approx(track.value[0], rel=0.05)


def test_an_impact_that_was_not_filmed_is_told_by_its_rebound():
    start = recording("st27", *as_file("gondret2002_st27")).start
    assert start.kind == "impact"
    assert abs(start.prior.mean - 0.518) < start.prior.sigma < 0.3 * 0.518


def test_a_stated_release_is_a_length_with_its_unit():
    _, conditions = as_file("li2012_drop5", release=0.0253)
    assert stated_release(Reading(), conditions).mean == 0.0253
    for text, metres in (("25.3 mm", 0.0253), ("2 d", 0.019)):
        assert stated_release(Reading(track=Settings(release=text)), conditions).mean == pytest.approx(metres)
    with pytest.raises(InputError, match="no unit"):
        stated_release(Reading(track=Settings(release="25.3")), conditions)


def test_a_release_below_the_frames_is_refused():
    track, conditions = as_file("li2012_drop5")
    low = replace(stated_release(Reading(track=Settings(release="1 mm")), conditions))
    with pytest.raises(InputError, match="below frames"):
        recording("low", track, conditions, release=low)


@pytest.mark.parametrize("option", [["--release", "25mm"], ["--film"]])
def test_options_of_trajectories_are_refused_without(option, capsys):
    assert main(["fit", "gondret2002_st152", "--law", "eq4_exponential", "--speed", "far", *option]) == 2
    assert "--trajectory" in capsys.readouterr().err
