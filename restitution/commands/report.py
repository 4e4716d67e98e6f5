"""``restitution report``: regenerate a comparison report."""

from __future__ import annotations

import argparse
from pathlib import Path

from restitution.console import show


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``report fig1``."""
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
    add.set_defaults(run=run_fig1)


def run_fig1(args: argparse.Namespace) -> None:
    """Write the Fig. 1 report and name its files."""
    from restitution.errors import Defect, InputError
    from restitution.report import fig1
    from restitution.stokes import Speed

    if not args.out:
        raise InputError(Defect("names no folder", field="--out"))
    for name in fig1.write(args.out, Speed(args.speed)):
        show(str(Path(args.out) / name))
