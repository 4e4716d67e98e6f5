"""``solver.json``: what the calibration of a solver found; finite, whole, and true to itself, or refused.

Its values are put into a case where they are asked for by name, never as a silent default.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, FiniteFloat

from restitution import __version__
from restitution.calibration.estimation.maximum import LEVELS
from restitution.campaigns.design import value_of
from restitution.cases.case import Case
from restitution.cases.reading import case_of, content_of, find, nested, over
from restitution.conditions import Record
from restitution.doubts import Doubt
from restitution.emulation.calibration import Calibration
from restitution.emulation.held_out import GAIN, closer, distances
from restitution.emulation.runs_table import CELLS
from restitution.errors import Defect, InputError
from restitution.runs.record import RESOLVED
from restitution.tables.schema import read_record

FILE = "solver.json"
MODEL = "model"
_ALIKE = 1e-9
_LEVELS = tuple(f"{level:.0%}" for level in LEVELS)
_ROUND_OFF = 1e-6
Interval = tuple[FiniteFloat, FiniteFloat]
NotNegative = Annotated[FiniteFloat, Field(ge=0)]


class ParameterFit(Record):
    """One parameter: its prior range (uniform, in the logarithm or not), median and intervals by level."""

    name: str
    prior: Interval
    logarithmic: bool
    median: FiniteFloat
    intervals: dict[str, Interval]
    told: bool
    """False: the records say nothing about it, its posterior is as wide as its prior."""
    pressed: str | None = None
    """``low``, ``high``: the best values lie at that end of the runs or beyond."""


class RecordFit(Record):
    """One record: whether it was held out, frames in use, rms distances in d, discrepancy in d (median, 68 %)."""

    name: str
    held_out: bool
    runs: Annotated[int, Field(ge=1)]
    frames: Annotated[int, Field(ge=1)]
    flights: Annotated[int, Field(ge=1)]
    rms_before_d: NotNegative
    rms_after_d: NotNegative
    discrepancy_d: tuple[NotNegative, NotNegative, NotNegative] | None = None
    predicts: FiniteFloat
    """Part of the variance of runs it has not seen that the emulator predicts."""
    coverage: Annotated[FiniteFloat, Field(ge=0, le=1)]
    """Part of such runs within its 95 % intervals."""
    widened: Annotated[FiniteFloat, Field(ge=1)] = 1.0
    """Times by which its error is widened, for it is too small of itself."""


class GroupFit(Record):
    """One calibration: of the runs that have ``group`` in common."""

    group: dict[str, str]
    parameters: Annotated[tuple[ParameterFit, ...], Field(min_length=1)]
    correlation: tuple[tuple[FiniteFloat, ...], ...]
    records: Annotated[tuple[RecordFit, ...], Field(min_length=1)]
    before: dict[str, FiniteFloat] | None = None
    walkers: Annotated[int, Field(ge=1)]
    steps: Annotated[int, Field(ge=1)]
    seed: Annotated[int, Field(ge=0)]
    doubts: tuple[str, ...] = ()

    @property
    def recommended(self) -> dict[str, float]:
        """The medians."""
        return {p.name: p.median for p in self.parameters}


class SolverFit(Record):
    """The content of ``solver.json``."""

    restitution: str
    table: str
    groups: Annotated[tuple[GroupFit, ...], Field(min_length=1)]

    def text(self) -> str:
        """As JSON."""
        return self.model_dump_json(indent=1, exclude_none=True) + "\n"


def solver_fit(table: str, found: Sequence[Calibration]) -> SolverFit:
    """Calibrations as what is written."""
    return SolverFit(restitution=__version__, table=table, groups=tuple(_group(c) for c in found))


def _group(c: Calibration) -> GroupFit:
    parameters = tuple(
        ParameterFit(
            name=t.name, prior=t.prior, logarithmic=t.logarithmic, median=t.median,
            intervals={f"{level:.0%}": ends for level, ends in t.intervals.items()}, told=not t.says_nothing,
            pressed=t.pressed,
        )
        for t in c.told
    )  # fmt: skip
    lacks = {x.record: x.sigma_d for x in c.discrepancies}
    records = tuple(
        RecordFit(
            name=e.name, held_out=p.held_out, runs=len(e.runs), frames=int(e.frames.use.sum()),
            flights=e.registration.flights, rms_before_d=p.rms_before_d, rms_after_d=p.rms_after_d,
            discrepancy_d=lacks.get(e.name), predicts=e.predicts, coverage=e.check.coverage,
            widened=e.widened,
        )
        for e, p in zip((*c.used, *c.held_out), c.predictions, strict=True)
    )  # fmt: skip
    return GroupFit(
        group=dict(c.group.group), parameters=parameters,
        correlation=tuple(tuple(map(float, row)) for row in c.correlation), records=records,
        before=dict(c.before) if c.before is not None else None, walkers=c.posterior.walkers,
        steps=c.posterior.steps, seed=c.seed, doubts=tuple(map(str, c.doubts)),
    )  # fmt: skip


def read_solver(path: str | Path) -> SolverFit:
    """A calibration from its file; raises :class:`InputError` naming all that is wrong with it."""
    result = read_record(path, SolverFit)
    defects = [
        Defect(rule, file=str(path), field=f"groups.{k}.{field}", value=value)
        for k, group in enumerate(result.groups)
        for field, value, rule in _findings(group)
    ]
    if defects:
        raise InputError(*defects)
    return result


def _findings(g: GroupFit) -> Iterator[tuple[str, str | None, str]]:
    names = [p.name for p in g.parameters]
    if len(set(names)) < len(names):
        yield "parameters", ", ".join(names), "names a parameter twice"
    for k, p in enumerate(g.parameters):
        where, (low, high) = f"parameters.{k}", p.prior
        if not low < high or (p.logarithmic and low <= 0):
            yield f"{where}.prior", f"{low:g} to {high:g}", "must rise, in the logarithm from a positive number"
        if not low <= p.median <= high:
            yield f"{where}.median", f"{p.median:g}", f"lies outside its prior, {low:g} to {high:g}"
        if tuple(p.intervals) != _LEVELS:
            yield f"{where}.intervals", ", ".join(p.intervals), f"must be those of {', '.join(_LEVELS)}"
            continue
        (a, b), (c, d) = (p.intervals[level] for level in _LEVELS)
        if not low <= c <= a <= p.median <= b <= d <= high:
            yield (
                f"{where}.intervals",
                f"{c:g}, {a:g}, {b:g}, {d:g}",
                "must lie about the median, within the prior",
            )
    n, R = len(names), g.correlation
    if len(R) != n or any(len(row) != n for row in R):
        yield "correlation", f"{len(R)} rows", f"must be {n} x {n}, a row and a column a parameter"
    else:
        C = np.array(R)
        if not (np.allclose(C, C.T, atol=_ROUND_OFF) and np.allclose(np.diag(C), 1, atol=_ROUND_OFF)):
            yield "correlation", None, "must be symmetric, with ones on its diagonal"
        elif np.linalg.eigvalsh(C).min() < -_ROUND_OFF:
            yield "correlation", None, "is negative for some combination of the parameters"
    if all(r.held_out for r in g.records):
        yield "records", None, "has none that was met: all are held out"
    if g.before is not None and set(g.before) != set(names):
        yield "before", ", ".join(g.before), f"must have a value of each of {', '.join(names)}"


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
        cells = _cells(before)
        own = "without [numerics]" if cells is None else f"{cells:g} cells a diameter"
        rule = f"has no calibration of runs like {before.name}, {own}, but of {known}"
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


def _doubts(group: GroupFit, file: str) -> Iterator[Doubt]:
    if closer(group.records) >= GAIN:
        held = True in distances(group.records)
        which = "records that had no say" if held else "the records that were met (none was held out)"
        before, after = distances(group.records)[held]
        yield Doubt("no gain", f"brings the solver no closer to {which}: {before:.3f} to {after:.3f} d", file)
    if not any(name.rpartition(".")[2] == CELLS for name in group.group):
        yield Doubt("cells", "does not say of how many cells a diameter its runs are: are they the case's?", file)
    idle = [p.name for p in group.parameters if not p.told]
    if idle:
        rule = f"its records say nothing about {', '.join(idle)}: a median of all that was run, no finding"
        yield Doubt("not told", rule, file)
