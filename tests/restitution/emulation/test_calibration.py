"""Solvers of known truth are calibrated to it; what cannot be told, or believed, is said."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

from restitution.calibration.reading.reading import Reading
from restitution.cli import main
from restitution.emulation import calibrate, read_runs, read_solver
from restitution.emulation.held_out import GAIN, closer
from restitution.emulation.page import files, gain
from restitution.errors import InputError

from .parabolas import CONDITIONS, design, gap, write_runs, write_track

HOW = Reading(conditions=CONDITIONS)
TRUTH = {"e": 0.78, "C": 0.6}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return write_runs(tmp_path_factory.mktemp("runs"), design(14), tuple(TRUTH.values()))


@pytest.fixture(scope="module")
def found(runs):
    return calibrate(read_runs(runs)[0], how=HOW)


def test_truth_lies_within_the_intervals(found):
    for t in found.told:
        low, high = t.intervals[0.95]
        assert low < TRUTH[t.name] < high
    e = found.told[0]
    assert e.intervals[0.95][1] - e.intervals[0.95][0] < 0.02
    assert not e.says_nothing
    # Of the duration 2 e v/g' and the height (e v)^2/(2 g') a greater e makes up for a greater g', C smaller.
    assert found.correlation[0, 1] != 0
    assert found.predictions[0].rms_after_d < 0.01


def test_what_is_gained_is_said_of_records_that_had_no_say(found):
    met = found.predictions[0]
    assert "something is gained on records that were met" in gain(found)
    out = replace(met, held_out=True, rms_before_d=0.1, rms_after_d=0.099)
    idle = replace(found, predictions=(met, out))
    assert "held out from 0.100 to 0.099 d: nothing is gained on records that had no say" in gain(idle)
    assert closer(idle.predictions) == pytest.approx(0.99)
    assert closer(found.predictions) < GAIN


def test_draws_are_the_same_to_the_last_digit(found, runs):
    again = calibrate(read_runs(runs)[0], how=HOW)
    np.testing.assert_array_equal(again.draws, found.draws)


def altered(runs, folder, change):
    """The table with each row (a dict) changed, its files beside it."""
    rows = list(csv.DictReader(runs.read_text("utf-8").splitlines()))
    for row in rows:
        row["track"] = str(runs.parent / row["track"])
        row["record"] = str(runs.parent / row["record"])
    rows = [r for r in (change(k, dict(row)) for k, row in enumerate(rows)) if r is not None]
    with (folder / "runs.csv").open("w", newline="") as stream:
        out = csv.DictWriter(stream, list(rows[0]))
        out.writeheader()
        out.writerows(rows)
    return folder / "runs.csv"


def test_a_parameter_without_effect_is_named_so(runs, tmp_path):
    rng = np.random.default_rng(8)
    idle = rng.permutation(np.linspace(0, 1, 14))
    found = calibrate(read_runs(altered(runs, tmp_path, lambda k, row: row | {"idle": idle[k]}))[0], how=HOW)
    told = {t.name: t for t in found.told}
    assert told["idle"].says_nothing
    assert not told["e"].says_nothing


def test_a_record_that_no_run_comes_near_is_missed_by_more_than_its_parameters_move_it(tmp_path):
    """Runs of e from 0.70 to 0.86, a sphere of 0.45: apexes of 3 d where 1 d is filmed."""
    group = read_runs(write_runs(tmp_path, design(14), truth=(0.45, 0.6)))[0]
    found = calibrate(group, how=HOW)
    lacks, after = found.discrepancies[0], found.predictions[0].rms_after_d
    assert after > 0.4
    assert lacks.elsewhere
    assert not lacks.bounded
    assert {"edge", "discrepancy"} <= {d.name for d in found.doubts}
    assert "not recommended" in files("runs.csv", [found], "")["index.html"]


def test_too_few_runs_are_refused_and_few_doubted(runs, tmp_path):
    few = read_runs(altered(runs, tmp_path, lambda k, row: row if k < 5 else None))[0]
    with pytest.raises(InputError, match="5 runs"):
        calibrate(few, how=HOW)


def test_an_emulator_that_predicts_nothing_is_refused(runs, tmp_path):
    other = np.random.default_rng(2).permutation(14)
    rows = list(csv.DictReader(runs.read_text("utf-8").splitlines()))
    mixed = altered(runs, tmp_path, lambda k, row: row | {"e": rows[other[k]]["e"], "C": rows[other[k]]["C"]})
    with pytest.raises(InputError, match="predicts"):
        calibrate(read_runs(mixed)[0], how=HOW)


def test_a_run_in_another_unit_is_named(runs, tmp_path):
    path = runs.parent / "6.csv"
    time, height = np.loadtxt(path, delimiter=",", skiprows=1).T
    write_track(tmp_path / "other.csv", time, 1e3 * height)
    other = {"track": str(tmp_path / "other.csv")}
    with pytest.raises(InputError, match="most it misses r6, apex"):
        calibrate(read_runs(altered(runs, tmp_path, lambda k, row: row | (other if k == 6 else {})))[0], how=HOW)


def test_ranges_beyond_the_runs_and_unknown_names_are_refused(runs):
    group = read_runs(runs)[0]
    with pytest.raises(InputError, match="within the runs"):
        calibrate(group, prior={"e": (0.5, 0.9)}, how=HOW)
    with pytest.raises(InputError, match="no parameter"):
        calibrate(group, prior={"tension": (0.5, 0.9)}, how=HOW)
    with pytest.raises(InputError, match="simulated by no run"):
        calibrate(group, ["gondret2002_st27"], how=HOW)


def test_runs_of_another_experiment_are_refused(runs, tmp_path):
    time = np.arange(-0.02, 0.19, 4e-4)
    write_track(tmp_path / "slow.csv", 0.4 * time, 0.1 * gap(0.78, 0.6, time))
    record = tmp_path / "slow.csv"
    write_track(record, time[::5], 0.05 * gap(0.78, 0.6, time[::5]))
    group = read_runs(altered(runs, tmp_path, lambda k, row: row | {"record": str(record)}))[0]
    with pytest.raises(InputError):
        calibrate(group, how=HOW)


def test_strict_refuses_what_is_doubted_and_writes_nothing(runs, tmp_path, capsys):
    few = altered(runs, tmp_path, lambda k, row: row if k < 8 else None)
    out = tmp_path / "out"
    words = [str(few), "--conditions", str(runs.parent / "filmed.toml"), "--out", str(out), "--strict"]
    assert main(["calibrate-solver", *words]) == 2
    printed = capsys.readouterr()
    assert "8 runs vary 2 parameters" in printed.err
    assert printed.out == ""
    assert not out.exists()


def test_the_command_writes_what_it_reads(runs, tmp_path, capsys):
    conditions, out = runs.parent / "filmed.toml", tmp_path / "out"
    assert main(["calibrate-solver", str(runs), "--conditions", str(conditions), "--out", str(out)]) == 0
    assert "unseen runs predicted" in capsys.readouterr().out
    fit = read_solver(out / "solver.json")
    assert fit.groups[0].recommended["e"] == pytest.approx(0.78, abs=0.01)
    assert f"--conditions {conditions}" in (out / "index.html").read_text()
    assert "<svg" not in (out / "index.html").read_text()  # figures are images of their own
    content = json.loads((out / "solver.json").read_text())
    for change, field in (
        (("median", 2.0), "median"),
        (("prior", [0.9, 0.7]), "prior"),
        (("intervals", {"68%": [0.77, 0.79], "95%": [0.775, 0.785]}), "intervals"),
    ):
        spoiled = json.loads(json.dumps(content))
        spoiled["groups"][0]["parameters"][0][change[0]] = change[1]
        (tmp_path / "spoiled.json").write_text(json.dumps(spoiled))
        with pytest.raises(InputError, match=field):
            read_solver(tmp_path / "spoiled.json")


def test_bad_options_end_in_one_line_and_status_2(runs, capsys):
    for options, said in (
        (["--prior", "e=0.1:0.9"], "within the runs"),
        (["--before", "e=0.8"], "has no value of C"),
        (["--held-out", "filmed.csv"], "simulated by no run"),
    ):
        conditions = ["--conditions", str(runs.parent / "filmed.toml")]
        assert main(["calibrate-solver", str(runs), *conditions, *options]) == 2
        assert said in capsys.readouterr().err
