"""Running a case: progress, checkpoints, resuming, and a folder of tables in the schemas of the measured data.

==================  =====================================================================================
file                content
==================  =====================================================================================
``trajectory.csv``  time from the first contact and gap, in the schema of the measured trajectories
``velocity.csv``    the same rows as velocity, in the schema of the measured settling velocities
``impacts.csv``     impacts by :func:`restitution.impacts.find_impacts` under its three definitions of speed
``run.json``        key and hashes of the run, its numbers, the contacts as the solver had them, notes
``flow.npz``        vorticity in the middle plane before, at and after the first impact
``motion.csv``      every step: position, velocity, spin, force, torque (not among kept results)
==================  =====================================================================================

A run that is stopped leaves ``checkpoint.h5`` and what it has of the tables; the same command with ``resume``
continues it. Files appear whole or not at all.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from restitution.case import Case
from restitution.errors import Defect, InputError, StoppedError
from restitution.files import write_folder, write_whole
from restitution.flow_pictures import FlowFrames
from restitution.impacts import find_impacts
from restitution.run_key import RunKey, run_key
from restitution.run_progress import RunProgress
from restitution.stokes import MEASURED_SPEEDS
from restitution.table_writing import table_text
from restitution.tracks import MINIMUM_FRAMES, Track

if TYPE_CHECKING:
    import pandas as pd

    from restitution.resolved import ResolvedRun, SolverContact

SECONDS_PER_CHECKPOINT = 30.0
CHECKPOINT, IDENTITY, SO_FAR = "checkpoint.h5", "checkpoint.json", "trajectory_so_far.csv"
KEPT = ("trajectory.csv", "velocity.csv", "impacts.csv", "run.json", "flow.npz")


def simulate(
    case: Case,
    folder: str | Path,
    *,
    resume: bool = False,
    snapshots: bool = False,
    every_step: bool = True,
    show: Callable[[str], None] | None = None,
    file: str = "",
) -> RunKey:
    """Run ``case`` and write its results into ``folder``; returns the key of the run.

    ``resume`` continues from the checkpoint in the folder, if it has one, and refuses that of another run. Raises
    :class:`InputError` for a case that cannot be run and :class:`StoppedError` for a run that diverges or
    cannot write; Ctrl-C is raised again once the checkpoint has been written.
    """
    from restitution.resolved import ResolvedRun

    folder = Path(folder)
    run, key = ResolvedRun(case, file), run_key(case)
    say = show or (lambda _: None)
    for warning in run.warnings:
        say(f"warning: {warning}")
    frames, spent = FlowFrames(), 0.0
    if resume and (folder / CHECKPOINT).exists():
        spent = _resume(run, key, frames, folder)
        say(f"continues at t = {run.time_s:.4g} s")
    else:
        if resume:
            say(f"{folder} has no checkpoint: starts anew")
        (folder / CHECKPOINT).unlink(missing_ok=True)  # of a run that is given up
    start = saved = time.perf_counter()
    try:
        write_folder(folder, {IDENTITY: json.dumps({"key": key.key, "seconds": spent})})
        observers = (run.snapshots(folder),) if snapshots else ()
        with RunProgress(case.name, run.cells, show is not None) as shown:
            while not run.finished:
                before = run.simulation.steps
                run.advance(observers)
                frames.look(run)
                shown.update(run.simulation.steps - before, run.time_s, run.expected_s, run.gap_d)
                if time.perf_counter() - saved > SECONDS_PER_CHECKPOINT:
                    saved = time.perf_counter()
                    _checkpoint(run, key, frames, folder, spent + saved - start)
    except BaseException:
        _leave(run, key, frames, folder, spent + time.perf_counter() - start)
        raise
    seconds = spent + time.perf_counter() - start
    contents = results(run, case, key, frames, seconds)
    if every_step:
        contents["motion.csv"] = table_text(run.motion(), "%.7g")
    write_folder(folder, contents)
    for name in (CHECKPOINT, IDENTITY, SO_FAR):
        (folder / name).unlink(missing_ok=True)
    return key


def results(
    run: ResolvedRun, case: Case, key: RunKey, frames: FlowFrames, seconds: float
) -> dict[str, str | bytes]:
    """The files of a run as it now stands, but the motion of every step."""
    motion = run.motion().iloc[:: run.rows_apart()]
    trajectory = motion[["time_s", "gap_m"]]
    velocity = motion[["time_s", "vz_m_s"]].rename(columns={"vz_m_s": "velocity_m_s"})
    impacts, notes = simulated_impacts(trajectory, case)
    first = run.contacts[0].time_s if run.contacts else 0.0
    about = {
        **key.stated(),
        "case": case.name,
        "title": case.title,
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
        "finished": run.finished,
        "seconds": round(seconds, 1),
        "threads": run.simulation.threads,
        "steps": run.simulation.steps,
        "shape": list(run.simulation.shape),
        "step_s": run.step_s,
        "numbers": {name: float(f"{value:.5g}") for name, value in run.flow.describe().items()},
        "contacts": [_contact(c, first) for c in run.contacts],
        "notes": notes,
        "case_as_run": case.model_dump(mode="json", exclude_none=True),
    }
    return {
        "trajectory.csv": table_text(trajectory),
        "velocity.csv": table_text(velocity),
        "impacts.csv": table_text(impacts),
        "run.json": json.dumps(about, indent=1) + "\n",
        "flow.npz": frames.as_bytes(),
    }


def simulated_impacts(trajectory: pd.DataFrame, case: Case) -> tuple[pd.DataFrame, list[str]]:
    """Impacts of a simulated trajectory under all three definitions of speed, and remarks on them.

    Where the case has a measured record, its camera is taken: the same interval between frames, and the same noise
    to weight them by, so that a definition of speed means the same for both.
    """
    import pandas as pd

    from restitution import datasets

    columns = list(datasets.schema("impact").columns)
    if case.sphere.e_dry is None or len(trajectory) < MINIMUM_FRAMES:
        return pd.DataFrame(columns=columns), []
    track = _as_filmed(trajectory, case)
    rows, notes = [], []
    for speed in MEASURED_SPEEDS:
        found = find_impacts(track, case.conditions, speed, record=case.name, kind="simulated")
        rows += found.rows
        notes += [f"{speed}: {note}" for note in found.notes]
    return pd.DataFrame(rows, columns=columns), notes


def _as_filmed(trajectory: pd.DataFrame, case: Case) -> Track:
    """The trajectory as the record's camera would have it, the contact in the middle between two frames."""
    from restitution import datasets

    if case.record is None or datasets.resource(case.record).table != "trajectory":
        return Track.from_table(trajectory)
    record = datasets.load_track(case.record)
    interval = float(np.median(np.diff(record.time_s)))
    time, gap = (trajectory[name].to_numpy() for name in ("time_s", "gap_m"))
    first, last = np.ceil(time[0] / interval - 0.5), np.floor(time[-1] / interval - 0.5)
    frames = interval * (np.arange(first, last + 1) + 0.5)
    if len(frames) < MINIMUM_FRAMES:
        return Track.from_table(trajectory)
    return Track(frames, np.interp(frames, time, gap), "gap", record.sigma)


