"""``restitution export``: a law or a fit as source code, table, or input of a DEM code."""

from __future__ import annotations

import argparse
import sys

from restitution.commands import options
from restitution.commands.console import show_rows
from restitution.commands.predict import conditions_of, values


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``export LAW-or-FIT.json --to TARGET ...`` and ``export --list``."""
    parser = commands.add_parser(
        "export",
        help="a law or a fit as functions, table, or input of a DEM code",
        description="Write a law, or a fit that 'restitution fit --out' wrote, for another program: restitution "
        "export eq4_exponential K=18 --to c --out law.h. Without --out it is printed.",
    )
    parser.add_argument("law", nargs="?", metavar="LAW-or-FIT.json", help="name of a law, or the JSON of a fit")
    parser.add_argument(
        "parameters", nargs="*", type=options.assignment, metavar="NAME=NUMBER", help="parameters of a law"
    )
    parser.add_argument("--list", action="store_true", help="the targets and what each takes")
    parser.add_argument("--to", metavar="TARGET", help="what to write it for, one of --list")
    parser.add_argument("--derivative", action="store_true", help="functions: the derivative as well")
    parser.add_argument(
        "--bare", action="store_true", help="csv: no comments, for programs that read numbers alone"
    )
    parser.add_argument("--fluid", type=values, metavar="density=D,viscosity=MU", help="in kg/m3 and Pa s")
    parser.add_argument("--sphere", type=values, metavar="diameter=D,density=RHO,e_dry=E", help="in m and kg/m3")
    parser.add_argument("--conditions", metavar="FILE", help="fluid and sphere, or partner, in TOML instead")
    parser.add_argument(
        "--e-dry", type=options.number, metavar="E", help="dry restitution, where no fit or sphere has it"
    )
    parser.add_argument(
        "--of", action="append", default=[], type=options.pair, metavar="COLUMN=NAME",
        help="which of a fit's separate parameters",
    )  # fmt: skip
    parser.add_argument(
        "--level", type=int, default=0, choices=(0, 1, 2), help="0: constant e; 1: the code's own law, refitted"
    )
    parser.add_argument(
        "--speed", type=options.number, metavar="V", help="level 0: impact speed in m/s that e is taken at"
    )
    parser.add_argument(
        "--within",
        type=options.number,
        default=0.02,
        metavar="X",
        help="level 0: error of e that bounds its range (0.02)",
    )
    parser.add_argument(
        "--st-range", type=stokes_range, default=(20.0, 1000.0), metavar="LOW:HIGH",
        help="level 1: Stokes numbers of the law that it is refitted for (20:1000)",
    )  # fmt: skip
    parser.add_argument("--drop-test", action="store_true", help="lammps: a script that prints the e delivered")
    parser.add_argument("--out", metavar="FILE")
    parser.add_argument("--force", action="store_true", help="replace FILE where it exists")
    parser.set_defaults(run=run)


def stokes_range(text: str) -> tuple[float, float]:
    """``LOW:HIGH``, positive and in order, as an argument type."""
    try:
        low, high = map(options.number, text.split(":"))
    except (ValueError, argparse.ArgumentTypeError):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form LOW:HIGH") from None
    if not 0 < low < high < float("inf"):
        raise argparse.ArgumentTypeError(f"{text!r} must be positive and rise")
    return low, high


def run(args: argparse.Namespace) -> None:
    """Print or write the exported text."""
    from restitution.errors import Defect, InputError
    from restitution.export import TARGETS, Options, Request, closure_of, target
    from restitution.files import write_whole

    if args.list:
        show_rows(("target", "what", "takes"), [(t.key, t.title, t.takes) for t in TARGETS.values()])
        return
    if args.law is None:
        raise InputError("name a law or the JSON of a fit; 'restitution laws list' has the laws")
    if args.to is None:
        raise InputError(Defect(f"is needed: one of {', '.join(TARGETS)}", field="--to"))
    wanted = target(args.to)
    for option, value in (("--speed", args.speed), ("--within", args.within)):
        if value is not None and not 0 < value < float("inf"):
            raise InputError(Defect("must be positive and finite", field=option, value=f"{value:g}"))
    _check_place(args)
    closure = closure_of(args.law, dict(args.parameters), dict(args.of))
    request = Request(args.level, args.speed, args.within, args.st_range)
    conditions = conditions_of(args)
    text = wanted.text(
        closure, Options(args.derivative, args.bare, args.drop_test, conditions, args.e_dry, request)
    )
    if args.out is None:
        sys.stdout.write(text)
    else:
        write_whole(args.out, text)


def _check_place(args: argparse.Namespace) -> None:
    """Refuse an output that exists or cannot be written, before any work."""
    from pathlib import Path

    from restitution.errors import Defect, InputError

    options.check_output("--out", args.out, [args.law])
    if args.out and Path(args.out).exists() and not args.force:
        raise InputError(Defect("exists; --force replaces it", file=args.out, field="--out"))
