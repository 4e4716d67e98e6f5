"""Somebody else's trajectory: scored by what it is made of, refused where it cannot be the record's impact."""

import json
import math

import numpy as np
import pandas as pd
import pytest

from restitution import datasets
from restitution.cli import main
from restitution.errors import InputError
from restitution.impacts.shipped import impacts_of
from restitution.stokes import Speed
from restitution.tracks import Track
from restitution.validation import assert_trajectory, case_of, score, trajectory_page
from restitution.validation.trajectory_file import read_trajectory

CASE = case_of("gondret-st152")
APPROACH, E, FALL = 0.59, (0.81, 0.71, 0.55), 8.0
"""m/s; of each bounce; deceleration of a flight without drag, m/s2: all is known in closed form."""


def flown(step: float = 2e-4) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[float], list[float]]:
    """Times, gaps, velocities, apexes and durations of a sphere that falls freely and rebounds with ``E``."""
    time = np.arange(-0.03 + step / 3, 0.3, step)
    speed, begin = APPROACH, 0.0
    t = time[time < 0]
    gap, velocity = [-((speed + FALL * t / 2) * t)], [-(speed + FALL * t)]
    apexes, spans = [], []
    for e in E:
        speed *= e
        span = 2 * speed / FALL
        t = time[(time >= begin) & (time < begin + span)] - begin
        gap.append(speed * t - FALL * t**2 / 2)
        velocity.append(speed - FALL * t)
        apexes.append(speed**2 / (2 * FALL))
        spans.append(span)
        begin += span
    gap, velocity = np.concatenate(gap), np.concatenate(velocity)
    return time[: len(gap)], gap, velocity, apexes, spans


@pytest.mark.parametrize("kind", ["gap", "velocity"])
def test_values_are_those_of_the_closed_form(kind):
    time, gap, velocity, apexes, spans = flown()
    column = {"gap": {"gap_m": gap}, "velocity": {"velocity_m_s": velocity}}[kind]
    scored = score("theirs", Track.from_table(pd.DataFrame({"time_s": time, **column})), CASE)
    assert scored.values["approach, m/s"] == pytest.approx(APPROACH, rel=0.01)
    for n in (1, 2):
        assert scored.values[f"apex {n}, mm"] == pytest.approx(1e3 * apexes[n - 1], rel=0.01)
        assert scored.values[f"flight {n}, ms"] == pytest.approx(1e3 * spans[n - 1], rel=0.01)
        assert scored.values[f"e {n}"] == pytest.approx(E[n - 1], abs=0.02)


def test_a_record_agrees_with_itself():
    scored = score("record", datasets.load_track(CASE.record), CASE)
    assert scored.missed == []
    assert scored.values["rms, d"] == pytest.approx(0, abs=1e-9)


def test_a_record_of_one_flight_can_be_scored():
    case = case_of("gondret-st27")
    speed = impacts_of(case.record, Speed.FAR).rows[0]["impact_speed_m_s"]
    record = datasets.load_track(case.record)
    after = record.time_s > 0
    fall = np.arange(-0.03, 0, float(np.median(np.diff(record.time_s))))
    track = Track(
        np.r_[fall, record.time_s[after]], np.r_[-speed * fall, record.value[after]], "gap", record.sigma
    )
    assert score("theirs", track, case).values["apex 1, mm"] == pytest.approx(
        1e3 * record.value[after].max(), rel=0.02
    )


def test_a_first_contact_in_the_middle_of_a_flight_is_refused():
    time, gap, *_ = flown()
    track = Track.from_table(pd.DataFrame({"time_s": time, "gap_m": gap}))
    assert score("theirs", track, CASE, first_s=1e-4).values["apex 1, mm"] > 0
    with pytest.raises(InputError, match=r"no contact"):
        score("theirs", track, CASE, first_s=0.05)


def test_velocities_counted_downwards_are_told_from_another_impact():
    time, _, velocity, *_ = flown()
    with pytest.raises(InputError, match="--direction down"):
        score("theirs", Track.from_table(pd.DataFrame({"time_s": time, "velocity_m_s": -velocity})), CASE)


