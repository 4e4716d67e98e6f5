"""What is seen of a track before anything is believed of it: flights, contacts, and records without any impact."""

import numpy as np
import pandas as pd
import pytest

from restitution.cli import main
from restitution.conditions import Conditions
from restitution.impacts import find_impacts
from restitution.report.look import Told, pages, view_of
from restitution.report.look.plot import thinned
from restitution.tracks import Track
from tests.flights import STEEL_IN_OIL

G_EFF = 9.81 * (7800 - 935) / (7800 + 935 / 2)
"""Free fall of the steel sphere in oil, with buoyancy and half its displaced mass: 8.15 m/s2."""


def ballistic(speeds=(0.4, 0.3, 0.2), g=G_EFF, fps=1000.0, noise=1e-6, clock=1.0):
    """Flights that leave the wall at these speeds without drag, then rest; positions as gaps."""
    durations = [2 * v / g for v in speeds]
    begins = np.cumsum([0.0, *durations])
    time = np.arange(0, begins[-1] + 0.1, 1 / fps)
    gap = np.zeros_like(time)
    for begin, v, T in zip(begins, speeds, durations, strict=False):
        t = time - begin
        during = (t >= 0) & (t < T)
        gap[during] = v * t[during] - g * t[during] ** 2 / 2
    gap += noise * np.random.default_rng(5).standard_normal(len(time))
    return pd.DataFrame({"time_s": clock * time, "gap_m": gap})


@pytest.mark.parametrize("clock", [1.0, 8.0])
def test_flights_curve_as_gravity_by_the_clock_of_the_record(clock):
    """A film played eight times slower curves a 64th."""
    table = ballistic(clock=clock)
    view = view_of(Track.from_table(table), STEEL_IN_OIL, None)
    first = view.flights[0]
    assert -first.acceleration == pytest.approx(G_EFF / clock**2, abs=5 * first.error)
    assert first.error < 0.01 * G_EFF / clock**2
    assert first.top_m == pytest.approx(0.3**2 / (2 * G_EFF), rel=2e-3)
    assert view.free_fall == pytest.approx(G_EFF, rel=1e-6)


def test_branches_are_those_that_the_impacts_were_read_from():
    """Their slopes at the contact are the speeds of the table of impacts."""
    track = Track.from_table(ballistic())
    impacts = find_impacts(track, STEEL_IN_OIL)
    view = view_of(track, STEEL_IN_OIL, impacts)
    row, t = impacts.rows[0], impacts.rows[0]["time_s"]
    near = [b for b in view.branches if abs(b.origin - t) < 0.02]
    slopes = {b.rebound: np.ptp(b.value(np.array([t, t + 1e-6]), "gap")) / 1e-6 for b in near}
    assert slopes[False] == pytest.approx(row["impact_speed_m_s"], abs=3 * row["impact_speed_sigma_m_s"] + 1e-3)
    assert slopes[True] == pytest.approx(row["rebound_speed_m_s"], abs=3 * row["rebound_speed_sigma_m_s"] + 1e-3)


def test_no_outlier_is_lost_where_few_frames_are_drawn():
    value = np.sin(np.linspace(0, 20, 100_000))
    value[[777, 43210]] = 9.0, -9.0
    time, drawn = thinned(np.arange(100_000.0), value, 1000)
    assert len(time) <= 1000
    assert {777.0, 43210.0} <= set(time)
    assert drawn.max() == 9.0
    assert drawn.min() == -9.0


def test_doubts_are_shown():
    track = Track.from_table(ballistic())
    with_doubt = Told("a.csv", doubts=["the clock is eight times too slow"])
    plain = pages(view_of(track, None, None), Told("a.csv"), None)
    told = pages(view_of(track, None, None), with_doubt, None)
    assert with_doubt.doubts[0] in told["index.html"]
    assert told["figure.png"] != plain["figure.png"]
    assert pages(view_of(track, None, None), Told("a.csv"), None) == plain  # the same bytes again


@pytest.fixture
def look(tmp_path, monkeypatch, capsys):
    """The command in a folder with a track, its conditions, and a track upside down."""
    monkeypatch.chdir(tmp_path)
    table = ballistic()
    table.to_csv("up.csv", index=False)
    table.assign(gap_m=0.05 - table.gap_m).to_csv("down.csv", index=False)
    (tmp_path / "c.toml").write_text(
        "[fluid]\ndensity = 935.0\nviscosity = 0.01\n[sphere]\ndiameter = 3e-3\ndensity = 7800.0\ne_dry = 0.97\n"
    )

    def run(*arguments):
        status = main(["look", *arguments])
        said = capsys.readouterr()
        return status, said.out, said.err

    return run


@pytest.mark.parametrize("arguments", [(), ("--conditions", "c.toml")])
@pytest.mark.parametrize("track", ["up.csv", "down.csv"])
def test_a_picture_with_conditions_or_without_and_where_no_impact_is_found(look, tmp_path, track, arguments):
    status, out, error = look(track, *arguments, "--out", "there")
    assert (status, error) == (0, "")
    assert {p.name for p in (tmp_path / "there").iterdir()} == {"figure.svg", "figure.png", "index.html"}
    assert str(tmp_path / "there" / "index.html").endswith(out.split()[-1])


FIRST_BYTES = [("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.html", b"<!DOCTYPE")]


@pytest.mark.parametrize(("name", "begins"), FIRST_BYTES)
def test_one_file_by_its_ending(look, tmp_path, name, begins):
    assert look("up.csv", "--out", name)[0] == 0
    assert (tmp_path / name).read_bytes().startswith(begins)


def test_input_is_not_replaced_and_a_length_in_diameters_needs_the_diameter(look, tmp_path):
    before = (tmp_path / "c.toml").read_bytes()
    assert look("up.csv", "--conditions", "c.toml", "--out", "")[0] == 2
    assert look("up.csv", "--unit", "d")[0] == 2
    assert "--conditions" in look("up.csv", "--unit", "d")[2]
    assert (tmp_path / "c.toml").read_bytes() == before


def test_a_frame_that_no_flight_passes_through_is_left_out_and_drawn_as_such():
    table = ballistic()
    table.loc[20, "gap_m"] += 4e-3
    view = view_of(Track.from_table(table), STEEL_IN_OIL, None)
    assert list(view.left_out.time_s) == [table.time_s[20]]
    assert table.time_s[20] not in view.track.time_s


def test_conditions_in_which_the_sphere_floats_have_no_terminal_speed():
    floats = Conditions.model_validate(
        {"fluid": {"density": 1000.0, "viscosity": 0.001}, "sphere": {"diameter": 3e-3, "density": 900.0}}
    )
    assert view_of(Track.from_table(ballistic()), floats, None).terminal is None
