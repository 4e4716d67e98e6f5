"""A table of bounces: the time of each contact, or the apex that follows it, in a file of any layout."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from restitution.errors import Defect, InputError
from restitution.foreign.programs import TIMES
from restitution.foreign.settings import Settings, Units
from restitution.foreign.table import ForeignTable
from restitution.tables.reading import read_table
from restitution.tables.schema import read_schema

if TYPE_CHECKING:
    from restitution.conditions import Conditions

NUMBERS = (
    "bounce",
    "impact",
    "contact",
    "rebound",
    "bounce_no",
    "bounce number",
    "impact number",
    "hit",
    "event",
    "n",
    "no",
)
"""Names of the column that counts the contacts."""
APEXES = ("apex_m", "apex", "apex_height", "apex height", "rebound height", "height_m", "height", "h")
SIGMAS = ("sigma_s", "sigma_m", "time_sigma_s", "apex_sigma_m", "sigma", "error", "uncertainty", "dt", "dh")
_NO_FLIGHTS = ("e_eff", "stokes", "impact_speed_m_s", "velocity_m_s", "velocity", "gap_m", "gap", "y", "z")
"""Columns of other tables: those of impacts and of tracks."""
Kind = Literal["times", "apexes"]


@dataclass(frozen=True)
class Flights:
    """Successive bounces: the number of each row, its ``value`` (time in s or apex in m) and its error or NaN.

    Number 0 is the release from rest: the time of it, or the height.
    """

    kind: Kind
    number: NDArray
    value: NDArray
    sigma: NDArray
    reading: str = ""

    def runs(self) -> list[slice]:
        """Rows whose numbers follow each other, as far as none is missing."""
        cuts = np.flatnonzero(np.diff(self.number) != 1) + 1
        ends = [0, *cuts.tolist(), len(self.number)]
        return [slice(a, b) for a, b in pairwise(ends)]


def is_flights(table: ForeignTable, names: dict[str, str]) -> bool:
    """Whether a table counts bounces and has the time or the apex of each, and nothing of a track."""
    return _columns(table, names) is not None


def read_flights(
    table: ForeignTable,
    names: dict[str, str],
    settings: Settings,
    conditions: Conditions | None = None,
    sigma: float | None = None,
) -> Flights:
    """The bounces in a table.

    Parameters
    ----------
    table : a file for which :func:`is_flights` holds.
    names : the file's own names of ``bounce``, ``time_s``, ``apex_m``, ``sigma``, where they are given.
    settings : units, where the file does not state them; ``point`` "centre" where apexes are of the centre.
    conditions : for units of the sphere's diameter, and for apexes of its centre.
    sigma : error of each value in the file's unit, where the file has no column of it.

    Raises
    ------
    InputError : naming the unit that is needed, or every row that is wrong.
    """
    columns = _columns(table, names)
    assert columns is not None
    kind, own = columns
    value = own["time_s" if kind == "times" else "apex_m"]
    unit, in_words = _unit(table, kind, value, settings, conditions)
    schema = read_schema(Path(__file__).with_name("contact_times.json" if kind == "times" else "apexes.json"))
    column = schema.columns[1]
    scale = dict.fromkeys((column, "sigma"), unit)
    rows = read_table(table.text(), schema, own, scale)
    values = rows[column].to_numpy(float)
    if kind == "apexes" and settings.point == "centre":
        if conditions is None:
            rule = "--conditions says how large the sphere is, whose centre the apexes are of"
            raise InputError(Defect(rule, file=table.file))
        values = values - conditions.sphere.radius
        if (values <= 0).any():
            row = table.rows[int(np.argmax(values <= 0))][0]
            rule = "is less than the radius: are apexes those of the lowest point (--point lowest)?"
            raise InputError(Defect(rule, file=table.file, row=row, field=value))
    stated = rows["sigma"].to_numpy(float) if "sigma" in own else np.full(len(rows), math.nan)
    errors = np.where(np.isnan(stated) & (sigma is not None), (sigma or 0.0) * unit, stated)
    what = "times of contact" if kind == "times" else "apexes"
    return Flights(kind, rows["bounce"].to_numpy(int), values, errors, f"{what} from {value!r} in {in_words}")


def _columns(table: ForeignTable, names: dict[str, str]) -> tuple[Kind, dict[str, str]] | None:
    """Which columns are meant, by the caller's names or the usual ones."""
    found = {name: own for name, given in names.items() if (own := table.column(given))}

    def one_of(usual: tuple[str, ...]) -> str | None:
        return next((own for name in usual if (own := table.column(name)) and own not in found.values()), None)

    if "bounce" not in found and (own := one_of(NUMBERS)):
        found["bounce"] = own
    if "bounce" not in found or not table.named:
        return None
    given = {"time_s", "apex_m"} & found.keys()
    if not given:
        time, apex = one_of(TIMES), one_of(APEXES)
        if any(table.column(name) for name in _NO_FLIGHTS) or (time is None) == (apex is None):
            return None
        if time is not None:
            found["time_s"] = time
        elif apex is not None:
            found["apex_m"] = apex
    if len(given) > 1:
        return None
    if "sigma" not in found and (own := one_of(SIGMAS)):
        found["sigma"] = own
    return ("times" if "time_s" in found else "apexes"), found


def _unit(
    table: ForeignTable, kind: Kind, name: str, settings: Settings, conditions: Conditions | None
) -> tuple[float, str]:
    """What one of the file's values is in s or m, and its unit in words."""
    ours = {"time_s": "s", "apex_m": "m", "height_m": "m"}
    given = settings.time_unit if kind == "times" else settings.unit
    unit = given or ours.get(name) or table.units.get(name)
    if unit is None:
        option = "--time-unit U (s, ms, frame)" if kind == "times" else "--unit U (m, cm, mm, d)"
        raise InputError(Defect(f"does not say the unit of {name}: say {option}", file=table.file))
    units = Units.of(settings, conditions)
    return (units.time(unit) if kind == "times" else units.length(unit)), unit
