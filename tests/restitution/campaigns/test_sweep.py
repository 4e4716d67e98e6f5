"""A sweep on the processes of this machine: designs, what is kept, what a kill costs, what a folder says."""

import json
import os
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from restitution import datasets
from restitution.calibration import read
from restitution.campaigns.design import Sweep
from restitution.campaigns.manifest import ATTEMPTS, DIVERGED, FAILED, FINISHED, LOST, RETRY, Manifest, line
from restitution.campaigns.plan import planned
from restitution.campaigns.run import BEGUN, DEADLY, ELSEWHERE, STOP, Task, perform
from restitution.campaigns.sweep import sweep
from restitution.campaigns.table import impacts_of, runs_of
from restitution.cli import main
from restitution.emulation import read_runs
from restitution.errors import InputError, StoppedError
from restitution.locks import sole_writer
from restitution.runs.simulate import CHECKPOINT
from restitution.runs.validity.program import program_hash
from restitution.stokes import convention
from restitution.tables import check_table
from tests import sweeps

LONG = 0.12
"""Span of runs that take half a second to some seconds: time to kill in."""
LONGER = 0.6
"""Of which six runs are never done before an interrupt a second after the first has begun."""


def cases(folder: Path, text: str) -> list:
    return list(Sweep(sweeps.write(folder, f'base = "gondret_st152_10"\n{text}')).cases())


def test_a_grid_has_every_combination_in_si(tmp_path):
    found = cases(tmp_path, '[vary]\nsphere.e_dry = [0.8, 0.9]\n"fluid.viscosity" = ["10 mPa s", "20 mm2/s"]\n')
    density = found[0].case.fluid.density
    pairs = [(c.case.sphere.e_dry, c.case.fluid.viscosity) for c in found]
    assert pairs == [(e, pytest.approx(mu)) for e in (0.8, 0.9) for mu in (0.01, 2e-5 * density)]
    assert [c.parameters for c in found] == [{"sphere.e_dry": e, "fluid.viscosity": mu} for e, mu in pairs]


@pytest.mark.parametrize("design", ["latin hypercube", "sobol"])
def test_points_lie_one_in_each_layer_of_each_range(tmp_path, design):
    text = f"""design = "{design}"
runs = 16
[vary]
sphere.e_dry = {{ from = 0.8, to = 0.96 }}
fluid.viscosity = {{ from = "10 mPa s", to = "40 mPa s", scale = "log" }}
"""
    found = cases(tmp_path, text)
    e = np.array([c.case.sphere.e_dry for c in found])
    mu = np.array([c.case.fluid.viscosity for c in found])
    for share in ((e - 0.8) / 0.16, np.log(mu / 0.01) / np.log(4)):
        assert sorted(np.floor(16 * share)) == list(range(16))
    again = cases(tmp_path, text)
    assert [c.parameters for c in again] == [c.parameters for c in found]


