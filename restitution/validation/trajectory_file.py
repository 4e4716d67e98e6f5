"""A trajectory from a file of any form, or a shipped record by its name."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from restitution import datasets
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.foreign import Settings, read_foreign, read_track
from restitution.foreign.self_named import left_open, of_header
from restitution.tracks import Track


@dataclass(frozen=True)
class Trajectory:
    """A track, ``reading`` how its file was read in one line (empty: a record), and notes on that."""

    track: Track
    reading: str = ""
    notes: tuple[str, ...] = ()


def read_trajectory(
    file: str | Path,
    conditions: Conditions | None,
    own: Settings | None = None,
    shared: Settings | None = None,
) -> Trajectory:
    """The trajectory in a file.

    Parameters
    ----------
    file : a table of any form (:func:`restitution.foreign.read_foreign`), or the name of a shipped record.
    conditions : of its case, for units of the sphere and heights of its centre.
    own : what the numbers of this file mean; goes before what its header says.
    shared : the same of several files: a file whose header says all is not asked, one that says some is completed.

    Raises
    ------
    InputError : naming what is not known of the file, or what is wrong with its rows.
    """
    if not Path(file).exists():
        if str(file) not in datasets.names():
            raise InputError(Defect("does not exist, and no shipped record has this name", file=str(file)))
        return Trajectory(datasets.load_track(str(file)))
    own, shared = own or Settings(), shared or Settings()
    table = read_foreign(file, own.decimal or shared.decimal, own.sheet or shared.sheet)
    shared, notes = left_open(table, shared)
    settings, taken = of_header(table, own.over(shared))
    found = read_track(table, settings, conditions)
    return Trajectory(found.track(), found.reading or "as it stands", (*notes, *taken, *found.notes))
