"""How far a run has come, kept in a checkpoint every half minute and where it is stopped."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path

import numpy as np

from restitution.errors import Defect, InputError, StoppedError
from restitution.files import write_whole
from restitution.runs.flow_pictures import FlowFrames
from restitution.runs.resolved import ResolvedRun, owner_of
from restitution.runs.results import trajectory_of
from restitution.tables.writing import table_text

SECONDS_PER_CHECKPOINT = 30.0
CHECKPOINT, SO_FAR = "checkpoint.h5", "trajectory_so_far.csv"
_SECONDS = "seconds"


class Stand:
    """State and pictures of a run, and the seconds that it took, all in the checkpoint ``path``."""

    def __init__(self, run: ResolvedRun, key: str, path: Path):
        self.run, self.key, self.path = run, key, path
        self.frames = FlowFrames()
        self._before = 0.0
        self._began = self._saved = time.perf_counter()
        self._saved_at = -1

    @property
    def seconds(self) -> float:
        """What the run has taken so far, all processes together."""
        return self._before + time.perf_counter() - self._began

    def save_now_and_then(self) -> None:
        """Write the checkpoint where the last one is long ago."""
        if time.perf_counter() - self._saved > SECONDS_PER_CHECKPOINT:
            self.save()

    def save(self) -> None:
        """Write the checkpoint."""
        self._saved = time.perf_counter()
        if self.run.simulation.steps == self._saved_at:
            return
        beside = {_SECONDS: np.array([round(self.seconds, 1)]), **self.frames.arrays()}
        self.run.save(self.path, self.key, beside)
        self._saved_at = self.run.simulation.steps

    def restore(self) -> None:
        """Take up the checkpoint; raises :class:`InputError` for one of another run."""
        if owner_of(self.path) not in (None, self.key):
            rule = "is of another case or of another version of the code: leave --resume out to start anew"
            raise InputError(Defect(rule, file=str(self.path)))
        self._take(self.path, self.run.restore(self.path, self.key))

    def fork(self, path: Path, approach: str) -> None:
        """Begin from the checkpoint of an approach; raises :class:`InputError` for one of another approach."""
        if owner_of(path) not in (None, approach):
            raise InputError(Defect("is not of an approach that this case shares", file=str(path)))
        self._take(path, self.run.fork(path, approach))

    def _take(self, path: Path, beside: dict[str, np.ndarray]) -> None:
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
            write_whole(self.path.with_name(SO_FAR), table_text(table[np.isfinite(table).all(axis=1)]))
