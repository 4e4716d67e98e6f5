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

_ASKED = ("status", "retry", "clean", "table")
_SHOWN = 40


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``sweep SWEEP.toml`` and ``sweep status|retry|clean|table DIR``."""
    parser = commands.add_parser(
        "sweep",
        help="many runs of one case with keys varied, on the processes of this machine or on a cluster",
        description="Make the runs that a sweep's file asks for, those not finished yet: the same command "
        "goes on after whatever stopped it. Or ask a sweep's folder: 'status DIR' says how its runs stand, 'retry "
        "DIR' has those that were given up tried again, 'clean DIR' removes what is not needed any more, 'table "
        "DIR' writes runs.csv and impacts.csv of what there is.",
        epilog="Each run is known by its content, so that a sweep's file may be changed: only new runs are made. "
        "Several commands may work on one folder, on machines that share it.",
    )
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
    if args.what in _ASKED:
        if args.folder is None:
            raise InputError(Defect(f"name the sweep's folder: restitution sweep {args.what} DIR", field="DIR"))
        return _ask(args.what, Path(args.folder), args.speed)
    if args.folder is not None:
        known = ", ".join(_ASKED)
        raise InputError(Defect(f"is none of {known}; a sweep's folder is given by --out", field=args.what))
    return _make(args)


def _make(args: argparse.Namespace) -> int | None:
    from restitution.campaigns.design import Sweep
    from restitution.campaigns.driver import drive
    from restitution.campaigns.plan import planned, write_plan
    from restitution.campaigns.processes import LocalProcesses
    from restitution.campaigns.progress import SweepProgress
    from restitution.campaigns.share import shared_out
    from restitution.campaigns.table import write_tables
    from restitution.errors import Defect, InputError, StoppedError
    from restitution.files import check_folder

    sweep = Sweep(args.what)
    runs = planned(sweep.cases(), _say)
    if args.list:
        _list(runs)
        return None
    if args.only:
        unknown = set(args.only) - {r.run for r in runs}
        if unknown:
            raise InputError(
                Defect("is no run of this sweep (--list names them)", field="--only", value=min(unknown))
            )
    folder = Path(args.out or Path(args.what).stem)
    check_folder(folder)
    write_plan(folder, runs)
    wanted = [r for r in runs if not args.only or r.run in args.only]
    processes, told = shared_out(wanted, args.processes, args.threads)
    _say(f"{len(wanted)} runs in {folder}: {told}")
    executor = LocalProcesses(processes, args.threads)
    try:
        with SweepProgress(folder.name) as progress:
            manifest = drive(
                wanted,
                folder,
                executor,
                at_once=processes,
                threads=args.threads,
                show=progress.update,
                say=progress.say,
            )
    except KeyboardInterrupt:
        executor.interrupt()
        executor.shutdown(cancel_futures=True)
        _say(f"stopped; continue with: restitution sweep {args.what} --out {folder}")
        raise
    except StoppedError as error:
        executor.interrupt()
        executor.shutdown(cancel_futures=True)
        _say(f"error: {error}")
        return 2
    executor.shutdown()
    if args.only:
        return None
    write_tables(folder, args.speed)
    return _end(folder, runs, manifest)


def _end(folder: Path, runs: list[Planned], manifest: Manifest) -> int:
    """Say what there is; 2 where a run did not finish."""
    from restitution.campaigns.driver import counts
    from restitution.campaigns.manifest import FINISHED
    from restitution.campaigns.table import IMPACTS, TABLE

    found = counts(manifest, runs)
    show(f"{_counted(found)}; {folder / TABLE}, {folder / IMPACTS}")
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
        removed = clean(folder, runs, manifest)
        show(f"{removed / 1e6:.1f} MB removed")
    else:
        write_tables(folder, speed)
        return _end(folder, runs, manifest)
    return None


def _status(folder: Path, runs: list[Planned], manifest: Manifest) -> None:
    from restitution.campaigns.driver import counts
    from restitution.campaigns.keeping import under_way
    from restitution.campaigns.manifest import FINISHED

    at_it = under_way(folder, runs, manifest)
    rows = [
        (
            r.run,
            "under way" if r.run in at_it else manifest.of(r.run).shown,
            _parameters(r),
            manifest.of(r.run).message,
        )
        for r in runs
        if manifest.of(r.run).state != FINISHED
    ]
    if rows:
        show_rows(("run", "state", "parameters", "message"), rows[:_SHOWN])
    if len(rows) > _SHOWN:
        show(
            f"and {len(rows) - _SHOWN} more that are not finished; all runs by 'restitution sweep table {folder}'"
        )
    show(_counted(counts(manifest, runs)) + (f"; {len(at_it)} under way" if at_it else ""))


def _counted(found: dict[str, int]) -> str:
    return f"{sum(found.values())} runs: " + ", ".join(f"{n} {state}" for state, n in sorted(found.items()))


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