def test_what_it_does_not_reach_is_named_and_never_passes():
    track = datasets.load_track(CASE.record)
    until = track.time_s < 0.06  # amid the first flight
    scored = score("short", Track(track.time_s[until], track.value[until], "gap", track.sigma), CASE)
    assert {"apex 2, mm", "flight 1, ms", "rms, d"} <= set(scored.left_open)


def test_another_impact_is_refused_and_says_what_may_be_wrong():
    track = datasets.load_track(CASE.record)
    slow = Track(8 * track.time_s, track.value, "gap", track.sigma)
    with pytest.raises(InputError, match="unit"):
        score("slow motion", slow, CASE)


def test_a_trajectory_that_ends_too_early_passes_no_gate(tmp_path, monkeypatch):
    track = datasets.load_track(CASE.record)
    until = track.time_s < 0.08  # one bounce
    columns = {"time_s": track.time_s[until], "gap_m": track.value[until]}
    with pytest.raises(AssertionError, match="apex 2, mm was not evaluated"):
        assert_trajectory(columns, "gondret-st152")
    lacking = score("short", Track.from_table(pd.DataFrame(columns)), CASE).left_open
    assert_trajectory(columns, "gondret-st152", may_lack=lacking)
    pd.DataFrame(columns).to_csv(tmp_path / "short.csv", index=False)
    call = ["validate", "--trajectory", str(tmp_path / "short.csv"), "--case", "gondret-st152"]
    assert main([*call, "--out", str(tmp_path / "out")]) == 3


def test_gaps_count_from_where_the_sphere_rests():
    time, gap, *_ = flown()
    still = np.arange(1, 200) * 2e-4
    time, gap = np.r_[time, time[-1] + still], np.r_[gap, np.zeros(len(still))]
    told = [score("g", Track(time, gap + shift, "gap", 1e-6), CASE) for shift in (0.0, 1.5e-3)]
    for label in ("apex 1, mm", "flight 1, ms", "rms, d"):
        assert told[1].values[label] == pytest.approx(told[0].values[label], rel=1e-3)
    assert any("gaps are counted from there" in note for note in told[1].notes)


def test_a_sphere_deep_in_the_wall_is_doubted():
    time, gap, *_ = flown()
    deep = Track(time, gap - 3e-4, "gap", 1e-6)
    assert any("--first-contact" in note for note in score("g", deep, CASE).notes)
    assert not any("--first-contact" in note for note in score("g", deep, CASE, first_s=0.0).notes)


@pytest.mark.parametrize(
    "options",
    [
        ["--case", "gondret-st152"],
        ["--only", "couette", "--unit", "mm"],
        ["--trajectory", "a.csv", "--bless", "x"],
    ],
)
def test_options_without_effect_are_refused(options, tmp_path, capsys):
    assert main(["validate", *options, "--out", str(tmp_path / "out")]) == 2
    assert "--trajectory" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_an_assertion_names_what_fails_and_a_known_shortfall_can_be_held():
    time, gap, *_ = flown()
    columns = {"time_s": time, "gap_m": gap}
    with pytest.raises(AssertionError, match=r"theirs: .*apex 1, mm"):
        assert_trajectory(columns, "gondret-st152", name="theirs")
    missed = score("theirs", Track.from_table(pd.DataFrame(columns)), CASE).missed
    scored = score("theirs", Track.from_table(pd.DataFrame(columns)), CASE)
    assert_trajectory(columns, "gondret-st152", allow=dict.fromkeys(missed, 1e3), may_lack=scored.left_open)
    with pytest.raises(InputError, match="apex 9"):
        assert_trajectory(columns, "gondret-st152", allow={"apex 9": 1.0})


HEADERS = {
    "t/sqrt(d/g),gap/d": (math.sqrt(CASE.sphere.diameter / CASE.gravity), CASE.sphere.diameter, "gap"),
    "t [s], gap [mm]": (1, 1e-3, "gap"),
    "Zeit [ms];Abstand [mm]": (1e-3, 1e-3, "gap"),
    "t,gap": (1, 1, "gap"),
    "t,v": (1, 1, "velocity"),
    "time (ms),velocity (mm/s)": (1e-3, 1e-3, "velocity"),
}


