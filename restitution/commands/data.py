"""``restitution data``: list the shipped tables, show one, validate shipped or own files."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from restitution.commands import options
from restitution.commands.console import cell, show, show_doubts, show_facts, show_rows

if TYPE_CHECKING:
    from restitution.datasets.package import Resource


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Declare ``data list``, ``data show NAME`` and ``data validate [PATH]``."""
    parser = commands.add_parser(
        "data", help="list, show and validate measured data", description="Measured data and exact references."
    )
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")

    add = actions.add_parser("list", help="all shipped tables")
    add.set_defaults(run=run_list)

    add = actions.add_parser("show", help="what is known about one table, and its rows")
    add.add_argument("name", metavar="NAME")
    add.add_argument("--rows", type=_rows, default=10, metavar="N", help="rows to print, or 'all' (default: 10)")
    add.set_defaults(run=run_show)

    add = actions.add_parser(
        "validate",
        help="name every defect of a CSV file or a data package",
        description="Name file, row, column, value and rule of every defect, and what is doubtful about a table "
        "without defects. Without PATH: the shipped package.",
    )
    add.add_argument(
        "path", nargs="?", metavar="PATH", help="a CSV file, a folder with datapackage.json, or that file"
    )
    add.add_argument("--schema", metavar="NAME", help="kind of table of a CSV file (default: told by its header)")
    options.add_columns(add)
    add.add_argument("--unit", choices=("m", "mm"), default="m", help="unit of gap_m in a CSV file (default: m)")
    add.add_argument(
        "--conditions", metavar="FILE", help="fluid and sphere of a track in TOML, which it is held against"
    )
    options.add_strict(add)
    add.set_defaults(run=run_validate)


def _rows(text: str) -> int | None:
    if text == "all":
        return None
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number of rows nor 'all'")
    return int(text)


def run_list(args: argparse.Namespace) -> None:
    """Print one line a table."""
    from restitution import datasets

    listing = []
    for name in datasets.names():
        r = datasets.resource(name)
        stokes = r.quoted.get("stokes")
        rows = str(len(datasets.load(name)))
        listing.append((name, r.kind, r.table, rows, "" if stokes is None else f"{stokes:g}", r.experiment.cite))
    show_rows(("name", "kind", "table", "rows", "St", "source"), listing, right=("rows", "St"))


def run_show(args: argparse.Namespace) -> None:
    """Print what is known about a table, then its first rows."""
    from restitution import datasets

    r = datasets.resource(args.name)
    show_facts(_about(r))

    table = datasets.load(args.name)
    shown = table.head(len(table) if args.rows is None else args.rows)
    show("")
    rows = ([cell(value) for value in record] for record in shown.itertuples(index=False))
    show_rows(table.columns, rows, right=table.columns)
    if len(shown) < len(table):
        show(f"... {len(table) - len(shown)} more of {len(table)} rows: --rows all")


