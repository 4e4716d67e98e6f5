"""Programs whose files are known by their own marks, and what is thereby known of the numbers.

Recognised is what a program always writes, never what its user chose: no length of a pixel, no frames a second, no
place of the wall.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace


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
    either_way: bool = False
    """Whether positions grow up or down depends on its version or settings, so that it is asked."""
    counted: bool = False
    """Its rows are frames, one after another; the files have no column of them."""
    joined: tuple[str, str | Callable] | None = None
    """How it joins the name of a track to that of a column: a pattern, and what makes it "track/column"."""

    def renamed(self, name: str) -> str:
        """A column's name as "track/column"."""
        return name if self.joined is None else re.sub(self.joined[0], self.joined[1], name, flags=re.IGNORECASE)


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
        and any(re.fullmatch(r".+/\d+/[xy]|trajectory \d+/[xy]", name) for name in names)
    ),
    time="time", position="y", units={"time": "ms"},
)  # fmt: skip
KINOVEA_TEXT = Program(
    "Kinovea", lambda names: False, time="t", position="y", particle="trajectory", either_way=True
)  # fmt: skip
"""Its axis points up or, where it was not calibrated, down; its times are in the unit that its user chose."""
TRACKER = Program(
    "Tracker",
    lambda names: "t" in names and {"x", "y"} <= {name.rpartition("/")[2] for name in names},
    time="t", position="y", units={"t": "s"},
)  # fmt: skip
"""Known besides by the line of the track's name above; see :func:`program_of`."""
IMAGEJ = Program(
    "ImageJ",
    lambda names: {"", "x", "y", "slice"} <= names and bool({"area", "mean", "label"} & names),
    time="slice", position="y", units={"slice": "frame"}, down=True, centre=True,
)  # fmt: skip
IMAGEJ_MASS = replace(
    IMAGEJ, position="ym",
    recognises=lambda names: {"", "xm", "ym", "slice"} <= names and bool({"area", "mean", "label"} & names),
)  # fmt: skip
"""ImageJ's table of results, centroids or centres of mass; its lengths may be calibrated without a word."""
MANUAL_TRACKING = Program(
    "Fiji's Manual Tracking",
    lambda names: (
        {"x", "y", "pixel value"} <= names and any(re.fullmatch(r"slice n\W*", name) for name in names)
    ),
    time="slice n", position="y", particle="track n", units={"slice n": "frame", "x": "px", "y": "px"}, down=True,
    joined=(r"^(slice|track) n\W+$", r"\1 n"),
)  # fmt: skip
MTRACKJ_POINTS = Program(
    "MTrackJ", lambda names: {"nr", "tid", "pid"} <= names,
    time="t", position="y", particle="tid", down=True,
)  # fmt: skip
MTRACKJ = Program(
    "MTrackJ", lambda names: False,
    time="t", position="y", particle="track", units={"t": "frame", "x": "px", "y": "px", "z": "px"}, down=True,
)  # fmt: skip
SLEAP = Program(
    "SLEAP", lambda names: {"frame_idx", "instance.score"} <= names,
    time="frame_idx", position="y", particle="track", units={"frame_idx": "frame", "x": "px", "y": "px"},
    down=True, joined=(r"^(.+)\.(x|y|score)$", r"\1/\2"),
)  # fmt: skip
DLTDV = Program(
    "DLTdv", lambda names: any(re.fullmatch(r"pt\d+_cam\d+_[xy]", name) for name in names),
    time="frame", position="y", units={"frame": "frame", "x": "px", "y": "px"}, either_way=True, counted=True,
    joined=(r"^(pt\d+_cam\d+)_([xy])$", r"\1/\2"),
)  # fmt: skip
IDTRACKER = Program(
    "idtracker.ai", lambda names: {"x1", "y1"} <= names and bool({"time", "seconds"} & names),
    time="time", position="y", units={"time": "s", "seconds": "s", "x": "px", "y": "px"}, down=True, centre=True,
    joined=(r"^([xy])(\d+)$|^seconds$", lambda m: f"{m[2]}/{m[1]}" if m[2] else "time"),
)  # fmt: skip
_DATA_SET = r"(?:data set(?: \d+)?|latest|run \d+|video ?analysis(?: \d+)?)"
VERNIER = Program(
    "Logger Pro",
    lambda names: any(re.match(rf"{_DATA_SET} ?: ?time", name) for name in names),
    time="time", position="y",
    joined=(rf"^({_DATA_SET}) ?: ?(.*?) ?(\(.*\))?$", r"\1/\2 \3"),
)  # fmt: skip
VERNIER_TEXT = Program("Logger Pro", lambda names: False, time="t", position="y")
"""Known by the first line of the text, "Vernier Format"."""
LAMMPS = Program("LAMMPS", lambda names: False, time="timestep", particle="id", centre=True)
LAMMPS_LOG = Program("LAMMPS", lambda names: False, time="time", centre=True)
OPENFOAM = Program("OpenFOAM", lambda names: False, time="time", units={"time": "s"})
TECPLOT = Program("Tecplot", lambda names: False, time="solutiontime", units={"solutiontime": "s"})
FLUENT = Program("Fluent", lambda names: False, particle="curve")
GRACE = Program("Grace", lambda names: False, particle="set")
LABVIEW = Program("LabVIEW", lambda names: False, time="x_value")
OPENPTV = Program(
    "OpenPTV", lambda names: False, time="frame", particle="trajectory", centre=True,
    units={"frame": "frame", "x": "mm", "y": "mm", "z": "mm"},
)  # fmt: skip
ICY = Program(
    "Icy", lambda names: False, time="t", position="y", particle="track", down=True, centre=True,
    units={"t": "frame", "x": "px", "y": "px", "z": "px"},
)  # fmt: skip
WEBPLOTDIGITIZER = Program("WebPlotDigitizer", lambda names: False, time="x", position="y")
_BY_NAMES = (
    TRACKMATE, TRACKPY, DEEPLABCUT, KINOVEA, IMAGEJ_MASS, IMAGEJ, MANUAL_TRACKING, MTRACKJ_POINTS, SLEAP, DLTDV,
    IDTRACKER, VERNIER,
)  # fmt: skip

