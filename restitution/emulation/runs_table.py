"""A table of runs, made with any solver: one row a run, its parameters and the place of its trajectory.

======================  ==========================================================================================
column                  content
======================  ==========================================================================================
``run``                 name of the run, once
``track``               path of its trajectory, beside the table or absolute: time and gap, or velocity
``record``              the measured record that it simulates: a shipped one by name, or a file; may be left out
                        where all runs are of one
``state``               may be left out; runs that are not ``finished`` take no part
``seconds``, ...        what a sweep writes of its runs beside (``attempts``, ``message``): no parameters
every other             a parameter: numbers are calibrated, texts (a form of film) and ``cells_per_diameter``
                        divide the runs into groups, each calibrated for itself
======================  ==========================================================================================
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution import datasets
from restitution.campaigns.table import CELLS
from restitution.doubts import Doubt
from restitution.errors import Defect, InputError, of_rows
from restitution.tables.csv_text import CsvText
from restitution.units import NUMBER

FILE = "runs.csv"
OWN = ("run", "state", "track", "record", "seconds", "attempts", "message")
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
    left_out = {row for row, state in cells["state"].items() if state.lower() not in ("", FINISHED)}
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
    cut = [(number, len(row)) for number, row in text.rows if len(row) != len(text.header)]
    defects += of_rows(
        lambda i: f"has {cut[i][1]} values where the header names {len(text.header)} columns",
        [number for number, _ in cut],
        file=file,
    )
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
    words: list[str] = []
    defects: list[Defect] = []
    for name in names:
        column = cells[name]
        texts = [row for row in rows if column[row] and not NUMBER.fullmatch(column[row])]
        odd = any(column[row].lower() in ("nan", "inf", "-inf", "none", "null") for row in texts)
        if len(texts) == len(rows) and not odd:
            words.append(name)
            continue
        numbers = set(rows).difference(texts)
        endless = [row for row in rows if row in numbers and column[row] and not math.isfinite(float(column[row]))]
        empty = [row for row in rows if not column[row]]
        defects += _of_cells("must be a finite number, as in the other runs", texts, column, file, name)
        defects += of_rows("must not be empty", empty, file=file, field=name)
        defects += _of_cells("must be finite", endless, column, file, name)
    return words, defects


def _of_cells(rule: str, rows: Sequence[int], cells: Mapping[int, str], file: str, name: str) -> Iterator[Defect]:
    return of_rows(rule, rows, lambda i: cells[rows[i]], file=file, field=name)


def _row_defects(
    cells: dict[str, dict[int, str]], rows: Sequence[int], numbers: Sequence[str], file: Path
) -> list[Defect]:
    again, seen = list[tuple[int, int]](), dict[str, int]()
    for row in rows:
        first = seen.setdefault(cells["run"][row], row)
        if first != row and cells["run"][row]:
            again.append((row, first))
    names, tracks, records = cells["run"], cells["track"], cells["record"]
    file_of = {track: _place(track, file).is_file() for track in set(tracks.values()) if track}
    known = set(datasets.names())
    own = {r: str(_place(r, file)) for r in set(records.values()) - known if r and _place(r, file).is_file()}
    strange = [row for row in rows if records[row] not in known and records[row] not in own]
    named, at = str(file), [row for row, _ in again]
    defects = [
        *of_rows("must not be empty", [row for row in rows if not names[row]], file=named, field="run"),
        *of_rows(
            lambda i: f"is the name of the run in row {again[i][1]} already",
            at, lambda i: names[at[i]], file=named, field="run",
        ),
        *of_rows(
            "must not be empty: where is the run's trajectory? (state: failed leaves it out)",
            [row for row in rows if not tracks[row]], file=named, field="track",
        ),
        *_of_cells(
            "is no file: where is the run's trajectory?",
            [row for row in rows if tracks[row] and not file_of[tracks[row]]], tracks, named, "track",
        ),
        *_of_cells(
            "is no shipped record ('restitution data list'), and no file", strange, records, named, "record"
        ),
    ]  # fmt: skip
    records.update((row, own[records[row]]) for row in rows if records[row] in own)
    return sorted(defects, key=lambda d: d.row or 0)


def _place(given: str, file: Path) -> Path:
    """A path that the table names, beside itself."""
    return file.parent / given


def _check_repeats(groups: Sequence[Runs]) -> None:
    """Refuse runs of the same parameters: one of them was counted twice, or a column that differs is missing."""
    defects: list[Defect] = []
    for g in groups:
        found = list[tuple[Run, Run]]()
        for record in g.records:
            runs = g.of(record)
            levels = [_levels(np.array(column)) for column in zip(*(run.values for run in runs), strict=True)]
            first: dict[tuple, Run] = {}
            for run, level in zip(runs, zip(*levels, strict=True), strict=True):
                if (known := first.setdefault(level, run)) is not run:
                    found.append((known, run))
        found.sort(key=lambda pair: pair[1].row)
        defects += _repeats(found, g.file)
    if defects:
        raise InputError(*defects)


def _levels(values: NDArray) -> list[int]:
    """Which values of a parameter are the same, by number."""
    order = np.argsort(values)
    rises = np.diff(values[order]) > _ALIKE * np.abs(values[order][1:])
    levels = np.empty(len(values), int)
    levels[order] = np.concatenate([[0], np.cumsum(rises)])
    return levels.tolist()


def _repeats(found: Sequence[tuple[Run, Run]], file: str) -> Iterator[Defect]:
    return of_rows(
        lambda i: f"repeats the parameters of run {found[i][0].name} in row {found[i][0].row}",
        [run.row for _, run in found],
        lambda i: found[i][1].name,
        file=file,
        field="run",
    )
