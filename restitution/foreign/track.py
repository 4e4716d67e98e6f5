"""A track from a foreign table and what its numbers mean; all that is not known is asked for at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING

from restitution import datasets
from restitution.conditions import LARGEST, SMALLEST, Conditions
from restitution.errors import Defect, InputError
from restitution.foreign.asking import check_order, overridden, what_is_needed, without_use
from restitution.foreign.completed import Columns, Quantity, as_filmed, completed
from restitution.foreign.number_text import as_number, is_lost
from restitution.foreign.settings import Settings, Units
from restitution.foreign.table import ROW, ForeignTable
from restitution.tables.reading import read_table
from restitution.tracks import Track, contacts

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: dict[Quantity, str] = {"gap": "gap_m", "velocity": "velocity_m_s"}
"""The project's own names of the value of a track."""
_SCHEMAS: dict[Quantity, str] = {"gap": "trajectory", "velocity": "settling"}
SURE = 0.6
"""Likelihood below which a position counts as lost; the default of DeepLabCut."""


@dataclass(frozen=True)
class ForeignTrack:
    """A track in SI, ``reading`` how it was read in one line (empty: as it stands), and notes on it."""

    table: pd.DataFrame
    reading: str
    notes: tuple[str, ...]
    unit: float
    """What one of the file's values is in m or m/s."""

    def track(self, sigma: float | None = None) -> Track:
        """As a track; ``sigma`` is its noise in the file's unit, estimated if not given."""
        return Track.from_table(self.table, None if sigma is None else sigma * self.unit)


def columns_of(table: ForeignTable, settings: Settings) -> Columns | None:
    """The columns of a track, by the settings, the project's own names, or the program's; None if it has none."""
    sought = _sought(table, settings)
    if sought is None:
        return None
    program, stated = table.program, settings.position or settings.velocity
    if (
        program is not None
        and stated is None
        and sought.value == program.position
        and not table.column(sought.value)
    ):
        return None  # of that program, but of another of its tables
    return replace(sought, time=_named(table, sought.time), value=_named(table, sought.value))


def is_track(table: ForeignTable, settings: Settings) -> bool:
    """Whether a table is a track: it has the time, and a position or a velocity, perhaps of several particles."""
    return _sought(table, settings) is not None


def _sought(table: ForeignTable, settings: Settings) -> Columns | None:
    """What the columns of a track would be called."""
    program = table.program
    time = settings.time or _own(table, "time_s") or _clock(table) or (program.time if program else None)
    if time is None:
        return None
    if settings.velocity and settings.position:
        rule = "is given beside a position: a track has one of them"
        raise InputError(Defect(rule, file=table.file, field="velocity", value=settings.velocity))
    position = settings.position or (None if settings.velocity else _own(table, "gap_m"))
    velocity = settings.velocity or (None if position else _own(table, "velocity_m_s"))
    if position is None and velocity is None and program is not None:
        position = program.position
    value, quantity = (velocity, "velocity") if velocity else (position, "gap")
    if value is None:
        return None
    return Columns(time, value, quantity)  # type: ignore[arg-type]


def _clock(table: ForeignTable) -> str | None:
    """The program's column of times in seconds, if the file states their unit."""
    own = table.column(table.program.clock) if table.program is not None and table.program.clock else None
    return own if own is not None and table.units.get(own, "frame") != "frame" else None


def _own(table: ForeignTable, name: str) -> str | None:
    return name if name in table.header else None


def _named(table: ForeignTable, name: str) -> str:
    own = table.column(name)
    if own is None:
        rule = f"is missing; the header names {', '.join(table.header)}"
        if not table.named:
            rule = f"is missing: the file names no columns, they are called {', '.join(table.header)}"
        raise InputError(Defect(rule, file=table.file, row=1, field=name))
    return own


