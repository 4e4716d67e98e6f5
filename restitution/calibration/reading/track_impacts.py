"""A camera track as observations: its impacts, found under one stated definition of the impact speed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from restitution.calibration.reading.impact_checks import CONDITIONS, NO_SPEED, check_physical
from restitution.calibration.reading.impact_table import SCHEMA, conditions_of_row
from restitution.calibration.reading.observations import Observations
from restitution.calibration.reading.reading import Reading
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.foreign.table import ForeignTable
from restitution.foreign.track import read_track
from restitution.impacts.find import find_impacts
from restitution.stokes import H_FILM, MEASURED_SPEEDS, film_edge
from restitution.tables.reading import read_table
from restitution.tables.schema import read_schema
from restitution.tracks import Track


def from_track_file(table: ForeignTable, how: Reading, digest: str) -> Observations:
    """The impacts of a track in a file."""
    track, conditions, notes = track_of(table, how)
    o = from_track(track, conditions, how, table.file, digest)
    return replace(o, notes=(*(f"{table.file}: {note}" for note in notes), *o.notes))


def track_of(table: ForeignTable, how: Reading) -> tuple[Track, Conditions, tuple[str, ...]]:
    """The track in a file, its conditions (the caller's, or those of its own columns), and how it was read."""
    conditions = how.conditions or _conditions_of_track(table)
    read = read_track(table, how.settings, conditions)
    return read.track(), conditions, (*([f"read: {read.reading}"] if read.reading else []), *read.notes)


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
    edge = H_FILM if how.edge is None else film_edge(how.edge, "--edge")
    impacts = find_impacts(track, conditions, how.speed, stokes, Path(name).stem, h_film=edge)
    doubts = tuple(replace(doubt, where=name) for doubt in impacts.doubts)
    if not impacts.rows:
        rule = "; ".join(["no impact is resolved in this track", *(doubt.message for doubt in doubts)])
        raise InputError(Defect(rule, file=name))
    o = Observations.from_impacts(
        impacts.rows,
        conditions,
        places=tuple((f"{name}, impact", int(row["impact"])) for row in impacts.rows),
        files={name: digest},
        notes=tuple(f"{name}: {note}" for note in impacts.notes),
        doubts=doubts,
    )
    return check_physical(o, how)


def _conditions_of_track(table: ForeignTable) -> Conditions:
    """The conditions that a track's own columns state, the same in every row."""
    needed = (*CONDITIONS, "e_dry")
    if not set(needed) <= set(table.header):
        rule = f"is a track; fluid and sphere are needed: --conditions FILE, or the columns {', '.join(needed)}"
        raise InputError(Defect(rule, file=table.file))
    stated = read_table(table.text(), read_schema(SCHEMA), {name: name for name in needed})
    for name in needed:
        if stated[name].nunique(dropna=False) != 1:
            row = table.rows[int((stated[name] != stated[name].iloc[0]).to_numpy().argmax())][0]
            raise InputError(
                Defect("must be the same in all rows of a track", file=table.file, row=row, field=name)
            )
    return conditions_of_row(stated.iloc[0])
