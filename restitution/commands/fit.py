"""``restitution fit``: from measured impacts or tracks to closure parameters with intervals."""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands import fit_trajectory, options
from restitution.console import show, show_facts

if TYPE_CHECKING:
    from restitution.calibration.plan import Plan
    from restitution.calibration.reading import Reading


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``fit DATA... --law LAW``."""
    parser = commands.add_parser(
        "fit",
        help="calibrate a law to your own impacts or tracks, with intervals",
        description="Fit a rebound law to tables of impacts, camera tracks or shipped records.",
    )
    add_data(parser)
    parser.add_argument(
        "--law",
        metavar="LAW",
        help="a rebound law by name (eq4_exponential), or a formula in St, e_dry and parameters of your own, as "
        'in "e_dry*exp(-(a/St)**n)"; see --bounds',
    )
    parser.add_argument(
        "--law-stokes", metavar="CONVENTION", help="which Stokes number St in a formula is (that of the data)"
    )
    add_plan(parser)
    fit_trajectory.add_options(parser)
    parser.add_argument("--posterior", action="store_true", help="also sample the posterior (emcee)")
    parser.add_argument("--seed", type=int, default=0, help="of the posterior's random numbers (0)")
    parser.add_argument("--out", metavar="FILE", help="write the fit as JSON, for predict and design")
    parser.add_argument("--report", metavar="FOLDER", help="write figure, tables, page and JSON")
    parser.add_argument("--template", metavar="FOLDER", help="write impacts.csv to start from")
    parser.set_defaults(run=run)


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
    parser.add_argument("--conditions", metavar="FILE", help="fluid and sphere in TOML, where columns do not say")
    options.add_columns(parser)
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
    found = re.fullmatch(r"([A-Za-z_]\w*)=([^:]+):([^:]+)", text)
    try:
        return found[1], (float(found[2]), float(found[3]))
    except (TypeError, ValueError):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form NAME=LOW:HIGH") from None


def _prior(text: str) -> tuple[str, tuple[float, float]]:
    found = re.fullmatch(r"([A-Za-z_]\w*)=([^+]+)\+-(.+)", text)
    try:
        return found[1], (float(found[2]), float(found[3]))
    except (TypeError, ValueError):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form NAME=MEAN+-SIGMA") from None


def reading_of(args: argparse.Namespace) -> Reading:
    """How the files are read, from the options."""
    from restitution.calibration.reading import Reading
    from restitution.conditions import read_conditions
    from restitution.stokes import Speed, convention

    if args.stokes is not None:
        convention(args.stokes)
    return Reading(
        stokes=args.stokes,
        speed=None if args.speed is None else Speed(args.speed),
        columns=dict(args.column),
        conditions=read_conditions(args.conditions) if args.conditions else None,
        unphysical=args.allow_unphysical,
        axes=(args.x, args.y),
    )


def plan_of(args: argparse.Namespace, law: str, law_stokes: str | None = None, strict: bool = True) -> Plan:
    """What is estimated, from the options; without ``strict`` those that the law does not know are left out."""
    from restitution.calibration.plan import Plan
    from restitution.calibration.rebound_model import model_of

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

    from restitution.calibration.parameters import Normal
    from restitution.errors import Defect, InputError

    if not (math.isfinite(mean) and 0 < sigma < math.inf):
        raise InputError(
            Defect("a prior needs a finite mean and a positive error", None, None, name, f"{sigma:g}")
        )
    return Normal(mean, sigma)


def run(args: argparse.Namespace) -> None:
    """Fit, print, and write what was asked for."""
    if args.template:
        from restitution.calibration.template import write_template

        for line in write_template(Path(args.template)):
            show(line)
        return
    from restitution.calibration.fit_result import result_of
    from restitution.calibration.fit_summary import describe
    from restitution.calibration.fitting import estimate
    from restitution.calibration.impact_data import read
    from restitution.errors import Defect, InputError
    from restitution.files import write_whole

    if not args.data:
        raise InputError("name the data: CSV files or shipped records (--template FOLDER writes an example)")
    options.check_output("--out", args.out, args.data)
    if args.report == "":
        raise InputError(Defect("names no folder", field="--report"))
    if args.trajectory:
        fit_trajectory.run(args)
        return
    if args.wake != "auto":
        raise InputError(Defect("belongs to --trajectory", field="--wake", value=args.wake))
    observations = read(args.data, reading_of(args))
    law = args.law or "eq4_exponential"
    fit = estimate(plan_of(args, law, args.law_stokes or observations.convention), observations)
    chain = None
    if args.posterior:
        from restitution.calibration.fit_result import chain_of
        from restitution.calibration.posterior import sample

        chain = chain_of(sample(fit.likelihood, fit.maximum, args.seed, progress=sys.stderr.isatty()))
    result = result_of(fit, chain)
    if args.out:
        write_whole(args.out, result.to_json())
    written = []
    if args.report:
        from restitution.report import fit as report

        written = report.write(args.report, result)
    show_facts(describe(result))
    for name in written:
        show(str(Path(args.report) / name))