def read_track(table: ForeignTable, settings: Settings, conditions: Conditions | None) -> ForeignTrack:
    """The track in a table.

    Parameters
    ----------
    table : the file.
    settings : what the numbers mean, where the file does not say it.
    conditions : the sphere's diameter, for positions of its centre and units of it; where it is not known, heights
        of the centre stay such.

    Raises
    ------
    InputError : naming every option that is needed, or what is wrong with the rows.
    """
    table = _of_particle(table, settings)
    if settings.time == ROW and table.column(ROW) is None:
        table = table.with_rows()
    columns = columns_of(table, settings)
    if columns is None:
        raise InputError(what_is_needed(table, settings))
    table, played = as_filmed(table, settings, columns.time)
    notes = (*played, *overridden(table, settings, columns.time, columns.value))
    settings = completed(table, settings, columns)
    notes = (*notes, *without_use(table, settings, columns.time, columns.value))
    units = Units.of(settings, conditions)
    time_unit = units.time(settings.time_unit or "s")
    unit = (
        units.length(settings.unit or "m")
        if columns.quantity == "gap"
        else units.speed(settings.unit or "m", time_unit)
    )
    kept, lost = _without_lost(table, columns)
    check_order(kept, columns.time, columns.value)
    names = {"time_s": columns.time, COLUMNS[columns.quantity]: columns.value}
    scale = {"time_s": time_unit, COLUMNS[columns.quantity]: unit}
    frames = read_table(kept.text(), datasets.schema(_SCHEMAS[columns.quantity]), names, scale)
    _in_reach(frames, table.file)
    level = _gap_from(frames, settings, conditions, unit, columns.quantity, table.file)
    _in_reach(frames, table.file)
    sized = conditions is not None
    return ForeignTrack(frames, _in_words(table, settings, columns, level, sized), (*notes, *lost), unit)


def _in_reach(frames: pd.DataFrame, file: str) -> None:
    """Raise unless times and values are of a size that powers and differences of them can be made of."""
    for name in frames.columns.intersection(["time_s", *COLUMNS.values()]):
        size = frames[name].abs().max()
        if size > LARGEST or 0 < size < SMALLEST:
            rule = (
                f"reaches {size:.3g} in SI, which is no size of a track: is its unit, or --wall, what was meant?"
            )
            raise InputError(Defect(rule, file=file, field=name))


def _of_particle(table: ForeignTable, settings: Settings) -> ForeignTable:
    """The rows of the particle; where it is not clear which, raises with all else that is needed too."""
    particle = None if settings.particle is None else str(settings.particle)
    if particle is None and (position := settings.position or settings.velocity):
        own = [name for name, apart in table.sections.items() if apart().column(position) is not None]
        particle = own[0] if len(own) == 1 else None
    try:
        return table.of_particle(particle)
    except InputError as several:
        if particle is not None:
            raise
        one = table.of_particle(next(iter(table.particles())))
        try:
            columns = columns_of(one, settings)
            if columns is None:
                raise InputError(what_is_needed(one, settings))
            completed(one, settings, columns)
        except InputError as more:
            also = "; ".join(defect.rule for defect in more.defects)
            raise InputError(replace(several.defects[0], rule=f"{several.defects[0].rule}; {also}")) from None
        raise


def _without_lost(table: ForeignTable, columns: Columns) -> tuple[ForeignTable, tuple[str, ...]]:
    """The rows that have a time and a position; a particle's frames in the order of time."""
    lost = set(_lost_rows(table, [columns.time, columns.value]))
    quality = table.program.quality if table.program is not None else None
    own = quality and table.column(f"{columns.value.rpartition('/')[0]}/{quality}".lstrip("/"))
    if own:
        k = table.header.index(own)
        lost |= {i for i, (_, cells) in enumerate(table.rows) if not as_number(cells[k]) >= SURE}  # nor NaN
    if len(lost) == len(table.rows):
        rule = f"has no row with both {columns.time} and {columns.value}"
        raise InputError(Defect(rule, file=table.file))
    rows = [row for i, row in enumerate(table.rows) if i not in lost]
    if table.program is not None and table.program.particle:
        at = table.header.index(columns.time)
        rows.sort(key=lambda row: as_number(row[1][at]))
    notes: tuple[str, ...] = ()
    if lost:
        lines = [table.rows[i][0] for i in sorted(lost)]
        one = len(lines) == 1
        notes = (f"{len(lines)} frame{'' if one else 's'} without a position left out: {_lines(lines)}",)
    return replace(table, rows=rows), notes


