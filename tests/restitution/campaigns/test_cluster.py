"""A sweep on a real Dask scheduler with two workers, and what is left of it when each of them is killed."""

import contextlib
import json
import os
import shutil
import signal
import time

import pytest

from restitution.campaigns import cluster as own
from restitution.campaigns.cluster import Renewal, keywords
from restitution.campaigns.manifest import ATTEMPTS
from tests import sweeps

pytest.importorskip("distributed")
LONG = 0.12
"""Span of runs that take two to three seconds: time to kill in."""


@pytest.fixture
def cluster(tmp_path, request):
    """A scheduler and two workers on this machine: the address, and the processes; with nannies if asked for."""
    nanny = getattr(request, "param", "--no-nanny")
    file = tmp_path / "scheduler.json"
    quiet = ("--no-dashboard", "--scheduler-file", file)
    scheduler = sweeps.module("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", 0, *quiet)
    sweeps.until(lambda: file.exists() and file.read_text().rstrip().endswith("}"))
    address = json.loads(file.read_text())["address"]
    workers = [
        sweeps.module(
            "distributed.cli.dask_worker", address, "--nthreads", 1, nanny, "--no-dashboard",
            "--local-directory", tmp_path / f"worker{i}",
        )
        for i in range(2)
    ]  # fmt: skip
    yield address, scheduler, workers
    for process in (*workers, scheduler):
        if process.poll() is None:
            sweeps.kill(process)


@pytest.fixture(scope="module")
def by_processes(tmp_path_factory):
    """The same sweeps on the processes of this machine, by their span."""
    folder = tmp_path_factory.mktemp("processes")
    assert sweeps.run(sweeps.tiny(folder, LONG), "--out", folder / "out").returncode == 0
    return sweeps.results(folder / "out")


def test_a_killed_worker_costs_no_run_and_the_results_are_those_of_processes(cluster, by_processes, tmp_path):
    address, _, workers = cluster
    out = tmp_path / "out"
    with sweeps.start(sweeps.tiny(tmp_path, LONG), "--out", out, "--scheduler", address) as driver:
        sweeps.until(lambda: sum(sweeps.finished(out).values()) >= 1)
        sweeps.kill(workers[0])
        _, said = driver.communicate(timeout=120)
    assert driver.returncode == 0, said
    assert sorted(sweeps.finished(out).values()) == [1] * 6
    assert sweeps.results(out) == by_processes


def test_a_killed_scheduler_is_said_and_the_sweep_goes_on_without_it(cluster, by_processes, tmp_path):
    address, scheduler, _ = cluster
    out, file = tmp_path / "out", sweeps.tiny(tmp_path, LONG)
    with sweeps.start(file, "--out", out, "--scheduler", address) as driver:
        sweeps.until(lambda: sum(sweeps.finished(out).values()) >= 2)
        sweeps.kill(scheduler)
        _, said = driver.communicate(timeout=60)
    before = sweeps.finished(out)
    assert driver.returncode == 2
    assert "is gone" in said
    assert "Traceback" not in said
    assert len(before) >= 2
    assert sweeps.run(file, "--out", out).returncode == 0
    assert sorted(sweeps.finished(out).values()) == [1] * 6
    assert sweeps.results(out) == by_processes


def test_a_killed_driver_is_followed_by_another(cluster, by_processes, tmp_path):
    address, *_ = cluster
    out, file = tmp_path / "out", sweeps.tiny(tmp_path, LONG)
    with sweeps.start(file, "--out", out, "--scheduler", address) as driver:
        sweeps.until(lambda: sum(sweeps.finished(out).values()) >= 1)
        sweeps.kill(driver)
    assert sweeps.run(file, "--out", out, "--scheduler", address).returncode == 0
    assert sorted(sweeps.finished(out).values()) == [1] * 6
    assert sweeps.results(out) == by_processes


