"""``solver.json``: what the calibration of a solver found; finite, whole, and true to itself, or refused."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, FiniteFloat

from restitution import __version__
from restitution.calibration.estimation.maximum import LEVELS
from restitution.conditions import Record
from restitution.emulation.calibration import Calibration
from restitution.errors import Defect, InputError
from restitution.tables.schema import read_record

FILE = "solver.json"
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
