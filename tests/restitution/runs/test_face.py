"""The face of the runs: light until a run is asked for."""

import subprocess
import sys

import pytest

from restitution import runs


def test_it_loads_no_solver_before_it_is_asked_for_a_run():
    code = "import sys, restitution.runs; sys.exit('lbm' in sys.modules or 'numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_it_hands_on_what_it_names():
    assert all(hasattr(runs, name) for name in runs.__all__)
    with pytest.raises(AttributeError):
        _ = runs.no_such_name
