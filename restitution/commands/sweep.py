"""``restitution sweep``: many runs of one case with keys varied."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands.console import cell, show, show_rows
from restitution.commands.options import check_output, whole

if TYPE_CHECKING:
    from restitution.campaigns.manifest import Manifest
    from restitution.campaigns.plan import Planned

_ASKED = {
    "status": "Say how the runs of a sweep's folder stand: those not finished, each with its message, those whose "
    "results are gone or changed, and how many there are of each.",
    "retry": "Have runs that diverged, failed or were given up tried again, and finished ones whose results are "
    "gone or changed: the next 'restitution sweep SWEEP.toml --out DIR' makes them.",
    "clean": "Remove from a sweep's folder, for good: all results of runs that its plan has no more, checkpoints "
    "and parts of files of runs that are over, approaches once all runs are over. What a process is at is left.",
    "table": "Write runs.csv and impacts.csv of what a sweep's folder has by now; --speed far, contact or window: "
    "the impact speed by which impacts.csv has the impacts (far).",
}
"""What a sweep's folder is asked, and what that does."""
_SHOWN = 40
_GONE = "results gone or changed"


class _Help(argparse.Action):
    """Help on what a folder is asked, where that stands before it; else on the command."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: object,
        option: str | None = None,
    ) -> None:
        asked = getattr(namespace, "what", None)
        if asked in _ASKED:
            speed = " [--speed far|contact|window]" if asked == "table" else ""
            one = argparse.ArgumentParser(usage=f"{parser.prog} {asked} DIR{speed}", description=_ASKED[asked])
            one.add_argument("folder", metavar="DIR", help="the sweep's folder")
            parser = one
        parser.print_help()
        parser.exit()


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``sweep SWEEP.toml`` and ``sweep status|retry|clean|table DIR``."""
    parser = commands.add_parser(
        "sweep",
        add_help=False,
        help="many runs of one case with keys varied, on the processes of this machine or on a cluster",
        description="Make the runs that a sweep's file asks for, those not finished yet: the same command "
        "goes on after whatever stopped it. Or ask a sweep's folder: 'status DIR' says how its runs stand, 'retry "
        "DIR' has those that were given up tried again, 'clean DIR' removes what is not needed any more, 'table "
        "DIR' writes runs.csv and impacts.csv of what there is.",
        epilog="Each run is known by its content, so that a sweep's file may be changed: only new runs are made. "
        "Several commands may work on one folder, on machines that share it.",
    )
    parser.add_argument("-h", "--help", action=_Help, nargs=0, help="show this help message and exit")
    parser.add_argument(
        "what", metavar="SWEEP.toml", nargs="?", help="a sweep's file; or status, retry, clean, table"
    )
    parser.add_argument(
        "folder", metavar="DIR", nargs="?", help="the sweep's folder, for status, retry, clean, table"
    )
    parser.add_argument("--out", metavar="DIR", help="the sweep's folder (a folder named after the file)")
    parser.add_argument(
        "--processes", type=whole, metavar="N", help="of this machine (as many as its cores and memory allow)"
    )
    parser.add_argument("--threads", type=whole, metavar="N", default=1, help="of each process (1)")
    parser.add_argument(
        "--scheduler",
        metavar="WHERE",
        help="have Dask make the runs: the tcp://HOST:PORT of its scheduler, or slurm:FILE with the keywords of "
        "dask_jobqueue.SLURMCluster, and jobs, in TOML; have workers end before their walltime does: "
        'worker_extra_args = ["--lifetime", "55m", "--lifetime-stagger", "4m"] for an hour',
    )
    parser.add_argument(
        "--dry-run", action="store_true", help="print the script of a job of slurm:FILE; submit none"
    )
    parser.add_argument(
        "--no-forks",
        action="store_true",
        help="run each from its start, also where runs differ only in what acts from the film on (film, contact, "
        "e_dry, roughness) and could begin from one approach; the results are the same",
    )
    parser.add_argument(
        "--replace", action="store_true", help="take the place of another sweep's plan in the folder; runs stay"
    )
    parser.add_argument("--only", metavar="RUN", action="append", help="make this run alone; may be repeated")
    parser.add_argument("--list", action="store_true", help="list the runs that the file asks for; make none")
    parser.add_argument(
        "--speed",
        choices=("far", "contact", "window"),
        default="far",
        help="impact speed by which impacts.csv has the impacts (far)",
    )
    parser.add_argument("--template", metavar="FILE", help="write a sweep with every key explained, instead")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int | None:
    """Make a sweep's runs, or say how they stand."""
    from restitution.errors import Defect, InputError

    if args.template is not None:
        _write_template(Path(args.template))
        return None
    if args.what is None:
        raise InputError("name a sweep's file ('restitution sweep --template sweep.toml' writes one)")
    for name, value in (("--processes", args.processes), ("--threads", args.threads)):
        if value == 0:
            raise InputError(Defect("must be 1 or above", field=name, value="0"))
    if args.what in _ASKED:
        if args.folder is None:
            raise InputError(Defect(f"name the sweep's folder: restitution sweep {args.what} DIR", field="DIR"))
        return _ask(args.what, Path(args.folder), args.speed)
    if args.folder is not None:
        known = ", ".join(_ASKED)
        raise InputError(Defect(f"is none of {known}; a sweep's folder is given by --out", field=args.what))
    return _make(args)


