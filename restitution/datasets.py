"""The shipped data: which records there are, what is known about each, and its table.

The package is a Frictionless data package (``data/datapackage.json``); its own properties are described in
``data/README.md``. It lies beside the packages in a source checkout and inside this one in an installed wheel.
"""

from __future__ import annotations

import difflib
import hashlib
import math
from dataclasses import replace
from functools import cache
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Annotated, Literal, TypeVar

from pydantic import AfterValidator, Field, model_validator

from restitution.conditions import Conditions, NonNegative, Record
from restitution.errors import Defect, InputError
from restitution.stokes import CONVENTIONS, Speed
from restitution.table_schema import Schema, read_record, read_schema
from restitution.tables import check_table, read_header, read_table
from restitution.tracks import Track

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd


T = TypeVar("T")


def _inside(path: str) -> str:
    if PurePosixPath(path).is_absolute() or ".." in PurePosixPath(path).parts:
        raise ValueError("must lie inside the package")
    return path


def _known_convention(key: str) -> str:
    if key not in CONVENTIONS:
        raise ValueError(f"must be one of {', '.join(CONVENTIONS)}")
    return key


Inside = Annotated[str, AfterValidator(_inside)]


class Source(Record):
    """Frictionless: where the data come from."""

    title: str
    path: str | None = None


class Experiment(Record):
    """The publication: ``cite`` as in running text, full ``reference``, ``doi``, ``figure`` or table."""

    cite: str
    reference: str
    doi: str
    figure: str


class ObtainedFrom(Record):
    """The public place the numbers were taken from."""

    repository: str
    path: str
    commit: str
    licence: str


class ReadingError(Record):
    """The error of digitisation, in words and, where known, as standard deviations by column.

    ``sigma`` differs from row to row, ``offset_sigma`` is common to the record (both in the unit of the column),
    ``scale_sigma`` is a common relative error.
    """

    text: str
    sigma: dict[str, NonNegative] = Field(default_factory=dict)
    offset_sigma: dict[str, NonNegative] = Field(default_factory=dict)
    scale_sigma: dict[str, NonNegative] = Field(default_factory=dict)

    @property
    def speed_scale_sigma(self) -> float:
        """Relative error common to all speeds of a track: of the scales of length and of time."""
        return math.hypot(*self.scale_sigma.values())


class QuotedConventions(Record):
    """What the quoted Stokes number stands for."""

    stokes: Annotated[str, AfterValidator(_known_convention)]
    speed: Speed


class Resource(Record):
    """What is known about one table: the properties of Frictionless, then the project's own."""

    name: str
    title: str
    path: Inside
    format: Literal["csv"] = "csv"
    mediatype: str = "text/csv"
    encoding: Literal["utf-8"] = "utf-8"
    schema_path: Inside = Field(alias="schema")
    bytes: int
    hash: Annotated[str, Field(pattern="^sha256:[0-9a-f]{64}$")]
    sources: tuple[Source, ...]

    version: str
    kind: Literal["measured", "simulated", "reference"]
    experiment: Experiment
    obtained_from: ObtainedFrom
    digitised_by: str
    digitisation_error: ReadingError
    conditions: Conditions | None = None
    conventions: QuotedConventions | None = None
    quoted: dict[str, float | tuple[float, ...]] = Field(default_factory=dict)
    measured: tuple[str, ...]
    derived: dict[str, str]
    notes: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _with_conditions(self) -> Resource:
        if self.kind != "reference" and (self.conditions is None or self.conventions is None):
            raise ValueError(f"a {self.kind} table needs conditions and conventions")
        return self

    @property
    def table(self) -> str:
        """The kind of table: the name of its schema."""
        return PurePosixPath(self.schema_path).stem


class Package(Record):
    """``datapackage.json``."""

    standard: str | None = Field(None, alias="$schema")
    name: str
    title: str
    description: str = ""
    version: str
    resources: tuple[Resource, ...]


def folder() -> Path:
    """The folder of the shipped data package."""
    here = Path(__file__).parent
    for place in (here / "_data", here.parent / "data"):
        if (place / "datapackage.json").is_file():
            return place
    raise FileNotFoundError("the data package is missing from this installation of restitution")


def names() -> list[str]:
    """The names of all shipped tables."""
    return list(_shipped())


def resource(name: str) -> Resource:
    """What is known about a table; raises :class:`InputError` for an unknown name."""
    return _pick(name, _shipped(), "dataset")


