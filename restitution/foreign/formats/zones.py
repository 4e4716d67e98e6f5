"""Curves and zones of plotting files: Tecplot's (DaVis, solvers), Fluent's, Grace's; measurements of LabVIEW.

Tecplot: ``VARIABLES = "x [mm]", ...``, then ``ZONE ... SOLUTIONTIME=t`` and its rows, a time step a zone. Fluent:
``(labels "time" "y")``, then ``((xy/key/label "name")``, rows of two numbers, ``)``. LabVIEW (.lvm): tags, a head
that ``***End_of_Header***`` ends, names, rows with one cell less, for the comment is mostly empty.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from restitution.errors import Defect, InputError
from restitution.foreign.formats.spots import Read
from restitution.foreign.heading import unit_of
from restitution.foreign.layout import Row, split
from restitution.foreign.number_text import is_number

_VARIABLES = re.compile(r"\s*VARIABLES\s*=\s*(.*)", re.IGNORECASE)
_ZONE = re.compile(r"\s*ZONE\b", re.IGNORECASE)
_TIME = re.compile(r"SOLUTIONTIME\s*=\s*([-+.\deE]+)", re.IGNORECASE)
_QUOTED = re.compile(r'"([^"]*)"')
_LABELS = re.compile(r'\s*\(labels\s+"([^"]*)"\s+"([^"]*)"')
_KEY = re.compile(r'\s*\(\(xy/key/label\s+"([^"]*)"')
_END = "***End_of_Header***"
SOLUTION_TIME = "solutiontime"


def is_tecplot(lines: Sequence[str]) -> bool:
    """Whether the text is Tecplot's."""
    return any(_VARIABLES.match(line) for line in lines[:50]) and any(_ZONE.match(line) for line in lines)


def tecplot(lines: Sequence[str], file: str) -> Read:
    """Names and rows of all zones, their time in front where they have one."""
    names: list[str] = []
    rows: list[Row] = []
    time, within = "", False
    for number, line in enumerate(lines, 1):
        if match := _VARIABLES.match(line):
            names = _QUOTED.findall(match[1]) or re.split(r"[,\s]+", match[1].strip())
        elif _ZONE.match(line) or (within and "=" in line):
            within = True
            found = _TIME.search(line)
            time = found[1] if found else "" if _ZONE.match(line) else time
        elif within and is_number((cells := split(line, " ") or [""])[0]):
            rows.append(Row(number, [*([time] if time else []), *cells]))
        elif names and not rows and line.lstrip().startswith('"'):
            names += _QUOTED.findall(line)  # one a line
    if not rows:
        raise InputError(Defect("is a file of Tecplot without points in its zones", file=file))
    timed = len(rows[0].cells) == len(names) + 1
    return [SOLUTION_TIME, *names] if timed else names, rows, {}


def is_fluent(lines: Sequence[str]) -> bool:
    """Whether the text is a plot of Fluent."""
    return any(_KEY.match(line) for line in lines[:50])


def fluent(lines: Sequence[str], _file: str) -> Read:
    """Names and rows of all curves, the name of each in front."""
    names, rows, curve = ["x", "y"], list[Row](), ""
    for number, line in enumerate(lines, 1):
        if match := _LABELS.match(line):
            names = [match[1], match[2]]
        elif match := _KEY.match(line):
            curve = match[1]
        elif curve and len(cells := line.split()) == 2 and is_number(cells[0]):
            rows.append(Row(number, [curve, *cells]))
    return ["curve", *names], rows, {}


def is_grace(lines: Sequence[str]) -> bool:
    """Whether the text is a project of Grace, or of GROMACS for it."""
    return any(re.match(r"@\s*(version|target|type|[xy]axis)\b", line, re.IGNORECASE) for line in lines[:500])


def grace(lines: Sequence[str], file: str) -> Read:
    """Names, by the labels of the axes, and rows of all sets, the number of each in front."""
    names, rows, number = ["x", "y"], list[Row](), 1
    for line_number, line in enumerate(lines, 1):
        if match := re.match(r'@\s*([xy])axis\s+label\s+"([^"]+)"', line):
            names["xy".index(match[1])] = match[2]
        elif line.startswith("&"):
            number += 1
        elif len(cells := line.split()) >= 2 and all(map(is_number, cells)):
            rows.append(Row(line_number, [f"{number}", *cells]))
    if not rows:
        raise InputError(Defect("is a project of Grace without points", file=file))
    width = len(rows[0].cells) - 1  # errors, or several y, beside the first two
    return ["set", *names, *(f"y{k}" for k in range(2, width))], rows, {}


def is_labview(lines: Sequence[str]) -> bool:
    """Whether the text is a measurement of LabVIEW."""
    return lines[0].startswith("LabVIEW Measurement")


def labview(lines: Sequence[str], file: str) -> Read:
    """Names, rows and units of all segments; times from start and step where the file has no column of them."""
    separator = "," if any(line.strip() == "Separator,Comma" for line in lines[:50]) else "\t"
    names: list[str] = []
    rows: list[Row] = []
    tags: dict[str, list[str]] = {}
    below = False
    for number, line in enumerate(lines, 1):
        cells = split(line, separator)
        if line.startswith(_END):
            below = "Channels" in tags
        elif below and cells[:1] == ["X_Value"]:
            names = [name for name in cells if name and name != "Comment"]
        elif below and names and cells[:1] == ["Channels"]:
            below, names = False, []
        elif below and names and len(cells) > 1:
            values = cells[: len(names)]
            if not values[0]:
                start, step = (_stated(tags, key, file) for key in ("X0", "Delta_X"))
                values[0] = f"{start + step * len(rows):.12g}"
            rows.append(Row(number, values))
        elif cells and cells[0]:
            tags[cells[0]] = cells[1:]
    if not rows:
        raise InputError(Defect("is a measurement of LabVIEW without values", file=file))
    labels = tags.get("Y_Unit_Label", [])
    units = {name: unit_of(label) for name, label in zip(names[1:], labels, strict=False) if label}
    return names, rows, units | ({names[0]: "s"} if (tags.get("X_Dimension") or ["Time"])[0] == "Time" else {})


def _stated(tags: dict[str, list[str]], key: str, file: str) -> float:
    """A number of the head of a measurement."""
    text = (tags.get(key) or [""])[0].replace(",", ".")
    if not is_number(text):
        raise InputError(Defect("is no number, and there is no column of times", file=file, field=key, value=text))
    return float(text)
