"""Programs whose files are known by their own marks, and what is thereby known of the numbers.

Recognised is what a program always writes, never what its user chose: no length of a pixel, no frames a second, no
place of the wall.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Program:
    """What the files of one program say by being its files. Columns are named in lower case."""

    name: str
    recognises: Callable[[set[str]], bool]
    """Told by the names of the columns, in lower case."""
    time: str | None = None
    clock: str | None = None
    """A better time than ``time``, where the file states a unit of it other than frames."""
    position: str | None = None
    particle: str | None = None
    units: dict[str, str] = field(default_factory=dict)
    """Units of columns where the file states none."""
    down: bool = False
    """Positions are rows of an image, counted downwards."""
    centre: bool | None = None
    """Positions are those of centres; None: the user decided."""
    quality: str | None = None
    """A column that says how sure a position is, from 0 to 1."""


TRACKMATE = Program(
    "TrackMate",
    lambda names: {"position_x", "position_y", "frame"} <= names,
    time="frame", clock="position_t", position="position_y", particle="track_id",
    units={"frame": "frame", "position_x": "px", "position_y": "px", "position_z": "px"},
    down=True, centre=True,
)  # fmt: skip
TRACKPY = Program(
    "trackpy",
    lambda names: {"x", "y", "frame"} <= names and bool({"mass", "particle", "ecc"} & names),
    time="frame", position="y", particle="particle",
    units={"frame": "frame", "x": "px", "y": "px", "z": "px"},
    down=True, centre=True,
)  # fmt: skip
DEEPLABCUT = Program(
    "DeepLabCut",
    lambda names: "likelihood" in {name.rpartition("/")[2] for name in names} and "coords" in names,
    time="coords", position="y",
    units={"coords": "frame", "x": "px", "y": "px"},
    down=True, quality="likelihood",
)  # fmt: skip
KINOVEA = Program(
    "Kinovea",
    lambda names: (
        any(re.fullmatch(r"time( [(\[]\w+[)\]])?", name) for name in names)
        and any(re.fullmatch(r".+/\d+/[xy]", name) for name in names)
    ),
    time="time", position="y", units={"time": "ms"},
)  # fmt: skip
KINOVEA_TEXT = Program(
    "Kinovea", lambda names: False, time="t", position="y", particle="trajectory", units={"t": "s"}
)  # fmt: skip
TRACKER = Program(
    "Tracker",
    lambda names: "t" in names and {"x", "y"} <= {name.rpartition("/")[2] for name in names},
    time="t", position="y", units={"t": "s"},
)  # fmt: skip
"""Known besides by the line of the track's name above; see :func:`program_of`."""
LAMMPS = Program("LAMMPS", lambda names: False, time="timestep", particle="id", centre=True)
OPENFOAM = Program("OpenFOAM", lambda names: False, time="time", units={"time": "s"})
_BY_NAMES = (TRACKMATE, TRACKPY, DEEPLABCUT, KINOVEA)

TIMES = (
    "time_s",
    "time",
    "t",
    "t_s",
    "time (s)",
    "t/t0",
    "t_star",
    "frame",
    "timestep",
    "step",
    "seconds",
    "slice",
    "slice n°",
)
"""Names by which a column is guessed to be the time, in a message that says how to name it."""
POSITIONS = ("gap_m", "gap", "gap/d", "gap_over_d", "y", "z", "height", "h", "pos_y", "pos_z", "position")
PARTICLES = (
    "particle",
    "particle_id",
    "track_id",
    "track",
    "trackid",
    "track id",
    "trajectory",
    "object_id",
    "id",
)
"""Names of a column that tells particles apart, if its numbers repeat."""


def program_of(names: Sequence[str]) -> Program | None:
    """The program that writes columns of these names; None where no mark is known."""
    lower = {name.strip().lower() for name in names}
    return next((program for program in _BY_NAMES if program.recognises(lower)), None)


def is_tracker(names: Sequence[str], titles: Sequence[Sequence[str]]) -> bool:
    """Whether a line of nothing but names of tracks, of one word each, stands above ``t  x  y``: Tracker's."""
    if not titles:
        return False
    tracks = [cell for cell in titles[-1] if cell]
    named = 1 <= len(tracks) < len(names) and not any(" " in track for track in tracks)
    return named and TRACKER.recognises({name.strip().lower() for name in names})
