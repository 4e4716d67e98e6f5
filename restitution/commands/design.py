"""``restitution design``: what to measure next to narrow an interval of a fit."""

from __future__ import annotations

import argparse
import statistics
from typing import TYPE_CHECKING

from restitution.commands import options
from restitution.commands.console import show, show_doubts, show_rows

if TYPE_CHECKING:
    from restitution.calibration.result.design import Gain
    from restitution.calibration.result.fit_result import FitResult


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``design FIT [--parameter NAME | --at ST]``."""
    parser = commands.add_parser(
        "design",
        help="what to measure next: which fluid, sphere and speed would narrow an interval most",
        description="Rank feasible experiments by how much they would narrow a chosen interval of a fit.",
    )
    parser.add_argument("fit", metavar="FIT", help="the JSON of a fit")
    goal = parser.add_mutually_exclusive_group()
    goal.add_argument("--parameter", metavar="NAME", help="narrow this parameter (default: the first of the law)")
    goal.add_argument("--at", type=options.number, metavar="ST", help="narrow e_eff at this Stokes number instead")
    parser.add_argument(
        "--shots", type=_shots, default=(1, 5, 20), metavar="M[,M...]", help="impacts each (1,5,20)"
    )
    parser.add_argument(
        "--pairs", metavar="FILE", help="feasible fluids and spheres, as CSV (default: a shipped list)"
    )
    parser.add_argument(
        "--height",
        type=options.numbers_in("m"),
        default=[0.01, 0.05, 0.2],
        metavar="H[,H...]",
        help="release heights in m or with a unit (0.01,0.05,0.2)",
    )
    parser.add_argument("--all", action="store_true", help="every release height, not only the best of each pair")
    parser.add_argument(
        "--level",
        action="append",
        default=[],
        type=options.pair,
        metavar="COLUMN=NAME",
        help="of separate parameters (default: that of --parameter)",
    )
    parser.add_argument(
        "--e-sigma", type=options.number, metavar="S", help="error of a new e_eff (default: as in the fit)"
    )
    parser.add_argument(
        "--st-sigma", type=options.number, metavar="S", help="relative error of a new St (as in the fit)"
    )
    parser.add_argument(
        "--e-dry", type=options.number, metavar="E", help="dry restitution, where it was not estimated"
    )
    parser.add_argument("--same-source", action="store_true", help="no new offset: the same laboratory and set-up")
    parser.add_argument("--beyond", action="store_true", help="also St outside the calibrated range")
    parser.add_argument("--rows", type=options.whole, default=12, metavar="N", help="rows to print (12)")
    parser.add_argument("--plot", metavar="FILE", help="also draw the gain against St, as SVG or PNG")
    options.add_strict(parser)
    parser.set_defaults(run=run)


def _shots(text: str) -> tuple[int, ...]:
    parts = text.split(",")
    if not all(part.isdecimal() and int(part) > 0 for part in parts):
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of numbers of impacts")
    return tuple(sorted(int(part) for part in parts))


def run(args: argparse.Namespace) -> None:
    """Print the ranked experiments, and draw them where asked."""
    from restitution.calibration.result import design
    from restitution.calibration.result.fit_file import read_fit
    from restitution.doubts import of_conditions, refuse
    from restitution.errors import Defect, InputError
    from restitution.files import write_whole

    for option, value, least in (
        ("--at", args.at, "positive"),
        ("--e-sigma", args.e_sigma, "zero or positive"),
        ("--st-sigma", args.st_sigma, "zero or positive"),
        ("--rows", args.rows, "positive"),
    ):
        if value is not None and not (0 < value < float("inf") or (value == 0 and "zero" in least)):
            raise InputError(Defect(f"must be {least} and finite", field=option, value=f"{value:g}"))
    if args.plot is not None and not args.plot.endswith((".svg", ".png")):
        raise InputError(Defect("must end in .svg or .png", field="--plot", value=args.plot))
    options.check_output("--plot", args.plot, [args.fit])
    result = read_fit(args.fit)
    experiments = design.candidates(args.pairs or design.PAIRS, tuple(args.height))
    doubts = of_conditions((x.conditions for x in experiments), args.pairs or "")
    if args.strict:
        refuse(doubts)
    first = next((p.name for p in result.parameters if p.mean), None)
    target = design.Target(None if args.at is not None else args.parameter or first, args.at)
    levels = design.levels_of(result, target, options.once("--level", args.level))
    e_dry = args.e_dry if args.e_dry is not None else _typical_e_dry(result, levels)
    plan = design.Design(
        result, target, e_dry, experiments[0].conditions, args.e_sigma, args.st_sigma, args.same_source, levels
    )
    gains = plan.rank(experiments, args.shots, args.beyond)
    if not gains:
        raise InputError("no pair gives a Stokes number in the calibrated range: --height, --pairs, or --beyond")
    if args.plot:
        from restitution.report.fits.design_plot import draw

        drawing = draw(plan, gains, args.shots, target)
        write_whole(args.plot, drawing.svg if args.plot.endswith(".svg") else drawing.png)
    what = target.parameter if args.at is None else f"e_eff at St {args.at:g}"
    most = args.shots[-1]
    St, low, high = plan.best(most)
    show(
        f"{most} impacts narrow {what} most at St {St:.3g}; nine tenths of that anywhere from St {low:.3g} "
        f"to {high:.3g}"
    )
    show(f"standard error of {what} now: {plan.now:.3g}; after M impacts, as a fraction of it:")
    rows = gains if args.all else design.best_of_pairs(gains)
    _show(rows[: args.rows], args.shots)
    if len(rows) > args.rows:
        show(f"... {len(rows) - args.rows} more: --rows {len(rows)}")
    show_doubts(doubts)


def _typical_e_dry(result: FitResult, levels: dict[str, str]) -> float | None:
    """The median of what the fitted impacts of these levels had, where it was not estimated."""
    known = [p.e_dry for p in result.points if p.e_dry is not None and levels.items() <= p.levels.items()]
    return statistics.median(known) if known else None


def _show(gains: list[Gain], shots: tuple[int, ...]) -> None:
    headings = ("fluid", "sphere", "fall m", "speed m/s", "St", "e_eff", *(f"M = {m}" for m in shots))
    rows = [
        (
            gain.candidate.fluid,
            gain.candidate.sphere,
            "" if gain.candidate.height is None else f"{gain.candidate.height:g}",
            f"{gain.candidate.speed:.3g}",
            f"{gain.stokes:.3g}",
            f"{gain.e_eff:.2f}",
            *(f"{ratio:.2f}" for ratio in gain.ratio),
        )
        for gain in gains
    ]
    show_rows(headings, rows, right=headings[2:])
