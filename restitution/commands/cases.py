"""``restitution cases``: list the cases, show one in every unit, write input files of other solvers for it."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from restitution.commands import options
from restitution.commands.console import doubt_aside, show, show_facts, show_rows

if TYPE_CHECKING:
    from restitution.cases.case import Case


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``cases list``, ``cases show CASE`` and ``cases export CASE --to SOLVER``."""
    parser = commands.add_parser(
        "cases",
        help="list the cases, show one in SI and dimensionless numbers, export it to another solver",
        description="Cases: a sphere, a fluid, a release, a grid.",
    )
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")

    add = actions.add_parser("list", help="the shipped cases, one a line")
    add.set_defaults(run=run_list)

    add = actions.add_parser(
        "show", help="conditions in SI, dimensionless numbers in every convention, the lattice"
    )
    _add_case(add)
    add.set_defaults(run=run_show)

    add = actions.add_parser(
        "export",
        help="the input file of another solver for the same case",
        description="The same fluid, sphere, release, box and film as an input file of waLBerla "
        "(SphereWallCollision) or Lethe (lethe-fluid-sharp), to hold that solver against the record. e_dry and "
        "the least gap, whatever contact the case has; the head of the file says what could not be told.",
    )
    _add_case(add)
    add.add_argument("--to", required=True, metavar="SOLVER", help="walberla or lethe")
    add.add_argument("--out", metavar="FILE", help="where to write it (default: printed)")
    add.add_argument("--force", action="store_true", help="replace FILE where it exists")
    add.set_defaults(run=run_export)


def _add_case(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "case", metavar="CASE", help="a TOML file, the name of a shipped case, or of a record that has one"
    )


def run_list(_: argparse.Namespace) -> None:
    """Print one line a case."""
    from restitution.cases.numbers import numbers_of
    from restitution.cases.reading import names, read_case

    rows = []
    for case in map(read_case, names()):
        n = numbers_of(case)
        cells = "" if case.numerics is None else f"{case.numerics.cells_per_diameter:g}"
        mode = "none" if case.contact is None else case.contact.mode
        rows.append(
            (case.name, case.record or "", f"{n.reynolds:.3g}", f"{n.stokes['st']:.3g}", cells, mode, case.title)
        )
    show_rows(("case", "record", "Re", "St", "cells per d", "contact", "title"), rows, ("Re", "St", "cells per d"))


def run_show(args: argparse.Namespace) -> None:
    """Print what a case says, in SI, in dimensionless numbers, and as the lattice is told."""
    case = _case(args.case)
    doubt_aside(case.conditions, args.case)
    show_facts([*_conditions(case), *_numbers(case), *_lattice(case, args.case)])


def _case(given: str) -> Case:
    """The case of a file or a name; that of a record is named on the standard error."""
    from pathlib import Path

    from restitution.cases.reading import names, of_record, plain, read_case

    if not Path(given).is_file() and given not in names():
        known = {plain(name): name for name in names()}
        case = of_record().get(plain(given))
        if case is not None and plain(given) not in known:
            print(f"{case.record} is a record; its case is {case.name}", file=sys.stderr)  # noqa: T201
            return case
        given = known.get(plain(given), given)
    return read_case(given)


def _conditions(case: Case) -> list[tuple[str, str]]:
    c, r, d = case.conditions, case.release, case.sphere.diameter
    start = f"{1e3 * r.gap_d * d:.4g} mm, {r.gap_d:g} d above the wall"
    if r.kind == "drive":
        along = f", {r.along:g} m/s along the wall" if r.along else ""
        start += f", driven to {r.speed:g} m/s over {1e3 * r.ramp:.4g} ms{along}, free below {r.free_below_d:g} d"
    else:
        start += ", let go at rest"
    e_dry = "not stated" if case.sphere.e_dry is None else f"{case.sphere.e_dry:g}"
    contact = "none" if case.contact is None else case.contact.mode
    if case.contact is not None and case.contact.law:
        contact += f", {case.contact.law}"
    return [
        ("case", case.name),
        ("title", case.title),
        ("record", case.record or "none"),
        ("fluid", f"{c.fluid.density:g} kg/m3, {c.fluid.viscosity:g} Pa s"),
        ("sphere", f"{1e3 * d:g} mm, {c.sphere.density:g} kg/m3, e_dry {e_dry}"),
        ("gravity", f"{case.gravity:g} m/s2"),
        ("start", start),
        ("film", case.film.form + ("" if case.floor is None else f", down to {case.floor:.3g} m")),
        ("contact", contact),
    ]


