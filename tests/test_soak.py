"""A minute of the soak: what is tried at random breaks nothing."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
pytest.importorskip("fcntl", reason="forks and signals as POSIX knows them")


def test_a_minute_of_attempts_to_break_it_finds_nothing():
    command = [sys.executable, "-m", "benchmarks.soak", "--seconds", "60"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-5000:] + done.stderr[-5000:]
    assert "sum" in done.stdout
