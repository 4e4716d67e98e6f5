"""What a table must satisfy: the models of a Table Schema and of the rules it cannot say itself.

Types and bounds are those of the Table Schema standard (https://datapackage.org/standard/table-schema/); rules
between rows and between fields stand in its custom property ``restitution:rules``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal, TypeVar

from pydantic import BaseModel, ValidationError, model_validator
from pydantic import Field as PydanticField

from restitution.conditions import Record, defects_of
from restitution.errors import InputError
from restitution.inputs import read_json

Model = TypeVar("Model", bound=BaseModel)


class Constraints(Record):
    """What one cell must satisfy; bounds are in the unit of the field."""

    required: bool = False
    minimum: float | None = None
    maximum: float | None = None
    exclusive_minimum: float | None = PydanticField(None, alias="exclusiveMinimum")
    exclusive_maximum: float | None = PydanticField(None, alias="exclusiveMaximum")
    enum: tuple[str, ...] | None = None


class Field(Record):
    """One column: ``unit`` in SI ("1" for a pure number, "" for text)."""

    name: str
    type: Literal["number", "integer", "string"]
    description: str
    unit: str = ""
    constraints: Constraints = Constraints()


class RequiredWhen(Record):
    """``field`` must not be empty in rows where every field of ``when`` has the given value."""

    field: str
    when: dict[str, str]


class Rules(Record):
    """Rules between rows and between fields, checked on the rows whose cells are valid."""

    minimum_rows: int = 1
    strictly_increasing: tuple[str, ...] = ()
    unique: tuple[tuple[str, ...], ...] = ()
    required_when: tuple[RequiredWhen, ...] = ()


class Schema(Record):
    """A kind of table. ``fields`` are its columns in their usual order."""

    standard: str | None = PydanticField(None, alias="$schema")
    name: str
    title: str
    description: str = ""
    fields: tuple[Field, ...]
    rules: Rules = PydanticField(Rules(), alias="restitution:rules")

    @model_validator(mode="after")
    def _of_its_own_fields(self) -> Schema:
        """Names stand once, and rules are about fields that there are."""
        names = [f.name for f in self.fields]
        repeated = sorted({name for name in names if names.count(name) > 1})
        if repeated or not names:
            raise ValueError(f"names a field twice: {', '.join(repeated)}" if names else "names no fields")
        rules = self.rules
        used = [*rules.strictly_increasing, *(name for group in rules.unique for name in group)]
        used += [name for rule in rules.required_when for name in (rule.field, *rule.when)]
        unknown = sorted(set(used) - set(names))
        if unknown:
            raise ValueError(f"has rules about {', '.join(unknown)}, which are no fields of it")
        return self

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(f.name for f in self.fields)

    @property
    def required(self) -> tuple[str, ...]:
        return tuple(f.name for f in self.fields if f.constraints.required)


def read_record(path: str | Path, model: type[Model]) -> Model:
    """A JSON file as a ``model``; raises :class:`InputError` naming every field that is wrong."""
    try:
        return model.model_validate(read_json(path))
    except ValidationError as error:
        raise InputError(*defects_of(error, str(path))) from None


def read_schema(path: str | Path) -> Schema:
    """The schema in a JSON file; raises :class:`InputError` naming what is wrong with it."""
    return read_record(path, Schema)
