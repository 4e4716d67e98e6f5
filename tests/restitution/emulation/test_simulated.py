"""Runs of another fluid or sphere than the record's are not taken for errors of the solver."""

import json

import pytest

from restitution.emulation.runs_table import Run
from restitution.emulation.simulated import of_simulated

from .parabolas import CONDITIONS


def run_of(folder, fluid=(), sphere=()):
    """A run that says in its run.json what it was of."""
    case = CONDITIONS.model_dump(mode="json", exclude_none=True)
    case["fluid"] |= dict(fluid)
    case["sphere"] |= dict(sphere)
    folder.mkdir(exist_ok=True)
    (folder / "run.json").write_text(json.dumps({"case_as_run": case}))
    return Run("r", 2, (), folder / "trajectory.csv", "filmed.csv")


@pytest.mark.parametrize(
    "change", [{"fluid": {"viscosity": 0.1}}, {"sphere": {"diameter": 0.006}}, {"sphere": {"density": 2500.0}}]
)
def test_another_pair_is_doubted_unless_it_is_what_the_runs_vary(tmp_path, change):
    run = run_of(tmp_path, **change)
    section, name = next((s, n) for s, keys in change.items() for n in keys)
    (doubt,) = of_simulated([run], [], "filmed.csv", CONDITIONS)
    assert f"{section}.{name}" in doubt.message
    assert not list(of_simulated([run], [f"{section}.{name}"], "filmed.csv", CONDITIONS))


def test_runs_of_the_record_and_of_other_programs_are_not(tmp_path):
    alike, foreign = run_of(tmp_path / "a", fluid={"viscosity": 0.0101}), Run("x", 3, (), tmp_path / "x.csv", "f")
    assert not list(of_simulated([alike, foreign], [], "filmed.csv", CONDITIONS))