@pytest.mark.parametrize("through", ["fluid.viscosity", "release.speed"])
def test_a_stokes_number_is_that_of_the_drive(tmp_path, through):
    text = f'st_through = "{through}"\n[case]\nrelease.kind = "drive"\nrelease.gap_d = 2.0\nrelease.speed = 0.3\n'
    found = cases(tmp_path, text + "release.ramp = 0.001\n[vary]\nSt = [20.0, 80.0]\n")
    for one, St in zip(found, (20.0, 80.0), strict=True):
        c = one.case
        assert c.sphere.density * c.release.speed * c.sphere.diameter / (9 * c.fluid.viscosity) == pytest.approx(
            St
        )
        assert convention("st").per_speed(c.conditions) * c.release.speed == pytest.approx(St)
        assert list(one.parameters) == ["St", through]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[vary]\nfilm.tensoin = [1.0]\n", "film.tensoin"),
        ("[vary]\nsphere.e_dry = [1.2]\n", "sphere.e_dry"),
        ("[vary]\nsphere.e_dry = { from = 0.8, to = 0.9 }\n", "count"),
        ('design = "sobol"\nruns = 6\n[vary]\nsphere.e_dry = { from = 0.8, to = 0.9 }\n', "power of two"),
        ('design = "latin hypercube"\nruns = 6\n[vary]\nsphere.e_dry = [0.8]\n', "range"),
        ("", "vary"),
        ("[vary]\nfluid.viscosity = ['3 mm']\n", "fluid.viscosity"),
        ("[vary]\nsphere.e_dry = [0.8]\n[case]\nsphere.e_dry = 0.9\n", "sphere.e_dry: stands in"),
        ("[vary]\nSt = [10.0]\n[case]\nrelease = { kind = 'rest', gap_d = 2.0 }\n", "from rest"),
    ],
)
def test_a_sweep_that_cannot_be_is_refused_before_any_run(tmp_path, text, says):
    file = sweeps.write(tmp_path, f'base = "gondret_st152_10"\n{text}')
    with pytest.raises(InputError, match=says):
        sweep(file, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_runs_are_known_by_their_content(tmp_path):
    few = planned(Sweep(sweeps.write(tmp_path, sweeps.POINTS)).cases())
    more = sweeps.POINTS.replace("[0.8, 0.9,", "[0.75, 0.8, 0.8, 0.9,")
    said = []
    many = planned(Sweep(sweeps.write(tmp_path, more)).cases(), said.append)
    assert {r.run for r in few} < {r.run for r in many}
    assert len(many) == 8
    assert said == ["2 of 10 runs are the same as others: each is made once"]


def test_each_of_several_bases_has_all_points_and_its_record(tmp_path):
    text = """base = ["gondret_st152_10", "li_drop1"]
models = ["point particle"]
design = "latin hypercube"
runs = 4
[vary]
film.floor = { from = 1e-7, to = 1e-5, scale = "log" }
"""
    file, out = sweeps.write(tmp_path, text), tmp_path / "out"
    in_threads(file, out)
    runs = runs_of(out)
    records = ["gondret2002_st152", "li2012_drop1"]
    assert list(runs.record) == [r for r in records for _ in range(4)]
    floors = [list(runs["film.floor"][runs.record == r]) for r in records]
    assert floors[0] == floors[1]
    assert len(set(floors[0])) == 4
    group = read_runs(out)[0]
    assert group.parameters == ("film.floor",)
    assert group.records == tuple(records)


def test_bases_of_one_record_are_told_apart_by_name(tmp_path):
    bases = ["gondret_st152_10", "gondret_st152_16"]
    found = list(Sweep(sweeps.write(tmp_path, f"base = {bases}\n[vary]\nsphere.e_dry = [0.8, 0.9]\n")).cases())
    assert [c.parameters for c in found] == [{"base": b, "sphere.e_dry": e} for b in bases for e in (0.8, 0.9)]
    assert [c.case.numerics.cells_per_diameter for c in found] == [10, 10, 16, 16]


def in_threads(file: Path, out: Path, **more) -> Manifest:
    """A sweep on a given executor, of threads: what any other one has of the interface."""
    with ThreadPoolExecutor(2) as executor:
        return sweep(file, out, executor=executor, **more)


def test_tables_have_a_row_a_run_and_impacts_that_fit_reads(tmp_path):
    out = tmp_path / "out"
    in_threads(sweeps.write(tmp_path, sweeps.POINTS), out)
    runs = runs_of(out)
    assert list(runs.state) == [FINISHED] * 6
    assert sorted(zip(runs["sphere.e_dry"], runs["fluid.viscosity"], strict=True)) == [
        (e, mu) for e in (0.8, 0.9, 0.97) for mu in (0.01, 0.02)
    ]
    for track in runs.track:
        assert check_table(out / track, datasets.schema("trajectory")) == []
    assert check_table(out / "impacts.csv", datasets.schema("impact")) == []
    assert read([str(out / "impacts.csv")]) is not None
    joined = impacts_of(out)
    assert set(joined.run) == set(runs.run)
    assert (joined["e_dry"] == joined["sphere.e_dry"]).all()


def test_finished_runs_are_not_made_again_even_if_their_line_is_lost(tmp_path):
    out, file = tmp_path / "out", sweeps.write(tmp_path, sweeps.POINTS)
    in_threads(file, out)
    before = {p: p.stat().st_mtime_ns for p in (out / "runs").rglob("*.csv")}
    path = out / "manifest.jsonl"
    text = path.read_text().splitlines()
    text[1] = text[1].replace("finished", "finishes")
    path.write_text("\n".join(text[:5]) + "\n" + text[5][:30])
    said = []
    manifest = in_threads(file, out, say=said.append)
    assert [d.row for d in manifest.defects] == [2, 6]
    assert any("manifest.jsonl:2" in s for s in said)
    assert all(manifest.of(r.run).state == FINISHED for r in planned(Sweep(file).cases()))
    assert {p: p.stat().st_mtime_ns for p in (out / "runs").rglob("*.csv")} == before


@pytest.mark.parametrize("spoil", [Path.unlink, lambda path: path.write_text("")])
def test_results_that_somebody_removed_are_made_again_the_same(tmp_path, spoil):
    out, file = tmp_path / "out", sweeps.write(tmp_path, sweeps.POINTS)
    in_threads(file, out)
    path = next((out / "runs").glob("*/trajectory.csv"))
    before, said = path.read_bytes(), []
    spoil(path)
    in_threads(file, out, say=said.append)
    assert path.read_bytes() == before
    assert any(path.parent.name in text for text in said)


def test_runs_without_an_impact_are_said_with_what_mends_it(tmp_path):
    said, text = [], sweeps.POINTS + "[case]\nrun.after_contact = 0.001\n"
    out = tmp_path / "out"
    in_threads(sweeps.write(tmp_path, text), out, say=said.append)
    assert len((out / "impacts.csv").read_text().splitlines()) == 1
    assert any("6 of 6" in text and "run.after_contact" in text for text in said)


def test_a_line_is_only_ever_added(tmp_path):
    one, other = Manifest(tmp_path), Manifest(tmp_path)
    one.append([line("a", FINISHED, seconds=1.0)])
    other.append([line("a", FINISHED, seconds=2.0), line("b", FAILED, "why")])
    one.refresh()
    assert sweeps.finished(tmp_path) == {"a": 1}
    assert one.of("a").seconds == 1.0
    assert one.of("b").message == "why"


def test_attempts_and_deaths_are_counted_apart(tmp_path):
    manifest = Manifest(tmp_path)
    manifest.append([line("fails", FAILED)] * (ATTEMPTS - 1))
    assert not manifest.of("fails").over
    manifest.append([line("fails", FAILED)])
    assert manifest.of("fails").over
    manifest.append([line("moves", LOST, further=True)] * 10)
    assert not manifest.of("moves").over
    manifest.append([line("stays", LOST, further=False)] * ATTEMPTS)
    assert manifest.of("stays").over
    manifest.append([line("flows", DIVERGED), line("fails", RETRY)])
    assert manifest.of("flows").over
    assert not manifest.of("fails").over


def one_task(folder: Path, **more) -> Task:
    run = planned(Sweep(sweeps.tiny(folder)).cases())[0]
    return Task(run.run, run.model, run.case, str(folder / "runs" / run.run), program_hash(), **more)


def test_a_truncated_checkpoint_is_a_start_anew(tmp_path, monkeypatch):
    from restitution.runs.resolved import ResolvedRun

    for name in ("whole", "cut"):
        (tmp_path / name).mkdir()
    whole, cut = one_task(tmp_path / "whole"), one_task(tmp_path / "cut")
    advance, count = ResolvedRun.advance, []

    def interrupted(self, observers=()):
        count.append(1)
        if len(count) == 4:
            raise KeyboardInterrupt
        advance(self, observers)

    with monkeypatch.context() as patch:
        patch.setattr(ResolvedRun, "advance", interrupted)
        with pytest.raises(KeyboardInterrupt):
            perform(cut)
    checkpoint = Path(cut.folder) / CHECKPOINT
    checkpoint.write_bytes(checkpoint.read_bytes()[:-2000])
    assert perform(cut).state == FINISHED
    assert perform(whole).state == FINISHED
    assert sweeps.results(tmp_path / "cut") == sweeps.results(tmp_path / "whole")


def test_a_run_that_another_process_has_is_left_to_it(tmp_path):
    task = one_task(tmp_path)
    Path(task.folder).mkdir(parents=True)
    with sole_writer(Path(task.folder), ".claimed"):
        assert perform(task).state == ELSEWHERE
    assert perform(Task(task.run, task.model, task.case, task.folder, "other")).state == STOP


def test_a_run_that_kills_each_worker_is_given_up_and_begins_afresh_under_another_driver(tmp_path):
    """As an executor does that starts a run again by itself: what is left of a killed process is its folder."""
    task = one_task(tmp_path, driver="one")
    folder = Path(task.folder)
    for _ in range(ATTEMPTS):
        killed = os.fork()
        if not killed:
            with patched_to_die():
                perform(task)
        os.waitpid(killed, 0)
        assert (folder / BEGUN).exists()
    assert perform(task).state == DEADLY
    assert not (folder / BEGUN).exists()
    (folder / BEGUN).write_text(json.dumps(["one", 0.0, ATTEMPTS]))
    assert perform(replace(task, driver="another")).state == FINISHED
    assert not (folder / BEGUN).exists()


@contextmanager
def patched_to_die():
    from restitution.runs import simulate

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulate, "simulate", lambda *_, **__: os.kill(os.getpid(), signal.SIGKILL))
        yield


