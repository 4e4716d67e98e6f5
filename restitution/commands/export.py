"""``restitution export``: a law or a fit as source code, table, or input of a DEM code."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from restitution.commands import options
from restitution.commands.console import doubt_aside, show, show_rows
from restitution.commands.predict import conditions_of, values

if TYPE_CHECKING:
    from restitution.export import Closure, Options
    from restitution.export.targets import Target


_WITHIN, _STOKES = 0.02, (20.0, 1000.0)
"""Unless said otherwise: error of e that bounds the range of a constant, and Stokes numbers of the law."""


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
        "--level", type=int, choices=(0, 1, 2),
        help="0 (default): constant e; 1: the code's own law, refitted; 2: e(St) of the speed at first contact",
    )  # fmt: skip
    parser.add_argument(
        "--speed",
        type=options.number,
        metavar="V",
        help="impact speed in m/s: that e of level 0 or a film law is taken at",
    )
    parser.add_argument("--cells", type=options.number, metavar="N", help="walberla, lethe: cells a diameter")
    parser.add_argument(
        "--modulus", type=options.number, metavar="E", help="film laws: reduced modulus E* of the two bodies in Pa"
    )
    parser.add_argument(
        "--within", type=options.number, metavar="X", help="level 0: error of e that bounds its range (0.02)"
    )
    parser.add_argument(
        "--st-range", type=stokes_range, metavar="LOW:HIGH",
        help="Stokes numbers of the law: that level 1 is refitted for, that stiffness and drops are for (20:1000)",
    )  # fmt: skip
    parser.add_argument(
        "--drop-test", action="store_true",
        help="lammps, liggghts, yade, openfoam: drop spheres on a wall there and print the e delivered; without "
        "the program the input that would do so",
    )  # fmt: skip
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
    from restitution.export import TARGETS, FilmRequest, Options, Request, closure_of, target

    if args.list:
        show_rows(("target", "what", "takes"), [(t.key, t.title, t.takes) for t in TARGETS.values()])
        return
    if args.law is None:
        raise InputError("name a law or the JSON of a fit; 'restitution laws list' has the laws")
    if args.to is None:
        raise InputError(Defect(f"is needed: one of {', '.join(TARGETS)}", field="--to"))
    wanted = target(args.to)
    for option, value in _numbers(args):
        if value is not None and not 0 < value < float("inf"):
            raise InputError(Defect("must be positive and finite", field=option, value=f"{value:g}"))
    _check_taken(args, wanted)
    _check_place(args)
    closure = closure_of(args.law, options.once("NAME=NUMBER", args.parameters), options.once("--of", args.of))
    request = Request(args.level or 0, args.speed, args.within or _WITHIN, args.st_range or _STOKES)
    conditions = conditions_of(args)
    doubt_aside(conditions, args.conditions)
    film = FilmRequest(args.cells, args.speed, args.modulus)
    given = Options(args.derivative, args.bare, conditions, args.e_dry, request, film)
    if args.drop_test:
        _drop(wanted, closure, given, args.out)
    else:
        _put(wanted.text(closure, given), args.out)


def _check_taken(args: argparse.Namespace, wanted: Target) -> None:
    """Refuse an option that the target or the level would ignore."""
    from restitution.errors import Defect, InputError

    for option in ("derivative", "bare", "level", "speed", "within", "st-range", "drop-test", "cells", "modulus"):
        value = getattr(args, option.replace("-", "_"))
        if value not in (None, False) and f"--{option}" not in wanted.takes:
            rule = f"is not taken by {wanted.key}, which takes {wanted.takes or 'no options'}"
            raise InputError(Defect(rule, field=f"--{option}"))
    for option in ("fluid", "sphere", "conditions", "e-dry"):
        if getattr(args, option.replace("-", "_")) is not None and "--fluid" not in wanted.takes:
            rule = f"is not taken by {wanted.key}: its functions and tables are for any pair"
            raise InputError(Defect(rule, field=f"--{option}"))
    for option, value in (("--speed", args.speed), ("--within", args.within)):
        if args.level and value is not None:
            raise InputError(Defect(f"belongs to level 0; level {args.level} takes --st-range", field=option))
    if not args.level and args.st_range and not args.drop_test:
        rule = "belongs to levels 1 and 2, and to --drop-test; level 0 takes --speed"
        raise InputError(Defect(rule, field="--st-range"))


def _numbers(args: argparse.Namespace) -> list[tuple[str, float | None]]:
    """Options that must be positive."""
    return [(f"--{name}", getattr(args, name)) for name in ("speed", "within", "cells", "modulus")]


def _put(text: str, place: str | None) -> None:
    """Write a text to its place, or print it."""
    from restitution.files import write_whole

    if place is None:
        sys.stdout.write(text)
    else:
        write_whole(place, text)


def _drop(wanted: Target, closure: Closure, given: Options, place: str | None) -> None:
    """Run a drop test and show what is delivered; without the program print its input and say what is missing."""
    from restitution.export.drops.measure import NotInstalledError, drop_test
    from restitution.export.impacts import impacts_of

    impacts = impacts_of(closure, given.conditions, given.e_dry, wanted.key)
    test = drop_test(wanted.key, wanted.program, impacts, given.request)
    if place is not None:
        _put(test.deck.files[test.deck.main], place)
    try:
        version, drops = test.run()
    except NotInstalledError as error:
        print(f"not run: {error}", file=sys.stderr)  # noqa: T201
        if place is None:
            _put(test.deck.files[test.deck.main], None)
        return
    show(f"{wanted.program.title} {version}, level {given.request.level}: e asked by the exported text, delivered")
    rows = [
        (f"{d.speed:.4g}", f"{d.stokes:.4g}", *(f"{e:.4f}" for e in (d.law, d.asked, d.delivered)),
         f"{d.delivered - d.asked:+.4f}")
        for d in drops
    ]  # fmt: skip
    show_rows(("m/s", "St", "law", "asked", "delivered", "deviation"), rows)
    worst, far = (max(abs(d.delivered - e(d)) for d in drops) for e in (lambda d: d.asked, lambda d: d.law))
    show(f"greatest deviation from what is asked {worst:.4f}, from the law {far:.4f}")


def _check_place(args: argparse.Namespace) -> None:
    """Refuse an output that exists or cannot be written, before any work."""
    from pathlib import Path

    from restitution.errors import Defect, InputError

    options.check_output("--out", args.out, [args.law])
    if args.out and Path(args.out).exists() and not args.force:
        raise InputError(Defect("exists; --force replaces it", file=args.out, field="--out"))
