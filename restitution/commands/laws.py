"""``restitution laws``: list the closure laws, show one, evaluate one."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from restitution.commands import options
from restitution.commands.console import doubt_aside, show, show_facts, show_rows

if TYPE_CHECKING:
    from restitution.laws import Law


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``laws list``, ``laws show NAME`` and ``laws evaluate NAME VARIABLE=VALUE ...``."""
    parser = commands.add_parser("laws", help="list, show and evaluate closure laws", description="Closure laws.")
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")

    add = actions.add_parser("list", help="all laws, one a line")
    add.add_argument("--family", help="only laws of this family, such as rebound or resistance")
    add.set_defaults(run=run_list)

    add = actions.add_parser("show", help="formula, convention, range, source and status of a law")
    add.add_argument("name", metavar="NAME")
    add.set_defaults(run=run_show)

    add = actions.add_parser(
        "evaluate",
        help="the value of a law",
        description="Variables and parameters as NAME=NUMBER: restitution laws evaluate eq4_exponential St=152 "
        "e_dry=0.97 K=18. Parameters not given keep their defaults.",
    )
    add.add_argument("name", metavar="NAME")
    add.add_argument("values", nargs="+", type=options.assignment, metavar="NAME=NUMBER")
    add.add_argument(
        "--stokes",
        metavar="CONVENTION",
        help="which Stokes number St is: st, st_star, st_d, st_18, st_b (a rebound law needs this)",
    )
    add.add_argument(
        "--speed",
        choices=("far", "contact", "window", "film_edge"),
        help="which impact speed St was made with (a law that is meant for one needs this)",
    )
    add.add_argument("--conditions", metavar="FILE", help="conditions in TOML, for converting between conventions")
    add.add_argument("--out-of-range", choices=("warn", "raise", "clip"), default="warn")
    add.set_defaults(run=run_evaluate)


def run_list(args: argparse.Namespace) -> None:
    """Print one line a law."""
    from restitution import laws
    from restitution.errors import InputError

    names = sorted(laws.names(args.family), key=lambda name: laws.REGISTRY[name].family)
    if not names:
        families = ", ".join(sorted({law.family for law in laws.REGISTRY.values()}))
        raise InputError(f"no law is of the family {args.family!r}; known: {families}")
    rows = [
        (n, law.family, getattr(law, "convention", ""), str(law.status), law.title)
        for n in names
        if (law := laws.REGISTRY[n])
    ]
    show_rows(("name", "family", "Stokes", "status", "title"), rows)


def run_show(args: argparse.Namespace) -> None:
    """Print all that a law knows of itself."""
    from restitution import laws

    show_facts(_about(laws.get(args.name)))


def _about(law: Law) -> list[tuple[str, str]]:
    from restitution.laws import ReboundLaw
    from restitution.stokes import convention

    low, high = law.validity
    facts = [
        ("name", law.name),
        ("title", law.title),
        ("family", law.family),
        ("formula", law.formula or law.formula_note),
        ("LaTeX", law.latex()),
        ("variables", ", ".join(law.variables)),
    ]
    if isinstance(law, ReboundLaw):
        facts.append(("Stokes number", f"{law.convention}: {convention(law.convention).definition}"))
        facts.append(("impact speed", str(law.speed)))
        facts.append(("edge of the film", "unstated: taken at any" if law.edge is None else f"{law.edge:g} d"))
    for f in law.parameter_fields():
        unit, (least, most) = f.metadata["unit"], f.metadata["bounds"]
        unit = "" if unit == "1" else f" {unit}"
        meaning, source = f.metadata["meaning"], f.metadata["source"]
        facts.append((f.name, f"{f.default:g}{unit} in [{least:g}, {most:g}]: {meaning}. Default: {source}"))
    source = f" ({law.validity_source})" if law.validity_source else ""
    facts += [
        ("valid", f"{low:g} <= {law.variables[0]} <= {high:g}{source}"),
        ("reference", law.reference),
        ("status", f"{law.status}: {law.evidence}" if law.evidence else str(law.status)),
    ]
    for check in law.checks:
        at = ", ".join(f"{k} = {v:g}" for k, v in (check.inputs | check.parameters).items())
        facts.append(("check", f"{check.value:g} +- {check.tolerance:g} at {at} ({check.source})"))
    return facts


def run_evaluate(args: argparse.Namespace) -> None:
    """Print the value of a law at one point."""
    from restitution import laws
    from restitution.conditions import read_conditions
    from restitution.errors import Defect, InputError
    from restitution.stokes import Speed, StokesNumber

    law = laws.get(args.name)
    given = dict(args.values)
    variables = {v: given.pop(v) for v in law.variables if v in given}
    missing = [v for v in law.variables if v not in variables]
    if missing:
        raise InputError(Defect(f"{law.name} needs a value for it, as in {missing[0]}=1", field=missing[0]))
    law = law.replace(**given)
    if not isinstance(law, laws.ReboundLaw):
        show(f"{law(**variables, out_of_range=args.out_of_range):.6g}")
        return
    if args.stokes is None:
        raise InputError(f"say which Stokes number St is: --stokes {law.convention}, the law's own, or another")
    conditions = read_conditions(args.conditions) if args.conditions else None
    doubt_aside(conditions, args.conditions)
    if args.speed is None and law.speed is not Speed.UNSTATED:
        raise InputError(f"say which impact speed St was made with: --speed {law.speed} is the law's own")
    St = StokesNumber(variables["St"], args.stokes, args.speed or Speed.UNSTATED)
    show(f"{law(St, variables['e_dry'], conditions, args.out_of_range):.6g}")
