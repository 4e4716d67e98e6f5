"""Whether a calibration brings a solver closer to records: distances before and after, in diameters."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Protocol

GAIN = 0.9
"""Distance to records after over that before, below which something is gained; one apex read anew moves it so."""


class Distances(Protocol):
    """A record: whether it was held out, root mean square distances of its frames in diameters."""

    @property
    def held_out(self) -> bool: ...
    @property
    def rms_before_d(self) -> float: ...
    @property
    def rms_after_d(self) -> float: ...


def distances(records: Iterable[Distances]) -> dict[bool, tuple[float, float]]:
    """Root mean square distance before and after, of records held out (True) and of those met (False)."""
    records, found = list(records), {}
    for held in (False, True):
        own = [r for r in records if r.held_out is held]
        if own:
            before, after = (
                math.sqrt(sum(x**2 for x in each) / len(own))
                for each in ([r.rms_before_d for r in own], [r.rms_after_d for r in own])
            )
            found[held] = (before, after)
    return found


def closer(records: Iterable[Distances]) -> float:
    """Distance after over that before: of records that had no say, else of those met."""
    known = distances(records)
    before, after = known.get(True, known[False])
    return after / before