@pytest.mark.parametrize("cluster", ["--nanny"], indirect=True)
def test_a_run_that_kills_each_worker_is_given_up_alone(cluster, by_processes, tmp_path):
    """Workers come back, their nannies see to it; Dask starts the run on them again by itself."""
    address, *_ = cluster
    out, file = tmp_path / "out", sweeps.tiny(tmp_path, LONG)
    deadly, killed = sorted(by_processes)[2], set()
    claim = out / "runs" / deadly / ".running"
    with sweeps.start(file, "--out", out, "--scheduler", address, "--no-forks") as driver:
        while driver.poll() is None:
            with contextlib.suppress(OSError, IndexError, ValueError):
                pid = int(claim.read_text().split()[1])
                if pid not in killed:
                    os.kill(pid, signal.SIGKILL)
                    killed.add(pid)
            time.sleep(0.02)
        _, said = driver.communicate(timeout=120)
    assert driver.returncode == 2
    assert len(killed) == ATTEMPTS
    assert [line for line in said.splitlines() if deadly in line and "given up" in line]
    assert "Traceback" not in said
    assert {run for run, times in sweeps.finished(out).items() if times == 1} == set(by_processes) - {deadly}
    assert {run: files for run, files in sweeps.results(out).items() if run != deadly} == {
        run: files for run, files in by_processes.items() if run != deadly
    }


def test_no_scheduler_and_a_keyword_that_is_none_are_one_line_each(tmp_path):
    file = sweeps.tiny(tmp_path)
    done = sweeps.run(file, "--out", tmp_path / "out", "--scheduler", "nowhere")
    assert done.returncode == 2
    assert [line.startswith("error:") for line in done.stderr.splitlines()].count(True) == 1
    assert "Traceback" not in done.stderr
    slurm = sweeps.write(tmp_path, 'quene = "x"\ncores = 1\nmemory = "1 GB"\n', "slurm.toml")
    done = sweeps.run(file, "--scheduler", f"slurm:{slurm}", "--dry-run")
    assert done.returncode == 2
    assert "did you mean queue?" in done.stderr


def test_the_script_of_a_job_has_what_the_file_says(tmp_path):
    text = (
        'jobs = 3\nqueue = "long"\naccount = "flow"\ncores = 4\nprocesses = 4\n'
        'memory = "8 GB"\nwalltime = "02:00:00"\n'
    )
    slurm = sweeps.write(tmp_path, text, "slurm.toml")
    script = sweeps.run(sweeps.tiny(tmp_path), "--scheduler", f"slurm:{slurm}", "--dry-run").stdout
    for line in ("#SBATCH -p long", "#SBATCH -A flow", "#SBATCH --cpus-per-task=4", "#SBATCH -t 02:00:00"):
        assert line in script.splitlines()
    assert "--nthreads 1" in script
    if shutil.which("sbatch") is None:
        done = sweeps.run(sweeps.tiny(tmp_path), "--out", tmp_path / "out", "--scheduler", f"slurm:{slurm}")
        assert done.returncode == 2
        assert "there is no sbatch here" in done.stderr
    interrupt = signal.getsignal(signal.SIGINT)
    assert {"queue", "account", "walltime", "cores", "memory", "processes", "worker_extra_args"} <= keywords()
    assert signal.getsignal(signal.SIGINT) is interrupt


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # dask-jobqueue's, of its jobs
def test_a_job_that_is_over_is_asked_for_anew(monkeypatch):
    """Jobs of two processes each, as jobs of SLURM are, but on this machine: the end of a walltime is a kill."""
    from dask_jobqueue.local import LocalCluster

    monkeypatch.setattr(own, "_SECONDS_GONE", 0.5)
    here = {"host": "127.0.0.1", "dashboard_address": None}
    with LocalCluster(cores=2, processes=2, memory="1GB", scheduler_options=here) as cluster:
        renew = Renewal(cluster, 1)

        def addresses():
            renew()
            return set(cluster.scheduler_info["workers"])

        cluster.scale(jobs=1)
        sweeps.until(lambda: len(addresses()) == 2)
        before = addresses()
        cluster.sync(cluster.scheduler_comm.retire_workers, workers=list(before))
        sweeps.until(lambda: len(addresses() - before) == 2)
