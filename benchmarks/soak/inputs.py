"""Good inputs of every format, small, and what spoils them: values, edits of a text, bytes at random."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from random import Random

from restitution import datasets

FLUID = ("density=935,viscosity=0.01", "diameter=3e-3,density=7800,e_dry=0.97")
PAIR = ("--fluid", FLUID[0], "--sphere", FLUID[1])
LAW = ("--law", "eq4_exponential")
STATED = ("--stokes", "st", "--speed", "far", "--e-dry", "0.97")

CONDITIONS = """\
[fluid]
density = 935.0
viscosity = 0.01
[sphere]
diameter = 0.003
density = 7800.0
e_dry = 0.97
"""
CASE = """\
title = "a small case"
[fluid]
density = 1150
viscosity = 0.05
[sphere]
diameter = 0.004
density = 7800
e_dry = 0.97
roughness = 2e-7
[release]
kind = "drive"
gap_d = 2.0
speed = 0.5
ramp = 0.008
[numerics]
cells_per_diameter = 6
lattice_speed = 0.05
width_d = 3.0
height_d = 7.0
[film]
form = "none"
[contact]
mode = "effective"
law = "legendre_2005"
[run]
after_contact = 0.05
"""
IMPACTS = """\
source,material,speed_definition,stokes_convention,stokes,stokes_sigma,e_dry,e_eff,e_eff_sigma,outcome,e_eff_upper,note
lab A,steel,far,st,152,3,0.97,0.78,0.02,rebound,,made up
lab A,steel,far,st,80,2,0.97,0.63,0.02,rebound,,made up
lab A,steel,far,st,45,1,0.97,0.47,0.03,rebound,,made up
lab B,steel,far,st,27,1,0.97,0.29,0.02,rebound,,made up
lab B,steel,far,st,300,6,0.97,0.86,0.01,rebound,,made up
lab B,steel,far,st,9,0.5,0.97,,,no_rebound,0.05,made up
"""
POINTS = ((10.0, 0.05), (27.0, 0.29), (45.0, 0.47), (80.0, 0.63), (152.0, 0.78), (300.0, 0.86))
PLOT = "D,,E,\nX,Y,X,Y\n" + "".join(
    f"{a[0]:g},{a[1]:g},{b[0]:g},{b[1]:g}\n" for a, b in zip(POINTS[::2], POINTS[1::2], strict=True)
)


def track() -> str:
    """The first bounce of a shipped record."""
    return datasets.load("gondret2002_st152").iloc[:45].to_csv(index=False, float_format="%.7g")


def project() -> dict:
    """A project of WebPlotDigitizer with one set of points."""
    pixels = [{"x": St / 10, "y": 100 * (1 - e)} for St, e in POINTS]
    corners = ((0, 100, "0", "0"), (100, 100, "1000", "0"), (0, 100, "0", "0"), (0, 0, "0", "1"))
    marks = [{"px": x, "py": y, "dx": dx, "dy": dy} for x, y, dx, dy in corners]
    axes = {"name": "XY", "type": "XYAxes", "isLogX": False, "isLogY": False, "calibrationPoints": marks}
    return {"axesColl": [axes], "datasetColl": [{"name": "glass", "axesName": "XY", "data": pixels}]}


def lost_nothing() -> str:
    """A track whose rebounds lose nothing, which no fluid allows."""
    fall, apex = 8.4, 0.004
    half = math.sqrt(2 * apex / fall)
    rows = []
    for k in range(300):
        t = 0.0005 * k
        part = (t % (2 * half)) - half
        rows.append(f"{t:.6g},{apex - 0.5 * fall * part**2 + 5e-6 * math.sin(12.9898 * k):.7g}\n")
    return "time_s,gap_m\n" + "".join(rows)


WORSE = ("nan", "inf", "-inf", "1e999", "", "x", "1_0", "１０", "--3", "1e400", "9" * 5000)
"""What no table takes for a number."""
WORSE_TOML = ("nan", "inf", "-1", "1e308", "1e-320", "true", '"x"', "[]", "{}", "9" * 400, '"3 apples"', "[1, 2]")
"""What no size in a TOML file may be."""
WORSE_JSON = (None, "x", -1e300, 1e300, [], {}, "nan", True, [[1.0]], "\0")
HOSTILE = (
    b"\0", b"\xff\xfe", b"[" * 3000, b"{" * 3000, b'"', b"'", b"\n", b"\r", b",", b";", b"=", b"a." * 800,
    b"9" * 5000,
    b"\x1b]0;t\x07", b"1e999", b"nan", "१".encode(), b"$\\frac{$", b"<script>", b"#", b"\t", b"-", b"%s" * 50,
    b"x" * 5000,
)  # fmt: skip
"""What parsers stumble over."""


def spoiled(content: str | bytes, random: Random) -> bytes:
    """A text with one to three of: a hostile piece, a part cut out, a byte changed, a line twice, an end off."""
    data = bytearray(content.encode() if isinstance(content, str) else content)
    for _ in range(random.randint(1, 3)):
        at = random.randrange(len(data) + 1) if data else 0
        deed = random.randrange(5)
        if deed == 0:
            data[at:at] = random.choice(HOSTILE)
        elif deed == 1:
            del data[at : at + random.choice((1, 5, 50))]
        elif deed == 2 and data:
            data[at % len(data)] ^= 1 << random.randrange(8)
        elif deed == 3:
            lines = data.splitlines(keepends=True)
            if lines:
                data[at:at] = random.choice(lines)
        else:
            del data[at:]
    return bytes(data)


def places(content: object, here: tuple = ()) -> Iterator[tuple]:
    """Every place of a nested content."""
    inner = (
        content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    )
    for key, value in inner:
        yield (*here, key)
        yield from places(value, (*here, key))


def edited(content: object, place: tuple, value: object) -> object:
    """A copy with another value at a place; ``...`` removes what is there."""
    copy = json.loads(json.dumps(content))
    holder = copy
    for key in place[:-1]:
        holder = holder[key]
    if value is ...:
        del holder[place[-1]]
    else:
        holder[place[-1]] = value
    return copy


def with_cell(table: str, row: int, column: int, cell: str) -> str:
    """A table with another cell."""
    lines = table.splitlines()
    cells = lines[row].split(",")
    cells[column] = cell
    lines[row] = ",".join(cells)
    return "\n".join(lines) + "\n"
