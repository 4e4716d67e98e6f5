"""Results of simulations, kept as small tables under a key; an unchanged run is not repeated.

Each lies in a folder of its own, ``reports/runs/CASE/``, with the files that :mod:`restitution.simulate` writes.
"""

from __future__ import annotations

import json
from collections.abc import Callable
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
    import pandas as pd

FOLDER = Path("reports/runs")


class SolverContact(BaseModel):
    """One contact as the solver had it, time from the first."""

    time_s: float
    speed_in_m_s: float
    speed_out_m_s: float


class About(BaseModel):
    """``run.json``."""

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


def read_run(case: Case, folder: Path = FOLDER) -> KeptRun | None:
    """The kept result of a case; raises :class:`InputError` for a damaged one.

    None where there is none, or one of a case in an older form than can be read.
    """
    place = folder / case.name
    if not (place / "run.json").is_file():
        return None
    try:
        about = About.model_validate(json.loads((place / "run.json").read_bytes()))
    except (ValidationError, ValueError):
        rule = "is damaged: delete the folder, or repeat the run with --fresh"
        raise InputError(Defect(rule, str(place / "run.json"))) from None
    stale = about.key != run_key(case).key
    if stale:
        try:
            case = Case.model_validate(about.case_as_run)
        except ValidationError:
            return None
    trajectory = read_table(place / "trajectory.csv", datasets.schema("trajectory"))
    velocity = read_table(place / "velocity.csv", datasets.schema("settling"))
    impacts = _impacts(place / "impacts.csv")
    flow = FlowFrames()
    flow.read(place / "flow.npz")
    return KeptRun(case, about, trajectory, velocity, impacts, flow, stale)


def _impacts(path: Path) -> pd.DataFrame:
    import pandas as pd

    schema = datasets.schema("impact")
    if len(path.read_text("utf-8").splitlines()) < 2:
        return pd.DataFrame(columns=list(schema.columns))
    return read_table(path, schema)


def ensure(
    case: Case, folder: Path = FOLDER, fresh: bool = False, show: Callable[[str], None] | None = None
) -> KeptRun:
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
        raise InputError(Defect(f"has no result after its run; expected {', '.join(KEPT)}", str(place)))
    return made
