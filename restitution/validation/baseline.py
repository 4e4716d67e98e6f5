"""The baseline: what rows gave when somebody last said that it was right, and how far that may move.

One JSON file, a row an entry, known by the :attr:`~restitution.validation.row.Row.key` of its case. Each value has
the largest difference that was *measured* between ways of running one and the same program (threads, processors,
versions of libraries, precisions; ``spread.json`` beside it), and a tolerance of five times that. The file has a
seal, so that it is renewed by ``--bless`` and not by hand.
"""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from restitution import datasets
from restitution.conditions import defects_of
from restitution.errors import Defect, InputError
from restitution.inputs import read_json
from restitution.runs.record import digest
from restitution.runs.validity.program import program_hash
from restitution.validation.row import Row
from restitution.validation.scorecard import Result
from restitution.validation.verdict import Held

BASELINE, SPREAD = "baseline.json", "spread.json"
FOLDER = Path("reports/validate")
"""Where a checkout keeps both; an installed program has them beside this module."""
VERSION = 1
_MEND = "take it from version control, or delete it and have --bless write a new one"
SAFETY = 5
"""Tolerances are so many times the measured spread."""
_DIGITS = 1e-12
"""Least tolerance, over the value: the digits that are kept."""
_SOURCES = ("lbm", "restitution", "data", "reports/runs")
"""What must be as committed when a baseline is renewed: the program, the records, the kept runs."""


class HeldValue(BaseModel):
    """One value: its ``spread`` over ways of running, and how far another may be from it."""

    model_config = ConfigDict(extra="forbid")

    value: FiniteFloat
    spread: Annotated[FiniteFloat, Field(ge=0)]
    tolerance: Annotated[FiniteFloat, Field(ge=0)]


class HeldRow(BaseModel):
    """One row: the key of its case, its values, and who said when and why that they are right."""

    model_config = ConfigDict(extra="forbid")

    key: str
    values: dict[str, HeldValue]
    reason: str
    commit: str
    date: str


class Baseline(BaseModel):
    """The content of ``baseline.json``, rows by name."""

    model_config = ConfigDict(extra="forbid")

    version: int
    rows: dict[str, HeldRow]

    def held(self, row: Row) -> dict[str, Held] | None:
        """What is held of a row, by label; None where there is nothing of this case."""
        found = self.rows.get(row.name)
        if found is None or found.key != row.key:
            return None
        return {label: Held(v.value, v.tolerance) for label, v in found.values.items()}

    def text(self) -> str:
        """The file, a value a line."""
        content = self.model_dump(mode="json")
        return json.dumps(content | {"seal": _seal(content)}, indent=1) + "\n"


def _seal(content: Mapping[str, Any]) -> str:
    return digest(json.dumps(content, sort_keys=True))


def read_baseline(path: Path) -> Baseline:
    """A baseline; raises :class:`InputError` for one of another version, cut short, or edited by hand."""
    try:
        content = read_json(path)
    except InputError as error:
        raise InputError(*error.defects, Defect(f"is no baseline any more: {_MEND}", file=str(path))) from None
    if not isinstance(content, dict) or "version" not in content:
        raise InputError(Defect(f"is no baseline of 'restitution validate': {_MEND}", file=str(path)))
    if content["version"] != VERSION:
        rule = f"is of a baseline of another version; this program reads {VERSION}: {_MEND}"
        raise InputError(Defect(rule, file=str(path), field="version", value=str(content["version"])))
    sealed = content.pop("seal", None)
    try:
        baseline = Baseline.model_validate(content)
    except ValidationError as error:
        raise InputError(*defects_of(error, str(path))) from None
    if sealed != _seal(baseline.model_dump(mode="json")):
        rule = f"has been edited since --bless wrote it, as its seal shows: {_MEND}"
        raise InputError(Defect(rule, file=str(path), field="seal"))
    return baseline


