"""What is shown: the kept table, and how far each program is from what was asked and from the law."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from restitution.errors import Defect, InputError
from restitution.export.drops.kept import read_kept

MEANT = {
    0: "a constant e",
    1: "the code's own contact, inputs inverted or refitted",
    2: "e of the speed at first contact",
}
"""The levels in words."""


@dataclass(frozen=True)
class Summary:
    """One program at one level: greatest deviations of e over the range of Stokes numbers."""

    program: str
    version: str
    measured_on: str
    level: int
    from_asked: float
    from_law: float


def gather(path: str) -> tuple[pd.DataFrame, list[Summary]]:
    """The kept table, and its summary in the table's order."""
    table = read_kept(path)
    summary = []
    for (program, level), rows in table.groupby(["program", "level"], sort=False):
        if rows["version"].nunique() > 1:
            rule = f"{program} has rows of several versions at level {level}: measure it again"
            raise InputError(Defect(rule, file=str(path), field="version"))
        first = rows.iloc[0]
        from_asked, from_law = (float((rows["e_delivered"] - rows[e]).abs().max()) for e in ("e_asked", "e_law"))
        summary.append(
            Summary(str(program), first["version"], first["measured_on"], int(level), from_asked, from_law)
        )
    return table, summary
