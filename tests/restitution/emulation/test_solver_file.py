"""What a calibration recommends, in a case: by name, for runs of its kind, with what is doubtful about it."""

import json

import pytest

from restitution.calibration.estimation.maximum import LEVELS
from restitution.cases.reading import read_case
from restitution.emulation.solver_file import calibrated
from restitution.errors import InputError

FLOOR = {
    "name": "film.floor", "prior": [5e-8, 1e-5], "logarithmic": True, "median": 2e-7, "told": True,
    "intervals": {f"{level:.0%}": [1e-7, 4e-7] for level in LEVELS},
}  # fmt: skip
RECORD = {
    "name": "gondret2002_st152", "runs": 15, "frames": 40, "flights": 2, "predicts": 0.99, "coverage": 0.95,
    "held_out": False, "rms_before_d": 0.03, "rms_after_d": 0.01,
}  # fmt: skip
GROUP = {
    "group": {"model": "resolved", "cells_per_diameter": "16"}, "parameters": [FLOOR], "correlation": [[1.0]],
    "records": [RECORD], "walkers": 32, "steps": 5000, "seed": 0,
}  # fmt: skip


def solver(tmp_path, *groups):
    file = tmp_path / "solver.json"
    file.write_text(json.dumps({"restitution": "0.1.0", "table": "runs.csv", "groups": groups}))
    return file


def test_a_case_takes_the_values_of_its_own_cells(tmp_path):
    coarse = GROUP | {"group": {"cells_per_diameter": "10"}, "parameters": [FLOOR | {"median": 3e-7}]}
    case, values, doubts = calibrated("gondret_st152_16", solver(tmp_path, coarse, GROUP))
    assert case.film.floor == values["film.floor"] == 2e-7
    assert doubts == []
    own = ("film", "title", "study")  # a case that is calibrated is none of a study's
    other = read_case("gondret_st152_16")
    assert case.model_dump(exclude=set(own)) == other.model_dump(exclude=set(own))
    assert case.film.tension == other.film.tension


def test_runs_of_other_cells_are_refused_and_those_there_are_named(tmp_path):
    with pytest.raises(
        InputError, match=r"20.* cells a diameter, but of model = resolved, cells_per_diameter = 16"
    ):
        calibrated("gondret_st152_20", solver(tmp_path, GROUP))


def test_a_parameter_of_another_solver_is_refused(tmp_path):
    strange = solver(tmp_path, GROUP | {"parameters": [FLOOR | {"name": "cut.off"}]})
    with pytest.raises(InputError, match=r"cut\.off"):
        calibrated("gondret_st152_16", strange)


@pytest.mark.parametrize(
    ("change", "doubt"),
    [
        ({"records": [RECORD | {"rms_after_d": 0.029}]}, "no gain"),
        ({"records": [RECORD, RECORD | {"name": "drop", "held_out": True, "rms_after_d": 0.03}]}, "no gain"),
        ({"group": {"model": "resolved"}}, "cells"),
        ({"parameters": [FLOOR | {"told": False}]}, "not told"),
    ],
)
def test_what_a_calibration_does_not_say_is_doubted(tmp_path, change, doubt):
    assert [d.name for d in calibrated("gondret_st152_16", solver(tmp_path, GROUP | change))[2]] == [doubt]