def _about(r: Resource) -> list[tuple[str, str]]:
    """What is known about a table, in the order a reader asks for it."""
    lines = [
        ("name", r.name),
        ("title", r.title),
        ("kind", f"{r.kind} ({r.table} table, version {r.version})"),
        ("experiment" if r.kind == "measured" else "source", r.experiment.reference),
        ("doi", r.experiment.doi),
        ("figure", r.experiment.figure),
        ("obtained from", f"{r.obtained_from.repository}, {r.obtained_from.path} ({r.obtained_from.commit})"),
        ("licence", r.obtained_from.licence),
        ("digitised by", r.digitised_by),
        ("error", r.digitisation_error.text),
    ]
    for word in ("sigma", "offset_sigma", "scale_sigma"):
        sigma = getattr(r.digitisation_error, word)
        if sigma:
            lines.append((word, ", ".join(f"{column} {value:g}" for column, value in sigma.items())))
    if c := r.conditions:
        lines += [
            ("fluid", f"density {c.fluid.density:g} kg/m3, viscosity {c.fluid.viscosity:g} Pa s"),
            ("sphere", f"diameter {c.sphere.diameter:g} m, density {c.sphere.density:g} kg/m3"),
            ("e_dry", "not stated" if c.sphere.e_dry is None else f"{c.sphere.e_dry:g}"),
            ("roughness", "not stated" if c.sphere.roughness is None else f"{c.sphere.roughness:g} m"),
            ("gravity", f"{c.gravity:g} m/s2"),
        ]
        if i := c.impact:
            lines.append(("impact speed", f"{i.speed:g} +- {i.speed_sigma:g} m/s, {i.speed_definition} (quoted)"))
        lines.append(("conditions", c.source or "not stated"))
    if r.conventions:
        lines.append(("conventions", f"Stokes number {r.conventions.stokes}, impact speed {r.conventions.speed}"))
    if r.quoted:
        quoted = {k: v if isinstance(v, tuple) else (v,) for k, v in r.quoted.items()}
        lines.append(("quoted", ", ".join(f"{k} {' '.join(f'{x:g}' for x in v)}" for k, v in quoted.items())))
    lines.append(("measured", ", ".join(r.measured) or "none"))
    lines += [("derived", f"{column}: {how}") for column, how in r.derived.items()]
    lines += [("note", note) for note in r.notes]
    lines += [("sha256", r.hash.removeprefix("sha256:"))]
    return lines


def run_validate(args: argparse.Namespace) -> None:
    """Print one line a valid file, and doubts; raises :class:`InputError` with the defects otherwise."""
    from restitution import datasets
    from restitution.commands import data_doubts
    from restitution.conditions import read_conditions
    from restitution.datasets.checks import check_package, infer_schema
    from restitution.datasets.package import read_package
    from restitution.doubts import refuse
    from restitution.errors import Defect, InputError
    from restitution.tables.reading import check_table

    columns = dict(args.column)
    conditions = read_conditions(args.conditions) if args.conditions else None
    path = None if args.path is None else Path(args.path)
    if path is None or path.is_dir() or path.suffix == ".json":
        if args.schema or columns or args.unit != "m" or conditions is not None:
            rule = "--schema, --column, --unit and --conditions describe a CSV file; a data package states its own"
            raise InputError(rule)
        _raise(check_package(path))
        place, package = read_package(path or datasets.folder())
        doubts = data_doubts.of_package(place, package)
        if args.strict:
            refuse(doubts)
        for r in package.resources:
            show(f"{place / r.path}: valid {r.table} table")
        show_doubts(doubts)
        return

    if args.schema is None and not columns and (impacts := _impacts_of_a_fit(path)) is not None:
        doubts = data_doubts.of_impact_table(path, columns)
        if args.strict:
            refuse(doubts)
        show(f"{path}: valid table for a fit, {impacts}")
        show_doubts(doubts)
        return
    schema = datasets.schema(args.schema) if args.schema else infer_schema(path, columns)
    if args.unit == "mm" and "gap_m" not in schema.columns:
        raise InputError(Defect(f"--unit mm: a {schema.name} table has no gap_m", file=str(path)))
    _raise(check_table(path, schema, columns, {"gap_m": 1e-3} if args.unit == "mm" else None))
    doubts = data_doubts.of_table(path, schema, columns, 1e-3 if args.unit == "mm" else 1.0, conditions)
    if args.strict:
        refuse(doubts)
    show(f"{path}: valid {schema.name} table")
    show_doubts(doubts)


def _impacts_of_a_fit(path: Path) -> str | None:
    """What a table has that is of no kind of the package's data but one that ``fit`` takes; None for others."""
    from restitution.calibration.reading.impact_data import read
    from restitution.calibration.showing import counted
    from restitution.datasets.checks import fitting_schemas
    from restitution.tables.reading import read_header

    header = set(read_header(path))
    if fitting_schemas(list(header), {}) or not {"stokes", "e_eff"} <= header:
        return None
    return counted(len(read(path)), "impact")


def _raise(defects: list) -> None:
    """Raise what was found; nothing where nothing was found."""
    from restitution.errors import InputError

    if defects:
        raise InputError(*defects)
