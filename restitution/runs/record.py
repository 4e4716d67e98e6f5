"""``run.json``: what a run says of itself. One record, one writer, one reader."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from restitution.conditions import defects_of
from restitution.errors import Defect, InputError
from restitution.inputs import read_bytes, read_json

FILE = "run.json"
RESOLVED, POINT_PARTICLE = "resolved", "point particle"
"""The models a run may be of."""


class SolverContact(BaseModel):
    """One contact as the solver had it: time in s, speeds in m/s at the wall.

    Time counts from the release while the run goes on, in ``run.json`` from the first contact. With the contact
    mode ``effective`` the speeds are those of the motion outside the film, carried to the wall.
    """

    model_config = ConfigDict(frozen=True)

    time_s: FiniteFloat
    speed_in_m_s: Annotated[FiniteFloat, Field(ge=0)]
    speed_out_m_s: Annotated[FiniteFloat, Field(ge=0)]


class RunRecord(BaseModel):
    """The content of ``run.json``.

    ``physics`` is the version that the program agreed with when the run was made, None where it departed,
    ``code_hash`` the text of that program, ``told`` what the solver was told (:mod:`restitution.runs.validity`);
    ``filmed`` is what the table of impacts was taken with beside the trajectory. ``files`` has the SHA-256 of each
    file written with it, ``seal`` that of all its other fields; older records have neither.
    """

    model: str = RESOLVED
    case: str
    title: str = ""
    date: str
    finished: bool
    seconds: Annotated[FiniteFloat, Field(ge=0)]
    threads: Annotated[int, Field(ge=0)]
    steps: Annotated[int, Field(ge=1)]
    shape: tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]]
    step_s: Annotated[FiniteFloat, Field(gt=0)]
    numbers: dict[str, FiniteFloat]
    closures: dict[str, Any] | None = None
    contacts: tuple[SolverContact, ...]
    notes: tuple[str, ...] = ()
    physics: int | None = None
    code_hash: str
    told: dict[str, tuple[float | str, ...]] = {}
    filmed: dict[str, tuple[float | str, ...]] = {}
    case_as_run: dict[str, Any]
    files: dict[str, str] = {}
    seal: str | None = None

    def text(self) -> str:
        """The record as JSON, an entry of a table or list a line, under its seal."""
        content = self.model_dump(mode="json", exclude_none=True, exclude={"seal"})
        content["seal"] = _seal(content)
        return "{\n" + ",\n".join(f' "{name}": {_lines(value)}' for name, value in content.items()) + "\n}\n"


def digest(content: str | bytes) -> str:
    """SHA-256 of a file's content."""
    return hashlib.sha256(content.encode() if isinstance(content, str) else content).hexdigest()


def changed_files(folder: Path, record: RunRecord, names: Iterable[str]) -> list[Defect]:
    """Those of the named files that are no longer as they were written with the record."""
    defects = []
    for name in names:
        path, known = folder / name, record.files.get(name)
        if known is None:
            continue
        if not path.is_file():
            defects.append(Defect("is missing", file=str(path)))
        elif digest(read_bytes(path)) != known:
            rule = "has changed since it was written: its SHA-256 is not that in run.json"
            defects.append(Defect(rule, file=str(path)))
    return defects


def _seal(content: dict[str, Any]) -> str:
    return digest(json.dumps(content, sort_keys=True))


def _lines(value: Any) -> str:
    if isinstance(value, dict) and value:
        return "{\n" + ",\n".join(f"  {json.dumps(k)}: {json.dumps(v)}" for k, v in value.items()) + "\n }"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(f"  {json.dumps(v)}" for v in value) + "\n ]"
    return json.dumps(value)


def read_record(folder: Path, mend: str = "run the case again") -> RunRecord | None:
    """The record of the run in ``folder``; None where there is none.

    Raises :class:`InputError`, which says how to ``mend`` it, for one that is damaged or of an unfinished run.
    """
    path = folder / FILE
    if not path.is_file():
        return None
    try:
        content = read_json(path)
        record = RunRecord.model_validate(content)
    except ValidationError as error:
        raise InputError(Defect(f"is damaged: {mend}", file=str(path)), *defects_of(error, str(path))) from None
    except InputError as error:
        raise InputError(Defect(f"is damaged: {mend}", file=str(path)), *error.defects) from None
    sealed = content.pop("seal", None)
    if (record.files or sealed is not None) and sealed != _seal(content):
        rule = f"has changed since it was written, as its seal shows: {mend}"
        raise InputError(Defect(rule, file=str(path), field="seal"))
    if not record.finished:
        raise InputError(Defect(f"is of a run that did not finish: {mend}", file=str(path)))
    return record


def model_in(folder: Path) -> str | None:
    """Which model made the results in a folder, damaged or not; None where there are none."""
    try:
        return read_json(folder / FILE).get("model", RESOLVED)
    except (InputError, AttributeError):
        return None
