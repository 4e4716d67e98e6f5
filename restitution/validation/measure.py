"""Rows are measured one after the other; what is there stays when that is stopped."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path

from restitution.errors import InputError, StoppedError
from restitution.files import write_whole
from restitution.locks import sole_writer
from restitution.runs.validity.program import program_hash
from restitution.validation.row import NotEvaluatedError, Row, Values
from restitution.validation.scorecard import SO_FAR, Result, SoFar, read_so_far

Show = Callable[[str], None]


def measured(row: Row) -> Result:
    """What a row gives. A flow that diverges has no number and fails; what cannot be had is not evaluated."""
    clock, processor = time.perf_counter(), time.process_time()
    values: Values | None = None
    why = ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of numbers that the solver doubts, as a row may well ask it for them
        try:
            values = row.values()
        except NotEvaluatedError as error:
            why = str(error)
        except (StoppedError, ArithmeticError, RuntimeError) as error:
            # lbm's DivergenceError, an integration that fails, no steady state: the program gives no number
            values, why = {r.label: float("nan") for r in row.truth()}, _line(error)
        except (InputError, ValueError, LookupError, TypeError, AttributeError, OSError) as error:
            why = f"{type(error).__name__}: {_line(error)}"
    taken = {"seconds": time.perf_counter() - clock, "processor_s": time.process_time() - processor}
    finite = None if values is None else {name: v if abs(v) < float("inf") else None for name, v in values.items()}
    return Result(key=row.key, values=finite, why=why, **{name: round(s, 2) for name, s in taken.items()})


def _line(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def measure_all(
    rows: Mapping[str, Row],
    folder: Path,
    resume: bool = False,
    show: Show = lambda text: None,
    done: Callable[[Row, Result], None] = lambda row, result: None,
) -> dict[str, Result]:
    """The results of all rows by name; ``folder`` keeps them row by row until all are there.

    Parameters
    ----------
    rows : by name, in the order in which they are measured.
    folder : must exist; another process may not write to it meanwhile.
    resume : take what a stopped run of the same program has left there.
    show, done : told before and after each row.
    """
    with sole_writer(folder):
        before = read_so_far(folder) if resume else SoFar(program=program_hash(), results={})
        kept = {name: found for name, row in rows.items() if (found := before.still(row)) is not None}
        results: dict[str, Result] = {}
        for number, (name, row) in enumerate(rows.items(), 1):
            if name in kept:
                results[name] = kept[name]
                continue
            show(f"[{number}/{len(rows)}] {name}: {row.quantity}")
            results[name] = measured(row)
            done(row, results[name])
            so_far = SoFar(program=program_hash(), results=kept | results)
            write_whole(folder / SO_FAR, so_far.model_dump_json(indent=1) + "\n")
    return results
