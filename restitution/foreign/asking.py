"""What a file of no known program leaves open, asked for in one line that can be typed back."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np

from restitution.errors import Defect, InputError
from restitution.foreign import player
from restitution.foreign.completed import unit_in_file
from restitution.foreign.heading import FRAMES
from restitution.foreign.number_text import as_number
from restitution.foreign.programs import POSITIONS, TIMES, VELOCITIES
from restitution.foreign.settings import Settings, Units
from restitution.foreign.table import ROW, ForeignTable
from restitution.units import SPEED, UnitError, quantity

_SAME_CLOCK = 0.02
"""Part by which frames a second may differ from the rows a second of a file that has times of its own."""
_FROM_A_DETECTOR = ("position", "distance")
"""Words in the names of columns that detectors of motion write."""
_ALONG = re.compile(r"(?<![a-z])[yz](?![a-z])(?!.*(?:vel|speed|acc))|\[3\]|points:[12]$", re.IGNORECASE)
"""Names of columns that say y or z somewhere: "P1 Y", "Point1-Y[mm]", "y_position", "c_com[3]", "Points:2"."""
_MOST_NAMED = 30
"""Columns that a message names."""
_SWAPPED = 0.1
"""Part of the rows whose times go back from which on it is no matter of a few wrong rows."""
_COUNTED = [name for name, unit in FRAMES.items() if unit == "frame" and name != "fr"]
_FRAMES = ("slice", "image", "bild", *_COUNTED)


def what_is_needed(table: ForeignTable, given: Settings | None = None) -> Defect:
    """That the columns of a track are not known, with the options that name them, guessed from their names.

    What is ``given`` already is not asked for again.
    """
    given = given or Settings()
    time, value = _guessed(table)
    time, value = given.time or time, given.position or given.velocity or value
    header = ", ".join(map(_listed, table.header[:_MOST_NAMED])) + (
        " ..." if len(table.header) > _MOST_NAMED else ""
    )
    if table.named:
        columns = f"the header ({header}) does not tell which columns are time and position"
    else:
        columns = f"names no columns; they are {header}"
    speed = given.velocity is not None or (given.position is None and _is_velocity(table, value))
    asked = [] if given.time else [f"--column time_s={_quoted(time or 'NAME')}"]
    if not given.position and not given.velocity:
        name, other = ("velocity_m_s", "gap_m") if speed else ("gap_m", "velocity_m_s")
        asked.append(f"--column {name}={_quoted(value or 'NAME')} (or {other}=NAME)")
    also = []
    clock = unit_in_file(table, time) if time else None
    if time is None and table.named and len(table.header) != 2:
        also.append(f"--column time_s={ROW} --time-unit frame --fps N where each row is a frame")
    elif given.time_unit is None and clock in (None, "frame"):
        frames = clock is not None or (time is not None and any(word in time.lower() for word in _FRAMES))
        fps = "" if given.frames_per_second else " --fps N"
        also.append(f"--time-unit frame{fps}" if frames else "--time-unit s or what it is in")
    elif (
        given.frames_per_second is None
        and time is not None
        and (played := player.clock(table, time, clock)) is not None
    ):
        also.append(player.asked(time, played[0]))
    if given.unit is None and not (value and unit_in_file(table, value)):
        # Only a position has a point and may be in pixels.
        image = " (rows of an image: --unit px --pixel LENGTH --wall ROW --direction down)"
        also.append("--unit m/s or what it is in" if speed else f"--unit m or what it is in{image}")
    if not speed and given.point is None:
        asked_for = table.program is not None and table.program.centre is None
        also.append(
            "--point centre or lowest" if asked_for else "--point centre where it is the height of the centre"
        )
    if value is not None and any(word in value.lower() for word in _FROM_A_DETECTOR) and given.direction is None:
        also.append(
            "--direction down --wall X where it grows towards the wall, as a distance from a detector above"
        )
    rest = f", with {', '.join(also)}" if also else ""
    return Defect(f"{columns}: {' '.join(asked)}{rest}", file=table.file)


def check_order(table: ForeignTable, time: str, value: str) -> None:
    """Refuse a table whose times go up and down while its values only grow: its columns are likely swapped."""
    i, k = table.header.index(time), table.header.index(value)
    rows = [cells for _, cells in table.rows if len(cells) == len(table.header)]
    if not all(earlier < later for earlier, later in pairwise(as_number(cells[k]) for cells in rows)):
        return
    times = [as_number(cells[i]) for cells in rows]
    back = sum(later <= earlier for earlier, later in pairwise(times))
    if back > _SWAPPED * len(times):
        rule = f"goes back in {back} of {len(times)} rows, and {value} never does: are the two columns swapped?"
        raise InputError(Defect(rule, file=table.file, field=time))


def _guessed(table: ForeignTable) -> tuple[str | None, str | None]:
    """Which columns may be time and position: by their usual names, or the only two that there are."""
    time = table.column(table.program.time) if table.program is not None and table.program.time else None
    time = time or next((own for name in TIMES if (own := table.column(name))), None)
    time = time or next((own for own in table.header if "time" in own.lower() and _moves(table, own)), None)
    time = time or next(
        (own for own in table.header if own.lower().startswith(_FRAMES) and _moves(table, own)), None
    )
    value = next(
        (own for name in POSITIONS if (own := table.column(name)) and own != time and _moves(table, own)), None
    )
    if value is None:  # "Position (m) Run #1"
        starts = tuple(f"{name} " for name in POSITIONS if len(name) > 3)
        value = next((own for own in table.header if own.lower().startswith(starts) and _moves(table, own)), None)
    value = value or next(
        (own for own in table.header if _ALONG.search(own) and own != time and _moves(table, own)), None
    )
    value = value or next(
        (own for name in VELOCITIES if (own := table.column(name)) and own != time and _has_signs(table, own)),
        None,
    )
    if len(table.header) == 1 and time is None:
        value = value or table.header[0]
    if len(table.header) == 2:
        time = time or next(name for name in table.header if name != value)
        value = value or next(name for name in table.header if name != time)
    return time, value


def _is_velocity(table: ForeignTable, value: str | None) -> bool:
    """Whether a column is a velocity by its unit, or by its name."""
    if value is None or _is_speed(table.units.get(value)):
        return value is not None
    return value not in table.units and any(table.column(name) == value for name in VELOCITIES)


def _is_speed(unit: str | None) -> bool:
    try:
        return unit is not None and quantity(unit).dimension == SPEED
    except UnitError:
        return False


def _has_signs(table: ForeignTable, name: str) -> bool:
    """Whether a column has values of both signs, as a velocity has and its magnitude has not."""
    k = table.header.index(name)
    values = [as_number(cells[k]) for _, cells in table.rows if len(cells) == len(table.header)]
    return any(value < 0 for value in values) and any(value > 0 for value in values)


def _moves(table: ForeignTable, name: str) -> bool:
    """Whether a column has more than one value."""
    k = table.header.index(name)
    return len({cells[k] for _, cells in table.rows if len(cells) == len(table.header)}) > 1


def _listed(name: str) -> str:
    return f"'{name}'" if "," in name else name


def _quoted(name: str) -> str:
    return f"'{name}'" if any(sign in name for sign in " ()*#;&") else name


def overridden(table: ForeignTable, settings: Settings, time: str, value: str) -> tuple[str, ...]:
    """A note on each option that stands against the unit that the file itself states."""
    stated = ((time, "--time-unit", settings.time_unit), (value, "--unit", settings.unit))
    return tuple(
        f"{name} is taken in {given}, as {option} says; the file says {own}"
        for name, option, given in stated
        if given is not None and (own := table.units.get(name)) and own != given
    )


def without_use(table: ForeignTable, settings: Settings, time: str, value: str) -> tuple[str, ...]:
    """A note where a pixel is stated and lengths are not in pixels; raises where another clock is stated.

    A film that a program plays slowly has the times of the player.
    """
    at, fps = table.header.index(time), settings.frames_per_second
    if fps is not None and "frame" not in f"{settings.time_unit}":
        times = np.array([as_number(cells[at]) for _, cells in table.rows if len(cells) == len(table.header)])
        unit = (
            Units.of(settings, None).time(settings.time_unit or "s") if "d" not in f"{settings.time_unit}" else 0
        )
        steps = np.diff(times[np.isfinite(times)])
        step = float(np.mean(steps[steps < 1.6 * np.median(steps)])) if len(steps) else np.nan  # but lost frames
        if unit and step > 0 and abs(step * unit * fps - 1) > _SAME_CLOCK:
            rows, slow = 1 / (step * unit), 1 / (step * fps)
            rule = (
                f"is not the {rows:.4g} rows a second of the file: where they are frames on a player's clock, "
                f"--time-unit {slow:.4g}s is what one of its {settings.time_unit} was; else leave it out"
            )
            raise InputError(Defect(rule, file=table.file, field="--fps", value=f"{fps:g}"))
    if settings.pixel is not None and "px" not in f"{settings.unit}":
        return (f"--pixel is not used: {value} is in {settings.unit} (--unit px where it is in pixels)",)
    return ()