def _lost_rows(table: ForeignTable, names: list[str]) -> list[int]:
    """Which rows have no value in one of the columns."""
    width, found = len(table.header), set[int]()
    for i in map(table.header.index, names):
        cells = [row[i] if len(row) == width else "0" for _, row in table.rows]
        lost = {cell for cell in set(cells) if is_lost(cell)}
        found |= {k for k, cell in enumerate(cells) if cell in lost} if lost else set()
    return sorted(found)


def _lines(lines: list[int]) -> str:
    """Numbers of lines as ranges: "rows 62 to 71, 122"."""
    parts = []
    for _, run in groupby(enumerate(lines), key=lambda pair: pair[1] - pair[0]):
        run_lines = [line for _, line in run]
        parts.append(f"{run_lines[0]}" + (f" to {run_lines[-1]}" if len(run_lines) > 1 else ""))
    shown = ", ".join(parts[:5]) + (f" and {len(parts) - 5} more places" if len(parts) > 5 else "")
    return f"row{'s' if len(lines) > 1 else ''} {shown}"


def _gap_from(
    frames: pd.DataFrame,
    settings: Settings,
    conditions: Conditions | None,
    unit: float,
    quantity: Quantity,
    file: str,
) -> float | None:
    """Turn positions into gaps and velocities away from the wall; returns the level at rest where asked for."""
    name = COLUMNS[quantity]
    sign = -1.0 if settings.direction == "down" else 1.0
    if quantity == "velocity":
        if sign < 0:
            frames[name] = -frames[name]
        return None
    if settings.wall == "rest":
        heights = sign * frames[name]
        level = contacts(Track.from_table(frames.assign(**{name: heights}))).level
        if level is None:
            rule = "the sphere does not come to rest in this record, so that the wall must be given by its place"
            raise InputError(Defect(rule, file=file, field="--wall", value="rest"))
        frames[name] = heights - level
        return sign * level / unit
    wall = settings.wall or 0.0
    if sign < 0 or wall:
        frames[name] = sign * (frames[name] - wall * unit)
    if settings.point == "centre" and conditions is not None:
        frames[name] -= conditions.sphere.radius
    return None


def _in_words(table: ForeignTable, settings: Settings, columns: Columns, level: float | None, sized: bool) -> str:
    """How the numbers were taken, in one line; empty where they stand as the project's own tables have them."""
    if (
        columns.time == "time_s"
        and columns.value in COLUMNS.values()
        and not table.form
        and not settings.over(Settings()).stated().keys() - {"time_unit", "unit"}
        and settings.time_unit == "s"
        and settings.unit in ("m", "m/s")
    ):
        return ""  # fmt: skip
    time_unit = f"{settings.time_unit}"
    if "frame" in time_unit:
        time_unit += f" at {settings.frames_per_second:g} a second"
    unit = f"{settings.unit}" + (f" of {settings.pixel}" if "px" in f"{settings.unit}" else "")
    parts = [f"time from {columns.time!r} in {time_unit}", f"{columns.quantity} from {columns.value!r} in {unit}"]
    if settings.direction == "down":
        parts.append("growing towards the wall")
    if columns.quantity == "gap":
        if settings.wall == "rest":
            parts.append(f"wall where it comes to rest, at {level:.6g}")
        else:
            parts.append(f"wall at {settings.wall or 0:g}")
            centre = "of the centre, less d/2" if sized else "of the centre, d not known"
            parts.append(centre if settings.point == "centre" else "of the lowest point")
    if table.program is not None:
        parts.insert(0, table.program.name)
    if table.form and table.form != (table.program.name if table.program else ""):
        parts.insert(0, table.form)
    if settings.particle is not None:
        parts.append(f"particle {settings.particle}")
    return "; ".join(parts)