def _numbers(case: Case) -> list[tuple[str, str]]:
    from restitution.cases.numbers import numbers_of
    from restitution.stokes import CONVENTIONS

    n = numbers_of(case)
    return [
        ("speed", f"{n.speed:.4g} m/s, {n.of_what}; that of the impact is a result"),
        ("Re", f"{n.reynolds:.4g} = rho_f v d/mu"),
        *((key, f"{St:.4g} = {CONVENTIONS[key].definition}") for key, St in n.stokes.items()),
        ("density ratio", f"{n.density_ratio:.4g}"),
        ("Ga, Ar", f"{n.galileo:.4g}, {n.archimedes:.4g}; Ar = (s - 1) g d^3/nu^2 = Ga^2"),
        ("terminal", f"{n.terminal_speed:.4g} m/s, Re {n.terminal_reynolds:.4g}"),
        ("sqrt(d/g)", f"{1e3 * n.time_unit:.4g} ms, the unit of t*"),
    ]


def _lattice(case: Case, file: str) -> list[tuple[str, str]]:
    """What the resolved solver is told; nothing for a case that it cannot run."""
    if case.numerics is None or case.reference_speed is None:
        return [("lattice", "none: no [numerics] or reference speed")]
    import math
    import warnings

    from restitution.cases.reading import names
    from restitution.runs.setup import fall_time, set_up

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        setup = set_up(case, file)
    advice = [] if case.name in names() else [("doubt", f"{w.message}: it runs, less exactly") for w in told]
    flow = setup.flow
    whole = "a quarter of the box" if setup.mirrors else "the whole box"
    end = case.run.duration if case.run.after_contact is None else fall_time(case) + case.run.after_contact
    steps, cells = end / flow.scales.step_s, math.prod(setup.shape)
    return [
        ("cell, step", f"{flow.scales.cell_m:.4g} m, {flow.scales.step_s:.4g} s"),
        ("box", f"{' x '.join(map(str, setup.shape))} cells, {whole}; {case.numerics.precision}"),
        ("lattice speed", f"{flow.speed:g} cells a step, Ma {flow.mach:.3g}"),
        ("viscosity", f"{flow.viscosity:.4g} cells2 a step, relaxation time {flow.relaxation_time:.5g}"),
        ("grid Re", f"{flow.grid_reynolds:.3g}"),
        ("rates", case.rates),
        ("work", f"about {steps:.2g} steps, {steps * cells:.2g} cell updates"),
        *advice,
    ]


def run_export(args: argparse.Namespace) -> None:
    """Print or write the input of another solver."""
    from pathlib import Path

    from restitution.errors import Defect, InputError
    from restitution.export.solvers import case_file
    from restitution.files import write_whole

    options.check_output("--out", args.out, [args.case])
    if args.out and Path(args.out).exists() and not args.force:
        raise InputError(Defect("exists; --force replaces it", file=args.out, field="--out"))
    case = _case(args.case)
    given = args.case if Path(args.case).is_file() else case.name
    doubt_aside(case.conditions, given)
    text = case_file(args.to, case, given)
    if args.out is None:
        sys.stdout.write(text)
    else:
        write_whole(args.out, text)
        show(f"{args.out}: input of {args.to} for {given}")