def written(folder, header):
    """A file of the closed form under a header; its path."""
    time, gap, velocity, *_ = flown()
    time_unit, unit, quantity = HEADERS[header]
    values = (gap if quantity == "gap" else velocity) / unit
    sign = ";" if ";" in header else ","
    rows = [sign.join((f"{t:.9g}", f"{x:.9g}")) for t, x in zip(time / time_unit, values, strict=True)]
    if sign == ";":
        rows = [row.replace(".", ",") for row in rows]
    path = folder / f"{list(HEADERS).index(header)}.csv"
    path.write_text("\n".join([header, *rows]) + "\n", "utf-8")
    return path


@pytest.mark.parametrize("header", HEADERS)
def test_a_file_whose_header_says_what_it_holds_can_be_asserted(header, tmp_path):
    _, gap, _, apexes, spans = flown()
    scored = score("g", Track.from_table(pd.DataFrame({"time_s": flown()[0], "gap_m": gap})), CASE)
    held = dict.fromkeys((r.label for r in scored.judged.row.truth()), 1e3)
    found = assert_trajectory(written(tmp_path, header), "gondret-st152", allow=held, may_lack=held)
    assert found.values["apex 1, mm"] == pytest.approx(1e3 * apexes[0], rel=0.01)
    assert found.values["flight 1, ms"] == pytest.approx(1e3 * spans[0], rel=0.01)
    assert found.values["approach, m/s"] == pytest.approx(APPROACH, rel=0.01)


def test_units_taken_as_si_are_told_and_others_noticed(tmp_path):
    plain = written(tmp_path, "t,gap")
    assert any("SI" in note for note in read_trajectory(plain, CASE.conditions).notes)
    for time_unit, unit in ((1e-3, 1), (1, 1e-3), (1e-3, 1e-3)):  # both: the speed is as it should be
        time, gap, *_ = flown()
        pd.DataFrame({"t": time / time_unit, "gap": gap / unit}).to_csv(plain, index=False)
        with pytest.raises(InputError, match="wrong unit"):
            assert_trajectory(plain, "gondret-st152")


def test_files_of_different_form_stand_side_by_side(tmp_path):
    """Options are for those that need them; what cannot share options has a settings file each."""
    files = [written(tmp_path, header) for header in HEADERS]
    time, gap, *_ = flown()
    pd.DataFrame({"a": 1e3 * time, "b": 1e2 * gap}).to_csv(tmp_path / "bare.csv", index=False)
    told = ["--column", "time_s=a", "--column", "gap_m=b", "--time-unit", "ms", "--unit", "cm"]
    quiet = [files[0], files[1], files[2], files[5], tmp_path / "bare.csv"]
    call = ["validate", "--case", "gondret-st152", "--out", str(tmp_path / "out")]
    assert main([*call, "--trajectory", *map(str, quiet), *told]) == 1
    settings = []
    for k, text in enumerate(('time = "a"\nposition = "b"\ntime_unit = "ms"\nunit = "cm"\n', "")):
        (tmp_path / f"{k}.toml").write_text(text)
        settings.append(str(tmp_path / f"{k}.toml"))
    both = [str(tmp_path / "bare.csv"), str(files[3])]
    values = [t["values"] for t in json.loads((tmp_path / "out" / "scores.json").read_text())["trajectories"]]
    assert main([*call, "--trajectory", *both, "--settings", *settings]) == 1
    values += [t["values"] for t in json.loads((tmp_path / "out" / "scores.json").read_text())["trajectories"]]
    for one in values:
        assert one["apex 1, mm"] == pytest.approx(values[0]["apex 1, mm"], rel=5e-3)