def _make(args: argparse.Namespace) -> int | None:
    if not args.list and not args.dry_run and Path(args.what).is_file():
        _say(f"{args.what}: planning its runs")  # before what is slow to load
    from restitution.campaigns.design import Sweep
    from restitution.campaigns.plan import planned, read_plan
    from restitution.campaigns.progress import SweepProgress
    from restitution.campaigns.sweep import sweep
    from restitution.errors import StoppedError

    if args.list:
        _list(planned(Sweep(args.what).cases(), _say))
        return None
    if args.dry_run:
        _dry_run(args.scheduler)
        return None
    folder = Path(args.out or Path(args.what).stem)
    try:
        with SweepProgress(folder.name) as progress:
            manifest = sweep(
                args.what,
                folder,
                scheduler=args.scheduler,
                processes=args.processes,
                threads=args.threads,
                only=args.only or (),
                share=not args.no_forks,
                replace=args.replace,
                show=progress.update,
                say=progress.say,
            )
    except KeyboardInterrupt:
        _say(f"stopped; continue with: restitution sweep {args.what} --out {folder}")
        raise
    except StoppedError as error:
        _say(f"error: {error}")
        return 2
    runs = read_plan(folder)
    if args.only:
        return _end(folder, [r for r in runs if r.run in args.only], manifest)
    return _end(folder, runs, manifest)


def _dry_run(scheduler: str | None) -> None:
    from restitution.campaigns.cluster import SLURM, slurm_cluster
    from restitution.errors import Defect, InputError

    if scheduler is None or not scheduler.startswith(SLURM):
        rule = "prints the script of a job: give --scheduler slurm:FILE with it"
        raise InputError(Defect(rule, field="--dry-run"))
    with slurm_cluster(scheduler.removeprefix(SLURM)) as (cluster, jobs):
        show(f"# {jobs} of these\n{cluster.job_script()}")


def _end(folder: Path, runs: list[Planned], manifest: Manifest) -> int:
    """Say what there is; 2 where a run did not finish."""
    from restitution.campaigns.driver import counts
    from restitution.campaigns.manifest import FINISHED
    from restitution.campaigns.table import IMPACTS, TABLE

    found = counts(manifest, runs)
    tables = f"; {folder / TABLE}, {folder / IMPACTS}" if (folder / TABLE).exists() else ""
    show(_counted(found) + tables)
    return 0 if set(found) <= {FINISHED} else 2


def _ask(what: str, folder: Path, speed: str) -> int | None:
    from restitution.campaigns.keeping import clean, retry
    from restitution.campaigns.manifest import Manifest
    from restitution.campaigns.plan import read_plan
    from restitution.campaigns.table import write_tables

    runs, manifest = read_plan(folder), Manifest(folder)
    for defect in manifest.defects:
        _say(f"doubt: {defect}")
    if what == "status":
        _status(folder, runs, manifest)
    elif what == "retry":
        tried = retry(folder, runs, manifest)
        show(f"{tried} runs will be tried again by 'restitution sweep SWEEP.toml --out {folder}'")
    elif what == "clean":
        removed, size = clean(folder, runs, manifest)
        what = ", ".join(f"{count} {name}" for name, count in removed.items()) or "nothing to remove"
        show(f"{what}: {size / 1e6:.1f} MB removed" if removed else what)
    else:
        doubtful = write_tables(folder, speed)
        if doubtful:
            _say(doubtful)
        return _end(folder, runs, manifest)
    return None


def _status(folder: Path, runs: list[Planned], manifest: Manifest) -> None:
    from restitution.campaigns.driver import counts
    from restitution.campaigns.keeping import spoiled, under_way
    from restitution.campaigns.manifest import FINISHED

    at_it, gone = under_way(folder, runs, manifest), spoiled(folder, runs, manifest)
    rows = [
        (
            r.run,
            "under way" if r.run in at_it else _GONE if r.run in gone else manifest.of(r.run).shown,
            _parameters(r),
            "the next sweep makes it again" if r.run in gone else manifest.of(r.run).message,
        )
        for r in runs
        if manifest.of(r.run).state != FINISHED or r.run in gone
    ]
    if rows:
        show_rows(("run", "state", "parameters", "message"), rows[:_SHOWN])
    if len(rows) > _SHOWN:
        show(
            f"and {len(rows) - _SHOWN} more that are not finished; all runs by 'restitution sweep table {folder}'"
        )
    found = counts(manifest, runs)
    if gone:
        found |= {FINISHED: found[FINISHED] - len(gone), _GONE: len(gone)}
    show(_counted(found) + (f"; {len(at_it)} under way" if at_it else ""))


def _counted(found: dict[str, int]) -> str:
    every = sum(found.values())
    states = ", ".join(f"{n} {state}" for state, n in sorted(found.items()))
    return f"{every} run{'s' if every != 1 else ''}: {states}"


def _list(runs: list[Planned]) -> None:
    show_rows(("run", "model", "parameters"), [(r.run, r.model, _parameters(r)) for r in runs])


def _parameters(run: Planned) -> str:
    return ", ".join(f"{name} = {cell(value)}" for name, value in run.parameters.items() if value is not None)


def _write_template(target: Path) -> None:
    from restitution.campaigns.design import TEMPLATE
    from restitution.errors import Defect, InputError
    from restitution.files import write_whole

    check_output("--template", str(target))
    if target.exists():
        raise InputError(Defect("exists already; a template replaces nothing", file=str(target)))
    write_whole(target, TEMPLATE.read_text("utf-8"))
    show(f"{target}: next: restitution sweep {target} --out {target.stem}")


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)  # noqa: T201
