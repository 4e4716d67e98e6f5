"""What came out of a sweep: a row a run, and the impacts of all runs in the schema of the measured ones.

===============  ============================================================================================
file             content
===============  ============================================================================================
``runs.csv``     ``run``, ``state``, ``model``, ``record`` where one is simulated, ``cells_per_diameter`` where the
                 flow is resolved and they are not varied, a column a key varied, in SI,
                 ``track``, where its trajectory lies from the sweep's folder, ``seconds``, ``attempts``,
                 ``message``
``impacts.csv``  the impacts under one definition of speed, ``record`` being the run: for ``restitution fit``
===============  ============================================================================================

Where pyarrow is installed, both as Parquet beside them, the impacts with model and parameters of their runs.
"""

from __future__ import annotations

import csv
import importlib.util
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restitution import datasets
from restitution.campaigns.keeping import spoiled
from restitution.campaigns.manifest import FINISHED, Manifest
from restitution.campaigns.plan import RUNS, Planned, read_plan
from restitution.errors import Defect, InputError
from restitution.files import write_folder
from restitution.stokes import Speed
from restitution.tables.writing import rows_text

if TYPE_CHECKING:
    import pandas as pd

TABLE, IMPACTS = "runs.csv", "impacts.csv"
CELLS = "cells_per_diameter"
_DIGITS = "%.12g"


def write_tables(folder: Path, speed: str = Speed.FAR) -> str | None:
    """Write both tables of a sweep's folder, the impacts by one definition of ``speed``.

    Returns what is to be said of runs without any impact. Raises :class:`InputError` where it is no sweep's
    folder, or results of finished runs are gone or changed.
    """
    runs, manifest = read_plan(folder), Manifest(folder)
    rule = (
        "is not as this finished run left it, or gone: the same 'restitution sweep SWEEP.toml' as before makes it "
        f"again; 'restitution sweep retry {folder}' leaves it out until then"
    )
    gone = [Defect(rule, file=str(folder / RUNS / run)) for run in spoiled(folder, runs, manifest)]
    if gone:
        raise InputError(*gone)
    names = list(dict.fromkeys(name for run in runs for name in run.parameters))
    of_records = any(run.record is not None for run in runs)
    of_cells = f"numerics.{CELLS}" not in names and any(run.cells is not None for run in runs)
    own = ["run", "state", "model", *(["record"] if of_records else [])]
    own += [CELLS] if of_cells else []
    headings = [*own, *names, "track", "seconds", "attempts", "message"]
    rows = [_row(run, names, manifest, of_records, of_cells) for run in runs]
    columns = list(datasets.schema("impact").columns)
    impacts, finished, without, others = list[list[str]](), 0, 0, False
    for run in (r for r in runs if manifest.of(r.run).state == FINISHED):
        its = _impacts(folder, run)
        of_speed = [[row.get(name, "") for name in columns] for row in its if row["speed_definition"] == speed]
        impacts += of_speed
        finished, without = finished + 1, without + (not of_speed)
        others |= bool(its) and not of_speed
    contents: dict[str, str | bytes] = {
        TABLE: rows_text(headings, rows, _DIGITS),
        IMPACTS: rows_text(columns, impacts),
    }
    write_folder(folder, contents)
    if importlib.util.find_spec("pyarrow") is not None:
        joined = impacts_of(folder)
        runs_of(folder).to_parquet(folder / "runs.parquet")
        joined.to_parquet(folder / "impacts.parquet")
    if not without:
        return None
    found = f"doubt: {without} of {finished} finished runs without an impact in {IMPACTS}: "
    if others:
        return f"{found}of the speed {str(speed)!r} there is none, of another --speed there is"
    return (
        f"{found}the trajectory ends before a contact, or too soon after it to tell what came of it; let it be "
        "longer by run.after_contact or run.duration"
    )


def runs_of(folder: Path) -> pd.DataFrame:
    """The table of runs."""
    import pandas as pd

    words = dict.fromkeys(("run", "state", "record", "message", "track"), str)
    return pd.read_csv(folder / TABLE, dtype=words)


def impacts_of(folder: Path) -> pd.DataFrame:
    """The impacts of all runs, each with model and parameters of its run."""
    import pandas as pd

    runs = runs_of(folder).drop(columns=["state", "track", "seconds", "attempts", "message"])
    impacts = pd.read_csv(folder / IMPACTS, dtype={"record": str})
    return impacts.rename(columns={"record": "run"}).merge(runs, on="run", suffixes=("", "_of_case"))


def _row(run: Planned, names: Sequence[str], manifest: Manifest, of_records: bool, of_cells: bool) -> list[Any]:
    standing = manifest.of(run.run)
    finished = standing.state == FINISHED
    return [
        run.run,
        standing.shown,
        run.model,
        *([run.record] if of_records else []),
        *([run.cells] if of_cells else []),
        *(_cell(run.parameters.get(name)) for name in names),
        f"{RUNS}/{run.run}/trajectory.csv" if finished else "",
        round(standing.seconds, 3) if finished else None,
        standing.attempts,
        standing.message,
    ]


def _cell(value: Any) -> Any:
    """A value of a case in one cell."""
    if isinstance(value, list | dict | bool):
        return json.dumps(value)
    return float(value) if isinstance(value, int) else value


def _impacts(folder: Path, run: Planned) -> list[dict[str, str]]:
    path = folder / RUNS / run.run / "impacts.csv"
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))
