"""e_eff of each bounce of a measured record, for a simulation that is given the measured values.

They are those of whole trajectories (:mod:`restitution.calibration.trajectories.whole_trajectories`), the film a
black box within one edge, as it is in the simulation: every frame tells of them, where the slopes beside a contact
do not see a wake that dies out within two frames. They are kept in ``restitutions.csv`` by record, edge and model,
written by ``python -m benchmarks.film_edges --write``.

What runs have been told does not follow the fits from day to day: the table is of the drag of Schiller & Naumann
and of a wake of fixed strength. Today's fits, with drag, history and wake among the unknowns, differ by up to
0.03; written anew it would raise the version of the physics.
"""

from __future__ import annotations

import csv
from functools import cache
from pathlib import Path

from restitution.errors import InputError

RESTITUTIONS = Path(__file__).with_name("restitutions.csv")


def measured_restitution(record: str, edge_d: float, wake: bool | None = None) -> tuple[float, ...]:
    """e_eff of bounce 1, 2, ... of a shipped record.

    Parameters
    ----------
    record : its name.
    edge_d : of the film, in diameters.
    wake : of the model that the flights are continued with: whether the sphere meets the wake of its approach;
        None: where the flow is resolved, the model that the frames of the record prefer.

    Raises
    ------
    InputError
        For a record without bounces, and for an edge that the table lacks.
    """
    found = [row for row in _table() if row["record"] == record]
    if not found:
        raise InputError(f"{record}: no rebound is resolved, so there are no measured values to use")
    rows = [row for row in found if float(row["film_edge_d"]) == edge_d]
    if not rows:
        known = ", ".join(dict.fromkeys(row["film_edge_d"] for row in found))
        raise InputError(f"{record}: measured values are known for edges of the film of {known} d, not {edge_d:g}")
    if wake is None:
        wake = bool(int(max(rows, key=lambda row: float(row["ln_evidence"]))["wake"]))
    return tuple(float(row["e_eff"]) for row in rows if int(row["wake"]) == wake)


@cache
def _table() -> list[dict[str, str]]:
    with RESTITUTIONS.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
