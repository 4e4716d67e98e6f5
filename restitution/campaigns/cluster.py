"""Dask as the executor of a sweep: a scheduler that runs already, or one that asks SLURM for its workers.

``tcp://HOST:PORT`` is the address of a ``dask scheduler``; its workers (``dask worker tcp://HOST:PORT --nthreads
1``) must see the sweep's folder under the same path and have the same program. ``slurm:FILE`` names a TOML file
with the keywords of :class:`dask_jobqueue.SLURMCluster`, and ``jobs``, how many of them. Each job had better end
its workers before its walltime does (``worker_extra_args = ["--lifetime", "55m", "--lifetime-stagger", "4m"]``); a
run whose worker is gone goes on from its checkpoint on another one, and a job that is over is asked for anew.
"""

from __future__ import annotations

import difflib
import inspect
import logging
import shutil
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from restitution.errors import Defect, InputError
from restitution.inputs import read_toml

if TYPE_CHECKING:
    from dask_jobqueue import SLURMCluster
    from dask_jobqueue.core import JobQueueCluster
    from distributed import Client

SLURM = "slurm:"
JOBS = "jobs"
_SECONDS_TO_ANSWER = 15
_LOUD = ("distributed", "tornado", "asyncio")
_AHEAD = 2
"""Runs that each thread of a worker has, one of them waiting."""
_SECONDS_GONE = 30.0
"""After which a job none of whose workers is there any more is over; a scheduler misses one for moments too."""
_SECONDS_WITHOUT = 5.0
"""Without any worker after which that is said: one that has died may be started anew by its own nanny."""
_OURS = {"scheduler", "self", "job_cls", "loop", "asynchronous", "n_workers", "scheduler_cls", "job_kwargs"}
"""Keywords that are not the user's to give; ``jobs`` is ``n_workers`` in the words of SLURM."""


@dataclass(frozen=True)
class Engine:
    """What a driver is given: an executor, how many runs at a time, and why it is gone if it is."""

    executor: Executor
    at_once: Callable[[], int]
    lost: Callable[[], str | None]
    told: str


@contextmanager
def dask_engine(scheduler: str, say: Callable[[str], None] = lambda _: None) -> Iterator[Engine]:
    """The engine at an address, or of a file of SLURM's; raises :class:`InputError` for what cannot be had.

    ``say`` is told once each time that no worker is there any more.
    """
    _import()
    from distributed import Client

    for name in [n for n in logging.root.manager.loggerDict if n.split(".")[0] in _LOUD]:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)  # what is wrong is said by the driver, in a line
    if scheduler.startswith(SLURM):
        with slurm_cluster(scheduler.removeprefix(SLURM)) as (cluster, jobs):
            if shutil.which("sbatch") is None:  # dask-jobqueue would only log that, and wait
                rule = "there is no sbatch here: give the command where jobs are submitted (--dry-run needs none)"
                raise InputError(Defect(rule, field="--scheduler", value=scheduler))
            cluster.scale(jobs=jobs)
            with Client(cluster) as client:
                told = f"{jobs} jobs of SLURM, scheduler at {cluster.scheduler_address}"
                none = "no job of SLURM has a worker here: do they wait, or were they refused ('squeue --me')?"
                yield _engine(client, told, Renewal(cluster, jobs), _Watch(client, none, say))
        return
    try:
        client = Client(scheduler, timeout=_SECONDS_TO_ANSWER)
    except (OSError, ValueError, TypeError) as error:
        rule = f"no scheduler answers: {error or type(error).__name__}"
        raise InputError(Defect(rule, field="--scheduler", value=scheduler)) from None
    try:
        workers = client.scheduler_info()["workers"].values()
        told = f"{len(workers)} worker{'s' if len(workers) != 1 else ''} at {scheduler}"
        if any(w["nthreads"] > 1 for w in workers):
            told += "; runs share a process where a worker has several threads: start it with --nthreads 1"
        none = f"no worker at {scheduler}: start one (dask worker {scheduler} --nthreads 1), or stop by Ctrl-C"
        yield _engine(client, told, _Watch(client, none, say))
    finally:
        with suppress(OSError, TimeoutError):
            client.close(timeout=2)


