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

import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from restitution.cases.case import Case
from restitution.errors import Defect, InputError, StoppedError
from restitution.files import write_folder, write_whole
from restitution.locks import sole_writer
from restitution.runs.flow_pictures import FlowFrames
from restitution.runs.progress import RunProgress
from restitution.runs.resolved import ResolvedRun, owner_of
from restitution.runs.results import results, trajectory_of
from restitution.runs.validity import physics
from restitution.runs.validity.key import checkpoint_key
from restitution.tables.writing import table_text

SECONDS_PER_CHECKPOINT = 30.0
CHECKPOINT, SO_FAR = "checkpoint.h5", "trajectory_so_far.csv"
_SECONDS = "seconds"
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
        progress = _Stand(run, key, folder)
        if resume and (folder / CHECKPOINT).exists():
            progress.restore()
            say(f"continues at t = {run.time_s:.4g} s")
        else:
            if resume:
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
                    if time.perf_counter() - progress.saved > SECONDS_PER_CHECKPOINT:
                        progress.save()
            progress.save()  # whatever becomes of the tables, the run need not be made again
            write_folder(folder, results(run, progress.frames, progress.seconds, every_step))
        except BaseException:
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


class _Stand:
    """How far a run has come: its state and pictures, and the seconds that it took, all in one checkpoint."""

    def __init__(self, run: ResolvedRun, key: str, folder: Path):
        self.run, self.key, self.folder = run, key, folder
        self.frames = FlowFrames()
        self._before = 0.0
        self._began = self.saved = time.perf_counter()
        self._saved_at = -1

    @property
    def seconds(self) -> float:
        """What the run has taken so far, all processes together."""
        return self._before + time.perf_counter() - self._began

    def save(self) -> None:
        """Write the checkpoint."""
        self.saved = time.perf_counter()
        if self.run.simulation.steps == self._saved_at:
            return
        beside = {_SECONDS: np.array([round(self.seconds, 1)]), **self.frames.arrays()}
        self.run.save(self.folder / CHECKPOINT, self.key, beside)
        self._saved_at = self.run.simulation.steps

    def restore(self) -> None:
        """Take up the checkpoint in the folder; raises :class:`InputError` for one of another run."""
        path = self.folder / CHECKPOINT
        if owner_of(path) not in (None, self.key):
            rule = "is of another case or of another version of the code: leave --resume out to start anew"
            raise InputError(Defect(rule, file=str(path)))
        beside = self.run.restore(path, self.key)
        try:
            self._before = float(beside[_SECONDS][0])
            self.frames.take(beside)
            if self.run.is_due:  # stopped after the last step of a block, before it was looked at
                self.frames.look(self.run)
        except (KeyError, IndexError, ValueError, TypeError):
            rule = "is damaged: the pictures of the flow are not those of a run; start anew"
            raise InputError(Defect(rule, file=str(path))) from None

    def leave(self) -> None:
        """What a stopped run leaves: trajectory so far and, where its state is sound, a checkpoint."""
        if self.run.simulation.steps == 0:
            return
        with suppress(StoppedError, InputError):  # the last sound one stays
            self.run.check()
            self.save()
        table = trajectory_of(self.run)
        with suppress(InputError):  # a full disk: the error that stopped the run is the one to show
            write_whole(self.folder / SO_FAR, table_text(table[np.isfinite(table).all(axis=1)]))
