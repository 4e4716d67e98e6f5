"""The flight of one run: its gaps from contact to contact, and the e_eff of each bounce.

Contacts and e_eff are taken from the trajectory as from a measured one (:mod:`restitution.impacts`), so a table
of time and gap, or of velocity, is enough, whatever the solver does at contact; e_eff as the record's camera would
have filmed it, so that it means the same for both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions
from restitution.emulation.runs_table import Run
from restitution.errors import Defect, InputError
from restitution.foreign import Settings, read_foreign, read_track
from restitution.impacts.bounces import filmed
from restitution.impacts.find import find_impacts
from restitution.runs.filmed import as_filmed
from restitution.stokes import Speed
from restitution.tracks import Track, contacts
from restitution.validation.trajectory import from_rest, integrated

LOWEST_D = 0.01
"""Height in diameters below which a flight tells nothing, and its contact is no more than where it stays."""


@dataclass(frozen=True)
class Flown:
    """Gap in m at times in s after the first contact; the contacts; e_eff of each bounce, nan where not seen."""

    name: str
    time_s: NDArray
    gap_m: NDArray
    contacts_s: NDArray
    e: NDArray
    approach_m_s: float

    @property
    def flights(self) -> int:
        """How many were seen to come down."""
        return len(self.contacts_s) - 1


def flight_of(run: Run, conditions: Conditions, settings: Settings, camera: Track) -> Flown:
    """The flight of a run, ``camera`` the record's track.

    Raises :class:`InputError` for a trajectory that cannot be read or does not bounce.
    """
    try:
        table = read_foreign(str(run.track), settings.decimal, settings.sheet)
        track = read_track(table, settings, conditions).track()
        return flown(run.name, track, conditions, camera)
    except InputError as error:
        raise InputError(*(replace(d, file=d.file or str(run.track)) for d in error.defects)) from None


def flown(name: str, track: Track, conditions: Conditions, camera: Track | None = None) -> Flown:
    """The flight in a track, its gaps counted from where the sphere rests."""
    found = find_impacts(track, conditions, Speed.FAR, record=name, kind="simulated")
    if not found.rows:
        why = f": {found.notes[-1]}" if found.notes else ""
        raise InputError(Defect(f"of run {name} has no contact that could be evaluated{why}"))
    if track.quantity == "velocity":
        gaps = integrated(track, found)
    else:
        gaps, _ = from_rest(track, conditions.sphere.diameter)
    touches = _touches(gaps, conditions)
    seen = as_filmed(replace(gaps, time_s=gaps.time_s - touches[0]), camera)
    rows = find_impacts(seen, conditions, Speed.FAR, record=name, kind="simulated").rows
    e = {row["impact"]: row["e_eff"] for row in rows if row["outcome"] == "rebound"}
    return Flown(
        name, gaps.time_s - touches[0], gaps.value, touches - touches[0],
        np.array([e.get(k + 1, math.nan) for k in range(len(touches))]), float(found.rows[0]["impact_speed_m_s"]),
    )  # fmt: skip


def _touches(gaps: Track, conditions: Conditions) -> NDArray:
    """Times of the contacts, the last one where it stays too, up to the first flight that is too low to tell."""
    times = list(filmed(gaps, conditions).contacts_s)
    last = contacts(gaps).contacts[-1]
    low = LOWEST_D * conditions.sphere.diameter
    if last.nearest is None and len(last.approach) and gaps.time_s[last.approach[0]] >= times[-1]:
        high = [i for i in last.approach if gaps.value[i] > low][-2:]
        if len(high) == 2:
            (t0, t1), (h0, h1) = gaps.time_s[high], gaps.value[high]
            times.append(float(t1 + h1 * (t1 - t0) / (h0 - h1)) if h0 > h1 else float(t1))
    for k in range(len(times) - 1):
        inside = (gaps.time_s > times[k]) & (gaps.time_s < times[k + 1])
        if not inside.any() or gaps.value[inside].max() < low:
            return np.array(times[: k + 1])
    return np.array(times)
