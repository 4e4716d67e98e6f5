"""The shipped data: which records there are, what is known about each, and its table.

The package is a Frictionless data package (``data/datapackage.json``, :mod:`restitution.datasets.package`). It
lies beside the packages in a source checkout and inside this one in an installed wheel.
"""

from __future__ import annotations

import difflib
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from restitution.datasets.package import Resource, file_defects, read_package
from restitution.errors import InputError
from restitution.tables.reading import read_table
from restitution.tables.schema import Schema, read_schema
from restitution.tracks import Track

if TYPE_CHECKING:
    import pandas as pd

T = TypeVar("T")


def folder() -> Path:
    """The folder of the shipped data package."""
    here = Path(__file__).parent.parent
    for place in (here / "_data", here.parent / "data"):
        if (place / "datapackage.json").is_file():
            return place
    raise FileNotFoundError("the data package is missing from this installation of restitution")


def names() -> list[str]:
    """The names of all shipped tables."""
    return list(_shipped())


def resource(name: str) -> Resource:
    """What is known about a shipped table: experiment, conditions, errors, provenance.

    Parameters
    ----------
    name : one of :func:`names`, such as "gondret2002_st152".

    Returns
    -------
    The entry of the data package; ``conditions`` has fluid and sphere in SI, ``quoted`` what the source states.

    Raises
    ------
    InputError : for an unknown name, with the nearest known ones.
    """
    return _pick(name, _shipped(), "dataset")


def schema(name: str) -> Schema:
    """The schema of a kind of table: trajectory, settling, impact, resistance."""
    return read_schema(_pick(name, _schemas(), "kind of table"))


def schema_names() -> list[str]:
    """The kinds of table."""
    return list(_schemas())


def load(name: str) -> pd.DataFrame:
    """A shipped table, its file checked against the recorded hash and its schema.

    Parameters
    ----------
    name : one of :func:`names`.

    Returns
    -------
    A row a point, columns in SI with the unit in their names (``time_s``, ``gap_m``, ...).

    Raises
    ------
    InputError : for an unknown name, a file that is not the recorded one, or one that breaks its schema.
    """
    r = resource(name)
    defects = file_defects(folder() / r.path, r)
    if defects:
        raise InputError(*defects)
    return read_table(folder() / r.path, read_schema(folder() / r.schema_path))


def load_track(name: str, sigma: float | None = None) -> Track:
    """A trajectory or settling record as a track.

    Parameters
    ----------
    name : one of :func:`names`; what it was measured in, and by whom, is in :func:`resource`.
    sigma : noise of a position in m (or of a velocity in m/s); by default what the frames show, but at least the
        stated error of digitisation.

    Raises
    ------
    InputError : for an unknown name or a table that is no track.
    """
    r = resource(name)
    if r.table not in ("trajectory", "settling"):
        raise InputError(f"{name} is a {r.table} table, not a track")
    error = r.digitisation_error
    track = Track.from_table(load(name), sigma, error.speed_scale_sigma)
    stated = error.sigma.get("gap_m" if track.quantity == "gap" else "velocity_m_s", 0.0)
    return track if sigma is not None or stated <= track.sigma else replace(track, sigma=stated)


@cache
def _shipped() -> dict[str, Resource]:
    return {r.name: r for r in read_package(folder())[1].resources}


@cache
def _schemas() -> dict[str, Path]:
    return {path.stem: path for path in sorted((folder() / "schemas").glob("*.json"))}


def _pick(name: str, known: dict[str, T], what: str) -> T:
    if name in known:
        return known[name]
    near = difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    hint = f"did you mean {' or '.join(near)}?" if near else f"known: {', '.join(known)}"
    raise InputError(f"unknown {what} {name!r}; {hint}")
