"""Files of many small tables below each other, one a time step or a track.

Dumps of LAMMPS, Kinovea's text, data files of MTrackJ, logs of OpenFOAM's moving bodies.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from restitution.errors import Defect, InputError
from restitution.foreign.formats.spots import Read
from restitution.foreign.layout import Row, split

_ITEM = "ITEM:"
_KINOVEA = "#kinovea trajectory data export"
_TIME = re.compile(r"Time = ([\d.eE+-]+)s?\s*$")
_CENTRE = re.compile(r"\s*Cent(?:re|er) of mass: *\(([^()]*)\)")
_CLOCK = re.compile(r"(?:(\d+):)?(\d+):(\d+):(\d+)")


def is_lammps(lines: Sequence[str]) -> bool:
    """Whether the text is a dump of LAMMPS."""
    return next((line for line in lines if line.strip()), "").startswith(_ITEM)


def is_kinovea(lines: Sequence[str]) -> bool:
    """Whether the text is Kinovea's, of trajectories."""
    return next((line for line in lines if line.strip()), "").strip().lower() == _KINOVEA


def is_mtrackj(lines: Sequence[str]) -> bool:
    """Whether the text is a data file of MTrackJ (.mdf)."""
    return bool(re.match(r"MTrackJ [\d.]+ Data File", next((line for line in lines if line.strip()), "")))


def is_lammps_log(lines: Sequence[str]) -> bool:
    """Whether the text is a log of LAMMPS or LIGGGHTS with tables of thermodynamic output."""
    return re.match(r"(LAMMPS|LIGGGHTS) \(", next((line for line in lines if line.strip()), "")) is not None


def is_openfoam_log(lines: Sequence[str]) -> bool:
    """Whether the text is the log of a solver that moves a body."""
    return any(_CENTRE.match(line) for line in lines) and any(_TIME.match(line) for line in lines)


def mtrackj(lines: Sequence[str], file: str) -> Read:
    """Names and rows of all points, the number of their track in front; of several clusters "cluster.track".

    A point is ``Point ID x y z t c``, in pixels and frames.
    """
    rows: list[Row] = []
    cluster = track = "1"
    for number, line in enumerate(lines, 1):
        word, *cells = line.split() or [""]
        if word == "Cluster" and cells:
            cluster = cells[0]
        elif word == "Track" and cells:
            track = cells[0] if cluster == "1" else f"{cluster}.{cells[0]}"
        elif word == "Point":
            if len(cells) < 5:
                raise InputError(
                    Defect("is a point without ID x y z t", file=file, row=number, value=line.strip())
                )
            rows.append(Row(number, [track, *cells[1:5]]))
    if not rows:
        raise InputError(Defect("is a file of MTrackJ without points", file=file))
    return ["track", "x", "y", "z", "t"], rows, {}


def lammps_log(lines: Sequence[str], file: str) -> Read:
    """Names and rows of all tables, each from "Step ..." to "Loop time ..."; a step that two have is told once."""
    names: list[str] = []
    rows: dict[str, Row] = {}
    within = False
    for number, line in enumerate(lines, 1):
        cells = line.split()
        if cells[:1] == ["Step"]:
            if names and cells != names:
                raise InputError(Defect("names other columns than the table before", file=file, row=number))
            names, within = cells, True
        elif line.startswith("Loop time"):
            within = False
        elif within and len(cells) == len(names) and cells[0].isdigit():
            rows[cells[0]] = Row(number, cells)
    if not rows:
        raise InputError(Defect("is a log of LAMMPS without a table that begins with Step", file=file))
    return names, list(rows.values()), {}


def openfoam_log(lines: Sequence[str], _file: str) -> Read:
    """Names and rows of time and centre of mass, of each time the last that was computed."""
    rows: dict[str, Row] = {}
    time = ""
    for number, line in enumerate(lines, 1):
        if match := _TIME.match(line):
            time = match[1]
        elif time and (match := _CENTRE.match(line)):
            rows[time] = Row(number, [time, *match[1].split()])
    return ["time", *(f"centreOfMass_{axis}" for axis in "xyz")], list(rows.values()), {}


def lammps(lines: Sequence[str], file: str) -> Read:
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
    return names, rows, {}


def kinovea(lines: Sequence[str], _file: str) -> Read:
    """Names and rows of all trajectories, the name or number of each in front.

    Times are numbers, or h:mm:ss:cc with hundredths of a second, which are made seconds.
    """
    rows: list[Row] = []
    trajectory, count, named, gap, timed = "", 0, "", True, False
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
            timed |= _CLOCK.fullmatch(cells[0]) is not None
            rows.append(Row(number, [trajectory, _seconds(cells[0]), *cells[1:]]))
    return ["trajectory", "T", "X", "Y"], rows, {"T": "s"} if timed else {}


def _seconds(cell: str) -> str:
    clock = _CLOCK.fullmatch(cell)
    if clock is None:
        return cell
    hours, minutes, seconds, hundredths = (int(part or 0) for part in clock.groups())
    return f"{3600 * hours + 60 * minutes + seconds + hundredths / 100:.10g}"
