"""Whatever stops a run, and whenever: what it leaves is whole; the run that goes on ends with the same files."""

import json
import os
import shutil
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest

from restitution import cases
from restitution.errors import InputError, StoppedError
from restitution.locks import LOCK, sole_writer
from restitution.runs import resolved, simulate, stand
from restitution.runs.kept import read_run
from restitution.runs.record import read_record

CASE = """
base = "gondret_st152_10"
[release]
kind = "drive"
gap_d = 0.55
speed = 0.3
ramp = 0.0005
free_below_d = 0.5
[numerics]
cells_per_diameter = 6
lattice_speed = 0.1
width_d = 2.5
height_d = 4.5
[run]
after_contact = 0.004
"""
AROUND = 20
"""Steps about the first contact at each of which a run is stopped."""


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = tmp_path_factory.mktemp("case") / "small.toml"
    path.write_text(CASE)
    return cases.read_case(path)


@pytest.fixture(scope="module")
def whole(case, tmp_path_factory):
    """The results of a run that nothing stopped."""
    folder = tmp_path_factory.mktemp("whole") / case.name
    simulate.simulate(case, folder)
    return folder


def content(folder):
    """All files; of run.json what does not tell when it was made."""
    found = {p.name: p.read_bytes() for p in folder.iterdir()}
    about = json.loads(found.pop("run.json"))
    return found, {key: about[key] for key in about if key not in ("seconds", "date", "seal")}


def at_step(step, deed):
    """``deed`` once the simulation has come to a step, within whatever block of steps."""
    from lbm.spheres import Spheres

    move = Spheres._move

    def moved(self, s, now, grid):
        if now == step:
            deed()
        return move(self, s, now, grid)

    return pytest.MonkeyPatch.context(), moved


def stop_at(step, deed, case, folder, **options):
    context, moved = at_step(step, deed)
    with context as patch:
        patch.setattr("lbm.spheres.spheres.Spheres._move", moved)
        simulate.simulate(case, folder, **options)


def contact_step(whole):
    about = json.loads((whole / "run.json").read_text())
    motion = np.loadtxt(whole / "motion.csv", delimiter=",", skiprows=1)
    return round(-motion[0, 0] / about["step_s"])


