"""``run.json``: what a run says of itself. One record, one writer, one reader."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from restitution.errors import Defect, InputError

FILE = "run.json"
RESOLVED, POINT_PARTICLE = "resolved", "point particle"
"""The models a run may be of."""


class SolverContact(BaseModel):
    """One contact as the solver had it: time in s, speeds in m/s at the wall.

    Time counts from the release while the run goes on, in ``run.json`` from the first contact. With the contact
    mode ``effective`` the speeds are those of the motion outside the film, carried to the wall.
    """

    model_config = ConfigDict(frozen=True)

    time_s: float
    speed_in_m_s: float
    speed_out_m_s: float


class RunRecord(BaseModel):
    """The content of ``run.json``.

    ``physics`` is the version that the program agreed with when the run was made, None where it departed,
    ``code_hash`` the text of that program, ``told`` what the solver was told (:mod:`restitution.runs.validity`);
    ``filmed`` is what the table of impacts was taken with beside the trajectory.
    """

    model: str = RESOLVED
    case: str
    title: str = ""
    date: str
    finished: bool
    seconds: float
    threads: int
    steps: int
    shape: tuple[int, int, int]
    step_s: float
    numbers: dict[str, float]
    closures: dict[str, Any] | None = None
    contacts: tuple[SolverContact, ...]
    notes: tuple[str, ...] = ()
    physics: int | None = None
    code_hash: str
    told: dict[str, tuple[float | str, ...]] = {}
    filmed: dict[str, tuple[float | str, ...]] = {}
    case_as_run: dict[str, Any]

    def text(self) -> str:
        """The record as JSON, an entry of a table or list a line."""
        content = self.model_dump(mode="json", exclude_none=True)
        return "{\n" + ",\n".join(f' "{name}": {_lines(value)}' for name, value in content.items()) + "\n}\n"


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
        record = RunRecord.model_validate(json.loads(path.read_bytes()))
    except (ValidationError, ValueError):
        raise InputError(Defect(f"is damaged: {mend}", file=str(path))) from None
    if not record.finished:
        raise InputError(Defect(f"is of a run that did not finish: {mend}", file=str(path)))
    return record


def model_in(folder: Path) -> str | None:
    """Which model made the results in a folder, damaged or not; None where there are none."""
    try:
        return json.loads((folder / FILE).read_text("utf-8")).get("model", RESOLVED)
    except (OSError, ValueError, AttributeError):
        return None
