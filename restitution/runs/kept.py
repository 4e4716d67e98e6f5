"""Results of simulations, kept as small tables; a run that would come out the same is not repeated.

Each lies in a folder of its own, ``reports/runs/CASE/``, with the files that :mod:`restitution.runs.simulate`
writes.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import ValidationError

from restitution import datasets
from restitution.cases.case import Case
from restitution.errors import Defect, InputError
from restitution.runs.filmed import filmed, simulated_impacts
from restitution.runs.flow_pictures import FlowFrames
from restitution.runs.record import RESOLVED, RunRecord, changed_files, read_record
from restitution.runs.simulate import KEPT, can_resume, simulate
from restitution.runs.validity import physics
from restitution.runs.validity.program import program_hash
from restitution.runs.validity.told import departures, told
from restitution.tables.reading import read_table

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd

    from restitution.tables.schema import Schema

_MEND = "delete its folder, and the report makes the run again, or leaves it out if it is not one of its figure"


@dataclass(frozen=True)
class KeptRun:
    """A case and its kept result; it is stale where what is ``changed`` since would give another one.

    ``case`` is the case as it was run, which for a stale result need not be the present one.
    """

    case: Case
    about: RunRecord
    trajectory: pd.DataFrame
    velocity: pd.DataFrame
    impacts: pd.DataFrame
    flow: FlowFrames
    changed: tuple[str, ...] = ()

    @property
    def stale(self) -> bool:
        """Whether the run would come out otherwise now."""
        return bool(self.changed)

    @property
    def made_with(self) -> str:
        """Date and code hash, and what has changed since."""
        return f"{self.about.date}, code {self.about.code_hash}" + (
            f" ({', '.join(self.changed)} changed since)" if self.changed else ""
        )


def read_run(case: Case, folder: Path) -> KeptRun | None:
    """The kept result of a case; raises :class:`InputError` for a damaged one.

    None where there is none, or one of a case in an older form than can be read.
    """
    place = folder / case.name
    about = read_record(place, _MEND)
    if about is None:
        return None
    changed = _changed(about, case)
    return _result(place, case, about) if not changed else _as_it_was_run(place, about, changed)


def own_runs(folder: Path, known: Collection[str]) -> list[KeptRun]:
    """Results in ``folder`` whose names are not ``known``, of a user's own cases, under their folders' names.

    Those of the point-particle model, which has no grid, are left out. Raises :class:`InputError` naming all
    damaged ones.
    """
    runs, defects = [], []
    for place in sorted(folder.iterdir()) if folder.is_dir() else ():
        if place.name in known:
            continue
        try:
            about = read_record(place, _MEND)
            if about is not None and about.model == RESOLVED:
                runs.append(_as_it_was_run(place, about))
        except InputError as error:
            defects += error.defects
    if defects:
        raise InputError(*defects)
    return [run for run in runs if run is not None]


def _changed(about: RunRecord, case: Case) -> tuple[str, ...]:
    """What of case and program would give another run now than the one that is kept.

    A run is of the present program if its text made it, or if the program then and the program now both agree with
    the probes of one version. A result of the point-particle model, which takes milliseconds, is never stale.
    """
    if about.model != RESOLVED:
        return ()
    case_changed = bool(departures(about.told, told(case)))
    same_text = about.code_hash == program_hash()
    program_changed = not same_text and (about.physics is None or about.physics != physics.agreed_version())
    return ("case",) * case_changed + ("program",) * program_changed


def _as_it_was_run(place: Path, about: RunRecord, changed: tuple[str, ...] | None = None) -> KeptRun | None:
    try:
        case = Case.model_validate(about.case_as_run)
    except ValidationError:
        return None
    changed = _changed(about, case) if changed is None else changed
    return _result(place, case.model_copy(update={"name": place.name}), about, changed)


def _result(place: Path, case: Case, about: RunRecord, changed: tuple[str, ...] = ()) -> KeptRun:
    tables, defects = {}, changed_files(place, about, KEPT)
    for name, table in (("trajectory", "trajectory"), ("velocity", "settling"), ("impacts", "impact")):
        try:
            tables[name] = _table(place / f"{name}.csv", datasets.schema(table), name == "impacts")
            if name != "impacts":
                _check_end(place / f"{name}.csv", tables[name].time_s.to_numpy(float), about)
        except InputError as error:
            defects += error.defects
    if defects:
        raise InputError(*defects, Defect(f"has damaged tables: {_MEND}", file=str(place)))
    if about.model == RESOLVED and (departures(about.filmed, filmed(case)) or not physics.impacts_agree()):
        tables["impacts"] = simulated_impacts(tables["trajectory"], case)[0]
    flow = FlowFrames()
    flow.read(place / "flow.npz")
    return KeptRun(case, about, **tables, flow=flow, changed=changed)


def _table(path: Path, schema: Schema, may_be_empty: bool) -> pd.DataFrame:
    import pandas as pd

    if may_be_empty and path.is_file() and len(path.read_bytes().splitlines()) < 2:
        return pd.DataFrame(columns=list(schema.columns))
    return read_table(path, schema)


def _check_end(path: Path, time: np.ndarray, about: RunRecord) -> None:
    """A table that was cut is well formed; it ends before the run did."""
    end = time[0] + about.steps * about.step_s
    if len(time) > 1 and time[-1] < end - 2 * (time[1] - time[0]):
        raise InputError(
            Defect(f"ends before the run, which went on to {end:.4g} s", file=str(path), row=len(time) + 1)
        )


def ensure(case: Case, folder: Path, fresh: bool = False, show: Callable[[str], None] | None = None) -> KeptRun:
    """The kept result of a case, run first where there is none that is current or ``fresh`` asks for it.

    A run that was stopped is continued. Errors as in :func:`restitution.runs.simulate.simulate`.
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
