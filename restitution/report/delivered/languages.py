"""The kept table of exported source code against this package: how far each language is from it, and with what."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from restitution.tables.reading import read_table
from restitution.tables.schema import Constraints, Field, Rules, Schema

_NEEDED = Constraints(required=True)
_DEVIATION = Constraints(required=True, minimum=0.0)
_TEXTS = {
    "language": "its name",
    "program": "compiler or interpreter, as it names itself",
    "measured_on": "day of the run",
    "law": "name of the law",
}
SCHEMA = Schema(
    name="languages",
    title="Exported source code against this package",
    fields=(
        *(Field(name=n, type="string", description=said, constraints=_NEEDED) for n, said in _TEXTS.items()),
        Field(name="points", type="integer", description="random arguments", unit="1", constraints=_NEEDED),
        Field(
            name="value_deviation", type="number", description="greatest, relative", unit="1",
            constraints=_DEVIATION,
        ),
        Field(
            name="slope_deviation", type="number", description="greatest, relative", unit="1",
            constraints=_DEVIATION,
        ),
    ),
    **{"restitution:rules": Rules(unique=(("language", "law"),))},
)  # fmt: skip


@dataclass(frozen=True)
class Agreement:
    """One language: the greatest relative deviations over its laws, and which law has that of the value."""

    language: str
    program: str
    measured_on: str
    laws: int
    points: int
    value: float
    worst: str
    slope: float


def read_kept(path: str | Path) -> pd.DataFrame:
    """The kept table; raises :class:`InputError` with all its defects."""
    return read_table(path, SCHEMA)


def gather(path: str | Path) -> list[Agreement]:
    """One entry a language, in the table's order."""
    found = []
    for language, rows in read_kept(path).groupby("language", sort=False):
        worst = rows.loc[rows["value_deviation"].idxmax()]
        found.append(
            Agreement(
                str(language), worst["program"], worst["measured_on"], len(rows), int(rows["points"].min()),
                float(worst["value_deviation"]), worst["law"], float(rows["slope_deviation"].max()),
            )
        )  # fmt: skip
    return found