@pytest.mark.parametrize("from_contact", range(-AROUND // 2, AROUND // 2))
def test_ctrl_c_at_any_step_about_the_contact_changes_no_file(from_contact, case, whole, tmp_path):
    step = contact_step(whole) + from_contact
    with pytest.raises(KeyboardInterrupt):
        stop_at(step, lambda: signal.raise_signal(signal.SIGINT), case, tmp_path)
    assert (tmp_path / simulate.CHECKPOINT).exists()
    simulate.simulate(case, tmp_path, resume=True)
    assert content(tmp_path) == content(whole)


class Killed(BaseException):
    """The process is gone: nothing of it is done any more."""


@pytest.mark.parametrize("from_contact", range(-AROUND // 2, AROUND // 2))
def test_a_kill_at_any_step_about_the_contact_changes_no_file(from_contact, case, whole, tmp_path, monkeypatch):
    """With a checkpoint after every block of steps, of which the last that is whole is gone on from."""
    monkeypatch.setattr(stand, "SECONDS_PER_CHECKPOINT", 0.0)

    def kill():
        monkeypatch.setattr(stand.Stand, "leave", lambda _: None)
        raise Killed

    with pytest.raises(Killed):
        stop_at(contact_step(whole) + from_contact, kill, case, tmp_path)
    monkeypatch.undo()
    assert (tmp_path / simulate.CHECKPOINT).exists()
    simulate.simulate(case, tmp_path, resume=True)
    assert content(tmp_path) == content(whole)


def test_a_chain_of_interrupts_changes_no_file(case, whole, tmp_path):
    steps = json.loads((whole / "run.json").read_text())["steps"]
    for step in range(7, steps, steps // 9):
        with pytest.raises(KeyboardInterrupt):
            stop_at(step, lambda: signal.raise_signal(signal.SIGINT), case, tmp_path, resume=True)
    simulate.simulate(case, tmp_path, resume=True)
    assert content(tmp_path) == content(whole)


def test_what_fails_after_the_last_step_loses_no_step(case, whole, tmp_path, monkeypatch):
    """As a disk that is full once the tables are to be written."""

    def full(*_):
        raise InputError("No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(simulate, "results", full)
        with pytest.raises(InputError):
            simulate.simulate(case, tmp_path)
    advanced = []
    monkeypatch.setattr(resolved.ResolvedRun, "advance", lambda *_: advanced.append(1))
    simulate.simulate(case, tmp_path, resume=True)
    assert not advanced
    assert content(tmp_path) == content(whole)


@pytest.fixture(scope="module")
def stopped(case, whole, tmp_path_factory):
    """A folder with the checkpoint of a run that was stopped after its first contact."""
    folder = tmp_path_factory.mktemp("stopped")
    with pytest.raises(KeyboardInterrupt):
        stop_at(contact_step(whole) + 15, lambda: signal.raise_signal(signal.SIGINT), case, folder)
    return folder


def other_law(tmp_path):
    path = tmp_path / "other.toml"
    path.write_text(CASE + "[sphere]\ne_dry = 0.5\n")
    return cases.read_case(path)


def edited(change):
    def edit(path):
        with h5py.File(path, "r+") as file:
            change(file)

    return edit


def replace(file, name, data):
    del file[name]
    file.create_dataset(name, data=data)


def bomb(file):
    shape = file["slots"].shape
    del file["slots"]
    file.create_dataset("slots", shape=(*shape[:-1], 2**33), dtype="f4", chunks=(*shape[:-1], 1))


DAMAGES = {
    "steps": edited(lambda f: f.attrs.modify("steps", 10**12)),
    "parity": edited(lambda f: f.attrs.modify("parity", 1 - f.attrs["parity"])),
    "no seal": edited(lambda f: f.attrs.__delitem__("seal")),
    "no slots": edited(lambda f: f.__delitem__("slots")),
    "no pictures": edited(lambda f: f.__delitem__("beside")),
    "another shape": edited(lambda f: replace(f, "body/0/centres", [0.0])),
    "a bomb": edited(bomb),
    "deep description": edited(lambda f: replace(f, "description", "[" * 100_000)),
    "empty": lambda path: path.write_bytes(b""),
    "text": lambda path: path.write_text("x"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_checkpoint_that_is_not_as_it_was_written_is_refused(damage, case, stopped, tmp_path):
    shutil.copy(stopped / simulate.CHECKPOINT, tmp_path)
    DAMAGES[damage](tmp_path / simulate.CHECKPOINT)
    with pytest.raises(InputError, match="checkpoint") as refused:
        simulate.simulate(case, tmp_path, resume=True)
    assert len(str(refused.value).splitlines()) == 1


def test_a_checkpoint_of_another_law_is_refused(stopped, tmp_path):
    shutil.copy(stopped / simulate.CHECKPOINT, tmp_path)
    with pytest.raises(InputError, match="another case"):
        simulate.simulate(other_law(tmp_path), tmp_path, resume=True)
    assert not simulate.can_resume(tmp_path, other_law(tmp_path))


HOLDER = "import sys, time; from pathlib import Path; from restitution.locks import sole_writer\n"
HOLDER += "with sole_writer(Path(sys.argv[1])): print('held', flush=True); time.sleep(100)"


def test_two_processes_do_not_write_to_one_folder(case, tmp_path):
    other = subprocess.Popen([sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    try:
        assert other.stdout.readline() == "held\n"
        with pytest.raises(InputError, match=f"process {other.pid} on "):
            simulate.simulate(case, tmp_path)
    finally:
        other.kill()
        other.wait()
        other.stdout.close()
    assert (tmp_path / LOCK).exists()  # left by the one that was killed
    with sole_writer(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_sphere_that_never_arrives_is_not_a_finished_run(tmp_path):
    path = tmp_path / "slow.toml"
    path.write_text(CASE.replace('kind = "drive"', 'kind = "rest"').replace("speed = 0.3\nramp = 0.0005\n", "")
                    .replace("lattice_speed = 0.1", "lattice_speed = 0.1\nreference_speed = 0.3")
                    + "[fluid]\nviscosity = 5.0\n")  # fmt: skip
    with pytest.raises(StoppedError, match="did not reach the wall"):
        simulate.simulate(cases.read_case(path), tmp_path / "out")
    with pytest.raises(InputError, match="did not finish"):
        read_record(tmp_path / "out")


# Kept results


def kept_copy(whole, tmp_path):
    return shutil.copytree(whole, tmp_path / whole.name)


def edit_number(path, row, to):
    lines = path.read_text().splitlines()
    cells = lines[row].split(",")
    lines[row] = ",".join([*cells[:-1], to])
    path.write_text("\n".join(lines) + "\n")


TAMPERING = {
    "a number": lambda f: edit_number(f / "trajectory.csv", 5, "0.001"),
    "a row": lambda f: (f / "velocity.csv").write_text(
        (f / "velocity.csv").read_text().rpartition("\n0")[0] + "\n"
    ),
    "garbage": lambda f: (f / "impacts.csv").write_text("garbage\n"),
    "pictures": lambda f: (f / "flow.npz").write_bytes((f / "flow.npz").read_bytes()[:-7]),
    "no pictures": lambda f: (f / "flow.npz").unlink(),
}


@pytest.mark.parametrize("what", TAMPERING)
def test_results_that_are_not_as_they_were_written_are_refused(what, case, whole, tmp_path):
    place = kept_copy(whole, tmp_path)
    assert not read_run(case, tmp_path).stale
    TAMPERING[what](place)
    with pytest.raises(InputError, match=r"since it was written|is missing"):
        read_run(case, tmp_path)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("steps", 0), ("steps", 7), ("step_s", -1.0), ("step_s", 1e999), ("contacts", []), ("finished", False),
        ("case_as_run", {}), ("numbers", {}), ("files", {}), ("seal", None), ("seal", "0"),
    ],
)  # fmt: skip
def test_a_record_that_is_not_as_it_was_written_is_refused(field, value, case, whole, tmp_path):
    place = kept_copy(whole, tmp_path)
    about = json.loads((place / "run.json").read_text())
    (place / "run.json").write_text(json.dumps(about | {field: value}))
    with pytest.raises(InputError):
        read_run(case, tmp_path)


def test_a_record_of_before_there_were_hashes_is_read(case, whole, tmp_path):
    place = kept_copy(whole, tmp_path)
    about = json.loads((place / "run.json").read_text())
    (place / "run.json").write_text(json.dumps({k: v for k, v in about.items() if k not in ("files", "seal")}))
    assert not read_run(case, tmp_path).stale
    (place / "flow.npz").write_bytes(b"PK")
    with pytest.raises(InputError, match=r"flow\.npz"):
        read_run(case, tmp_path)


def test_the_process_id_is_no_part_of_what_is_left(tmp_path):
    """In a container it is the same each time: what a killed process left must not be in the way."""
    from restitution.files import write_whole

    left = [tmp_path / f".a.json.{os.getpid()}.part", tmp_path / ".a.json.0123456789abcdef.part"]
    for path in left:
        path.write_text("half")
    with (tmp_path / ".a.json.fedcba9876543210.part").open("w") as live:
        import fcntl

        fcntl.flock(live, fcntl.LOCK_EX)
        write_whole(tmp_path / "a.json", "whole")
    assert sorted(p.name for p in tmp_path.iterdir()) == [".a.json.fedcba9876543210.part", "a.json"]
