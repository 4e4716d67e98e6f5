"""The scorecard: what each row gave, its verdicts, and who measured it; as a record and as ``scorecard.json``.

``scorecard.json`` is read back for the rows that failed (``--failed``), what a stopped run left for ``--resume``.
"""

from __future__ import annotations

import json
import math
import os
import platform
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, Field, FiniteFloat, ValidationError

from restitution.conditions import defects_of
from restitution.errors import Defect, InputError
from restitution.inputs import read_json
from restitution.runs.validity.program import program_hash
from restitution.validation.row import Row
from restitution.validation.verdict import Held, Verdict, against_baseline, against_truth, status, worst

FILE = "scorecard.json"
SO_FAR = "so-far.json"
"""What a stopped run leaves, for ``--resume``."""
VERSION = 1


class Result(BaseModel):
    """What a row gave: values by label (None: not a number, as of a flow that diverged), or why there are none.

    ``seconds`` on the clock and ``processor_s`` of all threads, compiling included where a kernel was new.
    """

    key: str
    values: dict[str, FiniteFloat | None] | None = None
    why: str = ""
    seconds: Annotated[FiniteFloat, Field(ge=0)] = 0.0
    processor_s: Annotated[FiniteFloat, Field(ge=0)] = 0.0

    @property
    def numbers(self) -> dict[str, float] | None:
        """The values, NaN where there is none; None where the row was not evaluated."""
        if self.values is None:
            return None
        return {label: math.nan if value is None else value for label, value in self.values.items()}


@dataclass(frozen=True)
class Judged:
    """A row with its result and its verdicts."""

    row: Row
    result: Result
    held: Mapping[str, Held] | None
    truth_by_label: dict[str, Verdict]
    baseline_by_label: dict[str, Verdict]

    @classmethod
    def of(cls, row: Row, result: Result, held: Mapping[str, Held] | None) -> Judged:
        """A row judged by its references and by what a baseline holds of it."""
        values = result.numbers
        return cls(row, result, held, against_truth(row, values), against_baseline(row, values, held))

    @property
    def truth(self) -> Verdict:
        """The worst verdict against the truth."""
        return worst(self.truth_by_label.values())

    @property
    def baseline(self) -> Verdict:
        """The worst verdict against the baseline."""
        return worst(self.baseline_by_label.values())

    @property
    def fails(self) -> bool:
        """Whether either verdict is a failure, or there is none."""
        return not {self.truth, self.baseline} <= {Verdict.PASS, Verdict.KNOWN_MISS}


@dataclass(frozen=True)
class Made:
    """What measured a scorecard."""

    date: str
    program: str
    processor: str
    threads: int
    libraries: dict[str, str]

    @classmethod
    def here(cls) -> Made:
        """The present program on the present machine."""
        import numba

        libraries = {name: metadata.version(name) for name in ("restitution", "numpy", "scipy", "numba")}
        date = time.strftime("%Y-%m-%d", time.gmtime())
        return cls(date, program_hash(), _processor(), numba.config.NUMBA_NUM_THREADS, libraries)


@dataclass(frozen=True)
class Scorecard:
    """All rows that were run, in their order."""

    rows: Sequence[Judged]
    depth: str
    baseline: str = ""
    """The file of the baseline; nothing where there is none."""
    strict: bool = False
    made: Made = field(default_factory=Made.here)

    @property
    def status(self) -> int:
        """The exit status; see :mod:`restitution.validation.verdict`."""
        return status([(judged.truth, judged.baseline) for judged in self.rows], self.strict)

    def count(self, verdict: Verdict) -> tuple[int, int]:
        """Rows with that verdict against the truth, and against the baseline."""
        return sum(j.truth is verdict for j in self.rows), sum(j.baseline is verdict for j in self.rows)

    def text(self) -> str:
        """``scorecard.json``."""
        content = {
            "version": VERSION, "status": self.status, "depth": self.depth, "baseline": self.baseline,
            "made": asdict(self.made), "rows": [_row(judged) for judged in self.rows],
        }  # fmt: skip
        return json.dumps(content, indent=1, allow_nan=False) + "\n"


def _row(judged: Judged) -> dict[str, Any]:
    row, result = judged.row, judged.result
    values = []
    for reference in row.truth():
        label, held = reference.label, (judged.held or {}).get(reference.label)
        values.append(
            {
                "label": label, "value": (result.values or {}).get(label), "reference": reference.value,
                "tolerance": reference.tolerance, "side": reference.side,
                "baseline": None if held is None else held.value,
                "baseline_tolerance": None if held is None else held.tolerance,
                "truth": judged.truth_by_label[label], "against_baseline": judged.baseline_by_label[label],
                "known": row.known.get(label, ""),
            }
        )  # fmt: skip
    return {
        "name": row.name, "quantity": row.quantity, "unit": row.unit, "kind": row.kind, "source": row.source,
        "tolerance": row.tolerance, "depth": row.depth, "truth": judged.truth, "against_baseline": judged.baseline,
        **result.model_dump(exclude={"values"}), "values": values,
    }  # fmt: skip


class _Line(BaseModel):
    name: str
    truth: Verdict
    against_baseline: Verdict


class _Written(BaseModel):
    version: int
    rows: list[_Line]


def failed_rows(folder: Path) -> list[str]:
    """Names of the rows that did not pass in the scorecard of a folder.

    Raises :class:`InputError` where there is none or it is damaged.
    """
    path = folder / FILE
    if not path.is_file():
        raise InputError(Defect("is not there: --failed takes the rows that failed in it", file=str(path)))
    try:
        written = _Written.model_validate(read_json(path))
    except ValidationError as error:
        raise InputError(*defects_of(error, str(path))) from None
    fine = (Verdict.PASS, Verdict.KNOWN_MISS)
    return [r.name for r in written.rows if r.truth not in fine or r.against_baseline not in fine]


class SoFar(BaseModel):
    """Results of a run that was stopped, by row; they hold for the program whose text has that hash."""

    program: str
    results: dict[str, Result]

    def still(self, row: Row) -> Result | None:
        """The result of a row, if it was measured by this program on this case."""
        result = self.results.get(row.name)
        return result if result is not None and self.program == program_hash() and result.key == row.key else None


def read_so_far(folder: Path) -> SoFar:
    """What a stopped run left; empty where it left nothing."""
    path = folder / SO_FAR
    if not path.is_file():
        return SoFar(program=program_hash(), results={})
    try:
        return SoFar.model_validate(read_json(path))
    except (ValidationError, InputError) as error:
        defects = error.defects if isinstance(error, InputError) else defects_of(error, str(path))
        again = Defect(
            "is of no use any more: leave --resume out, then all rows are measured anew", file=str(path)
        )
        raise InputError(*defects, again) from None


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    names = cpuinfo.read_text().splitlines() if cpuinfo.exists() else []
    name = next((line.split(":")[1].strip() for line in names if line.startswith("model name")), None)
    return f"{name or platform.processor()}, {os.cpu_count()} cores"
