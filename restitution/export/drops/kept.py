"""What programs were measured to deliver, kept as a table: it is read where the programs are not installed."""

from __future__ import annotations

import datetime
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pandas as pd

from restitution import laws
from restitution.conditions import Conditions
from restitution.export.closure import law_closure
from restitution.export.dem import Request
from restitution.export.drops.deck import NotInstalledError, Program
from restitution.export.drops.measure import drop_test
from restitution.export.impacts import Impacts, impacts_of
from restitution.tables.reading import read_table
from restitution.tables.schema import Constraints, Field, Rules, Schema
from restitution.tables.writing import table_text

LAW = "eq4_exponential"
STOKES = (20.0, 1000.0)
CONSTANT_AT = 100.0
"""The Stokes number that the constant of level 0 is taken at."""
WITHIN = 0.02
"""Error of e that the range of that constant is stated for."""
_NEEDED = Constraints(required=True)
_E = Constraints(required=True, minimum=0.0, maximum=1.0)
SCHEMA = Schema(
    name="delivered",
    title="e delivered by programs, of exported texts",
    fields=(
        Field(name="program", type="string", description="its name", constraints=_NEEDED),
        Field(name="version", type="string", description="as it names itself", constraints=_NEEDED),
        Field(name="measured_on", type="string", description="day of the run", constraints=_NEEDED),
        Field(name="level", type="integer", description="of the export", unit="1", constraints=_NEEDED),
        Field(name="impact_speed", type="number", description="in m/s", unit="m/s", constraints=_NEEDED),
        Field(name="stokes", type="number", description="of the law", unit="1", constraints=_NEEDED),
        Field(name="e_law", type="number", description="e of the law", unit="1", constraints=_E),
        Field(name="e_asked", type="number", description="what the text promises", unit="1", constraints=_E),
        Field(name="e_delivered", type="number", description="measured", unit="1", constraints=_E),
    ),
    **{"restitution:rules": Rules(unique=(("program", "level", "stokes"),))},
)


def steel() -> Impacts:
    """The pair that is dropped: the 3 mm steel sphere of Gondret et al. (2002) in silicone oil, on a wall."""
    pair = Conditions.model_validate(
        {
            "fluid": {"density": 935.0, "viscosity": 0.01},
            "sphere": {"diameter": 0.003, "density": 7800.0, "e_dry": 0.97},
        }
    )
    return impacts_of(law_closure(laws.get(LAW)), pair, None, "the drop test")


def request_of(level: int) -> Request:
    """What is asked of a program at a level."""
    return Request(level, CONSTANT_AT / steel().per_speed, WITHIN, STOKES)


def read_kept(path: str | Path) -> pd.DataFrame:
    """The kept table; raises :class:`InputError` with all its defects."""
    return read_table(path, SCHEMA)


def kept_text(table: pd.DataFrame) -> str:
    """The table as it is kept."""
    return table_text(table, "%.6g")


def measure(
    programs: Iterable[tuple[str, Program]], kept: pd.DataFrame | None, say: Callable[[str], None]
) -> pd.DataFrame:
    """Run the programs that are installed at every level; of the others the kept rows stay."""
    rows, impacts, today = [], steel(), datetime.date.today().isoformat()
    for key, program in programs:
        for level in program.levels:
            try:
                version, drops = drop_test(key, program, impacts, request_of(level)).run()
            except NotInstalledError as error:
                say(f"{program.title}, level {level}: kept as it was: {error}")
                if kept is not None:
                    old = kept[(kept["program"] == program.title) & (kept["level"] == level)]
                    rows += old.to_dict("records")
                continue
            say(f"{program.title} {version}, level {level}: measured")
            rows += [
                dict(
                    zip(
                        SCHEMA.columns,
                        (program.title, version, today, level, d.speed, d.stokes, d.law, d.asked, d.delivered),
                        strict=True,
                    )
                )
                for d in drops
            ]
    return pd.DataFrame(rows, columns=list(SCHEMA.columns)).replace({np.nan: None})