def shipped(name: str) -> Path:
    """Where the program keeps :data:`BASELINE` or :data:`SPREAD`: the folder one is in, if a checkout."""
    installed = Path(__file__).with_name(name)
    return installed if installed.is_file() and not (FOLDER / name).is_file() else FOLDER / name


def read_spread(path: Path) -> dict[str, dict[str, float]]:
    """The largest difference measured of each value, by row and label; of ways of running, the worst."""
    content = read_json(path)
    try:
        return {
            row: {label: max(ways.values()) for label, ways in labels.items()}
            for row, labels in content["rows"].items()
        }
    except (KeyError, AttributeError, TypeError, ValueError):
        raise InputError(Defect("is no table of spreads", file=str(path))) from None


def check_blessing(rows: Mapping[str, Row], spread: Mapping[str, Mapping[str, float]], reason: str) -> str:
    """The commit that a baseline of ``rows`` would be of, found before they are measured.

    Raises :class:`InputError` for an empty reason, a program that is not as committed, and values whose spread was
    not measured, naming each.
    """
    defects = [] if reason.strip() else [Defect("say why, in a few words", field="--bless")]
    commit, dirty = _committed()
    defects += [Defect(f"is not as committed: commit first, then --bless ({dirty})")] if dirty else []
    for name, row in rows.items():
        missing = [r.label for r in row.truth() if r.label not in spread.get(name, {})]
        if missing:
            rule = f"its spread was not measured: python -m benchmarks.validation --spread --only {name}"
            defects.append(Defect(rule, field=name, value=missing[0]))
    if defects:
        raise InputError(*defects)
    return commit


def blessed(
    rows: Mapping[str, Row],
    results: Mapping[str, Result],
    spread: Mapping[str, Mapping[str, float]],
    reason: str,
    before: Baseline | None,
    known: Mapping[str, Row],
) -> Baseline:
    """A baseline with ``rows`` renewed; others of ``before`` stay as long as they are ``known``.

    Raises :class:`InputError` as :func:`check_blessing` does, and for a row without a value.
    """
    commit = check_blessing(rows, spread, reason)
    defects, made, date = [], {}, time.strftime("%Y-%m-%d", time.gmtime())
    for name, row in rows.items():
        values, labels = results[name].values or {}, [r.label for r in row.truth()]
        if any(values.get(label) is None for label in labels):
            defects.append(Defect(f"has no value: {results[name].why or 'not a number'}", field=name))
            continue
        held = {label: _held(values[label], spread[name][label]) for label in labels}
        made[name] = HeldRow(key=row.key, values=held, reason=reason.strip(), commit=commit, date=date)
    if defects:
        raise InputError(*defects)
    others = {} if before is None else {n: r for n, r in before.rows.items() if n in known}
    order = [*known]
    return Baseline(version=VERSION, rows=dict(sorted((others | made).items(), key=lambda e: order.index(e[0]))))


def _held(value: float, spread: float) -> HeldValue:
    tolerance = max(SAFETY * spread, _DIGITS * abs(value))
    return HeldValue(value=_g(value), spread=_g(spread), tolerance=_g(tolerance))


def _g(value: float) -> float:
    return float(f"{value:.13g}")


def _committed() -> tuple[str, str]:
    """What program it is, and the first of its files that is not as committed there.

    In a checkout the commit; an installed program is known by its version and its text.
    """
    root = datasets.folder().parent
    try:
        if Path(_git(root, "rev-parse", "--show-toplevel")).resolve() != root.resolve():
            raise FileNotFoundError(root)  # installed within a checkout of something else
        head = _git(root, "rev-parse", "--short=12", "HEAD")
        changed = _git(root, "status", "--porcelain", "--", *_SOURCES)
    except (OSError, subprocess.CalledProcessError):
        return f"version {metadata.version('restitution')}, text {program_hash()}", ""
    lines = changed.splitlines()
    return head, f"{lines[0].strip()}{f' and {len(lines) - 1} more' if len(lines) > 1 else ''}" if lines else ""


def _git(root: Path, *arguments: str) -> str:
    done = subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True, check=True)
    return done.stdout.strip()
