"""A camera track as observations: its impacts, found under one stated definition of the impact speed."""

from __future__ import annotations

from pathlib import Path

from restitution import datasets
from restitution.calibration.reading.impact_checks import CONDITIONS, NO_SPEED, check_physical
from restitution.calibration.reading.impact_table import SCHEMA, conditions_of_row
from restitution.calibration.reading.observations import Observations
from restitution.calibration.reading.reading import Reading
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.impacts.find import find_impacts
from restitution.stokes import MEASURED_SPEEDS
from restitution.tables.reading import read_header, read_table
from restitution.tables.schema import read_schema
from restitution.tracks import Track

QUANTITIES = {"gap_m": "trajectory", "velocity_m_s": "settling"}
"""What a track may have beside the time, and the schema of its table."""


def is_track(header: list[str], how: Reading) -> bool:
    """Whether a table is a track: it has the time, and either the gap or the velocity."""
    names = {how.columns.get(name, name) for name in ("time_s", *QUANTITIES)} & set(header)
    return len(names) == 2 and how.columns.get("time_s", "time_s") in names


def from_track_file(path: str, how: Reading, digest: str) -> Observations:
    """The impacts of a track in a file."""
    track, conditions = track_of(path, how)
    return from_track(track, conditions, how, path, digest)


def track_of(path: str, how: Reading) -> tuple[Track, Conditions]:
    """The track in a file, and its conditions: the caller's, or those that its own columns state."""
    conditions = how.conditions or _conditions_of_track(path)
    header = read_header(path)
    value = next(name for name in QUANTITIES if how.columns.get(name, name) in header)
    columns = {name: how.columns.get(name, name) for name in ("time_s", value)}
    return Track.from_table(read_table(path, datasets.schema(QUANTITIES[value]), columns)), conditions


def from_track(track: Track, conditions: Conditions, how: Reading, name: str, digest: str) -> Observations:
    """The impacts of one track under the stated definition of speed, which must be far, contact or window."""
    if how.speed is None:
        raise InputError(Defect(NO_SPEED, file=name))
    if how.speed not in MEASURED_SPEEDS:
        raise InputError(
            Defect(
                "a track gives the far, contact or window speed", file=name, field="--speed", value=str(how.speed)
            )
        )
    stokes = how.stokes or "st"
    impacts = find_impacts(track, conditions, how.speed, stokes, Path(name).stem)
    if not impacts.rows:
        raise InputError(Defect("no impact is resolved in this track", file=name))
    o = Observations.from_impacts(
        impacts.rows,
        conditions,
        places=tuple((f"{name}, impact", int(row["impact"])) for row in impacts.rows),
        files={name: digest},
        notes=tuple(f"{name}: {note}" for note in impacts.notes),
    )
    return check_physical(o, how)


def _conditions_of_track(path: str) -> Conditions:
    """The conditions that a track's own columns state, the same in every row."""
    header = read_header(path)
    needed = (*CONDITIONS, "e_dry")
    if not set(needed) <= set(header):
        rule = f"is a track; fluid and sphere are needed: --conditions FILE, or the columns {', '.join(needed)}"
        raise InputError(Defect(rule, file=path))
    table = read_table(path, read_schema(SCHEMA), {name: name for name in needed})
    for name in needed:
        if table[name].nunique(dropna=False) != 1:
            row = int((table[name] != table[name].iloc[0]).to_numpy().argmax()) + 2
            raise InputError(Defect("must be the same in all rows of a track", file=path, row=row, field=name))
    return conditions_of_row(table.iloc[0])
