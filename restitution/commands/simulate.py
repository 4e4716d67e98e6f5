"""``restitution simulate``: run a case with the resolved solver."""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path

from restitution.console import show


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
    parser.add_argument("--resume", action="store_true", help="continue from the checkpoint in the folder, if any")
    parser.add_argument(
        "--snapshots", action="store_true", help="also write the flow as VTKHDF files for ParaView"
    )
    parser.add_argument("--list", action="store_true", help="list the shipped cases")
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

    from restitution.case_files import TEMPLATE, find, read_case
    from restitution.commands.results import RESOLVED, folder_for
    from restitution.errors import InputError, StoppedError
    from restitution.simulate import CHECKPOINT, simulate

    if args.list:
        _list()
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
    folder = folder_for(args.out, case.name, RESOLVED)

    def say(text: str) -> None:
        print(text, file=sys.stderr)  # noqa: T201

    try:
        simulate(case, folder, resume=args.resume, snapshots=args.snapshots, show=say, file=args.case)
    except StoppedError as error:
        say(f"error: {error}; the trajectory so far is in {folder / 'trajectory_so_far.csv'}")
        return 2
    except KeyboardInterrupt:
        if (folder / CHECKPOINT).exists():
            say(f"stopped; continue with: restitution simulate {args.case} --out {folder} --resume")
        raise
    _report(folder)
    return None


def _list() -> None:
    from restitution.case_files import names, read_case
    from restitution.console import show_rows

    cases = [read_case(name) for name in names()]
    show_rows(
        ("case", "cells per d", "title"), [(c.name, f"{c.numerics.cells_per_diameter:g}", c.title) for c in cases]
    )


def _write_template(case: Path, target: Path) -> None:
    from restitution.errors import Defect, InputError
    from restitution.files import write_whole

    if target.exists():
        raise InputError(Defect("exists already; a template replaces nothing", str(target)))
    write_whole(target, case.read_text("utf-8"))
    show(f"{target}: next: restitution simulate {target} --out results")


def _report(folder: Path) -> None:
    """Print the contacts as the solver had them, the heights between them, and where the tables are."""
    import json

    import pandas as pd

    from restitution.commands.results import show_contacts

    about = json.loads((folder / "run.json").read_text())
    track, times = pd.read_csv(folder / "trajectory.csv"), [c["time_s"] for c in about["contacts"]]
    between = [track.gap_m[(track.time_s > a) & (track.time_s < b)] for a, b in itertools.pairwise(times)]
    show_contacts(about["contacts"], [1e3 * gap.max() for gap in between if len(gap)])
    show(f"{about['steps']} steps in {about['seconds']:.0f} s; results in {folder}")
