"""``restitution calibrate-solver``: which sub-grid parameters bring a solver closest to measured records."""

from __future__ import annotations

import argparse
import shlex
from typing import TYPE_CHECKING

from restitution.commands import options
from restitution.commands.console import now_and_then, show, show_doubts, show_rows

if TYPE_CHECKING:
    from restitution.emulation.calibration import Calibration


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``calibrate-solver RUNS``."""
    parser = commands.add_parser(
        "calibrate-solver",
        help="which cut-off, floor, tension ... bring a solver, ours or yours, closest to records",
        description="Calibrate the parameters of a solver by a table of its runs and measured records: an "
        "emulator of the runs' trajectories, the likelihood of all frames, a posterior with correlations.",
        epilog="RUNS is a CSV file, or a folder with runs.csv: one row a run, columns run (its name), track (path "
        "of its trajectory beside the table: time and gap, or velocity), record (what it simulates: a shipped "
        "record, or a file), and one a parameter; state may mark runs that failed. Columns of text and "
        "cells_per_diameter divide the runs into groups, each calibrated for itself. At least five runs a "
        "parameter, spread over their ranges as a Latin hypercube or Sobol design; needs scikit-learn (extra "
        "'emulator').",
    )
    parser.add_argument("runs", metavar="RUNS", help="table of runs, or the folder of a sweep")
    parser.add_argument(
        "--record", nargs="+", action="extend", default=[], metavar="NAME",
        help="records to be met (default: all that the runs simulate but those held out); for a table without the "
        "column, what all runs simulate",
    )  # fmt: skip
    parser.add_argument(
        "--held-out",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME",
        help="records that are predicted and have no say",
    )
    parser.add_argument(
        "--prior", action="append", default=[], type=_range, metavar="KEY=LO:HI",
        help="a narrower range of a parameter than that of the runs, uniform; may be repeated",
    )  # fmt: skip
    parser.add_argument(
        "--before", action="append", default=[], type=options.assignment, metavar="KEY=VALUE",
        help="what the solver had before, to compare with (default: the whole prior); one for each parameter",
    )  # fmt: skip
    parser.add_argument("--out", metavar="DIR", help="write solver.json, the page and its figures")
    parser.add_argument("--seed", type=options.whole, default=0, help="of the random numbers (0)")
    parser.add_argument("--conditions", metavar="FILE", help="fluid and sphere in TOML, of records that are files")
    options.add_columns(parser)
    options.add_track(parser)
    options.add_strict(parser)
    parser.set_defaults(run=run)


def _range(text: str) -> tuple[str, tuple[float, float]]:
    name, value = options.pair(text)
    low, colon, high = value.partition(":")
    if not colon:
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form KEY=LO:HI")
    return name, (options.number(low), options.number(high))


def run(args: argparse.Namespace) -> None:
    """Calibrate every group, print, write."""
    from restitution.calibration.reading.reading import Reading
    from restitution.conditions import read_conditions
    from restitution.doubts import refuse
    from restitution.emulation.calibration import calibrate
    from restitution.emulation.page import files
    from restitution.emulation.runs_table import read_runs
    from restitution.errors import Defect, InputError
    from restitution.files import check_folder, write_folder

    if args.out == "":
        raise InputError(Defect("names no folder", field="--out"))
    if args.out is not None:
        check_folder(args.out)
    options.check_track_columns(args.column)
    how = Reading(
        conditions=read_conditions(args.conditions) if args.conditions else None, track=options.settings_of(args)
    )
    prior, before = options.once("--prior", args.prior), options.once("--before", args.before) or None
    only = args.record[0] if len(args.record) == 1 else None
    groups = read_runs(args.runs, only)
    found = [
        calibrate(g, args.record, args.held_out, prior, before, how, args.seed, now_and_then()) for g in groups
    ]
    doubts = [doubt for c in found for doubt in c.doubts]
    if args.strict:
        refuse(doubts)
    for c in found:
        _show(c)
    show_doubts(doubts)
    if args.out is not None:
        write_folder(args.out, files(args.runs, found, _command(args)))
        show(f"solver.json and index.html in {args.out}")


def _command(args: argparse.Namespace) -> str:
    """What makes the page again."""
    words = ["restitution", "calibrate-solver", args.runs]
    for option, given in (("--record", args.record), ("--held-out", args.held_out)):
        words += [option, *given] if given else []
    words += [w for name, (low, high) in args.prior for w in ("--prior", f"{name}={low:g}:{high:g}")]
    words += [w for name, value in args.before for w in ("--before", f"{name}={value:g}")]
    for option in ("conditions", *options.TRACK):
        value = getattr(args, option)
        words += (
            []
            if value is None
            else [f"--{option.replace('_', '-')}", f"{value:g}" if isinstance(value, float) else value]
        )
    words += [w for name, own in args.column for w in ("--column", f"{name}={own}")]
    return shlex.join([*words, *(["--seed", str(args.seed)] if args.seed else []), "--out", args.out])


def _show(c: Calibration) -> None:
    from restitution.emulation.page import gain, recommended

    met, held = ", ".join(e.name for e in c.used), ", ".join(e.name for e in c.held_out)
    show(
        (f"{c.group.label}: " if c.group.label else "")
        + f"{len(c.group.runs)} runs; met: {met}"
        + (f"; held out: {held}" if held else "")
    )
    for note in c.group.notes:
        show(f"note: {note}")
    heads = ("parameter", "median", "68 %", "95 %", "prior", "the records say")
    keys = ("name", "median", "68%", "95%", "prior", "says")
    show_rows(heads, [tuple(str(r[k]) for k in keys) for r in recommended([c])], right=("median",))
    if len(c.told) > 1:
        names = [t.name for t in c.told]
        rows = [
            (name, *(f"{x:+.2f}" for x in row[: k + 1]), *[""] * (len(names) - k - 1))
            for k, (name, row) in enumerate(zip(names, c.correlation, strict=True))
        ]
        show_rows(("correlation", *names), rows, right=names)
    lacks = {x.record: f"{x.sigma_d[0]:.2g}" for x in c.discrepancies}
    rows = [
        (
            p.record, "held out" if p.held_out else "met", f"{p.rms_before_d:.4f}", f"{p.rms_after_d:.4f}",
            lacks.get(p.record, ""), f"{e.predicts:.1%}", f"{e.check.coverage:.0%}",
        )
        for e, p in zip((*c.used, *c.held_out), c.predictions, strict=True)
    ]  # fmt: skip
    heads = ("record", "", "rms/d before", "after", "discrepancy/d", "unseen runs predicted", "in 95 %")
    show_rows(heads, rows, right=heads[2:])
    rows = [
        (
            p.record, v.label, f"{v.measured:.4g} +- {v.sigma:.1g}", f"{v.before[2]:.4g}",
            f"{v.after[2]:.4g} ({v.after[1]:.4g} to {v.after[3]:.4g})",
        )
        for p in c.predictions
        for v in p.values
    ]  # fmt: skip
    show_rows(("record", "quantity", "measured", "before", "after (68 %)"), rows)
    show(gain(c))
