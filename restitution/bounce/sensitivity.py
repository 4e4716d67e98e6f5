"""Which physics matters: the same flight with each force switched off in turn."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from restitution.bounce.agreement import UNTIL, agreement
from restitution.bounce.closures import Closures, Release
from restitution.bounce.model import Trajectory, bounce
from restitution.conditions import Conditions
from restitution.laws.history import Basset1888

if TYPE_CHECKING:
    import pandas as pd

    from restitution.tracks import Track

APEXES = 3


def variants(closures: Closures) -> dict[str, Closures]:
    """What is switched off, in words, and the closures that remain; the first is the whole model."""
    found = {"nothing": closures}
    if closures.history is not None:
        found["history"] = replace(closures, history=None)
        found["decay of history at finite Re"] = replace(closures, history=Basset1888())
    if closures.wake is not None:
        found["wake of the approach"] = replace(closures, wake=None)
    if closures.added_mass is not None:
        found["added mass"] = replace(closures, added_mass=None)
    if closures.added_mass == "wall":
        found["growth of the added mass at the wall"] = replace(closures, added_mass="free")
    if closures.wall is not None:
        found["resistance of the wall"] = replace(closures, wall=None)
    if closures.lubrication:
        found["lubrication"] = replace(closures, lubrication=False)
        if math.isfinite(closures.tension):
            found["cavitation of the film"] = replace(closures, tension=math.inf)
    if closures.black_box:
        found["loss by e_eff"] = replace(closures, rebound=None, measured=None, lubrication=False)
    if closures.drag is not None:
        found["steady drag"] = replace(closures, drag=None)
    return found


def forces_off(
    conditions: Conditions,
    release: Release,
    closures: Closures,
    end: float,
    track: Track | None = None,
    until: float = UNTIL,
) -> pd.DataFrame:
    """One row for each force that is switched off, the release being the same.

    Columns: ``off``, the first three ``apex_<n>_m``, ``apex_<n>_change`` (relative to the whole model),
    ``flight_<n>_s``, ``change_d`` (rms difference of the gap from the whole model's, contacts brought together,
    over ``until`` in t* = t sqrt(g/d)), and with ``track`` ``rms_d``, the rms distance from the record.
    """
    import pandas as pd

    d = conditions.sphere.diameter
    after = np.linspace(0, until * math.sqrt(d / conditions.gravity), 801)
    whole, rows = None, []
    for off, chosen in variants(closures).items():
        path = bounce(conditions, release, chosen, end)
        whole = whole or path
        row = {"off": off, **_numbers(path)}
        for n in range(1, APEXES + 1):
            row[f"apex_{n}_change"] = row[f"apex_{n}_m"] / rows[0][f"apex_{n}_m"] - 1 if rows else 0.0
        difference = path.gap(_start(path) + after) - whole.gap(_start(whole) + after)
        row["change_d"] = float(np.sqrt(np.mean(difference**2)) / d)
        if track is not None:
            row["rms_d"] = agreement(path, track, until).rms_d
        rows.append(row)
    return pd.DataFrame(rows)


def _start(path: Trajectory) -> float:
    return path.impacts[0].time_s if path.impacts else 0.0


def _numbers(path: Trajectory) -> dict[str, float]:
    """The first apexes and times of flight; NaN where there are fewer."""
    apexes = np.append(path.apexes()[:APEXES], np.full(APEXES, np.nan))
    flights = np.append(np.diff([i.time_s for i in path.impacts])[:APEXES], np.full(APEXES, np.nan))
    return {f"apex_{n + 1}_m": float(apexes[n]) for n in range(APEXES)} | {
        f"flight_{n + 1}_s": float(flights[n]) for n in range(APEXES)
    }
