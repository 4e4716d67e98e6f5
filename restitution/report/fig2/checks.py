"""Figures of the solver beside figures from outside: ``benchmarks.sphere`` measures them, the page shows them."""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import BaseModel, TypeAdapter, ValidationError

from restitution.errors import Defect, InputError


class Check(BaseModel):
    """One figure beside its reference.

    ``error`` is relative, or absolute where the reference is 0; ``target`` is the magnitude that was aimed at;
    ``physics`` is the version of the program that gave it (:mod:`restitution.runs.validity`), None if not known.
    """

    group: str = ""
    name: str
    case: str = ""
    measured: float
    reference: float
    error: float
    target: float | None = None
    source: str
    physics: int | None = None

    @property
    def missed(self) -> bool:
        """Whether the figure is farther off than was aimed at."""
        return self.target is not None and abs(self.error) > self.target


def read_checks(path: str | Path) -> list[Check]:
    """The checks of a file; raises :class:`InputError` where it holds none."""
    try:
        return TypeAdapter(list[Check]).validate_python(json.loads(Path(path).read_bytes()))
    except OSError as error:
        raise InputError(Defect(f"cannot be read: {error.strerror}", file=str(path))) from None
    except (ValidationError, ValueError) as error:
        raise InputError(Defect(f"is no list of checks: {error}".splitlines()[0], file=str(path))) from None


def text_of(checks: list[Check]) -> str:
    """Checks as the text of their file."""
    return "[\n" + ",\n".join(f" {check.model_dump_json()}" for check in checks) + "\n]\n"
