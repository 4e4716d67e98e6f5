"""``restitution simulate``: run a case with the resolved solver."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands.cases import run_list
from restitution.commands.console import doubt_aside, show, show_doubts

if TYPE_CHECKING:
    from restitution.cases.case import Case


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``simulate CASE``."""
    parser = commands.add_parser(
        "simulate",
        help="run a case: a sphere that falls, meets the wall and rebounds, with the flow resolved",
        description="Run a case with the lattice-Boltzmann solver. Writes trajectory.csv, velocity.csv and "
        "impacts.csv in the schemas of the measured data, motion.csv with every step, and run.json. Ctrl-C stops "
        "between two steps and leaves a checkpoint.",
    )
    parser.add_argument(
        "case", metavar="CASE", nargs="?", help="a TOML file, or the name of a shipped case (see --list)"
    )
    parser.add_argument(
        "--out", metavar="FOLDER", help="where to write the results (a folder named after the case)"
    )
    parser.add_argument(
        "--calibrated",
        metavar="SOLVER.json",
        help="take the values that calibrate-solver recommends for the case's cells per diameter, in place of the "
        "case's own",
    )
    parser.add_argument("--resume", action="store_true", help="continue from the checkpoint in the folder, if any")
    parser.add_argument(
        "--snapshots", action="store_true", help="also write the flow as VTKHDF files for ParaView"
    )
    parser.add_argument("--list", action="store_true", help="list the shipped cases, as 'cases list' does")
    parser.add_argument(
        "--template",
        metavar="FILE",
        help="write a case to FILE to start from, instead of running it: a copy of CASE, or an example with every "
        "key explained",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int | None:
    """Run a case and say what came out."""
    import sys

    from restitution.cases.reading import TEMPLATE, find, read_case
    from restitution.commands.results import folder_for
    from restitution.errors import InputError, StoppedError
    from restitution.runs.record import RESOLVED
    from restitution.runs.simulate import CHECKPOINT, SO_FAR, simulate

    if args.calibrated is not None and (args.list or args.template is not None):
        raise InputError("--calibrated changes a run, it has no effect on --list and --template")
    if args.list:
        run_list(args)
        return None
    if args.template is not None and not args.case:
        _write_template(TEMPLATE, Path(args.template))
        return None
    if not args.case:
        raise InputError("name a case: a TOML file or a shipped one ('restitution simulate --list')")
    case = read_case(args.case)
    if args.template is not None:
        _write_template(find(args.case), Path(args.template))
        return None
    if args.calibrated is not None:
        case = _calibrated(args)
    doubt_aside(case.conditions, args.case)
    folder = folder_for(args.out, case.name, RESOLVED)

    def say(text: str) -> None:
        print(text, file=sys.stderr)  # noqa: T201

    try:
        simulate(case, folder, resume=args.resume, snapshots=args.snapshots, show=say, file=args.case)
    except StoppedError as error:
        left = folder / SO_FAR
        say(f"error: {error}" + (f"; the trajectory so far is in {left}" if left.exists() else ""))
        return 2
    except KeyboardInterrupt:
        if (folder / CHECKPOINT).exists():
            also = f" --calibrated {args.calibrated}" if args.calibrated is not None else ""
            say(f"stopped; continue with: restitution simulate {args.case}{also} --out {folder} --resume")
        raise
    show_result(folder, case)
    return None


def _calibrated(args: argparse.Namespace) -> Case:
    """The case with the recommended values, which are said."""
    from restitution.emulation.solver_file import calibrated

    case, values, doubts = calibrated(args.case, args.calibrated)
    show(f"{args.calibrated}: " + ", ".join(f"{name} = {value:.4g}" for name, value in values.items()))
    show_doubts(doubts)
    return case


def _write_template(case: Path, target: Path) -> None:
    from restitution.errors import Defect, InputError
    from restitution.files import write_whole

    if target.exists():
        raise InputError(Defect("exists already; a template replaces nothing", file=str(target)))
    write_whole(target, case.read_text("utf-8"))
    show(f"{target}: next: restitution simulate {target} --out results")


def show_result(folder: Path, case: Case) -> None:
    """Print the contacts as the solver had them, the apexes as the report has them, and where the tables are."""
    import numpy as np

    from restitution import datasets
    from restitution.commands.results import show_contacts
    from restitution.impacts.bounces import modelled
    from restitution.runs.record import read_record
    from restitution.tables.reading import read_table

    about = read_record(folder)
    track = read_table(folder / "trajectory.csv", datasets.schema("trajectory"))
    contacts = np.array([c.time_s for c in about.contacts])
    flights = modelled(track.time_s.to_numpy(), track.gap_m.to_numpy(), contacts, case.conditions)
    show_contacts(about.contacts, list(1e3 * flights.apexes_m))
    show(f"{about.steps} steps in {about.seconds:.0f} s; results in {folder}")