def test_an_executor_that_takes_no_more_stops_the_sweep(tmp_path):
    executor = ThreadPoolExecutor(1)
    executor.shutdown()
    with pytest.raises(StoppedError, match="takes no more runs"):
        sweep(sweeps.write(tmp_path, sweeps.POINTS), tmp_path / "out", executor=executor)
    assert sweeps.lines(tmp_path / "out") == []


def test_a_full_disk_stops_the_sweep_and_blames_no_run(tmp_path, monkeypatch):
    from restitution.runs import point_particle

    def full(*_):
        raise OSError(28, os.strerror(28))

    file, out = sweeps.write(tmp_path, sweeps.POINTS), tmp_path / "out"
    with monkeypatch.context() as patch:
        patch.setattr(point_particle, "write", full)
        with pytest.raises(StoppedError, match="No space left"):
            in_threads(file, out)
    assert sweeps.lines(out) == []
    assert all(s.attempts == 0 for s in in_threads(file, out).standing.values())


def test_a_killed_driver_leaves_no_process_and_no_finished_run_is_lost(tmp_path):
    out, file = tmp_path / "out", sweeps.tiny(tmp_path, LONG)
    with sweeps.start(file, "--out", out, "--processes", 2, "--no-forks") as driver:
        sweeps.until(lambda: sum(sweeps.finished(out).values()) >= 1 and sweeps.under_way(out))
        sweeps.kill(driver)
    before = {p: p.stat().st_mtime_ns for r in sweeps.finished(out) for p in (out / "runs" / r).glob("*.csv")}
    sweeps.until(lambda: not sweeps.under_way(out))
    done = sweeps.run(file, "--out", out, "--no-forks")
    assert done.returncode == 0, done.stderr
    assert sorted(sweeps.finished(out).values()) == [1] * 6
    assert {p: p.stat().st_mtime_ns for p in before} == before


