"""What ``data validate`` doubts of tables that are valid: the checks of ``impacts``, ``fit`` and ``compare``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

    from restitution.conditions import Conditions
    from restitution.datasets.package import Package
    from restitution.doubts import Doubt
    from restitution.tables.schema import Schema

TRACKS = ("trajectory", "settling")
"""Kinds of tables that are tracks."""


def of_table(
    path: Path, schema: Schema, columns: Mapping[str, str], scale: float, conditions: Conditions | None
) -> list[Doubt]:
    """Doubts about a table without defects; ``scale`` is what one of its gaps is in m.

    Without conditions a track is asked only for its frames and whether it moves.
    """
    from restitution.tables.reading import read_table

    if schema.name in TRACKS:
        table = read_table(path, schema, columns, {"gap_m": scale} if "gap_m" in schema.columns else None)
        return of_track_table(table, conditions, str(path))
    return of_impact_table(path, columns) if schema.name == "impact" else []


def of_track_table(
    table: pd.DataFrame, conditions: Conditions | None, where: str, sigma: float | None = None
) -> list[Doubt]:
    """Doubts about a track in SI; too few frames for an impact are no reason for one."""
    from restitution.doubts import of_record
    from restitution.tracks import MINIMUM_FRAMES, Track

    if len(table) < MINIMUM_FRAMES:
        return []
    return of_record(Track.from_table(table, sigma), conditions, where)


def of_impact_table(path: Path, columns: Mapping[str, str]) -> list[Doubt]:
    """Doubts about a table of impacts that states which Stokes number it has."""
    from restitution.calibration.reading.impact_checks import doubts_about
    from restitution.calibration.reading.impact_data import read
    from restitution.errors import InputError

    try:
        return list(doubts_about(read(path, columns=dict(columns))))
    except InputError:  # valid, but no fit could use it: what is missing is no doubt
        return []


def of_package(place: Path, package: Package) -> list[Doubt]:
    """Doubts about the tracks and impacts of a data package, each under the conditions that it states."""
    from restitution.tables.reading import read_table
    from restitution.tables.schema import read_schema

    found: list[Doubt] = []
    for resource in package.resources:
        path = place / resource.path
        if resource.table in TRACKS:
            table = read_table(path, read_schema(place / resource.schema_path))
            column = "gap_m" if "gap_m" in table else "velocity_m_s"
            stated = resource.digitisation_error.sigma.get(column)
            found += of_track_table(table, resource.conditions, str(path), stated or None)
        elif resource.table == "impact":
            found += [replace(doubt, where=str(path)) for doubt in of_impact_table(path, {})]
    return found
