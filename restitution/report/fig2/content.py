"""Figure 2: the bouncing sphere in time, simulated and measured; what the report is made of.

The report draws and scores kept runs (:mod:`restitution.runs.kept`). Those in ``SHORT`` are made where they are
missing or stale; all other shipped cases are long, are made on request, and are shown with the date and the hash
of the code that made them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from restitution import datasets
from restitution.cases import reading as case_files
from restitution.cases.case import Case
from restitution.errors import Defect, InputError, StoppedError
from restitution.impacts.bounces import Bounces, filmed
from restitution.report.fig2.checks import Check, read_checks
from restitution.report.fig2.point_lines import PointLine, lines, without_forces
from restitution.report.fig2.scores import Score, scores
from restitution.report.fig2.studies import Group, groups
from restitution.runs.kept import KeptRun, ensure, own_runs, read_run

if TYPE_CHECKING:
    import pandas as pd

RECORD = "gondret2002_st152"
"""The record of the figure."""
PUBLISHED = "biegert2017_st152"
"""The published simulation of it."""
IMPOSED, DRY, SOFT = "gondret_st152_10_imposed", "gondret_st152_10", "gondret_st152_10_soft"
"""Contact modes (a), (b), (c) at ten cells a diameter."""
FINE = "gondret_st152_20"
"""Mode (b) on a finer grid, at half the lattice speed."""
SHORT = (IMPOSED, DRY, SOFT)
"""What is made where it is missing."""
VERIFICATION = "benchmarks/sphere.json"
"""Where a checkout keeps the solver's verification; what is read is the caller's to say."""


@dataclass(frozen=True)
class Fig2:
    """The kept runs by case, scores, the records as filmed, and the solver's verification."""

    runs: dict[str, KeptRun]
    scores: dict[str, Score]
    """By case, those of ``lines`` among them."""
    records: dict[str, Bounces]
    checks: list[Check]
    forces_off: pd.DataFrame
    """The point-particle model on the main record with each force off in turn."""
    groups: list[Group] = field(default_factory=list)
    """Cases of the main record that differ in one choice, kept or not."""
    failed: dict[str, str] = field(default_factory=dict)
    lines: list[PointLine] = field(default_factory=list)
    """The point-particle model on the main record."""
    own: list[str] = field(default_factory=list)
    """Runs of cases that are not shipped."""
    missing: list[str] = field(default_factory=list)
    """Shipped cases that have not been run."""


def gather(
    runs: str | Path,
    verification: str | Path | None = None,
    full: bool = False,
    fresh: bool = False,
    show: Callable[[str], None] | None = None,
) -> Fig2:
    """Read the kept runs, making those that are wanted: the short ones, with ``full`` all of them.

    ``fresh`` repeats the wanted ones. A run that stops in error is named in ``failed`` and the report goes on.
    """
    runs, failed, checks = Path(runs), {}, _checks(verification)
    cases = {name: case_files.read_case(name) for name in case_files.names()}
    made = set(cases) if full else set(SHORT)
    found = _kept(cases, runs, skip=made if fresh else ())
    if show is not None and not found and not fresh:
        show(f"no results are kept in {runs}: the runs of the figure are made now")
    for name in sorted(made, key=lambda n: (n not in SHORT, n)):
        if name in found and not found[name].stale:
            continue
        try:
            found[name] = ensure(cases[name], runs, fresh, show)
        except StoppedError as error:
            failed[name] = str(error)
            found.pop(name, None)
    found = {name: found[name] for name in sorted(found, key=lambda n: (n not in SHORT, n not in cases, n))}
    wanted = {run.case.record for run in found.values() if run.case.record is not None}
    records = {}
    for name in sorted(wanted | {RECORD, PUBLISHED}):
        resource = datasets.resource(name)
        if resource.table == "trajectory" and resource.conditions.sphere.e_dry is not None:
            first = 0.0 if resource.kind == "simulated" else None  # its zero is the end of its stretched contact
            records[name] = filmed(datasets.load_track(name), resource.conditions, first)
    points = lines(RECORD)
    own = [name for name in found if name not in cases]
    off = without_forces(RECORD)
    missing = [name for name in cases if name not in found and name not in failed]
    studies = groups(cases | {name: found[name].case for name in own}, RECORD)
    return Fig2(found, scores(found, records, points), records, checks, off, studies, failed, points, own, missing)


def _kept(cases: dict[str, Case], folder: Path, skip: Collection[str] = ()) -> dict[str, KeptRun]:
    """All kept runs, of shipped cases and others; raises :class:`InputError` naming everything damaged."""
    found, defects = {}, []
    for name, case in cases.items():
        try:
            if name not in skip and (run := read_run(case, folder)) is not None:
                found[name] = run
        except InputError as error:
            defects += error.defects
    try:
        found |= {run.case.name: run for run in own_runs(folder, cases)}
    except InputError as error:
        defects += error.defects
    if defects:
        raise InputError(*defects)
    return found


def _checks(given: str | Path | None) -> list[Check]:
    """The solver's verification; none where no file is named."""
    if given is None:
        return []
    path = Path(given)
    if not path.is_file():
        raise InputError(Defect("is no file", file=str(path)))
    return read_checks(path)
