"""What a calibration recommends, put into a case: asked for by name, never a silent default."""

from __future__ import annotations

from pathlib import Path

from restitution.campaigns.design import value_of
from restitution.cases.case import Case
from restitution.cases.reading import case_of, content_of, find, nested, over
from restitution.doubts import Doubt
from restitution.emulation.held_out import GAIN, closer, distances
from restitution.emulation.runs_table import CELLS
from restitution.emulation.solver_file import GroupFit, read_solver
from restitution.errors import Defect, InputError
from restitution.runs.record import RESOLVED

MODEL = "model"
_ALIKE = 1e-9


def calibrated(case: str | Path, solver: str | Path) -> tuple[Case, dict[str, float], list[Doubt]]:
    """A case with the parameters that a calibration recommends for its kind of run.

    Parameters
    ----------
    case : path of a TOML file, or the name of a shipped case.
    solver : path of a ``solver.json``. Of its groups the one whose cells per diameter, form of film and whatever
        else it names are those of the case.

    Returns
    -------
    The case; the values, in SI, by the key they replace; doubts about the calibration.

    Raises
    ------
    InputError : the file is none, none of its groups is of such runs, a parameter is no key of a case.
    """
    path = find(case)
    content = content_of(path)
    before = case_of(content, str(path), runnable=False)
    groups = read_solver(solver).groups
    fitting = [g for g in groups if all(_has(before, name, value) for name, value in g.group.items())]
    if not fitting:
        known = "; ".join(", ".join(f"{name} = {value}" for name, value in g.group.items()) for g in groups)
        rule = f"has no calibration of runs like {before.name}, {_cells(before)} cells a diameter, but of {known}"
        raise InputError(Defect(rule, file=str(solver), field="groups"))
    group = fitting[0]
    strange = [
        p.name for p in group.parameters if value_of(before, p.name) is None and not _settable(before, p.name)
    ]
    if strange:
        rule = "is no key of a case: it is another solver's"
        raise InputError(*(Defect(rule, file=str(solver), field=name) for name in strange))
    title = f"{before.title or before.name}, calibrated"
    changed = case_of(over(content, nested(group.recommended) | {"title": title}), str(path))
    return changed, group.recommended, list(_doubts(group, str(solver)))


def _has(case: Case, name: str, value: str) -> bool:
    """Whether a case is of the runs that have this in common."""
    if name == MODEL:
        return value == RESOLVED
    own = _cells(case) if name.rpartition(".")[2] == CELLS else value_of(case, name)
    try:
        return own is not None and abs(float(value) - float(own)) <= _ALIKE * abs(float(own))
    except (TypeError, ValueError):
        return str(own) == value


def _cells(case: Case) -> float | None:
    return None if case.numerics is None else case.numerics.cells_per_diameter


def _settable(case: Case, name: str) -> bool:
    """Whether a key that the case leaves open is one all the same."""
    section, _, key = name.rpartition(".")
    own = value_of(case, section) if section else case
    return own is not None and key in getattr(type(own), "model_fields", {})


def _doubts(group: GroupFit, file: str):
    if closer(group.records) >= GAIN:
        held = True in distances(group.records)
        which = "records that had no say" if held else "the records that were met (none was held out)"
        before, after = distances(group.records)[held]
        yield Doubt("no gain", f"brings the solver no closer to {which}: {before:.3f} to {after:.3f} d", file)
    if not any(name.rpartition(".")[2] == CELLS for name in group.group):
        yield Doubt("cells", "does not say of how many cells a diameter its runs are: are they the case's?", file)
    idle = [p.name for p in group.parameters if not p.told]
    if idle:
        yield Doubt(
            "not told", f"its records say nothing about {', '.join(idle)}: it has the middle of the runs", file
        )
