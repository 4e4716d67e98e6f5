"""Trajectories of OpenPTV, of which each frame has a file of its own: ``ptv_is.10001``, ``ptv_is.10002``, ...

The first line counts the particles; a row is ``previous next x y z``: the rows of the same particle in the frames
before and after, counted from 0, negative where there is none, and its place in mm.
"""

from __future__ import annotations

import re
from pathlib import Path

from restitution.errors import Defect, InputError
from restitution.foreign.file_text import text_of
from restitution.foreign.formats.spots import Read
from restitution.foreign.layout import Row
from restitution.inputs import read_bytes

_NAME = re.compile(r"(ptv_is)\.(\d+)")
_MOST_FILES = 100_000


def is_frame(path: str | Path) -> bool:
    """Whether a file is that of one frame, by its name, or a folder has such files."""
    if _NAME.fullmatch(Path(path).name):
        return True
    return Path(path).is_dir() and any(_NAME.fullmatch(file.name) for file in Path(path).iterdir())


def trajectories(path: str | Path) -> Read:
    """Names and rows of all frames beside this one, the longest trajectory first."""
    folder = Path(path) if Path(path).is_dir() else Path(path).parent
    files = {int(m[2]): p for p in folder.iterdir() if (m := _NAME.fullmatch(p.name))}
    if len(files) > _MOST_FILES:
        raise InputError(
            Defect(f"has {len(files)} frames beside it; at most {_MOST_FILES} are read", file=str(path))
        )
    found: list[list[list[str]]] = []
    before: list[int] = []
    last = None
    for frame, file in sorted(files.items()):
        here: list[int] = []
        for number, line in enumerate(text_of(read_bytes(file), str(file)).splitlines()[1:], 2):
            cells = line.split()
            if len(cells) != 5 or not re.fullmatch(r"-?\d+", cells[0]):
                rule = f"has {len(cells)} values where a row is previous next x y z"
                raise InputError(Defect(rule, file=str(file), row=number))
            linked = int(cells[0])
            goes_on = last == frame - 1 and 0 <= linked < len(before)
            which = before[linked] if goes_on else len(found)
            if not goes_on:
                found.append([])
            found[which].append([f"{frame}", *cells[2:]])
            here.append(which)
        before, last = here, frame
    if not found:
        raise InputError(Defect("has no particle in any frame", file=str(path)))
    ordered = sorted(found, key=len, reverse=True)
    rows = [[f"{k}", *cells] for k, part in enumerate(ordered, 1) for cells in part]
    return ["trajectory", "frame", "x", "y", "z"], [Row(n, cells) for n, cells in enumerate(rows, 1)], {}
