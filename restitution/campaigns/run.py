"""One run of a sweep: a plain function of a task that any executor can send anywhere the folder is.

What is there already decides what is done: finished results are kept, a checkpoint is continued, a checkpoint that
cannot be read is put aside for a start anew. One process at a time has the folder of a run. Beginnings that came
to no end are counted there: an executor may start a run again by itself where its worker died, and one that kills
each of them is to be given up, not the workers.
"""

from __future__ import annotations

import errno
import json
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from restitution.campaigns.manifest import ATTEMPTS, DIVERGED, FAILED, FINISHED
from restitution.cases.case import Case
from restitution.errors import DivergedError, InputError, StoppedError
from restitution.locks import HeldError, sole_writer
from restitution.runs.record import POINT_PARTICLE, changed_files, read_record
from restitution.runs.validity.program import program_hash

CLAIM = ".claimed"
"""File in a run's folder that the process has which is at it."""
BEGUN = ".begun"
"""File in a run's folder while a process is at it: for which driver, how far it had come, beginnings since."""
ELSEWHERE, STOP, REFUSED, DEADLY = "elsewhere", "stop", "refused", "deadly"
"""Outcomes beside the manifest's: another process is at it; no run could go on here; the case cannot be run; each
worker that was at it has died."""
_NO_ROOM = tuple(os.strerror(number) for number in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG))


@dataclass(frozen=True)
class Task:
    """A run to be made: by ``model``, into ``folder``, by so many ``threads``, None leaving that to the solver."""

    run: str
    model: str
    case: Case
    folder: str
    program: str
    """Hash of the driver's program: results of another one would not be what the plan's keys stand for."""
    threads: int | None = None
    fork: str | None = None
    """Checkpoint of an approach that the run may begin from."""
    driver: str = ""
    """Whose task it is: deaths under another driver are not counted, it may have been stopped with its workers."""


@dataclass(frozen=True)
class Approach:
    """An approach to be run once: that of ``case``, to above the ``edge`` in diameters; ``run`` is its name."""

    run: str
    case: Case
    edge: float
    folder: str
    program: str
    threads: int | None = None
    driver: str = ""


@dataclass(frozen=True)
class Outcome:
    """What has become of a task; ``seconds`` are those that the run took, all its processes together."""

    run: str
    state: str
    message: str = ""
    seconds: float = 0.0
    made: bool = True
    """Whether it was made now; else it was found finished."""


def perform(task: Task | Approach) -> Outcome:
    """Make a run or an approach, or go on with it; its files are on the disk when this returns."""
    if task.threads is not None and "numba" not in sys.modules:
        os.environ["NUMBA_NUM_THREADS"] = str(task.threads)
    if task.program != program_hash():
        rule = f"the worker's program is {program_hash()}, the driver's {task.program}: they must be the same"
        return Outcome(task.run, STOP, rule)
    folder = Path(task.folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with sole_writer(folder, CLAIM):
            found = None if isinstance(task, Approach) else seconds_of(folder)
            if found is not None:
                return Outcome(task.run, FINISHED, seconds=found, made=False)
            with _counted(folder, task.driver) as deaths:
                if deaths >= ATTEMPTS:
                    rule = f"each worker that was at it died, {deaths} times without getting further: given up"
                    return Outcome(task.run, DEADLY, rule)
                if isinstance(task, Approach):
                    return _approach(task, folder)
                remark = _make(task, folder)
                _to_disk(folder)
            return Outcome(task.run, FINISHED, remark, seconds=seconds_of(folder) or 0.0)
    except HeldError as error:
        return Outcome(task.run, ELSEWHERE, str(error))
    except DivergedError as error:
        return Outcome(task.run, DIVERGED, str(error))
    except (InputError, StoppedError, OSError) as error:
        message = str(error).replace("\n", "; ").replace(f"{task.run}: ", "")
        if any(text in message for text in _NO_ROOM):
            return Outcome(task.run, STOP, message)
        return Outcome(task.run, REFUSED if isinstance(error, InputError) else FAILED, message)


@contextmanager
def _counted(folder: Path, driver: str) -> Iterator[int]:
    """Deaths in a row within this run under this driver, without getting further; what follows may be one."""
    path, now = folder / BEGUN, [driver, reached(folder)]
    try:
        whose, far, deaths = json.loads(path.read_text())
    except (OSError, ValueError, TypeError):
        whose, far, deaths = "", 0.0, 0
    deaths = deaths if [whose, far] == now else 0
    path.write_text(json.dumps([*now, deaths + 1]))
    try:
        yield deaths
    finally:
        path.unlink(missing_ok=True)


def reached(folder: Path) -> float:
    """When a run last left a checkpoint; 0 where there is none."""
    try:
        return (folder / "checkpoint.h5").stat().st_mtime
    except OSError:
        return 0.0


def seconds_of(folder: Path) -> float | None:
    """Seconds of the finished run in a folder, if its files are as they were written; None where there is none."""
    try:
        record = read_record(folder)
    except InputError:
        return None
    if record is None or not record.files or changed_files(folder, record, record.files):
        return None
    return record.seconds


def _make(task: Task, folder: Path) -> str:
    """Make the run; what is to be said of how."""
    if task.model == POINT_PARTICLE:
        _predict(task.case, folder)
        return ""
    from restitution.runs.simulate import CHECKPOINT, can_resume, simulate

    if can_resume(folder, task.case):
        try:
            simulate(task.case, folder, resume=True, every_step=False)
            return ""
        except HeldError:
            raise
        except InputError:  # one that can be told whose it is, but not be read on
            (folder / CHECKPOINT).unlink(missing_ok=True)
    remark = ""
    if task.fork is not None:
        try:
            simulate(task.case, folder, every_step=False, fork=Path(task.fork))
            return ""
        except HeldError:
            raise
        except InputError as error:  # the whole way gives the same
            remark = f"cannot begin from its approach: {str(error).splitlines()[0]}"
    simulate(task.case, folder, every_step=False)
    return remark


def _approach(task: Approach, folder: Path) -> Outcome:
    from restitution.runs.approach import run_approach

    began = time.perf_counter()
    if not run_approach(task.case, task.edge, folder):
        return Outcome(
            task.run, FAILED, "it is released too near to the wall, or too fast for its reference speed"
        )
    _to_disk(folder)
    return Outcome(task.run, FINISHED, seconds=time.perf_counter() - began)


def _predict(case: Case, folder: Path) -> None:
    from restitution.bounce import IntegrationError
    from restitution.runs.point_particle import predict, write

    began = time.perf_counter()
    try:
        prediction = predict(case)
    except IntegrationError as error:
        raise StoppedError(str(error)) from None
    write(prediction, folder, time.perf_counter() - began)


def _to_disk(folder: Path) -> None:
    """What was written is on the disk, whatever happens to the machine: files, then their names."""
    for place in (*(p for p in folder.iterdir() if p.is_file() and p.name not in (CLAIM, BEGUN)), folder):
        number = os.open(place, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
