"""A sweep from its file to its tables, on the processes of this machine or on any executor that is given."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path

from restitution.campaigns.cluster import Engine, dask_engine
from restitution.campaigns.design import Sweep
from restitution.campaigns.driver import Progress, drive
from restitution.campaigns.manifest import Manifest
from restitution.campaigns.plan import Planned, planned, replaced, write_plan
from restitution.campaigns.processes import LocalProcesses
from restitution.campaigns.share import shared_out
from restitution.campaigns.table import write_tables
from restitution.errors import Defect, InputError
from restitution.files import check_folder

_AT_ONCE = 64
"""Runs that are handed at a time to an executor that does not say how many it makes at once."""


def sweep(
    file: str | Path,
    folder: str | Path,
    *,
    executor: Executor | None = None,
    at_once: int | None = None,
    scheduler: str | None = None,
    processes: int | None = None,
    threads: int = 1,
    only: Collection[str] = (),
    share: bool = True,
    replace: bool = False,
    show: Callable[[Progress], None] = lambda _: None,
    say: Callable[[str], None] = lambda _: None,
) -> Manifest:
    """Make the runs of a sweep that are not finished yet, and write its tables.

    Parameters
    ----------
    file : the sweep's TOML file.
    folder : where runs, manifest and tables go; made if need be.
    executor : what makes the runs, anything with the interface of :class:`concurrent.futures.Executor` whose
        workers see the folder under the same path: ``mpi4py.futures.MPIPoolExecutor()``, a
        ``parsl.concurrent.ParslPoolExecutor``. It is not shut down. By default processes of this machine.
    at_once : runs that are handed to ``executor`` at a time.
    scheduler : ``tcp://...`` or ``slurm:FILE`` in place of that (:mod:`restitution.campaigns.cluster`).
    processes, threads : of this machine, and of each run; by default as many as cores and memory allow, of one.
    share : whether runs that differ in film and contact alone share their approach; results are the same.
    replace : whether the folder may be that of another study, whose plan this one takes the place of.
    only : names of the runs that are made; the tables are not written then.
    show, say : told how the sweep stands, and lines that are to be known.

    Raises
    ------
    InputError : for a sweep that cannot be made, before any run.
    StoppedError : where it cannot go on; the same call does, later. Ctrl-C is raised again once the runs have left
        their checkpoints.
    """
    folder = Path(folder)
    runs = planned(Sweep(file).cases(), say)
    wanted = [run for run in runs if not only or run.run in only]
    unknown = set(only) - {run.run for run in runs}
    if unknown:
        raise InputError(Defect("is no run of this sweep", file=str(file), field="--only", value=min(unknown)))
    check_folder(folder)
    gone = replaced(folder, runs, replace)
    if gone:
        say(gone)
    if executor is not None:
        most = at_once or getattr(executor, "_max_workers", None) or _AT_ONCE
        given = Engine(executor, lambda: most, lambda: None, f"{type(executor).__name__}, {most} at a time")
        return _drive(given, runs, wanted, folder, None, share, show, say)
    with _local(wanted, processes, threads) if scheduler is None else dask_engine(scheduler, say) as engine:
        return _drive(engine, runs, wanted, folder, threads, share, show, say)


def _drive(
    engine: Engine,
    runs: list[Planned],
    wanted: list[Planned],
    folder: Path,
    threads: int | None,
    share: bool,
    show: Callable[[Progress], None],
    say: Callable[[str], None],
) -> Manifest:
    write_plan(folder, runs)
    say(f"{len(wanted)} run{'s' if len(wanted) != 1 else ''} in {folder}: {engine.told}")
    manifest = drive(
        wanted,
        folder,
        engine.executor,
        at_once=engine.at_once,
        threads=threads,
        share=share,
        lost=engine.lost,
        show=show,
        say=say,
    )
    if len(wanted) == len(runs):
        doubtful = write_tables(folder)
        if doubtful:
            say(doubtful)
    return manifest


@contextmanager
def _local(wanted: list[Planned], processes: int | None, threads: int) -> Iterator[Engine]:
    """Processes of this machine; whatever stops the driver, they leave checkpoints and end."""
    count, told = shared_out(wanted, processes, threads)
    executor = LocalProcesses(count, threads)
    try:
        yield Engine(executor, lambda: count, lambda: None, told)
        executor.shutdown()  # within: an interrupt that comes only now has the processes end too
    except BaseException:
        executor.interrupt()
        executor.shutdown(cancel_futures=True)
        raise
