"""A drop test of one law, pair and level: e of the law, e that the exported text asks for, e delivered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.errors import Defect, InputError
from restitution.export.dem import Request
from restitution.export.drops.deck import Deck, NotInstalledError, Program, run_deck
from restitution.export.impacts import Impacts

__all__ = ["Drop", "DropTest", "NotInstalledError", "drop_test"]

_DROPS = 9
"""Impact speeds across the range of Stokes numbers."""


@dataclass(frozen=True)
class Drop:
    """One impact: speed in m/s, St of the law, and three restitutions."""

    speed: float
    stokes: float
    law: float
    asked: float
    delivered: float


@dataclass(frozen=True)
class DropTest:
    """A deck, and what belongs to its impacts."""

    program: Program
    impacts: Impacts
    request: Request
    speeds: NDArray
    deck: Deck

    def run(self) -> tuple[str, Sequence[Drop]]:
        """Version of the program, and the impacts; raises :class:`NotInstalledError`."""
        found = self.program.find(self.request.level)
        St = self.impacts.stokes(self.speeds)
        columns = (
            self.speeds,
            St,
            self.impacts.restitution(St),
            self.program.promised(self.impacts, self.request, St),
            run_deck(self.deck, found, len(self.speeds)),
        )
        return found.version, [Drop(*map(float, row)) for row in zip(*columns, strict=True)]


def drop_test(key: str, program: Program | None, impacts: Impacts, request: Request) -> DropTest:
    """The test of a target; raises :class:`InputError` for one that there is none for."""
    if program is None:
        raise InputError(Defect(f"{key} cannot be run from here", field="--drop-test"))
    if impacts.conditions.partner is not None:
        raise InputError(Defect("drops on a wall: leave out the partner", field="--drop-test"))
    speeds = np.geomspace(*request.stokes, _DROPS) / impacts.per_speed
    return DropTest(program, impacts, request, speeds, program.deck(impacts, request, speeds))
