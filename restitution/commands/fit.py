"""``restitution fit``: from measured impacts or tracks to closure parameters with intervals."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from restitution.commands import fit_options, fit_trajectory, options
from restitution.commands.console import show, show_facts


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``fit DATA... --law LAW``."""
    parser = commands.add_parser(
        "fit",
        help="calibrate a law to your own impacts or tracks, with intervals",
        description="Fit a rebound law to tables of impacts, camera tracks or shipped records.",
    )
    fit_options.add_data(parser)
    parser.add_argument(
        "--law",
        metavar="LAW",
        help="a rebound law by name (eq4_exponential), or a formula in St, e_dry and parameters of your own, as "
        'in "e_dry*exp(-(a/St)**n)"; see --bounds',
    )
    parser.add_argument(
        "--law-stokes", metavar="CONVENTION", help="which Stokes number St in a formula is (that of the data)"
    )
    fit_options.add_plan(parser)
    fit_trajectory.add_options(parser)
    parser.add_argument("--posterior", action="store_true", help="also sample the posterior (emcee)")
    parser.add_argument("--seed", type=options.whole, default=0, help="of the posterior's random numbers (0)")
    parser.add_argument("--out", metavar="FILE", help="write the fit as JSON, for predict and design")
    parser.add_argument("--report", metavar="FOLDER", help="write figure, tables, page and JSON")
    parser.add_argument("--template", metavar="FOLDER", help="write impacts.csv to start from")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> None:
    """Fit, print, and write what was asked for."""
    if args.template:
        from restitution.calibration.reading.template import write_template

        for line in write_template(Path(args.template)):
            show(line)
        return
    from restitution.calibration.estimation.fitting import estimate
    from restitution.calibration.reading.impact_data import read
    from restitution.calibration.result.fit_result import result_of
    from restitution.calibration.result.fit_summary import describe
    from restitution.doubts import refuse
    from restitution.errors import Defect, InputError
    from restitution.files import check_folder, write_whole

    if not args.data:
        raise InputError("name the data: CSV files or shipped records (--template FOLDER writes an example)")
    options.check_output("--out", args.out, args.data)
    if args.report == "":
        raise InputError(Defect("names no folder", field="--report"))
    if args.report is not None:
        check_folder(args.report)
    if args.trajectory and args.e_sigma is not None:
        raise InputError(Defect("is for tables of impacts: a track tells its own errors", field="--e-sigma"))
    if args.trajectory:
        fit_trajectory.run(args)
        return
    given = {"--wake": args.wake != "auto", "--film": args.film, "--release": args.release is not None}
    defects = [Defect("belongs to --trajectory", field=option) for option, is_given in given.items() if is_given]
    if defects:
        raise InputError(*defects)
    observations = read(args.data, fit_options.reading_of(args))
    law = args.law or "eq4_exponential"
    stokes = fit_options.convention_of_formula(args.law_stokes, [law], observations.convention)
    fit = estimate(fit_options.plan_of(args, law, stokes), observations)
    if args.strict:
        refuse(fit.doubts)
    chain = None
    if args.posterior:
        from restitution.calibration.estimation.posterior import sample

        chain = sample(fit.likelihood, fit.maximum, args.seed, progress=sys.stderr.isatty())
    result = result_of(fit, chain, influence=bool(args.report or args.out))
    written = []
    if args.report:
        from restitution.report.fits import report

        written = report.write(args.report, result, out=args.out)
    elif args.out:
        write_whole(args.out, result.to_json())
    show_facts(describe(result))
    for name in written:
        show(str(Path(args.report) / name))
