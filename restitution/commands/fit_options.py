"""The options of a fit, which three commands have: what the data are, and what is estimated."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING

from restitution.commands import options

if TYPE_CHECKING:
    from restitution.calibration.estimation.plan import Plan
    from restitution.calibration.reading.reading import Reading


def add_data(parser: argparse.ArgumentParser) -> None:
    """The options that say what the data are."""
    parser.add_argument(
        "data",
        nargs="*",
        metavar="DATA",
        help="tables of impacts, tracks, WebPlotDigitizer exports, shipped records",
    )
    parser.add_argument(
        "--stokes", metavar="CONVENTION", help="which Stokes number: st, st_star, st_d, st_18, st_b"
    )
    parser.add_argument(
        "--speed",
        choices=("far", "contact", "window", "film_edge", "unstated"),
        help="which impact speed the data mean; of a track, which one to take",
    )
    parser.add_argument(
        "--edge",
        type=float,
        metavar="H",
        help="gap in diameters at which the film ends, for the speed far: of a track, which one to take; of a "
        "table, which one its e_eff mean (default: as its column film_edge_d states, else 0.1)",
    )
    parser.add_argument("--conditions", metavar="FILE", help="fluid and sphere in TOML, where columns do not say")
    options.add_columns(parser)
    options.add_track(parser)
    options.add_strict(parser)
    parser.add_argument(
        "--allow-unphysical", action="store_true", help="take e_eff above 1 or below 0 as measured"
    )
    parser.add_argument("--x", metavar="COLUMN", default="stokes", help="what x is in a digitised plot (stokes)")
    parser.add_argument("--y", metavar="COLUMN", default="e_eff", help="what y is in a digitised plot (e_eff)")


def add_plan(parser: argparse.ArgumentParser) -> None:
    """The options that say what is estimated."""
    parser.add_argument(
        "--e-dry", metavar="E", help="VALUE, VALUE+-SIGMA (a prior) or free; default: as the data state it"
    )
    parser.add_argument(
        "--fix",
        action="append",
        default=[],
        type=options.assignment,
        metavar="NAME=VALUE",
        help="hold a parameter",
    )
    parser.add_argument("--free", action="append", default=[], metavar="NAME", help="free one that is a choice")
    parser.add_argument(
        "--bounds", action="append", default=[], type=_bounds, metavar="NAME=LOW:HIGH", help="of a parameter"
    )
    parser.add_argument(
        "--prior",
        action="append",
        default=[],
        type=_prior,
        metavar="NAME=MEAN+-SIGMA",
        help="an independent value",
    )
    parser.add_argument(
        "--separate",
        action="append",
        default=[],
        metavar="NAME=COLUMN",
        type=options.pair,
        help="one value for each level of a column (source, material, record), as in e_dry=material",
    )
    parser.add_argument("--no-scatter", action="store_true", help="trust the quoted errors alone")
    parser.add_argument(
        "--offsets",
        choices=("auto", "none", "source"),
        default="auto",
        help="an offset a source: if there is more than one (auto)",
    )
    parser.add_argument("--robust", action="store_true", help="Student's t errors, for outliers")


def _bounds(text: str) -> tuple[str, tuple[float, float]]:
    parts = re.fullmatch(r"([A-Za-z_]\w*)=([^:]+):([^:]+)", text)
    try:
        return parts[1], (float(parts[2]), float(parts[3]))
    except (TypeError, ValueError):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form NAME=LOW:HIGH") from None


def _prior(text: str) -> tuple[str, tuple[float, float]]:
    parts = re.fullmatch(r"([A-Za-z_]\w*)=([^+]+)\+-(.+)", text)
    try:
        return parts[1], (float(parts[2]), float(parts[3]))
    except (TypeError, ValueError):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form NAME=MEAN+-SIGMA") from None


def reading_of(args: argparse.Namespace) -> Reading:
    """How the files are read, from the options."""
    from restitution.calibration.reading.reading import Reading
    from restitution.conditions import read_conditions
    from restitution.stokes import Speed, convention, film_edge

    if args.stokes is not None:
        convention(args.stokes)
    return Reading(
        stokes=args.stokes,
        speed=None if args.speed is None else Speed(args.speed),
        edge=None if args.edge is None else film_edge(args.edge, "--edge"),
        columns=dict(args.column),
        conditions=read_conditions(args.conditions) if args.conditions else None,
        unphysical=args.allow_unphysical,
        axes=(args.x, args.y),
        track=options.settings_of(args),
    )


def plan_of(args: argparse.Namespace, law: str, law_stokes: str | None = None, strict: bool = True) -> Plan:
    """What is estimated, from the options; without ``strict`` those that the law does not know are left out."""
    from restitution.calibration.estimation.plan import Plan
    from restitution.calibration.estimation.rebound_model import model_of

    bounds = dict(args.bounds)
    model = model_of(law, bounds, law_stokes)
    known = {p.name for p in model.parameters} | {"e_dry"}

    def own(given: dict) -> dict:
        return given if strict else {name: value for name, value in given.items() if name in known}

    return Plan(
        model=model,
        fixed=own(dict(args.fix)),
        free=frozenset(own(dict.fromkeys(args.free))),
        bounds=own(bounds),
        priors=own({name: _normal(name, *value) for name, value in args.prior}),
        e_dry=_e_dry(args.e_dry),
        separate=own(dict(args.separate)),
        scatter=not args.no_scatter,
        offsets={"auto": None, "none": False, "source": True}[args.offsets],
        robust=args.robust,
    )


def _e_dry(text: str | None):
    from restitution.errors import Defect, InputError

    if text is None or text == "free":
        return text
    mean, _, sigma = text.partition("+-")
    try:
        return _normal("--e-dry", float(mean), float(sigma)) if sigma else float(mean)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(Defect("must be VALUE, VALUE+-SIGMA or free", field="--e-dry", value=text)) from None


def _normal(name: str, mean: float, sigma: float):
    import math

    from restitution.calibration.estimation.parameters import Normal
    from restitution.errors import Defect, InputError

    if not (math.isfinite(mean) and 0 < sigma < math.inf):
        raise InputError(
            Defect("a prior needs a finite mean and a positive error", field=name, value=f"{sigma:g}")
        )
    return Normal(mean, sigma)
