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
continues it, and ends with the same files bit for bit, but for date and seconds in ``run.json``. Files appear
whole or not at all; two processes do not write to one folder.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from restitution.cases.case import Case
from restitution.errors import StoppedError
from restitution.files import write_folder
from restitution.locks import interrupts_put_off, sole_writer
from restitution.runs.progress import RunProgress
from restitution.runs.resolved import ResolvedRun, owner_of
from restitution.runs.results import results
from restitution.runs.stand import CHECKPOINT, SO_FAR, Stand
from restitution.runs.validity import physics
from restitution.runs.validity.key import approach_key, checkpoint_key

KEPT = ("trajectory.csv", "velocity.csv", "impacts.csv", "run.json", "flow.npz")


def simulate(
    case: Case,
    folder: str | Path,
    *,
    resume: bool = False,
    fork: Path | None = None,
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
    fork : the checkpoint of an approach (:mod:`restitution.runs.approach`) that a run with nothing of its own to
        continue begins from, in place of the release; that of another approach is refused.
    snapshots : write the flow for ParaView as well, every ``run.snapshot_interval``.
    every_step : write ``motion.csv`` too, a row a step.
    show : called with each line to be said; None for silence.
    file : name of the case's file, for errors.

    Raises
    ------
    InputError : for a case that cannot be run, a checkpoint that is not its own, a folder another process has.
    StoppedError : for a run that diverges, cannot write or never reaches the wall. Ctrl-C is raised again once the
        checkpoint is written.
    """
    folder = Path(folder)
    run, key = ResolvedRun(case, file), checkpoint_key(case)
    physics.departures(show)  # asked before the run, where the answer may take a moment
    say = show or (lambda _: None)
    for warning in run.warnings:
        say(f"warning: {warning}")
    write_folder(folder, {})
    with sole_writer(folder):
        progress = Stand(run, key, folder / CHECKPOINT)
        if resume and (folder / CHECKPOINT).exists():
            progress.restore()
            say(f"continues at t = {run.time_s:.4g} s")
        else:
            if fork is not None:
                progress.fork(fork, approach_key(case))
                say(f"starts from {fork} at t = {run.time_s:.4g} s")
            elif resume:
                say(f"{folder} has no checkpoint: starts anew")
            (folder / CHECKPOINT).unlink(missing_ok=True)  # of a run that is given up
        try:
            observers = (run.snapshots(folder),) if snapshots else ()
            with RunProgress(case.name, run.cells, show is not None) as shown:
                while not run.finished:
                    before = run.simulation.steps
                    run.advance(observers)
                    progress.frames.look(run)
                    shown.update(run.simulation.steps - before, run.time_s, run.expected_s, run.gap_d)
                    progress.save_now_and_then()
            progress.save()  # whatever becomes of the tables, the run need not be made again
            write_folder(folder, results(run, progress.frames, progress.seconds, every_step))
        except BaseException:
            with interrupts_put_off():  # who presses Ctrl-C twice still wants to go on
                progress.leave()
            raise
        for name in (CHECKPOINT, SO_FAR):
            (folder / name).unlink(missing_ok=True)
    if run.gave_up:
        raise StoppedError(
            f"the sphere did not reach the wall within {run.time_s:.3g} s, several times the fall at "
            f"the reference speed; it is {run.gap_d:.3g} d above it. The tables in {folder} end there"
        )


def can_resume(folder: Path, case: Case) -> bool:
    """Whether the folder has a checkpoint of this very run."""
    return (folder / CHECKPOINT).exists() and owner_of(folder / CHECKPOINT) == checkpoint_key(case)
