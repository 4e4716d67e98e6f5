"""Everything wrong with a data package, and which kind of table a file is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from restitution import datasets
from restitution.datasets.package import file_defects, read_package
from restitution.errors import Defect, InputError
from restitution.tables.reading import check_table, read_header
from restitution.tables.schema import Schema, read_schema


def check_package(path: str | Path | None = None) -> list[Defect]:
    """Every defect of a data package: metadata, missing or changed files, and every defect of every table.

    ``path`` is the folder or its ``datapackage.json``, by default those of the shipped one.
    """
    try:
        place, package = read_package(datasets.folder() if path is None else path)
    except InputError as error:
        return list(error.defects)
    file = str(place / "datapackage.json")
    every = [r.name for r in package.resources]
    repeated = [name for name in dict.fromkeys(every) if every.count(name) > 1]
    defects = [Defect("is the name of more than one resource", file=file, field=name) for name in repeated]
    for r in package.resources:
        defects += file_defects(place / r.path, r)
        try:
            rules = read_schema(place / r.schema_path)
        except InputError as error:
            defects += error.defects
            continue
        defects += check_table(place / r.path, rules)
        for name in (*r.measured, *r.derived, *r.digitisation_error.sigma):
            if name not in rules.columns:
                defects.append(Defect(f"is not a column of {r.path}", file=file, field=f"{r.name}.{name}"))
    return defects


def fitting_schemas(header: Sequence[str], mapped: Mapping[str, str]) -> list[Schema]:
    """The kinds of tables that a header fits, its own names ``mapped`` to columns of a schema."""
    own = {name for name in header if name not in mapped.values()} | mapped.keys()
    return [
        s
        for s in map(datasets.schema, datasets.schema_names())
        if own.issuperset(s.required) and (mapped.keys() <= set(s.columns) if mapped else own <= set(s.columns))
    ]


def infer_schema(path: str | Path, columns: Mapping[str, str] | None = None) -> Schema:
    """The one kind of table that the header of a CSV file fits; raises :class:`InputError` if not exactly one.

    ``columns`` maps columns of the schema to the file's own names, as in :func:`restitution.tables.read_table`.
    """
    header = read_header(path)
    fits = fitting_schemas(header, columns or {})
    if len(fits) == 1:
        return fits[0]
    kinds = [datasets.schema(name) for name in datasets.schema_names()]
    known = "; ".join(f"{s.name} ({', '.join(s.required)})" for s in kinds)
    what = f"the header ({', '.join(header)}) does not tell which kind of table this is"
    rule = f"{what}: name the kind or map its columns (--schema KIND, --column gap_m=NAME); known: {known}"
    raise InputError(Defect(rule, file=str(path), row=1))