def test_a_killed_process_costs_its_own_run_alone(tmp_path):
    out, file = tmp_path / "out", sweeps.tiny(tmp_path, LONG)
    with sweeps.start(file, "--out", out, "--processes", 2, "--no-forks") as driver:
        sweeps.until(lambda: sweeps.under_way(out))
        holder = next((out / "runs").glob("*/.running"))
        os.kill(int(holder.read_text().split()[1]), signal.SIGKILL)
        _, said = driver.communicate(timeout=120)
    assert driver.returncode == 0, said
    lost = [entry["run"] for entry in sweeps.lines(out) if entry["state"] == LOST]
    assert lost == [holder.parent.name]
    assert sorted(sweeps.finished(out).values()) == [1] * 6


def test_an_interrupt_leaves_checkpoints_from_which_two_drivers_go_on(tmp_path):
    file = sweeps.tiny(tmp_path, LONGER)
    for seconds in (1.0, 2.0, 4.0, 8.0):  # before its first step, at which kernels load, a run leaves nothing
        out = tmp_path / f"after {seconds} s"
        with sweeps.start(file, "--out", out, "--processes", 2, "--no-forks") as driver:
            sweeps.until(partial(sweeps.under_way, out))
            time.sleep(seconds)
            driver.send_signal(signal.SIGINT)
            _, said = driver.communicate(timeout=60)
        assert driver.returncode == 130
        assert "Traceback" not in said
        if checkpoints := list((out / "runs").glob("*/checkpoint.h5")):
            break
    assert checkpoints
    both = [sweeps.start(file, "--out", out, "--processes", 1, "--no-forks") for _ in range(2)]
    assert [p.communicate(timeout=120) and p.returncode for p in both] == [0, 0]
    assert sorted(sweeps.finished(out).values()) == [1] * 6


