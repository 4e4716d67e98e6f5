"""Runs that come to the film in one way share it: which ones, and the approach that is run once for all of them.

What decides is :func:`restitution.runs.validity.key.approach_key`, of what the solver is told of each case: keys
of film and contact, e_dry, roughness and the span after the contact act after the fork; any other sets runs apart.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from restitution.campaigns.plan import Planned
from restitution.campaigns.run import Approach
from restitution.errors import InputError
from restitution.runs.record import RESOLVED

APPROACHES = "approaches"
"""Folder of the approaches' folders."""
_DIGITS = 12


@dataclass
class Fork:
    """An approach and the runs that go on from it."""

    approach: Approach
    runs: list[Planned]
    deaths: int = 0

    @property
    def checkpoint(self) -> Path:
        """What they go on from."""
        from restitution.runs.approach import APPROACH

        return Path(self.approach.folder) / APPROACH


def forks(
    runs: Iterable[Planned], folder: Path, program: str, threads: int | None, driver: str = ""
) -> tuple[list[Fork], list[Planned]]:
    """Approaches that two or more of the runs share, and the runs that share none."""
    alone: list[Planned] = []
    groups: dict[str, list[Planned]] = {}
    for run in runs:
        key = _key(run)
        if key is None:
            alone.append(run)
        else:
            groups.setdefault(key, []).append(run)
    found = []
    for key, group in groups.items():
        if len(group) == 1:
            alone += group
            continue
        edge = max(map(_edge, group))
        name = "a" + hashlib.sha256(f"{key} {edge!r}".encode()).hexdigest()[:_DIGITS]
        case = group[0].case.model_copy(update={"name": name})
        approach = Approach(name, case, edge, str(folder / APPROACHES / name), program, threads, driver)
        found.append(Fork(approach, group))
    return found, alone


def _key(run: Planned) -> str | None:
    """Of a run's approach; None where it has none, or the solver refuses the case, which the run will say."""
    from restitution.runs.validity.key import approach_key

    if run.model != RESOLVED or run.case.numerics is None:
        return None
    try:
        return approach_key(run.case)
    except InputError:
        return None


def _edge(run: Planned) -> float:
    from restitution.runs.setup import set_up

    return set_up(run.case).edge_d