@contextmanager
def slurm_cluster(file: str) -> Iterator[tuple[SLURMCluster, int]]:
    """The cluster of a TOML file, and how many jobs are asked for; none is submitted yet."""
    _import()
    from dask_jobqueue import SLURMCluster

    given = read_toml(file)
    jobs = given.pop(JOBS, 1)
    defects = [Defect("must be a whole number, 1 or above", file=file, field=JOBS, value=str(jobs))]
    defects = defects if not isinstance(jobs, int) or isinstance(jobs, bool) or jobs < 1 else []
    known = keywords()
    for name in sorted(set(given) - known):
        near = difflib.get_close_matches(name, known, n=2, cutoff=0.5)
        hint = f"did you mean {' or '.join(near)}?" if near else f"known: {JOBS}, {', '.join(sorted(known))}"
        defects.append(Defect(f"is no keyword of SLURMCluster; {hint}", file=file, field=name))
    if defects:
        raise InputError(*defects)
    try:
        cluster = SLURMCluster(**given)
    except (ValueError, TypeError, OSError) as error:
        raise InputError(
            Defect(f"is refused by dask-jobqueue: {' '.join(str(error).split())}", file=file)
        ) from None
    with cluster:
        yield cluster, jobs


def keywords() -> set[str]:
    """What :class:`dask_jobqueue.SLURMCluster` takes, as its own signatures have it."""
    _import()
    from dask_jobqueue.core import Job, JobQueueCluster
    from dask_jobqueue.slurm import SLURMJob

    found: set[str] = set()
    for kind in (SLURMJob, JobQueueCluster, Job):
        found |= {
            name for name, p in inspect.signature(kind.__init__).parameters.items() if p.kind is not p.VAR_KEYWORD
        }
    return found - _OURS


class Renewal:
    """Asks for a job anew once all its workers have come and gone, as they do at the end of its walltime.

    Of itself Dask does that for jobs of one process alone, where it scales by load (``adapt``), and never for a
    fixed number of jobs (dask-jobqueue, issue 611): a sweep longer than a walltime would wait for ever.
    """

    def __init__(self, cluster: JobQueueCluster, jobs: int):
        self.cluster, self.jobs = cluster, jobs
        self._seen: dict[object, float] = {}
        """When a worker of each job was there last."""

    def __call__(self) -> None:
        """Look which jobs are over; called now and then."""
        now = time.monotonic()
        there = {str(w["name"]) for w in self.cluster.scheduler_info["workers"].values()}
        jobs = dict(self.cluster.worker_spec)
        for name, spec in jobs.items():
            if there & {f"{name}{suffix}" for suffix in spec.get("group", [""])}:
                self._seen[name] = now
        over = [name for name in jobs if now - self._seen.get(name, now) > _SECONDS_GONE]
        if over:
            for name in over:
                del self._seen[name]
            self.cluster.sync(self.cluster.scale_down, over)
            self.cluster.scale(jobs=self.jobs)


class _Watch:
    """Says that runs wait for want of workers, which would look like runs that take long."""

    def __init__(self, client: Client, none: str, say: Callable[[str], None]):
        self.client, self.none, self.say = client, none, say
        self._since: float | None = None
        self._said = False

    def __call__(self) -> None:
        """Look whether any worker is there; called now and then."""
        with suppress(OSError, AttributeError):
            if self.client.nthreads():
                self._since, self._said = None, False
                return
        self._since = self._since or time.monotonic()
        if not self._said and time.monotonic() - self._since > _SECONDS_WITHOUT:
            self._said = True
            self.say(f"runs wait: {self.none}")


def _engine(client: Client, told: str, *looks: Callable[[], None]) -> Engine:
    address = client.scheduler.address if client.scheduler is not None else "its address"

    def at_once() -> int:
        with suppress(OSError, AttributeError):
            return max(1, _AHEAD * sum(client.nthreads().values()))
        return 1

    def lost() -> str | None:
        if client.status == "running":
            for look in looks:
                look()
            return None
        return (
            f"the scheduler at {address} is gone: what is finished is kept; start it again and give the same "
            "command, which goes on from the checkpoints"
        )

    # not pure: each submission is a run of its own, even of an equal task after a death
    return Engine(client.get_executor(pure=False), at_once, lost, told)


def _import() -> None:
    """Have the libraries loaded, and Ctrl-C as it was: dask-jobqueue makes it an exit when it is imported."""
    interrupt = signal.getsignal(signal.SIGINT)
    try:
        import dask_jobqueue  # noqa: F401
        import distributed  # noqa: F401
    except ImportError as error:
        rule = f"needs {error.name}: pip install 'restitution[cluster]'"
        raise InputError(Defect(rule, field="--scheduler")) from None
    finally:
        if threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGINT, interrupt)
