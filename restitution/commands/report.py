"""``restitution report``: regenerate a comparison report."""

from __future__ import annotations

import argparse
from pathlib import Path

from restitution.commands.console import show


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``report fig1``, ``report fig2``, ``report all`` and ``report export``."""
    parser = commands.add_parser(
        "report", help="regenerate a comparison report", description="Comparison reports."
    )
    reports = parser.add_subparsers(dest="report", required=True, metavar="REPORT")
    add = reports.add_parser("fig1", help="e_eff/e_dry against the Stokes number: measured impacts and laws")
    add.add_argument(
        "--speed",
        choices=("far", "contact", "window"),
        default="contact",
        help="which impact speed the figure takes (contact); the tables have all three",
    )
    add.add_argument("--out", metavar="FOLDER", default="reports/fig1", help="where to write it (reports/fig1)")
    _add_runs(add)
    _add_rebounds(add)
    add.set_defaults(run=run_fig1)

    add = reports.add_parser(
        "fig2",
        help="the bouncing sphere in time: simulated and measured",
        description="Simulated and measured trajectories. Runs of the figure that are missing or stale are made "
        "first (minutes), unchanged ones are not repeated; stopped ones are continued. Runs of your own cases "
        "(simulate CASE --out reports/runs/NAME) are scored beside them.",
    )
    add.add_argument("--out", metavar="FOLDER", default="reports/fig2", help="where to write it (reports/fig2)")
    _add_making(add)
    add.set_defaults(run=run_fig2)

    add = reports.add_parser(
        "export",
        help="e asked and e delivered by LAMMPS, LIGGGHTS and YADE, of an exported law",
        description="e asked and e delivered of an exported law, from the kept table delivered.csv in the folder.",
    )
    add.add_argument(
        "--out", metavar="FOLDER", default="reports/export", help="where it is kept and written (reports/export)"
    )
    add.add_argument(
        "--measure", action="store_true", help="first run the programs that are installed, and keep what they give"
    )
    add.set_defaults(run=run_export)

    add = reports.add_parser(
        "all",
        help="both reports, fig2 first",
        description="Both reports at once: what they share is computed once.",
    )
    add.add_argument("--out", metavar="FOLDER", default="reports", help="where to write fig1/ and fig2/ (reports)")
    _add_making(add)
    _add_rebounds(add)
    add.set_defaults(run=run_all)


def _add_making(add: argparse.ArgumentParser) -> None:
    """Which runs are made first, and what is shown beside them."""
    add.add_argument(
        "--full", action="store_true", help="make all shipped cases, not those of the figure alone (hours)"
    )
    add.add_argument("--fresh", action="store_true", help="repeat runs that have not changed")
    add.add_argument(
        "--checks",
        metavar="FILE",
        help="verification to show (benchmarks/sphere.json, if there is one)",
    )
    _add_runs(add)


def _add_runs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--runs",
        metavar="FOLDER",
        default="reports/runs",
        help="where results of simulations are kept (reports/runs)",
    )


def _add_rebounds(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--rebounds",
        metavar="FILE",
        help="simulated rebounds to show and fit (reports/rebounds/rebounds.csv, if there is one)",
    )


def run_fig1(args: argparse.Namespace) -> None:
    """Write the Fig. 1 report and name its files."""
    from restitution.errors import Defect, InputError
    from restitution.report.fig1 import report
    from restitution.report.fig1.rebounds import FILE
    from restitution.stokes import Speed

    if not args.out:
        raise InputError(Defect("names no folder", field="--out"))
    simulated = args.rebounds
    if simulated is None and Path(FILE).is_file():
        simulated = FILE
    for name in report.write(args.out, Speed(args.speed), args.runs, simulated):
        show(str(Path(args.out) / name))


def run_export(args: argparse.Namespace) -> None:
    """Write the report of e asked and delivered and name its files."""
    import sys

    from restitution.errors import Defect, InputError
    from restitution.report.delivered import report

    if not args.out:
        raise InputError(Defect("names no folder", field="--out"))

    def say(text: str) -> None:
        print(text, file=sys.stderr)  # noqa: T201

    for name in report.write(args.out, args.measure, say):
        show(str(Path(args.out) / name))


def run_all(args: argparse.Namespace) -> int:
    """Write both reports into folders within ``--out``; status 2 where a run stopped in error."""
    from restitution.errors import Defect, InputError

    if not args.out:
        raise InputError(Defect("names no folder", field="--out"))
    both, place = vars(args), Path(args.out)
    status = run_fig2(argparse.Namespace(**both | {"out": str(place / "fig2")}))
    run_fig1(argparse.Namespace(**both | {"out": str(place / "fig1"), "speed": "contact"}))
    return status


def run_fig2(args: argparse.Namespace) -> int:
    """Write the Fig. 2 report and name its files; status 2 where a run stopped in error."""
    import sys

    from restitution.errors import Defect, InputError
    from restitution.files import check_folder
    from restitution.report.fig2 import report
    from restitution.report.fig2.content import VERIFICATION

    for option in ("out", "runs"):  # before runs are made that take minutes
        if not getattr(args, option):
            raise InputError(Defect("names no folder", field=f"--{option}"))
    check_folder(args.out)
    if not Path(args.runs).is_dir():  # one that is there may be read-only: nothing need be made
        check_folder(args.runs)

    def say(text: str) -> None:
        print(text, file=sys.stderr)  # noqa: T201

    checks = args.checks
    if checks is None and Path(VERIFICATION).is_file():
        checks = VERIFICATION
    names, failed = report.write(args.out, args.runs, checks, args.full, args.fresh, say)
    for name in names:
        show(str(Path(args.out) / name))
    for case, why in failed.items():
        say(f"error: {case}: {why}")
    return 2 if failed else 0
