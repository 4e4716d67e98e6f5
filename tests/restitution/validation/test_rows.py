"""The rows themselves: each says what it is, and errors that are planted in a copy of the program are caught."""

import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from restitution.validation.row import Depth
from restitution.validation.rows import all_rows
from restitution.validation.verdict import Verdict, against_truth

ROOT = Path(__file__).parents[3]
ROWS = all_rows()
CHEAP = {
    "Stokes number without its 9": "stokes-number",
    "Schiller & Naumann's 0.15 read as 0.16": "drag-law",
    "sign of the lubrication force": "film-force",
}
"""Planted errors, and the row that has to catch each without a kernel to compile."""


@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
def test_a_row_says_what_it_is(row):
    assert row.name == row.name.lower()
    assert all((row.quantity, row.source, row.tolerance))
    labels = [r.label for r in row.truth()]
    assert labels
    assert len(set(labels)) == len(labels)
    assert set(row.known) <= set(labels)
    assert all(row.known.values())
    assert row.depth in Depth


def test_names_and_keys_are_of_one_row_each():
    assert len({row.key for row in ROWS.values()}) == len(ROWS)


@pytest.mark.parametrize("name", CHEAP.values())
def test_the_program_itself_passes(name):
    row = ROWS[name]
    assert set(against_truth(row, row.values()).values()) <= {Verdict.PASS, Verdict.KNOWN_MISS}


def test_planted_errors_are_caught(tmp_path):
    """Three at once in one copy, each by a row that the others do not touch."""
    errors = {e["what"]: e for e in tomllib.loads((ROOT / "benchmarks/planted_errors.toml").read_text())["change"]}
    assert len(errors) >= 15
    for package in ("lbm", "restitution", "data"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    for what in CHEAP:
        path, change = tmp_path / errors[what]["file"], errors[what]
        assert path.read_text().count(change["old"]) == 1, what
        path.write_text(path.read_text().replace(change["old"], change["new"]))
    command = ["validate", "--only", *CHEAP.values(), "exact-resistance", "--out", "found"]
    done = subprocess.run(
        [sys.executable, "-m", "restitution", *command], cwd=tmp_path, check=False, capture_output=True,
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    card = json.loads((tmp_path / "found" / "scorecard.json").read_text())
    truth = {row["name"]: row["truth"] for row in card["rows"]}
    assert truth == dict.fromkeys(CHEAP.values(), "fail") | {"exact-resistance": "pass"}


def test_every_planted_error_can_still_be_planted():
    for change in tomllib.loads((ROOT / "benchmarks/planted_errors.toml").read_text())["change"]:
        assert (ROOT / change["file"]).read_text().count(change["old"]) == 1, change["what"]
