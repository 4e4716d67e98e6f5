"""Running a case: progress, checkpoints, resuming, and a folder of tables in the schemas of the measured data.

==================  =====================================================================================
file                content
==================  =====================================================================================
``trajectory.csv``  time from the first contact and gap, in the schema of the measured trajectories
``velocity.csv``    the same rows as velocity, in the schema of the measured settling velocities
``impacts.csv``     impacts by :func:`restitution.impacts.find_impacts` under its three definitions of speed
``run.json``        numbers of the run, what the solver was told, the contacts as it had them, notes
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

import numpy as np

from restitution.cases.case import Case
from restitution.errors import Defect, InputError, StoppedError
from restitution.files import write_folder, write_whole
from restitution.runs.flow_pictures import FlowFrames
from restitution.runs.progress import RunProgress
from restitution.runs.resolved import ResolvedRun
from restitution.runs.results import results, trajectory_of
from restitution.runs.validity import physics
from restitution.runs.validity.key import checkpoint_key
from restitution.tables.writing import table_text

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
) -> None:
    """Run a case with the flow resolved and write its results; the files are those of the table above.

    Parameters
    ----------
    case : what is run; it needs ``[numerics]``.
    folder : where the results go; made if need be.
    resume : continue from the checkpoint in the folder, if it has one; that of another run is refused.
    snapshots : write the flow for ParaView as well, every ``run.snapshot_interval``.
    every_step : write ``motion.csv`` too, a row a step.
    show : called with each line to be said; None for silence.
    file : name of the case's file, for errors.

    Raises
    ------
    InputError : for a case that cannot be run, or a checkpoint that is not its own.
    StoppedError : for a run that diverges or cannot write. Ctrl-C is raised again once the checkpoint is written.
    """
    folder = Path(folder)
    run, key = ResolvedRun(case, file), checkpoint_key(case)
    physics.departures(show)  # asked before the run, where the answer may take a moment
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
        write_folder(folder, {IDENTITY: json.dumps({"key": key, "seconds": spent})})
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
    contents = results(run, frames, seconds)
    if every_step:
        contents["motion.csv"] = table_text(run.motion(), "%.7g")
    write_folder(folder, contents)
    for name in (CHECKPOINT, IDENTITY, SO_FAR):
        (folder / name).unlink(missing_ok=True)


def _checkpoint(run: ResolvedRun, key: str, frames: FlowFrames, folder: Path, seconds: float) -> None:
    run.save(folder / CHECKPOINT)
    state = {"key": key, "steps": run.simulation.steps, "seconds": round(seconds, 1)}
    write_folder(folder, {IDENTITY: json.dumps(state), "flow.npz": frames.as_bytes()})


def can_resume(folder: Path, case: Case) -> bool:
    """Whether the folder has a checkpoint of this very run."""
    return (folder / CHECKPOINT).exists() and _identity(folder).get("key") == checkpoint_key(case)


def _identity(folder: Path) -> dict:
    try:
        return json.loads((folder / IDENTITY).read_text())
    except (OSError, ValueError):
        return {}  # without its description a checkpoint is nobody's


def _resume(run: ResolvedRun, key: str, frames: FlowFrames, folder: Path) -> float:
    """Take up the checkpoint of the same run; returns the seconds it had taken."""
    state = _identity(folder)
    if state.get("key") != key:
        rule = "is of another case or of another version of the code: leave --resume out to start anew"
        raise InputError(Defect(rule, file=str(folder / CHECKPOINT)))
    run.restore(folder / CHECKPOINT)
    frames.read(folder / "flow.npz")
    return float(state.get("seconds", 0.0))


def _leave(run: ResolvedRun, key: str, frames: FlowFrames, folder: Path, seconds: float) -> None:
    """What a stopped run leaves: trajectory so far and, where its state is sound, a checkpoint."""
    if run.simulation.steps == 0:
        return
    with suppress(StoppedError, InputError):  # the last sound one stays
        run.check()
        _checkpoint(run, key, frames, folder, seconds)
    table = trajectory_of(run)
    with suppress(InputError):  # a full disk: the error that stopped the run is the one to show
        write_whole(folder / SO_FAR, table_text(table[np.isfinite(table).all(axis=1)]))
