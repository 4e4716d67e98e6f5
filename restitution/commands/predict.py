"""``restitution predict``: e_eff with its interval for given fluid, sphere and speed, by a fit."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from restitution.commands import options
from restitution.commands.console import show, show_doubts, show_rows

if TYPE_CHECKING:
    from restitution.conditions import Conditions

FLUID, SPHERE = ("density", "viscosity"), ("diameter", "density", "e_dry")


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``predict FIT --fluid ... --sphere ... [--speed ...]``."""
    parser = commands.add_parser(
        "predict",
        help="e_eff with its interval for your fluid, sphere and speed, by a fit",
        description="Predict e_eff by a fit that 'restitution fit --out' wrote.",
    )
    parser.add_argument("fit", metavar="FIT", help="the JSON of a fit")
    parser.add_argument(
        "--fluid",
        type=values,
        metavar="density=D,viscosity=MU",
        help="in kg/m3 and Pa s, or with units: viscosity=10 mPa s",
    )
    parser.add_argument(
        "--sphere", type=values, metavar="diameter=D,density=RHO[,e_dry=E]", help="in m and kg/m3, or with units"
    )
    parser.add_argument("--conditions", metavar="FILE", help="fluid and sphere in TOML instead")
    parser.add_argument(
        "--speed",
        type=options.numbers_in("m/s"),
        metavar="V[,V...]",
        help="impact speeds in m/s or with a unit, by the fit's definition",
    )
    parser.add_argument(
        "--st",
        type=options.numbers_in("1"),
        metavar="ST[,ST...]",
        help="Stokes numbers instead, by the fit's convention",
    )
    parser.add_argument(
        "--edge",
        type=options.diameters,
        metavar="H",
        help="gap in diameters at which the film ends whose loss e_eff is to have, if another than the fit's: "
        "converted by the point particle, for --fluid and --sphere",
    )
    parser.add_argument(
        "--e-dry", type=options.number, metavar="E", help="dry restitution, where it was not estimated"
    )
    parser.add_argument(
        "--level",
        action="append",
        default=[],
        type=options.pair,
        metavar="COLUMN=NAME",
        help="of separate parameters",
    )
    parser.add_argument(
        "--source",
        metavar="NAME",
        help="the laboratory or record of the fit that the one impact is of (default: a new one)",
    )
    options.add_strict(parser)
    parser.set_defaults(run=run)


def values(text: str) -> dict[str, float | str]:
    """``key=number,key=number``, with units or in SI, as an argument type."""
    given = [options.amount(part.strip()) for part in text.split(",")]
    if len(dict(given)) < len(given):
        raise argparse.ArgumentTypeError(f"{text!r} gives a name twice")
    return dict(given)


def conditions_of(args: argparse.Namespace) -> Conditions | None:
    """The conditions from a file or from the options; None where none are given."""
    from pydantic import ValidationError

    from restitution.conditions import Conditions, defects_of, read_conditions
    from restitution.errors import Defect, InputError

    if args.conditions:
        for option in ("fluid", "sphere"):
            if getattr(args, option) is not None:
                raise InputError(
                    Defect("stands in the file of --conditions: give one of them", field=f"--{option}")
                )
        return read_conditions(args.conditions)
    if args.fluid is None and args.sphere is None:
        return None
    given = {"fluid": args.fluid or {}, "sphere": args.sphere or {}}
    try:
        return Conditions.model_validate(given)
    except ValidationError as error:
        raise InputError(*defects_of(error, None)) from None


def run(args: argparse.Namespace) -> None:
    """Print e_eff and its intervals, one line a speed."""
    import numpy as np

    from restitution.calibration.result.fit_file import read_fit
    from restitution.calibration.result.fit_summary import speed_in_words
    from restitution.calibration.result.prediction import predict, predict_at, stokes_of
    from restitution.doubts import of_conditions, of_speed, refuse
    from restitution.errors import InputError

    result = read_fit(args.fit)
    conditions = conditions_of(args)
    if args.st is not None:
        St, speeds = np.array(args.st), None
    elif conditions is None:
        raise InputError(
            "say what hits what: --fluid and --sphere, or --conditions FILE, or Stokes numbers by --st"
        )
    else:
        per_speed = stokes_of(result, np.ones(1), conditions)[0]
        low, high = result.stokes_range
        speeds = np.array(args.speed) if args.speed else np.geomspace(low, high, 8) / per_speed
        St = speeds * per_speed
    doubts = [] if conditions is None else of_conditions([conditions], args.conditions or "")
    if not doubts and speeds is not None:
        asked = speeds.max() if args.speed else speeds.min()
        doubts = of_speed(float(asked), conditions, by_stokes=not args.speed)
    if args.strict:
        refuse(doubts)
    levels = options.once("--level", args.level)
    edge = result.edge_d if args.edge is None else args.edge
    if edge == result.edge_d:
        prediction = predict(result, St, args.e_dry, conditions, levels, args.source)
    elif conditions is None:
        raise InputError(
            f"--edge {edge:g}: the fit is of {result.edge_d:g} d; the conversion needs --fluid and --sphere, or "
            "--conditions FILE"
        )
    else:
        speeds = St / stokes_of(result, np.ones(1), conditions)[0]
        prediction = predict_at(result, speeds, edge, conditions, args.e_dry, levels, args.source)
    rows = []
    for i, x in enumerate(St):
        ends = [
            f"{max(low, 0):.3f} to {high:.3f}"
            for table in (prediction.law, prediction.impact)
            for low, high in (table[level][i] for level in table)
        ]
        speed = [] if speeds is None else [f"{speeds[i]:.4g}"]
        rows.append((*speed, f"{x:.4g}", f"{prediction.value[i]:.3f}", *ends))
    headings = (
        "St",
        "e_eff",
        *(f"law, {x}" for x in prediction.law),
        *(f"one impact, {x}" for x in prediction.impact),
    )
    said = speed_in_words(result)
    if edge != result.edge_d:
        said += f"; converted to an edge of {edge:g} d, speeds included"
    show(f"{result.law.text}; Stokes number {result.stokes_convention}, speed {said}")
    show_rows(headings if speeds is None else ("speed m/s", *headings), rows)
    show_doubts(doubts)
    for warning in prediction.warnings:
        print(f"warning: {warning}", file=sys.stderr)  # noqa: T201
