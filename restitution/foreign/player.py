"""The clock of a player: films of fast cameras are played at 24 to 60 frames a second, and trackers count that.

Whether times are a player's is never guessed: their steps say only that they may be. Frames a second of the camera
that are stated beside such times make them what they are, the number of the frame.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from restitution.foreign.number_text import as_number
from restitution.foreign.table import ForeignTable
from restitution.units import TIME, UnitError, quantity

RATES = (1.0, 10.0, 15.0, 24000 / 1001, 24.0, 25.0, 30000 / 1001, 30.0, 50.0, 60000 / 1001, 60.0)
"""Frames a second of players, and of programs that were told none: they count a frame as a second."""
SAME = 0.02
"""Part by which stated frames a second may differ from those of the times, and still be theirs."""
_CLOSE = 0.0005
"""Part by which the mean step of times may differ from a player's: what tells 30 from 29.97."""
_HUNDREDTH = 0.01
"""Some programs round to hundredths of a second, which is then how far first and last time are off together."""
_LOST = 1.6
"""Steps of the middle step and this factor have no lost frame in them."""


def clock(table: ForeignTable, time: str, unit: str | None) -> tuple[float, float] | None:
    """Frames a second at which the times of a column may have been played, their unit in s; None if no player's.

    Times whose ``unit`` is not stated may be in seconds or in milliseconds.
    """
    for name in ("s", "ms") if unit is None else (unit,):
        try:
            length, dimension = quantity(name)
        except UnitError:
            return None  # of frames, or of the sphere's own
        if dimension == TIME and (played := _rate(table, time, length)) is not None:
            return played, length
    return None


def _rate(table: ForeignTable, time: str, unit: float) -> float | None:
    if time not in table.header:
        return None
    times = _times(table, time) * unit
    steps = np.diff(times)
    if len(steps) < 3:
        return None
    steps = steps[steps < _LOST * np.median(steps)]
    found = 1 / float(np.mean(steps))
    rounded = _HUNDREDTH / float(np.sum(steps)) if _in_hundredths(times) else 0.0
    near = min(RATES, key=lambda played: abs(found / played - 1))
    return near if abs(found / near - 1) < _CLOSE + rounded else None


def in_frames(table: ForeignTable, time: str, played: float, unit: float) -> ForeignTable:
    """The same with the number of the frame in place of the time; frames may be lost between two."""
    k = table.header.index(time)
    numbers: dict[str, str] = {}
    known = sorted({cells[k] for _, cells in table.rows if not np.isnan(as_number(cells[k]))}, key=as_number)
    frame = 0
    for before, cell in pairwise([known[0], *known]):
        frame += round((as_number(cell) - as_number(before)) * unit * played)
        numbers[cell] = f"{frame}"
    rows = [(line, [*cells[:k], numbers.get(cells[k], cells[k]), *cells[k + 1 :]]) for line, cells in table.rows]
    units = {**table.units, time: "frame"}
    return ForeignTable(table.file, table.header, rows, units, table.program, table.named, table.form)


def asked(time: str, played: float) -> str:
    """What to say where such times are not explained."""
    count = "one frame a second" if played == 1 else f"{played:.4g} frames a second"
    return f"--fps N of the camera where it was not {count}, as a player or tracker counts in {time}"


def note(time: str, played: float, fps: float) -> str:
    """What was made of such times."""
    return f"{time} counts {played:.4g} frames a second, as a player does: taken as frames, {fps:g} a second"


def _times(table: ForeignTable, time: str) -> np.ndarray:
    k = table.header.index(time)
    times = np.array([as_number(cells[k]) for _, cells in table.rows if len(cells) == len(table.header)])
    return np.unique(times[np.isfinite(times)])


def _in_hundredths(times: np.ndarray) -> bool:
    return bool(np.all(np.abs(times * 100 - np.round(times * 100)) < 1e-6))