def schema(name: str) -> Schema:
    """The schema of a kind of table: trajectory, settling, impact, resistance."""
    return read_schema(_pick(name, _schemas(), "kind of table"))


def load(name: str) -> pd.DataFrame:
    """The table of that name, in SI, its file checked against the recorded hash and its schema."""
    r = resource(name)
    defects = _file_defects(folder() / r.path, r)
    if defects:
        raise InputError(*defects)
    return read_table(folder() / r.path, read_schema(folder() / r.schema_path))


def load_track(name: str, sigma: float | None = None) -> Track:
    """A trajectory or settling record as a track.

    Its noise, if ``sigma`` is not given, is what the frames show, but at least the stated error of digitisation.
    """
    r = resource(name)
    if r.table not in ("trajectory", "settling"):
        raise InputError(f"{name} is a {r.table} table, not a track")
    error = r.digitisation_error
    track = Track.from_table(load(name), sigma, error.speed_scale_sigma)
    stated = error.sigma.get("gap_m" if track.quantity == "gap" else "velocity_m_s", 0.0)
    return track if sigma is not None or stated <= track.sigma else replace(track, sigma=stated)


def read_package(path: str | Path | None = None) -> tuple[Path, Package]:
    """The folder and the metadata of a data package (default: the shipped one).

    ``path`` is the folder or its ``datapackage.json``; raises :class:`InputError` with all that is wrong in it.
    """
    path = folder() if path is None else Path(path)
    file = path / "datapackage.json" if path.is_dir() else path
    return file.parent, read_record(file, Package)


def check_package(path: str | Path | None = None) -> list[Defect]:
    """Every defect of a data package: metadata, missing or changed files, and every defect of every table."""
    try:
        place, package = read_package(path)
    except InputError as error:
        return list(error.defects)
    file = str(place / "datapackage.json")
    every = [r.name for r in package.resources]
    repeated = [name for name in dict.fromkeys(every) if every.count(name) > 1]
    found = [Defect("is the name of more than one resource", file, None, name) for name in repeated]
    for r in package.resources:
        found += _file_defects(place / r.path, r)
        try:
            rules = read_schema(place / r.schema_path)
        except InputError as error:
            found += error.defects
            continue
        found += check_table(place / r.path, rules)
        for name in (*r.measured, *r.derived, *r.digitisation_error.sigma):
            if name not in rules.columns:
                found.append(Defect(f"is not a column of {r.path}", file, None, f"{r.name}.{name}"))
    return found


def infer_schema(path: str | Path, columns: Mapping[str, str] | None = None) -> Schema:
    """The one kind of table that the header of a CSV file fits; raises :class:`InputError` if not exactly one.

    ``columns`` maps columns of the schema to the file's own names, as in :func:`restitution.tables.read_table`.
    """
    header = read_header(path)
    mapped = columns or {}
    own = {name for name in header if name not in mapped.values()} | mapped.keys()
    kinds = [schema(name) for name in _schemas()]
    fits = [
        s
        for s in kinds
        if own.issuperset(s.required) and (mapped.keys() <= set(s.columns) if mapped else own <= set(s.columns))
    ]
    if len(fits) == 1:
        return fits[0]
    known = "; ".join(f"{s.name} ({', '.join(s.required)})" for s in kinds)
    what = f"the header ({', '.join(header)}) does not tell which kind of table this is"
    rule = f"{what}: name the kind or map its columns; known: {known}"
    raise InputError(Defect(rule, str(path), 1))


def _file_defects(path: Path, r: Resource) -> list[Defect]:
    """A file that differs from the recorded one; that it cannot be read is found when it is read."""
    try:
        content = path.read_bytes()
    except OSError:
        return []
    found = []
    if len(content) != r.bytes:
        found.append(Defect(f"has {len(content)} bytes; the package records {r.bytes}", str(path)))
    digest = f"sha256:{hashlib.sha256(content).hexdigest()}"
    if digest != r.hash:
        found.append(Defect(f"has changed: its hash is {digest}; the package records {r.hash}", str(path)))
    return found


@cache
def _shipped() -> dict[str, Resource]:
    return {r.name: r for r in read_package()[1].resources}


@cache
def _schemas() -> dict[str, Path]:
    return {path.stem: path for path in sorted((folder() / "schemas").glob("*.json"))}


def _pick(name: str, known: dict[str, T], what: str) -> T:
    if name in known:
        return known[name]
    near = difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    hint = f"did you mean {' or '.join(near)}?" if near else f"known: {', '.join(known)}"
    raise InputError(f"unknown {what} {name!r}; {hint}")
