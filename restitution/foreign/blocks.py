"""Files of many small tables below each other: a LAMMPS dump, one a time step; Kinovea's text, each a track."""

from __future__ import annotations

import re
from collections.abc import Sequence

from restitution.errors import Defect, InputError
from restitution.foreign.layout import Row, split

_ITEM = "ITEM:"
_KINOVEA = "#kinovea trajectory data export"
_CLOCK = re.compile(r"(?:(\d+):)?(\d+):(\d+):(\d+)")


def is_lammps(lines: Sequence[str]) -> bool:
    """Whether the text is a dump of LAMMPS."""
    return next((line for line in lines if line.strip()), "").startswith(_ITEM)


def is_kinovea(lines: Sequence[str]) -> bool:
    """Whether the text is Kinovea's, of trajectories."""
    return next((line for line in lines if line.strip()), "").strip().lower() == _KINOVEA


def lammps(lines: Sequence[str], file: str) -> tuple[list[str], list[Row]]:
    """Names and rows of all atoms of all steps, the step in front."""
    names: list[str] = []
    rows: list[Row] = []
    step, item = "", ""
    for number, line in enumerate(lines, 1):
        if line.startswith(_ITEM):
            item = line.removeprefix(_ITEM).strip()
            if item.startswith("ATOMS"):
                here = ["timestep", *item.split()[1:]]
                if names and here != names:
                    raise InputError(Defect("names other columns than the steps before", file=file, row=number))
                names = here
        elif item == "TIMESTEP":
            step = line.strip()
        elif item.startswith("ATOMS") and line.strip():
            rows.append(Row(number, [step, *line.split()]))
    if not rows:
        raise InputError(Defect("is a LAMMPS dump without atoms", file=file))
    return names, rows


def kinovea(lines: Sequence[str]) -> tuple[list[str], list[Row]]:
    """Names and rows of all trajectories, the name or number of each in front, its times in seconds.

    Times are numbers, or h:mm:ss:cc with hundredths of a second.
    """
    rows: list[Row] = []
    trajectory, count, named, gap = "", 0, "", True
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if text.startswith("#"):
            named, gap = text.lstrip("# ").strip(), True
        elif not text:
            gap = True
        else:
            if gap:
                count += 1
                trajectory = named if named and named.upper() != "T X Y" and count > 0 else str(count)
                named, gap = "", False
            cells = split(text, " ")
            rows.append(Row(number, [trajectory, _seconds(cells[0]), *cells[1:]]))
    return ["trajectory", "T", "X", "Y"], rows


def _seconds(cell: str) -> str:
    clock = _CLOCK.fullmatch(cell)
    if clock is None:
        return cell
    hours, minutes, seconds, hundredths = (int(part or 0) for part in clock.groups())
    return f"{3600 * hours + 60 * minutes + seconds + hundredths / 100:.10g}"
