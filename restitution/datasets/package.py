"""What a data package says of itself: ``datapackage.json`` as a record, and whether its files are those recorded.

The properties of Frictionless (https://datapackage.org) and the project's own, which ``data/README.md`` describes.
"""

from __future__ import annotations

import hashlib
import math
from pathlib import Path, PurePosixPath
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, FiniteFloat, model_validator

from restitution.conditions import Conditions, NonNegative, Record
from restitution.errors import Defect
from restitution.stokes import CONVENTIONS, Speed
from restitution.tables.schema import read_record


def _inside(path: str) -> str:
    if not path or not path.isprintable():
        raise ValueError("must be a path of characters that can be printed")
    if "://" in path or PurePosixPath(path).is_absolute() or ".." in PurePosixPath(path).parts:
        raise ValueError("must lie inside the package")
    return path


def _known_convention(key: str) -> str:
    if key not in CONVENTIONS:
        raise ValueError(f"must be one of {', '.join(CONVENTIONS)}")
    return key


Inside = Annotated[str, AfterValidator(_inside)]
DIMENSIONLESS = ("drag", "oscillation")
"""Kinds of tables that hold for any fluid and sphere, whoever measured them in which."""


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
    quoted: dict[str, FiniteFloat | tuple[FiniteFloat, ...]] = Field(default_factory=dict)
    measured: tuple[str, ...]
    derived: dict[str, str]
    notes: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _with_conditions(self) -> Resource:
        if self.kind == "reference" or self.table in DIMENSIONLESS:
            return self
        if self.conditions is None or self.conventions is None:
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


def read_package(path: str | Path) -> tuple[Path, Package]:
    """The folder and the metadata of a data package.

    ``path`` is the folder or its ``datapackage.json``; raises :class:`InputError` with all that is wrong in it.
    """
    file = Path(path) / "datapackage.json" if Path(path).is_dir() else Path(path)
    return file.parent, read_record(file, Package)


def file_defects(path: Path, r: Resource) -> list[Defect]:
    """A file that differs from the recorded one; that it cannot be read is found when it is read."""
    try:
        content = path.read_bytes()
    except OSError:
        return []
    defects = []
    if len(content) != r.bytes:
        defects.append(Defect(f"has {len(content)} bytes; the package records {r.bytes}", file=str(path)))
    digest = f"sha256:{hashlib.sha256(content).hexdigest()}"
    if digest != r.hash:
        defects.append(Defect(f"has changed: its hash is {digest}; the package records {r.hash}", file=str(path)))
    return defects
