"""``restitution validate``: what it writes, its exit statuses, and what it refuses."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from restitution.cli import main
from restitution.validation import baseline
from restitution.validation.row import at_most
from restitution.validation.rows import closures

CHEAP = ["exact-resistance", "law-check-values"]
"""Rows of bounds alone."""
BASELINE = Path(__file__).parents[3] / "reports" / "validate" / "baseline.json"


def validate(*options):
    return main(["validate", *map(str, options)])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # no baseline there
    return tmp_path / "out"


def test_rows_that_pass_give_a_scorecard_a_page_and_status_0(folder, capsys):
    assert validate("--only", *CHEAP, "--out", folder, "--baseline", BASELINE) == 0
    card = json.loads((folder / "scorecard.json").read_text())
    assert {row["name"] for row in card["rows"]} == set(CHEAP)
    assert {row["truth"] for row in card["rows"]} == {"pass"}
    page = (folder / "index.html").read_text()
    assert page.count("<img src=") == len(CHEAP)
    assert not (folder / "so-far.json").exists()
    assert "law-check-values" in capsys.readouterr().out


def test_rows_may_be_named_one_by_one_and_listed(folder, capsys):
    first, second = CHEAP
    assert validate("--only", first, "--only", second, "--list") == 0
    listed = capsys.readouterr().out
    assert first in listed
    assert second in listed
    assert "shear-wave" not in listed


def test_blessing_what_fails_the_truth_says_so_and_is_no_pass(folder, tmp_path, capsys, monkeypatch):
    strict = tuple(
        replace(row, references=tuple(at_most(r.label, r.value / 1e6) for r in row.truth()))
        for row in closures.ROWS
    )
    monkeypatch.setattr(closures, "ROWS", strict)
    monkeypatch.setattr(baseline, "_committed", lambda: ("a commit", ""))
    shutil.copy(BASELINE.with_name("spread.json"), tmp_path)
    given = ["--only", "exact-resistance", "--out", folder, "--baseline", tmp_path / "baseline.json"]
    assert validate(*given, "--bless", "to hold the shortfall") == 1
    assert "exact-resistance" in capsys.readouterr().out.splitlines()[-1]
    assert validate(*given) == 1


def test_a_row_without_a_baseline_is_not_evaluated(folder):
    assert validate("--only", "stokes-number", "--out", folder) == 3
    (row,) = json.loads((folder / "scorecard.json").read_text())["rows"]
    assert (row["truth"], row["against_baseline"]) == ("pass", "not evaluated")
    assert validate("--failed", "--out", folder) == 3


def test_a_kept_run_that_is_not_there_is_not_evaluated(folder, tmp_path):
    assert validate("--only", "settling-tencate_e3", "--out", folder, "--runs", tmp_path / "none") == 3
    (row,) = json.loads((folder / "scorecard.json").read_text())["rows"]
    assert row["truth"] == "not evaluated"
    assert "no kept run" in row["why"]


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--only", "shear-wav"], "shear-wave"),
        (["--only", *CHEAP, "--failed"], "--failed"),
        (["--failed"], "scorecard.json"),
        (["--only", *CHEAP, "--baseline", "nowhere.json"], "nowhere.json"),
        (["--only", *CHEAP, "--baseline", str(BASELINE.parent)], "folder"),
        (["--only", *CHEAP, "--out", ""], "--out"),
    ],
)
def test_what_cannot_be_used_is_one_line_and_status_2(folder, capsys, options, named):
    where = [] if "--out" in options else ["--out", str(folder)]
    assert validate(*options, *where) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert named in lines[0]
    assert not folder.exists()


def test_nothing_is_blessed_without_a_measured_spread(folder, tmp_path, capsys):
    written = tmp_path / "baseline.json"
    assert validate("--only", *CHEAP, "--out", folder, "--baseline", written, "--bless", "first") == 2
    assert "spread.json" in capsys.readouterr().err
    assert not written.exists()
