"""The runs of a sweep, each known by its content: equal content is one run, whichever sweep asks for it.

The key of a run is a hash of the numbers of its case, of the model, of the record it takes data from, and of the
version of the physics: of the resolved solver the one that probe cases hold (:mod:`restitution.runs.validity`),
of the point particle, which takes milliseconds, the text of the program. ``plan.jsonl`` in the sweep's folder has
a line a run with its name and the values of the keys varied, so that what is asked of it needs no other file.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from restitution import __version__, datasets
from restitution.campaigns.design import Varied
from restitution.cases.case import Case
from restitution.doubts import of_conditions
from restitution.errors import Defect, InputError
from restitution.files import write_folder
from restitution.runs.record import POINT_PARTICLE, RESOLVED

FILE = "plan.jsonl"
RUNS = "runs"
"""Folder of the runs' folders."""
_DIGITS = 12
_NAMED = 3
"""Doubts about fluids and spheres that are said: a sweep of many may have one of each."""
_FOR_READERS = {"name", "title", "note", "prediction", "study"}


@dataclass(frozen=True)
class Planned:
    """A run by its name, which is its content's; ``case`` is None where only the folder was asked."""

    run: str
    model: str
    parameters: dict[str, Any]
    record: str | None = None
    """The measured record that it simulates."""
    case: Case | None = None
    cells: float | None = None
    """Cells per diameter, of a resolved run."""


def planned(varied: Iterable[Varied], show: Callable[[str], None] | None = None) -> list[Planned]:
    """The runs that are to be made, none twice, in the order of the design."""
    found: dict[str, Planned] = {}
    count = 0
    for one in varied:
        count += 1
        name = f"r{_key(one.case, one.model)}"
        if name not in found:
            cells = one.case.numerics.cells_per_diameter if one.model == RESOLVED and one.case.numerics else None
            found[name] = Planned(name, one.model, one.parameters, one.case.record, _plain(one.case, name), cells)
    if show is not None and count > len(found):
        show(f"{count - len(found)} of {count} runs are the same as others: each is made once")
    if show is not None:
        for doubt in of_conditions(r.case.conditions for r in found.values() if r.case is not None)[:_NAMED]:
            show(f"doubt: {doubt}")
    return list(found.values())


def write_plan(folder: Path, runs: Iterable[Planned]) -> None:
    """Write ``plan.jsonl``, the folder made if need be."""
    lines = []
    for r in runs:
        told: dict[str, Any] = {"run": r.run, "model": r.model, "parameters": r.parameters}
        told |= {name: value for name, value in (("record", r.record), ("cells", r.cells)) if value is not None}
        lines.append(f"{json.dumps(told, allow_nan=False)}\n")
    write_folder(folder, {FILE: "".join(lines)})


def read_plan(folder: Path) -> list[Planned]:
    """The runs of a sweep's folder; raises :class:`InputError` where it is none, or its plan is damaged."""
    path = folder / FILE
    if not path.is_file():
        raise InputError(Defect(f"is no folder of a sweep: it has no {FILE}", file=str(folder)))
    found = []
    for row, line in enumerate(path.read_bytes().splitlines(), 1):
        try:
            found.append(Planned(**json.loads(line)))
        except (ValueError, TypeError):
            rule = "is damaged: give the same 'restitution sweep SWEEP.toml' again, which writes it anew"
            raise InputError(Defect(rule, file=str(path), row=row)) from None
    return found


def replaced(folder: Path, runs: Iterable[Planned], mean_it: bool = False) -> str | None:
    """What is to be said of runs that the folder's plan has and this one has not; None where there are none.

    Raises :class:`InputError` where that plan is another study's, unless one says to ``mean_it``: no run is in
    both, and model and record, or all keys varied, are others.
    """
    try:
        before = read_plan(folder)
    except InputError:  # none, or damaged: it is written anew
        return None
    runs = list(runs)
    left_out = {r.run for r in before} - {r.run for r in runs}
    kinds = [{(r.model, r.record) for r in plan} for plan in (before, runs)]
    names = [{name for r in plan for name in r.parameters} for plan in (before, runs)]
    same_study = kinds[0] & kinds[1] and names[0] & names[1]
    if len(left_out) == len(before) > 0 and not same_study and not mean_it:
        rule = (
            f"is the folder of another sweep, of {len(before)} runs that vary {', '.join(sorted(names[0]))}: name "
            "another --out, or --replace its plan"
        )
        raise InputError(Defect(rule, file=str(folder)))
    if not left_out:
        return None
    count = "1 run" if len(left_out) == 1 else f"{len(left_out)} runs"
    return f"{count} of the earlier plan not in this one; 'restitution sweep clean {folder}' removes them"


def _plain(case: Case, name: str) -> Case:
    """The case under the run's name, without what is said of its base to readers."""
    return case.model_copy(update={"name": name, "study": None, "prediction": False})


def _key(case: Case, model: str) -> str:
    point = model == POINT_PARTICLE
    hidden = _FOR_READERS | ({"numerics"} if point else set())
    content = case.model_dump(mode="json", exclude=hidden)
    data = datasets.resource(case.record).hash if case.record is not None else ""
    parts = json.dumps([content, model, data, __version__, _program(point)], sort_keys=True)
    return hashlib.sha256(parts.encode()).hexdigest()[:_DIGITS]


def _program(point: bool) -> int | str:
    """What stands for the program: its physics' version where probes hold that, else its text."""
    from restitution.runs.validity.program import program_hash

    if point:
        return program_hash()
    from restitution.runs.validity import physics

    agreed = physics.agreed_version()
    return program_hash() if agreed is None else agreed