def test_a_figure_shows_all_that_is_scored_and_little_else():
    from matplotlib.figure import Figure

    time, gap, _, apexes, spans = flown()
    scored = score("mine", Track.from_table(pd.DataFrame({"time_s": time, "gap_m": gap})), CASE)
    ax = Figure().subplots()
    trajectory_page.fill(ax, [scored])
    unit = math.sqrt(CASE.sphere.diameter / CASE.gravity)
    record = datasets.load_track(CASE.record)
    (begin, end), (low, high) = ax.get_xlim(), ax.get_ylim()
    assert end > sum(spans) / unit
    assert low == 0
    assert high > max(apexes) / CASE.sphere.diameter
    assert begin > min(record.time_s[0], time[0]) / unit - 1


def test_names_of_cases_are_taken_in_any_form_and_offered():
    assert case_of("gondret2002_st152").record == case_of("gondret_st152_10").record == CASE.record
    with pytest.raises(InputError, match="gondret-st27"):
        case_of("gondret-27")


def test_the_published_simulation_is_scored_beside_ours(tmp_path, capsys):
    time, gap, *_ = flown()
    theirs = tmp_path / "mine.csv"
    d, g = CASE.sphere.diameter, CASE.gravity
    pd.DataFrame({"t": time / np.sqrt(d / g), "h": gap / d}).to_csv(theirs, index=False)
    told = ["--column", "time_s=t", "--column", "gap_m=h", "--unit", "d", "--time-unit", "sqrt(d/g)"]
    both = ["biegert2017_st152", str(theirs)]
    out = tmp_path / "out"
    status = main(["validate", "--trajectory", *both, "--case", "gondret-st152", "--out", str(out), *told])
    assert status == 1  # without drag it flies too high
    content = json.loads((out / "scores.json").read_text())
    assert [t["name"] for t in content["trajectories"]] == ["biegert2017_st152", "mine"]
    highest = 1e3 * datasets.load_track("biegert2017_st152").value[10:].max()
    assert content["trajectories"][0]["values"]["apex 1, mm"] == pytest.approx(highest, rel=0.01)
    assert "could not be filled" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("time_s,gap_m\n0,0.01\n0.01,nan\n", "at least 4"),
        ("time_s,gap_m\n" + "".join(f"{t / 100},{0.01 + t / 1000}\n" for t in range(20)), "contact"),
        ("time_s,gap_m\n" + "".join(f"{t},{1 - t / 10}\n" for t in (3, 1, 2, 0, 4)), "time"),
        ("time_s,gap_m\n" + "".join(f"{abs(t - 9.3)},{t}\n" for t in range(20)), "swapped"),
        ("t,velocity_z\n0,1\n1,2\n2,3\n3,4\n", "gap_m=velocity_z"),
        ("t,z,v\n0,1,0\n1,2,0\n2,3,0\n3,4,1\n", "gap_m=z"),
        ("x1,v\n0,1\n1,2\n2,3\n3,4\n", "velocity_m_s=v"),
    ],
    ids=["too short", "no contact", "unsorted", "swapped", "unknown", "height and velocity", "velocity"],
)
def test_what_is_no_trajectory_is_one_line_and_nothing_is_written(rows, said, tmp_path, capsys):
    (tmp_path / "bad.csv").write_text(rows)
    out = tmp_path / "out"
    call = ["validate", "--trajectory", str(tmp_path / "bad.csv"), "--case", "gondret-st152", "--out", str(out)]
    assert main(call) == 2
    error = capsys.readouterr().err.strip().splitlines()
    assert len(error) == 1
    assert said in error[0]
    assert not out.exists()


def test_only_what_is_not_given_is_asked_for(tmp_path, capsys):
    (tmp_path / "bare.dat").write_text("0 3\n1 2\n2 1\n3 0\n")
    call = ["validate", "--trajectory", str(tmp_path / "bare.dat"), "--case", "gondret-st152"]
    told = ["--unit", "d", "--time-unit", "sqrt(d/g)", "--point", "lowest", "--column", "time_s=1"]
    assert main([*call, *told, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "gap_m=2" in error
    assert not any(option in error for option in ("--unit", "--time-unit", "--point", "time_s="))


def test_names_must_tell_trajectories_apart(tmp_path, capsys):
    call = ["validate", "--case", "gondret-st152", "--out", str(tmp_path / "out"), "--trajectory"]
    assert main([*call, CASE.record, "biegert2017_st152", "--name", "one", "one"]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()