def test_an_interrupt_at_the_very_end_leaves_no_traceback(tmp_path):
    """While the processes of a sweep that is done are ended."""
    file, out = sweeps.tiny(tmp_path, rest="[vary]\nsphere.e_dry = [0.8, 0.9]\n"), tmp_path / "out"
    with sweeps.start(file, "--out", out, "--processes", 2) as driver:
        sweeps.until(lambda: len(sweeps.finished(out)) == 2)
        driver.send_signal(signal.SIGINT)
        _, said = driver.communicate(timeout=60)
    assert driver.returncode in (0, 130)
    assert "Traceback" not in said


def test_a_case_that_is_refused_is_tried_once_and_retry_asks_again(tmp_path, capsys):
    rest = '[vary]\ncontact.edge_d = [0.28, 0.05]\n[case.contact]\nmode = "effective"\nmeasured = [0.6]\n'
    file = sweeps.tiny(tmp_path, head="", rest=rest + '[case.film]\nform = "none"\n')
    out = tmp_path / "out"
    in_threads(file, out, threads=None)
    states = Manifest(out).standing
    assert sorted(s.state for s in states.values()) == [FAILED, FINISHED]
    assert len(sweeps.lines(out)) == 2
    assert main(["sweep", "status", str(out)]) == 0
    assert "numerics.lattice_speed" in capsys.readouterr().out
    assert main(["sweep", "retry", str(out)]) == 0
    assert sorted(s.over for s in Manifest(out).standing.values()) == [False, True]


def test_a_plan_of_another_study_is_replaced_where_one_means_it(tmp_path):
    out = tmp_path / "out"
    in_threads(sweeps.write(tmp_path, sweeps.POINTS), out)
    plan = (out / "plan.jsonl").read_text()
    head = 'base = "gondret_st152_10"\nmodels = ["point particle"]\n[vary]\n'
    other = sweeps.write(tmp_path, head + "film.tension = [50e3]\n", "other.toml")
    with pytest.raises(InputError, match="another sweep"):
        in_threads(other, out)
    assert (out / "plan.jsonl").read_text() == plan
    grown = sweeps.write(tmp_path, head + "sphere.e_dry = [0.7]\nfilm.tension = [50e3]\n", "grown.toml")
    in_threads(grown, out)
    in_threads(other, out, replace=True)
    assert len(runs_of(out)) == 1


@pytest.mark.parametrize("asked", ["status", "retry", "clean", "table"])
def test_help_is_of_what_a_folder_is_asked(asked, capsys):
    with pytest.raises(SystemExit) as end:
        main(["sweep", asked, "--help"])
    assert end.value.code == 0
    said = capsys.readouterr().out
    assert f"sweep {asked} DIR" in said
    assert "--scheduler" not in said


def test_clean_removes_what_no_plan_has(tmp_path, capsys):
    out = tmp_path / "out"
    in_threads(sweeps.write(tmp_path, sweeps.POINTS), out)
    said = []
    in_threads(sweeps.write(tmp_path, sweeps.POINTS.replace("0.8, ", "")), out, say=said.append)
    assert any(text.startswith("2 runs of the earlier plan") for text in said)
    capsys.readouterr()
    assert main(["sweep", "clean", str(out)]) == 0
    assert "2 runs that the plan has no more" in capsys.readouterr().out
    plan = [json.loads(text)["run"] for text in (out / "plan.jsonl").read_text().splitlines()]
    assert sorted(p.name for p in (out / "runs").iterdir()) == sorted(plan)
    assert len(pd.read_csv(out / "runs.csv")) == 4
