"""From a program's own file to a table of impacts, by the options that the command itself asks for."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from restitution.cli import main
from tests.flights import STEEL_IN_OIL, fly

FPS = 500.0
RADIUS = STEEL_IN_OIL.sphere.radius
CONDITIONS = """\
[fluid]
density = "0.935 g/cm3"
viscosity = "10 mPa s"
[sphere]
diameter = "3 mm"
density = "7.8 g/cm3"
e_dry = 0.97
"""
OPTIONS = ["--fps", "500", "--pixel", "0.1mm", "--wall", "512"]


@pytest.fixture(scope="module")
def flight():
    """Times and gaps at 500 frames a second with a noise of 0.02 mm, the impacts behind them."""
    flights, truths = fly(0.03, 0.0, (0.8, 0.7), terminal=0.9)
    time = np.arange(0, flights[-1].end, 1 / FPS)
    gap = np.zeros_like(time)
    for part in flights:
        here = (time >= part.start) & (time < part.end)
        gap[here] = part.motion(time[here])[0]
    return time, gap + 2e-5 * np.random.default_rng(3).standard_normal(len(time)), truths


@pytest.fixture
def folder(tmp_path, flight, monkeypatch, capsys):
    """A folder with the flight as a table of the project's and as spots of TrackMate; gives status and texts."""
    monkeypatch.chdir(tmp_path)
    time, gap, _ = flight
    (tmp_path / "conditions.toml").write_text(CONDITIONS)
    pd.DataFrame({"time_s": time, "gap_m": gap}).to_csv("own.csv", index=False)
    rows = [f"ID{i},0,3,{512 - (y + RADIUS) / 1e-4:.7f},{i}" for i, y in enumerate(gap)]
    head = ["LABEL,TRACK_ID,POSITION_X,POSITION_Y,FRAME", "Label,Track ID,X,Y,Frame", ",,(pixel),(pixel),"]
    (tmp_path / "spots.csv").write_text("\n".join(head + rows) + "\n")

    def run(*arguments):
        status = main([*arguments, "--conditions", "conditions.toml"])
        out = capsys.readouterr()
        return status, out.out, out.err

    return run


def test_options_or_a_settings_file_give_the_impacts_of_the_own_table(folder, flight):
    assert folder("impacts", "own.csv", "--out", "own_impacts.csv")[0] == 0
    status, out, _ = folder("impacts", "spots.csv", *OPTIONS, "--out", "by_options.csv")
    assert (status, "TrackMate" in out.splitlines()[0]) == (0, True)
    Path("settings.toml").write_text('frames_per_second = 500\npixel = "0.1 mm"\nwall = 512\n')
    assert folder("impacts", "spots.csv", "--settings", "settings.toml", "--out", "by_file.csv")[0] == 0
    own, by_options, by_file = (pd.read_csv(f"{name}.csv") for name in ("own_impacts", "by_options", "by_file"))
    pd.testing.assert_frame_equal(by_options.drop(columns="record"), by_file.drop(columns="record"))
    for column in ("stokes", "e_eff", "time_s"):
        np.testing.assert_allclose(by_options[column], own[column], rtol=0.005)
    first = flight[2][0]
    assert abs(own.impact_speed_m_s[0] - first.v_in) < 3 * own.impact_speed_sigma_m_s[0] + 0.01 * first.v_in


def test_what_is_asked_for_suffices(folder):
    """The first refusal names every option that the second try needs."""
    status, _, error = folder("impacts", "spots.csv")
    assert status == 2
    [line] = error.splitlines()
    assert set(re.findall(r"--[a-z-]+", line)) - {"--settings"} == {"--fps", "--pixel", "--wall"}
    assert folder("impacts", "spots.csv", "--fps", "500", "--pixel", "0.1mm", "--wall", "512")[0] == 0


def test_fit_takes_the_same_options(folder):
    status, out, _ = folder("fit", "spots.csv", *OPTIONS, "--speed", "far")
    assert status == 0
    assert "TrackMate" in out
    status, _, error = folder("compare", "spots.csv", *OPTIONS, "--speed", "far", "--as-published", "--no-scatter")
    assert (status, error) == (0, "")


def test_the_template_has_every_key_of_the_settings(tmp_path, capsys):
    from restitution.foreign import Settings, read_settings

    assert main(["impacts", "--template", str(tmp_path)]) == 0
    capsys.readouterr()
    assert read_settings(tmp_path / "settings.toml") == Settings()
    text = (tmp_path / "settings.toml").read_text()
    uncommented = re.sub(r"(?m)^# (?=\w+ = )", "", text)
    (tmp_path / "all.toml").write_text(re.sub(r"(?m)^velocity = .*$", "", uncommented))
    assert set(read_settings(tmp_path / "all.toml").stated()) == set(Settings.model_fields) - {"velocity"}


