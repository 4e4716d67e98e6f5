"""The options of a fit, which three commands have: what the data are, and what is estimated."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from restitution.commands import options

if TYPE_CHECKING:
    from restitution.calibration.estimation.parameters import Earlier
    from restitution.calibration.estimation.plan import Plan
    from restitution.calibration.reading.reading import Reading


_LARGEST = 1e12
"""Of a prior: nothing that is estimated here is larger."""


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
        type=options.diameters,
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
    parser.add_argument(
        "--e-sigma",
        type=options.number,
        metavar="S",
        help="standard error of each e_eff of a table that states none (default: as of the others, or by scatter)",
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
        "--start",
        action="append",
        default=[],
        type=options.assignment,
        metavar="NAME=VALUE",
        help="where the search for a parameter begins (default: several places within its bounds)",
    )
    parser.add_argument(
        "--prior",
        action="append",
        default=[],
        type=_prior,
        metavar="NAME=MEAN+-SIGMA",
        help="an independent value; or FIT.json: an earlier fit of the law to other data, correlations included",
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
    parser.add_argument(
        "--no-log-variance",
        action="store_true",
        help="leave ln of the variances out, as York's line does; with --no-scatter and --offsets none",
    )
    parser.add_argument("--robust", action="store_true", help="Student's t errors, for outliers")


def _bounds(text: str) -> tuple[str, tuple[float, float]]:
    parts = re.fullmatch(r"([A-Za-z_]\w*)=([^:]+):([^:]+)", text)
    try:
        return parts[1], (_end(parts[2]), _end(parts[3]))
    except (TypeError, argparse.ArgumentTypeError):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form NAME=LOW:HIGH") from None


def _end(text: str) -> float:
    """A bound: a number, or inf and -inf, where there is none."""
    return float(text) if text in ("inf", "-inf") else options.number(text)


def _prior(text: str) -> tuple[str, tuple[float, float] | None]:
    """A parameter with mean and error, or the file of a fit with None."""
    if text.lower().endswith(".json"):
        return text, None
    parts = re.fullmatch(r"([A-Za-z_]\w*)=([^+]+)\+-(.+)", text)
    try:
        return parts[1], (options.number(parts[2]), options.number(parts[3]))
    except (TypeError, argparse.ArgumentTypeError):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form NAME=MEAN+-SIGMA") from None


def reading_of(args: argparse.Namespace) -> Reading:
    """How the files are read, from the options."""
    from restitution.calibration.reading.reading import Reading
    from restitution.conditions import read_conditions
    from restitution.stokes import Speed, convention, film_edge

    if args.stokes is not None:
        convention(args.stokes)
    own = {*args.free, *(name for name, _ in (*args.fix, *args.prior))}
    return Reading(
        stokes=args.stokes,
        speed=None if args.speed is None else Speed(args.speed),
        edge=None if args.edge is None else film_edge(args.edge, "--edge"),
        columns=options.once("--column", args.column),
        conditions=read_conditions(args.conditions) if args.conditions else None,
        e_sigma=args.e_sigma,
        unphysical=args.allow_unphysical,
        axes=(args.x, args.y),
        dry=args.e_dry is not None or "e_dry" in own,
        track=options.settings_of(args),
    )


def convention_of_formula(law_stokes: str | None, laws: Sequence[str], otherwise: str) -> str:
    """Which Stokes number a formula takes; raises :class:`InputError` where no law is one, or it is unknown."""
    from restitution.errors import Defect, InputError
    from restitution.stokes import convention

    if law_stokes is None:
        return otherwise
    if all(law.isidentifier() for law in laws):
        rule = "is for a formula: a law by name knows its own Stokes number"
        raise InputError(Defect(rule, field="--law-stokes", value=law_stokes))
    convention(law_stokes)
    return law_stokes


def plan_of(args: argparse.Namespace, law: str, law_stokes: str | None = None, strict: bool = True) -> Plan:
    """What is estimated, from the options; without ``strict`` those that the law does not know are left out."""
    from restitution.calibration.estimation.plan import Plan
    from restitution.calibration.estimation.rebound_model import model_of
    from restitution.errors import Defect, InputError

    bounds, fixed = options.once("--bounds", args.bounds), options.once("--fix", args.fix)
    given = options.once("--prior", args.prior)
    priors = {n: _normal(n, *value) for n, value in given.items() if value is not None}
    earlier = _earlier([n for n, value in given.items() if value is None], strict)
    for name in sorted(fixed.keys() & ({*args.free} | priors.keys())):
        raise InputError(Defect("is fixed, and asked to be free or given a prior", field=name))
    model = model_of(law, bounds, law_stokes)
    known = {p.name for p in model.parameters} | {"e_dry"}

    def own(given: dict) -> dict:
        return given if strict else {name: value for name, value in given.items() if name in known}

    return Plan(
        model=model,
        fixed=own(fixed),
        free=frozenset(own(dict.fromkeys(args.free))),
        bounds=own(bounds),
        priors=own(priors),
        starts=own(options.once("--start", args.start)),
        e_dry=_e_dry(args.e_dry),
        separate=own(options.once("--separate", args.separate)),
        scatter=not args.no_scatter,
        offsets={"auto": None, "none": False, "source": True}[args.offsets],
        robust=args.robust,
        log_variance=not args.no_log_variance,
        earlier=earlier,
    )


def _earlier(files: Sequence[str], strict: bool) -> Earlier | None:
    """The one earlier fit that is a prior; of one law, so that it goes with one law alone."""
    from restitution.calibration.result.chained import earlier_of
    from restitution.calibration.result.fit_file import read_fit
    from restitution.errors import Defect, InputError

    if not files:
        return None
    if len(files) > 1 or not strict:
        rule = (
            "a prior is one fit, chained with the fits before it" if strict else "is of one law: name it by --law"
        )
        raise InputError(Defect(rule, field="--prior", value=files[-1]))
    return earlier_of(read_fit(files[0]), files[0])


def _e_dry(text: str | None):
    from restitution.errors import Defect, InputError

    if text is None or text == "free":
        return text
    mean, _, sigma = text.partition("+-")
    try:
        value = options.number(mean)
        return _normal("--e-dry", value, options.number(sigma)) if sigma else value
    except argparse.ArgumentTypeError:
        raise InputError(Defect("must be VALUE, VALUE+-SIGMA or free", field="--e-dry", value=text)) from None


def _normal(name: str, mean: float, sigma: float):
    from restitution.calibration.estimation.parameters import Normal
    from restitution.errors import Defect, InputError

    if not (abs(mean) <= _LARGEST and 0 < sigma <= _LARGEST):
        raise InputError(
            Defect(
                f"a prior needs a mean and a positive error, both at most {_LARGEST:g}",
                field=name,
                value=f"{mean:g}+-{sigma:g}",
            )
        )
    return Normal(mean, sigma)
