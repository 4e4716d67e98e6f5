"""From the plan to the manifest: runs are handed to an executor as it has room, and their ends are written down.

Nothing is known here of where the runs are made. Whatever stops the driver, the folder says what is finished, and
the same command goes on. The death of a worker is not its run's fault as long as the run gets further each time.
"""

from __future__ import annotations

import time
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass, replace
from pathlib import Path

from restitution.campaigns.fork import Fork, forks
from restitution.campaigns.keeping import spoiled
from restitution.campaigns.manifest import ATTEMPTS, FAILED, FINISHED, LOST, RETRY, Manifest, line
from restitution.campaigns.plan import RUNS, Planned
from restitution.campaigns.run import DEADLY, ELSEWHERE, REFUSED, STOP, Outcome, Task, perform, reached
from restitution.errors import StoppedError
from restitution.runs.record import FILE
from restitution.runs.validity.program import program_hash

_SECONDS_TO_LOOK = 1.0
_SECONDS_ELSEWHERE = 2.0
"""After which a run that another process had is asked for again."""
_SECONDS_TO_APPEAR = 20.0
_DEATHS = ("KilledWorker", "WorkerLost", "ManagerLost")
"""Names of what Dask and Parsl raise where a run's worker is gone."""
_AGAIN = "What is finished is kept: mend that, and give the same command again"
_NAMED = 4
"""Runs that a line names."""
_DIED = "its worker died or was stopped"


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
    at_once: Callable[[], int],
    threads: int | None = None,
    share: bool = True,
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
    at_once : says how many runs are handed to it at a time, now.
    threads : of each run; None leaves that to the workers.
    share : whether runs that differ in film and contact alone share their approach.
    lost : says why no more can come of the executor, None as long as that is not so.
    show, say : told of the progress; of what is to be known at once.

    Raises
    ------
    StoppedError : where the sweep cannot go on: no room on the disk, the executor gone. What is finished is kept.
    """
    folder, program, driver = folder.resolve(), program_hash(), uuid.uuid4().hex
    manifest = Manifest(folder)
    for defect in manifest.defects:
        say(f"doubt: {defect}")
    again = spoiled(folder, runs, manifest)
    if again:
        manifest.append(line(run, RETRY) for run in again)
        count = "a finished run" if len(again) == 1 else f"{len(again)} finished runs"
        say(f"results of {count} are gone or changed, made again: {', '.join(again[:_NAMED])}")
    left = [run for run in runs if not manifest.of(run.run).over]
    shared, alone = forks(left, folder, program, threads, driver) if share else ([], left)
    if shared:
        say(f"{len(left) - len(alone)} runs share {len(shared)} approach{'es' if len(shared) > 1 else ''}")

    def task(run: Planned, fork: str | None = None) -> Task:
        return Task(run.run, run.model, run.case, str(folder / RUNS / run.run), program, threads, fork, driver)

    state = _State(manifest, Progress(len(runs) - len(left), len(runs)), say)
    state.todo.extend(shared)
    state.todo.extend(map(task, alone))
    while state.todo or state.pending or state.elsewhere:
        manifest.refresh()
        state.ask_again()
        room = at_once()
        while state.todo and len(state.pending) < room:
            state.submit(executor)
        state.progress.under_way = len(state.pending)
        show(state.progress)
        if not state.pending:
            time.sleep(0.2 if state.elsewhere else 0.0)
            continue
        done, _ = wait(state.pending, timeout=_SECONDS_TO_LOOK, return_when=FIRST_COMPLETED)
        why = lost()
        if why is not None:
            raise StoppedError(why)
        state.take(done, task)
    show(state.progress)
    return manifest


class _State:
    """What is to be done, what is under way, and what has come of it."""

    def __init__(self, manifest: Manifest, progress: Progress, say: Callable[[str], None]):
        self.manifest, self.progress, self.say = manifest, progress, say
        self.todo: deque[Task | Fork] = deque()
        self.pending: dict[Future, tuple[Task | Fork, float]] = {}
        self.elsewhere: list[tuple[float, Task | Fork]] = []

    def ask_again(self) -> None:
        """Put what other processes had a while ago into the queue again."""
        now = time.monotonic()
        self.todo.extend(job for since, job in self.elsewhere if now - since >= _SECONDS_ELSEWHERE)
        self.elsewhere = [(since, job) for since, job in self.elsewhere if now - since < _SECONDS_ELSEWHERE]

    def submit(self, executor: Executor) -> None:
        """Hand the next job over, if another driver has not done it."""
        job = self.todo.popleft()
        if isinstance(job, Task) and self.manifest.of(job.run).over:
            self.progress.over += 1
            return
        asked = job.approach if isinstance(job, Fork) else job
        try:
            future = executor.submit(perform, asked)
        except RuntimeError as error:  # of which a broken executor's is one
            rule = f"{type(executor).__name__} takes no more runs: {error}"
            raise StoppedError(f"{rule}. {_AGAIN}") from None
        self.pending[future] = job, reached(Path(asked.folder))

    def take(self, done: Iterable[Future], task: Callable[..., Task]) -> None:
        """Account for jobs that have ended; raises :class:`StoppedError` where none could go on."""
        ends: list[tuple[Task, dict]] = []
        stop = None
        for future in done:
            job, before = self.pending.pop(future)
            asked = job.approach if isinstance(job, Fork) else job
            outcome = _outcome(future, asked.run)
            if outcome.state == ELSEWHERE:
                self.elsewhere.append((time.monotonic(), job))
            elif outcome.state == STOP:
                stop = outcome.message
            elif isinstance(job, Fork):
                self._branch(job, outcome, task)
            elif outcome.state == FINISHED and not _seen(job.folder):
                stop = f"{job.run} is finished, says its worker, but is not in {job.folder}: do they share it?"
            else:
                ends.append((job, _line(outcome, reached(Path(job.folder)) > before)))
                if outcome.state == FINISHED and outcome.message:
                    self.say(f"{job.run}: {outcome.message}")
                self.progress.made += outcome.made
                self.progress.seconds += outcome.seconds * outcome.made
        self.manifest.append(entry for _, entry in ends)
        for job, entry in ends:
            over = self.manifest.of(job.run).over
            if over:
                self.progress.over += 1
            else:
                self.todo.append(job)
            if entry["state"] != FINISHED:
                self.say(_said(entry, over))
        if stop is not None:
            raise StoppedError(f"{stop}. {_AGAIN}")

    def _branch(self, fork: Fork, outcome: Outcome, task: Callable[..., Task]) -> None:
        """Let the runs of an approach go on from it, or from their start where there is none."""
        if outcome.state == LOST and fork.deaths + 1 < ATTEMPTS:
            self.todo.append(replace(fork, deaths=fork.deaths + 1))
            return
        there = outcome.state == FINISHED
        if not there:
            self.say(f"the approach of {len(fork.runs)} runs: {outcome.message}; each is run from its start")
        self.todo.extendleft(task(run, str(fork.checkpoint) if there else None) for run in reversed(fork.runs))


def _outcome(future: Future, run: str) -> Outcome:
    """What a future says of its run; what it raises is the run's end, or its worker's."""
    try:
        return future.result()
    except (BrokenExecutor, CancelledError):
        return Outcome(run, LOST, _DIED)
    except Exception as error:  # noqa: BLE001  whatever a run raises is its end, not the sweep's
        if type(error).__name__ in _DEATHS:
            return Outcome(run, LOST, _DIED)
        return Outcome(run, FAILED, f"{type(error).__name__}: {error}")


def _line(outcome: Outcome, further: bool) -> dict:
    """An outcome in the words of the manifest."""
    if outcome.state == FINISHED:
        return line(outcome.run, FINISHED, seconds=outcome.seconds)
    if outcome.state == LOST:
        return line(outcome.run, LOST, outcome.message, further=further)
    if outcome.state in (REFUSED, DEADLY):
        return line(outcome.run, FAILED, outcome.message, final=True)
    return line(outcome.run, outcome.state, outcome.message)


def _said(entry: dict, over: bool) -> str:
    if entry["state"] == LOST:
        end = f"{ATTEMPTS} times without getting further: given up" if over else "goes on elsewhere"
        return f"{entry['run']}: {entry['message']}; {end}"
    tried = over and entry["state"] == FAILED and not entry.get("final")
    end = f"; given up after {ATTEMPTS} attempts" if tried else ""
    return f"{entry['run']}: {entry['state']}: {entry['message']}{end}"


def _seen(place: str) -> bool:
    """Whether a run's results are here; a network's file system may take a while to show them."""
    folder = Path(place)
    until = time.monotonic() + _SECONDS_TO_APPEAR
    while not (folder / FILE).exists():
        if time.monotonic() > until:
            return False
        time.sleep(0.2)
        if folder.is_dir():
            list(folder.iterdir())  # reading the folder makes the file system look again
    return True


def counts(manifest: Manifest, runs: Iterable[Planned]) -> dict[str, int]:
    """How many runs stand how."""
    found: dict[str, int] = {}
    for run in runs:
        state = manifest.of(run.run).shown
        found[state] = found.get(state, 0) + 1
    return found
