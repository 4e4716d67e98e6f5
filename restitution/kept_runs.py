"""Results of simulations, kept as small tables under a key; an unchanged run is not repeated.

Each lies in a folder of its own, ``reports/runs/CASE/``, with the files that :mod:`restitution.simulate` writes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ValidationError

from restitution import datasets
from restitution.case import Case
from restitution.errors import Defect, InputError
from restitution.flow_pictures import FlowFrames
from restitution.run_key import run_key
from restitution.simulate import KEPT, can_resume, simulate
from restitution.tables import read_table

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd

    from restitution.table_schema import Schema

RESOLVED = "resolved"
"""The model of a run whose ``run.json`` names none."""
_MEND = "delete its folder, and the report makes the run again, or leaves it out if it is not one of its figure"


class SolverContact(BaseModel):
    """One contact as the solver had it, time from the first."""

    time_s: float
    speed_in_m_s: float
    speed_out_m_s: float


class About(BaseModel):
    """``run.json``."""

    model: str = RESOLVED
    key: str
    case_hash: str
    code_hash: str
    data_hash: str
    case: str
    date: str
    finished: bool
    seconds: float
    threads: int
    steps: int
    shape: tuple[int, int, int]
    step_s: float
    numbers: dict[str, float]
    contacts: tuple[SolverContact, ...]
    notes: tuple[str, ...] = ()
    case_as_run: dict[str, Any]


@dataclass(frozen=True)
class KeptRun:
    """A case and its kept result. ``stale``: made by another version of case, code or data.

    ``case`` is the case as it was run, which for a stale result need not be the present one.
    """

    case: Case
    about: About
    trajectory: pd.DataFrame
    velocity: pd.DataFrame
    impacts: pd.DataFrame
    flow: FlowFrames
    stale: bool

    @property
    def made_with(self) -> str:
        """Date and code hash, and whether the code is no longer that."""
        return f"{self.about.date}, code {self.about.code_hash}" + (
            " (code or case changed since)" if self.stale else ""
        )


def read_run(case: Case, folder: Path) -> KeptRun | None:
    """The kept result of a case; raises :class:`InputError` for a damaged one.

    None where there is none, or one of a case in an older form than can be read.
    """
    place = folder / case.name
    if not (place / "run.json").is_file():
        return None
    about = read_about(place)
    if about.key == run_key(case).key:
        return _result(place, case, about, stale=False)
    return _as_it_was_run(place, about)


def own_runs(folder: Path, known: Collection[str]) -> list[KeptRun]:
    """Results in ``folder`` whose names are not ``known``, of a user's own cases, under their folders' names.

    Those of the point-particle model, which has no grid, are left out. Raises :class:`InputError` naming all
    damaged ones.
    """
    found, defects = [], []
    for place in sorted(folder.iterdir()) if folder.is_dir() else ():
        if place.name in known or not (place / "run.json").is_file():
            continue
        try:
            about = read_about(place)
            found.append(_as_it_was_run(place, about) if about.model == RESOLVED else None)
        except InputError as error:
            defects += error.defects
    if defects:
        raise InputError(*defects)
    return [run for run in found if run is not None]


def read_about(place: Path) -> About:
    """What ``run.json`` in a folder of results says; raises :class:`InputError` for one that cannot be used."""
    path = place / "run.json"
    try:
        about = About.model_validate(json.loads(path.read_bytes()))
    except (ValidationError, ValueError):
        raise InputError(Defect(f"is damaged: {_MEND}", file=str(path))) from None
    if not about.finished:
        raise InputError(Defect(f"is of a run that did not finish: {_MEND}", file=str(path)))
    return about


def model_in(place: Path) -> str | None:
    """Which model made the results in a folder, damaged or not; None where there are none."""
    try:
        return json.loads((place / "run.json").read_text("utf-8")).get("model", RESOLVED)
    except (OSError, ValueError, AttributeError):
        return None


def _as_it_was_run(place: Path, about: About) -> KeptRun | None:
    try:
        case = Case.model_validate(about.case_as_run)
    except ValidationError:
        return None
    stale = about.key != run_key(case).key
    return _result(place, case.model_copy(update={"name": place.name}), about, stale)


def _result(place: Path, case: Case, about: About, stale: bool) -> KeptRun:
    tables, defects = {}, []
    for name, table in (("trajectory", "trajectory"), ("velocity", "settling"), ("impacts", "impact")):
        try:
            tables[name] = _table(place / f"{name}.csv", datasets.schema(table), name == "impacts")
            if name != "impacts":
                _check_end(place / f"{name}.csv", tables[name].time_s.to_numpy(float), about)
        except InputError as error:
            defects += error.defects
    if defects:
        raise InputError(*defects, Defect(f"has damaged tables: {_MEND}", file=str(place)))
    flow = FlowFrames()
    flow.read(place / "flow.npz")
    return KeptRun(case, about, **tables, flow=flow, stale=stale)


def _table(path: Path, schema: Schema, may_be_empty: bool) -> pd.DataFrame:
    import pandas as pd

    if may_be_empty and path.is_file() and len(path.read_bytes().splitlines()) < 2:
        return pd.DataFrame(columns=list(schema.columns))
    return read_table(path, schema)


def _check_end(path: Path, time: np.ndarray, about: About) -> None:
    """A table that was cut is well formed; it ends before the run did."""
    end = time[0] + about.steps * about.step_s
    if len(time) > 1 and time[-1] < end - 2 * (time[1] - time[0]):
        raise InputError(
            Defect(f"ends before the run, which went on to {end:.4g} s", file=str(path), row=len(time) + 1)
        )


def ensure(case: Case, folder: Path, fresh: bool = False, show: Callable[[str], None] | None = None) -> KeptRun:
    """The kept result of a case, run first where there is none of its key or ``fresh`` asks for it.

    A run that was stopped is continued. Errors as in :func:`restitution.simulate.simulate`.
    """
    found = None if fresh else read_run(case, folder)
    if found is not None and not found.stale:
        return found
    place = folder / case.name
    simulate(case, place, resume=can_resume(place, case) and not fresh, every_step=False, show=show)
    made = read_run(case, folder)
    if made is None:
        raise InputError(Defect(f"has no result after its run; expected {', '.join(KEPT)}", file=str(place)))
    return made
