"""A track whose header says itself what it holds: ``t,gap``, ``Zeit [ms];Abstand [mm]``, ``t/sqrt(d/g),gap/d``.

Units that it does not state are taken as SI, for a reader that would notice others: one that knows how fast the
sphere meets the wall.
"""

from __future__ import annotations

from restitution.foreign.programs import CLOCKS, GAPS, POSITIONS, VELOCITIES
from restitution.foreign.settings import Settings
from restitution.foreign.table import ForeignTable
from restitution.foreign.track import is_track

_COLUMNS = ("time", "position", "velocity")
_NUMBERS = ("time_unit", "unit", "frames_per_second", "pixel", "direction", "wall", "point")


def of_header(table: ForeignTable, given: Settings) -> tuple[Settings, tuple[str, ...]]:
    """The settings with what the names of the columns say, and a note where units were taken as SI."""
    if table.program is not None:
        return given, ()
    time, gap, velocity = _columns(table)
    own = Settings(
        time=time,
        position=None if given.velocity else gap,
        velocity=velocity if not gap and not given.position else None,
    )
    settings = given.over(own)
    value = settings.position or settings.velocity
    if settings.time is None or value is None:
        return given, ()
    if settings.time != time or value not in (gap, velocity):
        return settings, ()
    units = {"time_unit": (time, "s"), "unit": (value, "m" if value == gap else "m/s")}
    stated = settings.stated()
    si = {key: unit for key, (name, unit) in units.items() if key not in stated and name not in table.units}
    taken = " and ".join(f"{units[key][0]} in {unit}" for key, unit in si.items())
    note = (f"units that the file does not state are taken as SI: {taken} (--unit, --time-unit)",) if si else ()
    return settings.over(Settings(**si)), note


def left_open(table: ForeignTable, shared: Settings) -> tuple[Settings, tuple[str, ...]]:
    """What settings that several files share say of this one: nothing that its own header says; a note on that.

    A header of columns and their units leaves nothing open; one of columns alone is told no others.
    """
    time, gap, velocity = _columns(table)
    value = gap or velocity
    if is_track(table, Settings()) and table.program is None:
        needless = (*_COLUMNS, *_NUMBERS)
    elif table.program is None and time and value:
        whole = time in table.units and value in table.units
        strange = any(table.column(name) is None for key in _COLUMNS if (name := getattr(shared, key)))
        needless = (*_COLUMNS, *_NUMBERS) if whole else _COLUMNS if strange else ()
    else:
        needless = ()
    stated = shared.stated()
    left = Settings(**{key: value for key, value in stated.items() if key not in needless})
    note = "its header says what it holds, so that the options shared with the others are not for it"
    return left, (f"{note} (--settings takes one file each)",) if left != shared else ()


def _columns(table: ForeignTable) -> tuple[str | None, str | None, str | None]:
    """The columns of the time, the gap and the velocity by their names; none beside the project's own.

    A height leaves open whose it is, so that beside one a velocity is not what was clearly meant.
    """

    def first(names: tuple[str, ...]) -> str | None:
        return next((own for name in names if (own := table.column(name))), None)

    if is_track(table, Settings()):
        return None, None, None
    return first(CLOCKS), first(GAPS), None if first(POSITIONS) else first(VELOCITIES)
