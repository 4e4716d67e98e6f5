"""A table of runs, made with any solver: one row a run, its parameters and the place of its trajectory.

======================  ==========================================================================================
column                  content
======================  ==========================================================================================
``run``                 name of the run, once
``track``               path of its trajectory, beside the table or absolute: time and gap, or velocity
``record``              the measured record that it simulates: a shipped one by name, or a file; may be left out
                        where all runs are of one
``state``               may be left out; runs that are not ``finished`` take no part
every other             a parameter: numbers are calibrated, texts (a form of film) and ``cells_per_diameter``
                        divide the runs into groups, each calibrated for itself
======================  ==========================================================================================
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution import datasets
from restitution.doubts import Doubt
from restitution.errors import Defect, InputError
from restitution.tables.csv_text import CsvText
from restitution.units import NUMBER

FILE = "runs.csv"
OWN = ("run", "state", "track", "record")
CELLS = "cells_per_diameter"
FINISHED = "finished"
_ALIKE = 1e-9
"""Relative difference below which two values of a parameter are the same."""


@dataclass(frozen=True)
class Run:
    """One run: its row in the table, its parameters in their order, its trajectory, what it simulates."""

    name: str
    row: int
    values: tuple[float, ...]
    track: Path
    record: str


@dataclass(frozen=True)
class Runs:
    """Runs of one group, varied in ``parameters``; ``group`` names what all of them have, such as the cells."""

    file: str
    parameters: tuple[str, ...]
    runs: tuple[Run, ...]
    group: tuple[tuple[str, str], ...] = ()
    doubts: tuple[Doubt, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def records(self) -> tuple[str, ...]:
        """What is simulated, in the order of the table."""
        return tuple(dict.fromkeys(run.record for run in self.runs))

    @property
    def label(self) -> str:
        """The group in words."""
        return ", ".join(f"{name} = {value}" for name, value in self.group)

    @property
    def ranges(self) -> NDArray:
        """Least and greatest value of each parameter, (parameters, 2)."""
        values = np.array([run.values for run in self.runs])
        return np.stack([values.min(axis=0), values.max(axis=0)], axis=1)

    def of(self, record: str) -> tuple[Run, ...]:
        """The runs of one record."""
        return tuple(run for run in self.runs if run.record == record)


def read_runs(path: str | Path, record: str | None = None) -> list[Runs]:
    """The runs of a table, or of the ``runs.csv`` in a folder, by group.

    Parameters
    ----------
    path : the table or the folder.
    record : what all runs simulate, for a table without the column.

    Raises
    ------
    InputError : naming every row that cannot be used.
    """
    file = Path(path) / FILE if Path(path).is_dir() else Path(path)
    text = CsvText.read(file)
    if text.defects:
        raise InputError(*text.defects)
    cells = _cells(text, str(file), record)
    left_out = [row for row, state in cells["state"].items() if state.lower() not in ("", FINISHED)]
    rows = [row for row in cells["run"] if row not in left_out]
    if not rows:
        raise InputError(Defect("has no finished run", file=str(file)))
    names = [name for name in text.header if name not in OWN]
    words, defects = _kinds(cells, names, rows, str(file))
    numbers = [name for name in names if name not in words]
    defects += _row_defects(cells, rows, numbers, file)
    if not numbers:
        defects.append(Defect(f"has no column of a parameter beside {', '.join(text.header)}", file=str(file)))
    if defects:
        raise InputError(*defects)
    dividing = [name for name in names if name in words or name.rpartition(".")[2] == CELLS]
    groups: dict[tuple, list[int]] = {}
    for row in rows:
        groups.setdefault(tuple(cells[name][row] for name in dividing), []).append(row)
    notes = (f"{len(left_out)} of {len(cells['run'])} runs are not finished and take no part",) if left_out else ()
    found = []
    for key, members in groups.items():
        varied, constant = [], []
        for name in numbers:
            if name not in dividing:
                same = len({float(cells[name][row]) for row in members}) == 1
                (constant if same else varied).append(name)
        runs = tuple(
            Run(
                cells["run"][row], row, tuple(float(cells[name][row]) for name in varied),
                _place(cells["track"][row], file), cells["record"][row],
            )
            for row in members
        )  # fmt: skip
        group = tuple(zip(dividing, key, strict=True))
        if not varied:
            where = f" where {', '.join('='.join(g) for g in group)}" if group else ""
            raise InputError(Defect(f"varies nothing{where}: every parameter is constant", file=str(file)))
        doubts = tuple(
            Doubt("constant", f"{name} is {cells[name][members[0]]} in every run: it is not calibrated", str(file))
            for name in constant
        )
        found.append(Runs(str(file), tuple(varied), runs, group, doubts, notes))
    _check_repeats(found)
    return found


def _cells(text: CsvText, file: str, record: str | None) -> dict[str, dict[int, str]]:
    """The cells by column and row; raises for a table that has not the shape of one."""
    defects = [
        Defect(f"is missing; the header names {', '.join(text.header)}", file=file, row=1, field=name)
        for name in ("run", "track")
        if name not in text.header
    ]
    if "record" not in text.header and record is None:
        rule = "is missing: name what the runs simulate by --record, or in a column"
        defects.append(Defect(rule, file=file, row=1, field="record"))
    counts = Counter(text.header)
    defects += [
        Defect("appears more than once in the header", file=file, row=1, field=n) for n in counts if counts[n] > 1
    ]
    defects += [
        Defect(f"has {len(row)} values where the header names {len(text.header)} columns", file=file, row=number)
        for number, row in text.rows
        if len(row) != len(text.header)
    ]
    if not text.rows:
        defects.append(Defect("has no runs below the header", file=file))
    if defects:
        raise InputError(*defects)
    cells = {n: {number: row[k] for number, row in text.rows} for k, n in enumerate(text.header)}
    cells.setdefault("state", {number: "" for number, _ in text.rows})
    cells.setdefault("record", {number: record or "" for number, _ in text.rows})
    return cells


def _kinds(
    cells: dict[str, dict[int, str]], names: Sequence[str], rows: Sequence[int], file: str
) -> tuple[list[str], list[Defect]]:
    """Which columns are texts, and cells that are neither what their column is nor empty."""
    words, defects = [], []
    for name in names:
        texts = [row for row in rows if cells[name][row] and not NUMBER.fullmatch(cells[name][row])]
        odd = [row for row in texts if cells[name][row].lower() in ("nan", "inf", "-inf", "none", "null")]
        if len(texts) == len(rows) and not odd:
            words.append(name)
            continue
        rule = "must be a finite number, as in the other runs"
        defects += [Defect(rule, file=file, row=row, field=name, value=cells[name][row]) for row in texts]
        defects += [
            Defect("must not be empty", file=file, row=row, field=name) for row in rows if not cells[name][row]
        ]
        defects += [
            Defect("must be finite", file=file, row=row, field=name, value=cells[name][row])
            for row in rows
            if row not in texts and cells[name][row] and not math.isfinite(float(cells[name][row]))
        ]
    return words, defects


def _row_defects(
    cells: dict[str, dict[int, str]], rows: Sequence[int], numbers: Sequence[str], file: Path
) -> list[Defect]:
    defects, seen = [], {}
    for row in rows:
        name, track = cells["run"][row], cells["track"][row]
        if not name:
            defects.append(Defect("must not be empty", file=str(file), row=row, field="run"))
        elif name in seen:
            rule = f"is the name of the run in row {seen[name]} already"
            defects.append(Defect(rule, file=str(file), row=row, field="run", value=name))
        seen.setdefault(name, row)
        if not track:
            rule = "must not be empty: where is the run's trajectory? (state: failed leaves it out)"
            defects.append(Defect(rule, file=str(file), row=row, field="track"))
        elif not _place(track, file).is_file():
            rule = "is no file: where is the run's trajectory?"
            defects.append(Defect(rule, file=str(file), row=row, field="track", value=track))
        record = cells["record"][row]
        if record in datasets.names():
            continue
        place = _place(record, file)
        if not (record and place.is_file()):
            rule = "is no shipped record ('restitution data list'), and no file"
            defects.append(Defect(rule, file=str(file), row=row, field="record", value=record))
        else:
            cells["record"][row] = str(place)
    return list(dict.fromkeys(defects))


def _place(given: str, file: Path) -> Path:
    """A path that the table names, beside itself."""
    return file.parent / given


def _check_repeats(groups: Sequence[Runs]) -> None:
    """Refuse runs of the same parameters: one of them was counted twice, or a column that differs is missing."""
    defects = []
    for g in groups:
        for i, run in enumerate(g.runs):
            for other in g.runs[:i]:
                if run.record == other.record and np.allclose(run.values, other.values, rtol=_ALIKE, atol=0):
                    rule = f"repeats the parameters of run {other.name} in row {other.row}"
                    defects.append(Defect(rule, file=g.file, row=run.row, field="run", value=run.name))
                    break
    if defects:
        raise InputError(*defects)
