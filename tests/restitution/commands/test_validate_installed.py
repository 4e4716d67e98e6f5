"""An installed program has its baseline with it, and takes one of its user's own."""

import json
import os
import subprocess
import sys

ROWS = ("stokes-number", "rebound-li_drop1")
"""The second is of a kept run, which came along as well."""


def test_an_installed_program_knows_its_baseline_and_writes_another(installed, tmp_path):
    def validate(*options):
        command = [sys.executable, "-m", "restitution", "validate", "--only", *ROWS, *options]
        around = os.environ | {"PYTHONPATH": str(installed)}
        return subprocess.run(command, cwd=tmp_path, env=around, capture_output=True, text=True, check=False)

    assert validate().returncode == 0  # against the baseline that came along
    written = validate("--baseline", "mine.json", "--bless", "the program as installed")
    assert written.returncode == 0, written.stderr
    rows = json.loads((tmp_path / "mine.json").read_text())["rows"]
    assert set(rows) == set(ROWS)
    assert all("text" in row["commit"] for row in rows.values())  # no commit: known by its text
    assert validate("--baseline", "mine.json").returncode == 0
