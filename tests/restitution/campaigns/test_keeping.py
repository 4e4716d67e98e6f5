"""A sweep whose folder somebody has tidied by hand: what is gone is said, and made again where asked for."""

import json
import shutil

import pytest

from restitution.campaigns.keeping import retry
from restitution.campaigns.manifest import FINISHED, Manifest, line
from restitution.campaigns.plan import Planned
from restitution.campaigns.table import write_tables
from restitution.errors import InputError

RUNS = ("r000000000001", "r000000000002")
HEADER = "record,impact,kind,outcome,speed_definition,e_eff\n"


@pytest.fixture
def folder(tmp_path):
    """A sweep of two finished runs."""
    plan = ({"run": run, "model": "point particle", "parameters": {}} for run in RUNS)
    (tmp_path / "plan.jsonl").write_text("".join(f"{json.dumps(entry)}\n" for entry in plan))
    for run in RUNS:
        place = tmp_path / "runs" / run
        place.mkdir(parents=True)
        for name in ("trajectory.csv", "run.json"):
            (place / name).touch()
        (place / "impacts.csv").write_text(f"{HEADER}{run},1,simulated,rebound,far,0.8\n")
    Manifest(tmp_path).append(line(run, FINISHED, seconds=1.0) for run in RUNS)
    return tmp_path


def planned():
    return [Planned(run, "point particle", {}) for run in RUNS]


def test_finished_runs_whose_results_are_there_are_left_as_they_are(folder):
    assert retry(folder, planned(), Manifest(folder)) == 0
    assert all(Manifest(folder).of(run).over for run in RUNS)


@pytest.mark.parametrize("gone", ["", "impacts.csv", "run.json"])
def test_a_finished_run_whose_results_are_gone_is_made_again_where_asked_for(gone, folder):
    place = folder / "runs" / RUNS[0]
    (place / gone).unlink() if gone else shutil.rmtree(place)
    assert retry(folder, planned(), Manifest(folder)) == 1
    after = Manifest(folder)
    assert not after.defects
    assert [after.of(run).over for run in RUNS] == [False, True]


def test_a_table_of_results_that_are_gone_says_what_brings_them_back(folder):
    shutil.rmtree(folder / "runs" / RUNS[0])
    with pytest.raises(InputError, match="retry"):
        write_tables(folder)
    retry(folder, planned(), Manifest(folder))
    write_tables(folder)
    rows = (folder / "impacts.csv").read_text().splitlines()
    assert [row.split(",")[0] for row in rows[1:]] == [RUNS[1]]
