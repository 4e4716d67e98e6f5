"""What the settings and the file say together of a track's numbers; what neither says is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from restitution.errors import Defect, InputError
from restitution.foreign import player
from restitution.foreign.settings import Settings
from restitution.foreign.table import ForeignTable

Quantity = Literal["gap", "velocity"]


@dataclass(frozen=True)
class Columns:
    """Which columns of a file are the time and the value, and what the value is."""

    time: str
    value: str
    quantity: Quantity


def unit_in_file(table: ForeignTable, name: str) -> str | None:
    """The unit of a column, as the file or its program states it."""
    known = {} if table.program is None else table.program.units
    short = name.rpartition("/")[2].lower()
    ours = {"time_s": "s", "gap_m": "m", "velocity_m_s": "m/s"}
    return ours.get(name) or table.units.get(name) or known.get(name.lower()) or known.get(short)


def as_filmed(table: ForeignTable, settings: Settings, time: str) -> tuple[ForeignTable, tuple[str, ...]]:
    """The table with frames for a player's times where the camera's frames a second are stated; a note of it."""
    fps = settings.frames_per_second
    if fps is None or settings.time_unit is not None or time == "time_s":
        return table, ()
    found = player.clock(table, time, unit_in_file(table, time))
    if found is None or abs(found[0] / fps - 1) < player.SAME:
        return table, ()
    return player.in_frames(table, time, *found), (player.note(time, found[0], fps),)


def completed(table: ForeignTable, settings: Settings, columns: Columns) -> Settings:
    """The settings with what the file says; raises with all that neither says."""
    program, clock = table.program, unit_in_file(table, columns.time)
    played = None if columns.time == "time_s" else player.clock(table, columns.time, clock)
    if program is not None and clock is not None and played is not None and played[0] == 1:
        clock = "frame"  # whoever told the program no rate has a frame counted as a second
    found = {
        "time_unit": clock,
        "unit": unit_in_file(table, columns.value),
        "direction": "down" if program is not None and program.down else None,
        "point": "centre" if program is not None and program.centre else None,
    }
    whole = settings.over(Settings(**{k: v for k, v in found.items() if v is not None}))
    needed = []
    if whole.time_unit is None and played is not None:
        needed.append(f"{player.asked(columns.time, played[0])}; else --time-unit U of it (s, ms)")
    elif whole.time_unit is None:
        needed.append(f"--time-unit U of {columns.time} (s, ms, frame, 0.5ms, sqrt(d/g))")
    elif "frame" in whole.time_unit and whole.frames_per_second is None:
        needed.append(f"--fps N: frames a second, for {columns.time} counts frames")
    if whole.unit is None:
        needed.append(f"--unit U of {columns.value} (m, mm, px, 0.3mm, d)")
    elif "px" in whole.unit and whole.pixel is None:
        needed.append(f"--pixel LENGTH of one (0.125mm), for {columns.value} is in pixels")
    if columns.quantity == "gap" and program is not None:
        if program.either_way and whole.direction is None:
            needed.append(
                f"--direction up or down: whether {columns.value} grows away from the wall or towards it"
            )
        if whole.wall is None and (program.down or program.either_way):
            wall = "--wall X" if whole.point else "--wall X and --point centre or lowest"
            needed.append(f"{wall}: {columns.value} of the wall, or --wall rest: where the sphere comes to rest")
        elif whole.point is None and whole.wall != "rest":
            needed.append(f"--point centre or lowest: whose {columns.value} it is")
    if needed and whole.time_unit is not None and settings.time_unit is None and played and clock != "frame":
        needed.append(player.asked(columns.time, played[0]))
    if needed:
        what = f"is a file of {program.name}" if program is not None else "does not say what its numbers are"
        raise InputError(Defect(f"{what}; say {'; '.join(needed)} (or --settings FILE)", file=table.file))
    return whole