def test_times_of_a_clock_keep_the_digits_that_tell_impacts_apart(folder):
    own = pd.read_csv("own.csv")
    own.assign(time_s=(own.time_s + 1.718e9).map("{:.6f}".format)).to_csv("clock.csv", index=False)
    assert folder("impacts", "own.csv", "--out", "a.csv")[0] == 0
    status, out, _ = folder("impacts", "clock.csv", "--out", "b.csv")
    assert status == 0
    assert len(set(re.findall(r"17180000\d\d\.\d{4}", out))) >= 2
    np.testing.assert_allclose(pd.read_csv("b.csv").time_s - 1.718e9, pd.read_csv("a.csv").time_s, atol=1e-4)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--fps", "0"], "--fps"),
        (["--pixel", "1 s", "--fps", "500", "--wall", "512"], "--pixel"),
        (["--column", "height=POSITION_Y"], "--column"),
        (["--settings", "missing.toml"], "missing.toml"),
        (["--particle", "9"], "--particle"),
        (["--column", "gap_m=Z"], "Z"),
    ],
)
def test_options_that_cannot_be_used_are_named(folder, options, named):
    status, out, error = folder("impacts", "spots.csv", *options)
    assert (status, out) == (2, "")
    assert named in error


def test_misspelt_settings_are_named(folder, tmp_path):
    (tmp_path / "settings.toml").write_text('fps = 500\npoint = "top"\n')
    status, _, error = folder("impacts", "spots.csv", "--settings", "settings.toml")
    assert status == 2
    assert [("fps" in line, "point" in line) for line in error.splitlines()] == [(False, True), (True, False)]


def test_several_body_parts_need_one_more_try_alone(folder, flight, tmp_path):
    """What is asked for at first is all that is needed."""
    _, gap, _ = flight
    head = ["scorer" + ",net" * 6, "bodyparts,ball,ball,ball,mark,mark,mark", "coords" + ",x,y,likelihood" * 2]
    rows = [f"{i},9,{512 - (y + RADIUS) / 1e-4:.7f},0.99,1,2,0.98" for i, y in enumerate(gap)]
    (tmp_path / "pose.csv").write_text("\n".join(head + rows) + "\n")
    status, _, error = folder("impacts", "pose.csv")
    assert status == 2
    assert all(option in error for option in ("--particle", "--fps", "--pixel", "--wall"))
    options = ("--particle", "ball", *OPTIONS, "--point", "centre")
    assert folder("impacts", "pose.csv", *options, "--out", "pose_impacts.csv")[0] == 0
    assert folder("impacts", "own.csv", "--out", "own_impacts.csv")[0] == 0
    own, pose = (pd.read_csv(tmp_path / name) for name in ("own_impacts.csv", "pose_impacts.csv"))
    np.testing.assert_allclose(pose["e_eff"], own["e_eff"], rtol=1e-3)


def test_a_folder_of_frames_in_two_tries(folder, flight):
    """OpenPTV has a file a frame: the first refusal names what the second try needs."""
    for n, y in enumerate(flight[1]):
        Path(f"ptv_is.{n + 1}").write_text(f"1\n{-1 if n == 0 else 0} 0 1.0 {1e3 * (y + RADIUS):.6f} 2.0\n")
    status, _, error = folder("impacts", ".")
    assert (status, [option in error for option in ("--column", "--fps", "--unit ")]) == (2, [True, True, False])
    named = ["--column", "time_s=frame", "--column", "gap_m=y"]
    assert folder("impacts", ".", *named, "--fps", "500", "--out", "found.csv")[0] == 0
    assert folder("impacts", "own.csv", "--out", "own_impacts.csv")[0] == 0
    found, own = pd.read_csv("found.csv"), pd.read_csv("own_impacts.csv")
    np.testing.assert_allclose(found.e_eff, own.e_eff, rtol=0.005)


def test_a_film_played_slowly_in_two_tries(folder, flight):
    """Tracker counts the player's seconds: the camera's frames a second are asked for at once, and suffice."""
    rows = [f"{i / 30:.6f}\t0.1\t{1e3 * (y + RADIUS):.6f}" for i, y in enumerate(flight[1])]
    Path("tracker.txt").write_text("\n".join(["mass A\t\t", "t\tx\ty", *rows]) + "\n")
    status, _, error = folder("impacts", "tracker.txt")
    assert (status, all(option in error for option in ("--fps", "--unit", "--point"))) == (2, True)
    stated = ["--fps", "500", "--unit", "mm", "--point", "centre"]
    assert folder("impacts", "tracker.txt", *stated, "--out", "found.csv")[0] == 0
    assert folder("impacts", "own.csv", "--out", "own_impacts.csv")[0] == 0
    np.testing.assert_allclose(pd.read_csv("found.csv").e_eff, pd.read_csv("own_impacts.csv").e_eff, rtol=0.005)


@pytest.mark.parametrize(
    ("stated", "wrong", "named"),
    [
        ("10 mPa s", "10 Pa s", "viscosity"),
        ("7.8 g/cm3", "2.5 g/cm3", "density"),
        ("3 mm", "1.5 mm", "radius"),
    ],
)
def test_one_wrong_condition_is_one_doubt(folder, stated, wrong, named):
    """The K that follows from it is no second one, which would ask about what is right."""
    Path("conditions.toml").write_text(CONDITIONS.replace(stated, wrong))
    status, out, err = folder("impacts", "own.csv")
    (doubt,) = [line for line in (out + err).splitlines() if line.startswith("doubt:")]
    assert status == 0
    assert named in doubt


def test_an_unusual_k_alone_is_a_doubt(folder):
    """Water in place of the oil: nothing but what the film takes contradicts it."""
    Path("conditions.toml").write_text(CONDITIONS.replace("10 mPa s", "0.5 mPa s"))
    _, out, err = folder("impacts", "own.csv")
    (doubt,) = [line for line in (out + err).splitlines() if line.startswith("doubt:")]
    assert "K = " in doubt