TIMES = (
    "time_s", "time", "t", "t_s", "time (s)", "t/t0", "t_star", "flow-time", "flow time",
    "frame", "timestep", "step", "seconds", "slice",
    "slice n°",
    "frame_idx", "frame number", "frame#", "zeit", "temps", "tempo", "tiempo", "czas",
    "время", "час", "χρόνος", "时间", "時間", "时刻", "時刻", "시간", "кадр", "帧", "フレーム",
)  # fmt: skip
"""Names by which a column is guessed to be the time, in a message that says how to name it."""
POSITIONS = (
    "gap_m", "gap", "gap/d", "gap_over_d", "y", "z", "height", "h", "pos_y", "pos_z", "position", "posy", "posz",
    "p_y", "p_z", "zpos", "ypos", "v_zpos", "v_ypos", "cy", "ym", "y position",
    "höhe", "hoehe", "hauteur", "altura", "quota", "altezza", "wysokość", "centreofmass_z", "centreofmass_y",
    "зазор", "высота", "координата", "положение", "у", "ύψος", "高度", "高さ", "位置", "位移",
    "変位", "间隙", "높이",
)  # fmt: skip
CLOCKS = (
    "t", "time", "zeit", "temps", "tempo", "tiempo", "czas", "время", "час", "χρόνος", "时间", "時間", "시간",
)  # fmt: skip
GAPS = ("gap", "abstand", "spalt", "зазор", "间隙", "間隙")
VELOCITIES = ("v", "velocity", "geschwindigkeit", "vitesse", "velocidad", "velocità", "скорость", "速度", "속도")
"""Names that leave no doubt what a column is: a time, a gap of the lowest point, a velocity along the normal."""
PARTICLES = (
    "particle", "particle_id", "track_id", "track", "trackid", "track id", "trajectory", "object_id", "id",
)  # fmt: skip
"""Names of a column that tells particles apart, if its numbers repeat."""


def program_of(names: Sequence[str]) -> Program | None:
    """The program that writes columns of these names; None where no mark is known."""
    lower = {name.strip().lower() for name in names}
    return next((program for program in _BY_NAMES if program.recognises(lower)), None)


def is_tracker(names: Sequence[str], titles: Sequence[Sequence[str]], comments: Sequence[str]) -> bool:
    """Whether names of tracks and nothing else stand above ``t  x  y``, one word or cut as the columns are:
    Tracker's; or the mark of its files of several tracks.
    """
    if "multi:" in comments:
        return True
    if not titles:
        return False
    tracks = [cell for cell in titles[-1] if cell]
    cut = len(titles[-1]) > 1
    named = 1 <= len(tracks) < len(names) and (cut or not any(" " in track for track in tracks))
    return named and TRACKER.recognises({name.strip().lower() for name in names})
