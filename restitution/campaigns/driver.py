"""From the plan to the manifest: runs are handed to an executor as it has room, and their ends are written down.

Nothing is known here of where the runs are made. Whatever stops the driver, the folder says what is finished, and
the same command goes on. The death of a worker is not its run's fault as long as the run gets further each time.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path

from restitution.campaigns.manifest import ATTEMPTS, FAILED, FINISHED, LOST, Manifest, line
from restitution.campaigns.plan import RUNS, Planned
from restitution.campaigns.run import ELSEWHERE, FULL, Outcome, Task, perform
from restitution.errors import StoppedError

_SECONDS_TO_LOOK = 1.0
_SECONDS_ELSEWHERE = 2.0
"""After which a run that another process had is asked for again."""
_DEATHS = ("KilledWorker", "WorkerLost", "ManagerLost")
"""Names of what Dask and Parsl raise where a run's worker is gone."""


@dataclass
class Progress:
    """How a sweep stands: runs over, all of them, those made now and the seconds that took, those under way."""

    over: int
    runs: int
    made: int = 0
    seconds: float = 0.0
    under_way: int = 0


def drive(
    runs: Sequence[Planned],
    folder: Path,
    executor: Executor,
    *,
    at_once: int,
    threads: int | None = None,
    lost: Callable[[], str | None] = lambda: None,
    show: Callable[[Progress], None] = lambda _: None,
    say: Callable[[str], None] = lambda _: None,
) -> Manifest:
    """Make all runs that are not over.

    Parameters
    ----------
    runs : the plan, with the cases.
    folder : of the sweep; workers must see it under the same path.
    executor : anything with the interface of :class:`concurrent.futures.Executor`.
    at_once : runs that are handed to it at a time.
    threads : of each run; None leaves that to the workers.
    lost : says why no more can come of the executor, None as long as that is not so.
    show, say : told of the progress; of what is to be known at once.

    Raises
    ------
    StoppedError : where the sweep cannot go on: no room on the disk, the executor gone. What is finished is kept.
    """
    folder = folder.resolve()
    manifest = Manifest(folder)
    todo = deque(run for run in runs if not manifest.of(run.run).over)
    progress = Progress(len(runs) - len(todo), len(runs))
    pending: dict[Future, tuple[Planned, float]] = {}
    elsewhere: list[tuple[float, Planned]] = []
    while todo or pending or elsewhere:
        manifest.refresh()
        now = time.monotonic()
        todo.extend(run for since, run in elsewhere if now - since >= _SECONDS_ELSEWHERE)
        elsewhere = [(since, run) for since, run in elsewhere if now - since < _SECONDS_ELSEWHERE]
        while todo and len(pending) < at_once:
            run = todo.popleft()
            if manifest.of(run.run).over:
                progress.over += 1  # another driver has done it
                continue
            task = Task(run.run, run.model, run.case, str(folder / RUNS / run.run), threads)
            pending[executor.submit(perform, task)] = run, _reached(folder, run.run)
        progress.under_way = len(pending)
        show(progress)
        if not pending:
            time.sleep(0.2 if elsewhere else 0.0)
            continue
        done, _ = wait(pending, timeout=_SECONDS_TO_LOOK, return_when=FIRST_COMPLETED)
        why = lost()
        if why is not None:
            raise StoppedError(why)
        ends: list[tuple[Planned, dict]] = []
        stop = None
        for future in done:
            run, before = pending.pop(future)
            outcome = _outcome(future, run, _reached(folder, run.run) > before)
            if isinstance(outcome, dict):
                ends.append((run, outcome))
            elif outcome.state == ELSEWHERE:
                elsewhere.append((time.monotonic(), run))
            elif outcome.state == FULL:
                stop = outcome.message
            else:
                ends.append((run, line(run.run, outcome.state, outcome.message, seconds=outcome.seconds)))
                progress.made += outcome.made
                progress.seconds += outcome.seconds * outcome.made
        manifest.append(entry for _, entry in ends)
        for run, entry in ends:
            standing = manifest.of(run.run)
            if standing.over:
                progress.over += 1
            else:
                todo.append(run)
            if entry["state"] != FINISHED:
                say(_said(entry, standing.over))
        if stop is not None:
            raise StoppedError(
                f"{stop}. The runs that are finished are kept; make room and give the same command again"
            )
    show(progress)
    return manifest


def _outcome(future: Future, run: Planned, further: bool) -> Outcome | dict:
    """What a future says of its run, or a line of the manifest where it says nothing."""
    try:
        return future.result()
    except (BrokenExecutor, CancelledError) as error:
        return _death(run, error, further)
    except Exception as error:  # noqa: BLE001  whatever a run raises is its end, not the sweep's
        if type(error).__name__ in _DEATHS:
            return _death(run, error, further)
        return line(run.run, FAILED, f"{type(error).__name__}: {error}")


def _death(run: Planned, error: BaseException, further: bool) -> dict:
    return line(run.run, LOST, "its worker died or was stopped", further=further)


def _said(entry: dict, over: bool) -> str:
    if entry["state"] == LOST:
        end = f"{ATTEMPTS} times without getting further: given up" if over else "goes on elsewhere"
        return f"{entry['run']}: {entry['message']}; {end}"
    end = "" if not over else f"; given up after {ATTEMPTS} attempts" if entry["state"] == FAILED else ""
    return f"{entry['run']}: {entry['state']}: {entry['message']}{end}"


def _reached(folder: Path, run: str) -> float:
    """When the run last left a checkpoint; 0 where there is none."""
    try:
        return (folder / RUNS / run / "checkpoint.h5").stat().st_mtime
    except OSError:
        return 0.0


def counts(manifest: Manifest, runs: Iterable[Planned]) -> dict[str, int]:
    """How many runs stand how."""
    found: dict[str, int] = {}
    for run in runs:
        state = manifest.of(run.run).shown
        found[state] = found.get(state, 0) + 1
    return found
