"""Reading what is fitted: tables of impacts, camera tracks, digitised plots and shipped records, in any number.

A table of impacts has the columns of ``measurement.json`` or others mapped to them (:mod:`.impact_table`); a
track has ``time_s`` and ``gap_m`` or ``velocity_m_s`` (:mod:`.track_impacts`). Which Stokes number and which
impact speed is meant is stated by columns or by the caller, never assumed.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from restitution import datasets
from restitution.calibration.reading.digitizer import bars_left_out, is_export, read_export
from restitution.calibration.reading.impact_table import SCHEMA, from_table
from restitution.calibration.reading.observations import Observations, join
from restitution.calibration.reading.reading import Reading
from restitution.calibration.reading.track_impacts import from_track, from_track_file
from restitution.errors import Defect, InputError
from restitution.foreign.asking import what_is_needed
from restitution.foreign.formats.digitised import PIXEL, is_project
from restitution.foreign.table import read_foreign
from restitution.foreign.track import is_track
from restitution.inputs import read_bytes
from restitution.tables.reading import examine_table
from restitution.tables.schema import read_schema


def read(paths: str | Path | Sequence[str | Path], how: Reading | None = None, **stated: Any) -> Observations:
    """The impacts of files or of shipped records.

    Parameters
    ----------
    paths : tables of impacts, camera tracks, digitised plots (CSV, JSON), or names of shipped records.
    how : how the files are read; or
    stated : its single fields, as in ``read("my.csv", stokes="st", speed="far")``: see :class:`~.reading.Reading`.

    Returns
    -------
    Observations: e_eff, St, their errors and correlation, e_dry, source and labels, an entry an impact.

    Raises
    ------
    InputError : with everything that is wrong, by file, row, field and value.
    """
    how = replace(how or Reading(), **stated)
    paths = [paths] if isinstance(paths, str | Path) else paths
    parts: list[Observations] = []
    defects: list[Defect] = []
    for path in map(str, paths):
        try:
            parts.append(_read_one(path, how))
        except InputError as error:
            defects += error.defects
    seen: dict[str, str] = {}
    for part in parts:
        for name, digest in part.files.items():
            if digest in seen:
                defects.append(
                    Defect(f"has the same content as {seen[digest]}: its impacts would count twice", file=name)
                )
            seen[digest] = name
    if defects:
        raise InputError(*dict.fromkeys(defects))
    return join(parts)


def _read_one(path: str, how: Reading) -> Observations:
    if not Path(path).exists():
        if path in datasets.names():
            resource = datasets.resource(path)
            digest = resource.hash.removeprefix("sha256:")
            conditions = how.conditions or resource.conditions
            return from_track(datasets.load_track(path), conditions, how, path, digest)
        raise InputError(Defect("does not exist, and no shipped record has this name", file=path))
    if is_export(path, how.track.decimal, bool(how.columns), how.track.sheet):
        return _from_export(path, how, _digest(path))
    foreign = read_foreign(path, how.track.decimal, how.track.sheet)
    if is_track(foreign, how.settings):
        return from_track_file(foreign, how, _digest(path))
    _known_columns(dict.fromkeys(how.columns, "--column"))
    foreign = foreign.whole() if how.track.particle is None else foreign.of_particle(str(how.track.particle))
    own = _own_names(foreign.header) if not how.columns else {}
    how = replace(how, columns=own) if own else how
    if not set(foreign.header) & {*read_schema(SCHEMA).columns, *how.columns.values()}:
        rule = f"{what_is_needed(foreign).rule}; of impacts: --column stokes=NAME --column e_eff=NAME"
        raise InputError(Defect(rule, file=path))
    defects, table = examine_table(foreign.text(), read_schema(SCHEMA), how.columns)
    found = from_table(table, how, path, _digest(path), defects)
    if not own:
        return found
    note = f"{path}: '{own['stokes']}' is taken as stokes, '{own['e_eff']}' as e_eff (--column says otherwise)"
    return replace(found, notes=(*found.notes, note))


_OWN = {"stokes": ("st", "stokes", "stokes number"), "e_eff": ("e", "e_eff", "cor", "restitution")}
"""What others call the two columns that a fit needs."""


def _own_names(header: Sequence[str]) -> dict[str, str]:
    """The columns of a table that names its Stokes number and restitution in other words, and none as here."""
    lower = {name.strip().lower(): name for name in header}
    found = {key: next((lower[name] for name in names if name in lower), None) for key, names in _OWN.items()}
    known = {name: own for name, own in found.items() if own is not None}
    return known if len(known) == len(_OWN) and list(known) != list(known.values()) else {}


def _from_export(path: str, how: Reading, digest: str) -> Observations:
    """The points of a digitised plot, each data set a source."""
    _known_columns(dict(zip(how.axes, ("--x", "--y"), strict=True)))
    table = read_export(path, how.axes, how.track.decimal, how.track.sheet)
    points = from_table(table, replace(how, columns={}), path, digest)
    if not is_project(path):
        return points
    note = f"{path}: errors are those of a click, {PIXEL:g} pixel; those of the measurement are in the scatter"
    bars = bars_left_out(path)
    left_out = [f"{path}: {bars} ends of error bars are left out: the file does not say what they mean"] * bool(
        bars
    )
    return replace(points, notes=(*points.notes, note, *left_out))


def _known_columns(given: Mapping[str, str]) -> None:
    """Refuse names that are no columns of the schema, each given by the option that is its value."""
    known = read_schema(SCHEMA).columns
    rule = f"is not a column that a fit uses; known: {', '.join(known)}"
    defects = [Defect(rule, field=option, value=name) for name, option in given.items() if name not in known]
    if defects:
        raise InputError(*defects)


def _digest(path: str) -> str:
    return hashlib.sha256(read_bytes(path)).hexdigest()
