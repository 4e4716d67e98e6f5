"""A sweep whose folder somebody has tidied by hand: what is gone is said, and made again where asked for."""

import json
import shutil

import pytest

from restitution.campaigns.keeping import retry
from restitution.campaigns.manifest import FINISHED, Manifest, line
from restitution.campaigns.plan import Planned
from restitution.campaigns.table import write_tables
from restitution.cli import main
from restitution.errors import InputError
from restitution.runs.record import RunRecord, digest

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
        written = {
            "trajectory.csv": "time_s,gap_m\n",
            "impacts.csv": f"{HEADER}{run},1,simulated,rebound,far,0.8\n",
        }
        record = RunRecord(
            model="point particle", case=run, date="2026-01-01", finished=True, seconds=1.0, threads=1, steps=1,
            shape=(0, 0, 0), step_s=1e-4, numbers={}, contacts=(), code_hash="", case_as_run={},
            files={name: digest(content) for name, content in written.items()},
        )  # fmt: skip
        for name, content in (written | {"run.json": record.text()}).items():
            (place / name).write_text(content)
    Manifest(tmp_path).append(line(run, FINISHED, seconds=1.0) for run in RUNS)
    return tmp_path


def planned():
    return [Planned(run, "point particle", {}) for run in RUNS]


def test_finished_runs_whose_results_are_there_are_left_as_they_are(folder):
    assert retry(folder, planned(), Manifest(folder)) == 0
    assert all(Manifest(folder).of(run).over for run in RUNS)


@pytest.mark.parametrize("gone", ["", "impacts.csv", "run.json", "trajectory.csv", "emptied", "edited"])
def test_a_finished_run_whose_results_are_gone_is_made_again_where_asked_for(gone, folder, capsys):
    place = folder / "runs" / RUNS[0]
    if not gone:
        shutil.rmtree(place)
    elif gone == "emptied":
        (place / "trajectory.csv").write_text("")
    elif gone == "edited":
        (place / "impacts.csv").write_text((place / "impacts.csv").read_text().replace("0.8", "0.9"))
    else:
        (place / gone).unlink()
    assert main(["sweep", "status", str(folder)]) == 0
    assert "1 finished, 1 results gone" in capsys.readouterr().out
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