def _contact(c: SolverContact, first: float) -> dict[str, float]:
    return {
        "time_s": _g(c.time_s - first),
        "speed_in_m_s": _g(c.speed_in_m_s),
        "speed_out_m_s": _g(c.speed_out_m_s),
    }


def _g(value: float) -> float:
    return float(f"{value:.6g}")


def _checkpoint(run: ResolvedRun, key: RunKey, frames: FlowFrames, folder: Path, seconds: float) -> None:
    run.save(folder / CHECKPOINT)
    state = {"key": key.key, "steps": run.simulation.steps, "seconds": round(seconds, 1)}
    write_folder(folder, {IDENTITY: json.dumps(state), "flow.npz": frames.as_bytes()})


def can_resume(folder: Path, case: Case) -> bool:
    """Whether the folder has a checkpoint of this very run."""
    return (folder / CHECKPOINT).exists() and _identity(folder).get("key") == run_key(case).key


def _identity(folder: Path) -> dict:
    try:
        return json.loads((folder / IDENTITY).read_text())
    except (OSError, ValueError):
        return {}  # without its description a checkpoint is nobody's


def _resume(run: ResolvedRun, key: RunKey, frames: FlowFrames, folder: Path) -> float:
    """Take up the checkpoint of the same run; returns the seconds it had taken."""
    state = _identity(folder)
    if state.get("key") != key.key:
        rule = "is of another case or of another version of the code: leave --resume out to start anew"
        raise InputError(Defect(rule, file=str(folder / CHECKPOINT)))
    run.restore(folder / CHECKPOINT)
    frames.read(folder / "flow.npz")
    return float(state.get("seconds", 0.0))


def _leave(run: ResolvedRun, key: RunKey, frames: FlowFrames, folder: Path, seconds: float) -> None:
    """What a stopped run leaves: trajectory so far and, where its state is sound, a checkpoint."""
    if run.simulation.steps == 0:
        return
    with suppress(StoppedError, InputError):  # the last sound one stays
        run.check()
        _checkpoint(run, key, frames, folder, seconds)
    table = run.motion().iloc[:: run.rows_apart()][["time_s", "gap_m"]]
    with suppress(InputError):  # a full disk: the error that stopped the run is the one to show
        write_whole(folder / SO_FAR, table_text(table[np.isfinite(table).all(axis=1)]))
