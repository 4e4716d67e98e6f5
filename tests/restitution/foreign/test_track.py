"""One flight as cameras, spreadsheets and solvers write it: the same gaps and times come out of every file."""

import math
import random

import numpy as np
import pytest

from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.foreign import Settings, read_foreign, read_track

D = 4e-3
CONDITIONS = Conditions.model_validate(
    {
        "fluid": {"density": 1000.0, "viscosity": 0.005},
        "sphere": {"diameter": D, "density": 2500.0, "e_dry": 0.97},
    }
)
RATE = 250.0
FRAMES = 90


def flight():
    """Times and gaps of a sphere that falls, rebounds twice, and lies still: free fall, e = 0.6."""
    g, height = 5.0, 0.02
    touch, speed = math.sqrt(2 * height / g), math.sqrt(2 * height * g)
    first = touch + 2 * 0.6 * speed / g
    second = first + 2 * 0.36 * speed / g
    t = np.arange(FRAMES) / RATE
    gap = np.where(t < touch, height - g * t**2 / 2, 0.0)
    for start, end, v in ((touch, first, 0.6 * speed), (first, second, 0.36 * speed)):
        here = (t >= start) & (t < end)
        gap[here] = (v * (t - start) - g * (t - start) ** 2 / 2)[here]
    return t, gap


T, GAP = flight()
CENTRE = GAP + D / 2
PIXEL = 0.05e-3
ROW = 700.0
PIXELS = ROW - CENTRE / PIXEL
"""Rows of the centre in an image, counted down, the wall at row 700."""
IMAGE = {"frames_per_second": RATE, "pixel": "0.05 mm", "wall": ROW}


def lines(head, rows):
    return "\n".join([*head, *rows]) + "\n"


def comma(text):
    return text.replace(".", ",")


def csv(*columns, sign=","):
    return [sign.join(f"{x:.9g}" for x in row) for row in zip(*columns, strict=True)]


def trackmate():
    head = [
        "LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_Z,POSITION_T,FRAME,RADIUS",
        "Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,Radius",
        "Label,Spot ID,Track ID,Quality,X,Y,Z,T,Frame,R",
        ",,,(quality),(pixel),(pixel),(pixel),(frame),,(pixel)",
    ]
    rows = [f"ID{i},{i},4,7.5,200,{y:.6f},0,{i}.0,{i},20" for i, y in enumerate(PIXELS)]
    random.Random(1).shuffle(rows)  # spots are not listed in the order of time
    return lines(head, rows)


def trackpy():
    head = [",y,x,mass,size,ecc,signal,raw_mass,ep,frame,particle"]
    rows = []
    for i, y in enumerate(PIXELS):
        rows.append(f"0,{y:.6f},120.0,3000,4,0.1,90,5000,0.02,{i},0")
        rows.append(f"1,55.5,220.0,3000,4,0.1,90,5000,0.02,{i},1")
    return lines(head, rows)


def deeplabcut():
    head = [
        "scorer,DLC_resnet50,DLC_resnet50,DLC_resnet50,DLC_resnet50,DLC_resnet50,DLC_resnet50",
        "bodyparts,ball,ball,ball,rod,rod,rod",
        "coords,x,y,likelihood,x,y,likelihood",
    ]
    rows = [f"{i},120.0,{y:.6f},0.999,12.0,40.0,0.99" for i, y in enumerate(PIXELS)]
    return lines(head, rows)


def tracker_two():
    head = ["\tmass_A\t\tmass_B\t", "t\tx\ty\tx\ty"]
    return lines(head, [f"{t:.9E}\t1.0E-2\t{y:.9E}\t0.0\t0.5" for t, y in zip(T, CENTRE, strict=True)])


def kinovea_text():
    rows = ["#Kinovea Trajectory data export", "#T X Y", "", "# ball"]
    rows += [comma(f"{t:.6f} 12.00 {100 * y:.7f}") for t, y in zip(T, CENTRE, strict=True)]
    return lines(rows, ["", "# rod", "0,00 1,00 1,00", "0,01 1,00 1,00"])


def kinovea_clock():
    clock = [f"0:00:{int(2.5 * t * 4) // 100:02d}:{round(250 * t):02d} 12.00 {100 * y:.7f} "
             for t, y in zip(T, CENTRE, strict=True)]  # fmt: skip
    return lines(["#Kinovea Trajectory data export", "#T X Y"], clock)


def lammps():
    text = ""
    for i, (y, v) in enumerate(zip(CENTRE, np.gradient(GAP, T), strict=True)):
        text += f"ITEM: TIMESTEP\n{400 * i}\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0 1\n"
        text += f"ITEM: ATOMS id type x y z vz\n2 1 0.5 0.5 0.3 0\n1 1 0 0 {y:.9g} {v:.6g}\n"
    return text


def openfoam():
    rows = [f"{t:.9g} (0.01 0.01 {y:.9g}) (0 0 -0.1)" for t, y in zip(T, CENTRE, strict=True)]
    return lines(["# Motion of the sphere", "# Time position velocity"], rows)


def trackmate_model(units="pixel", scale=1.0, y=PIXELS):
    """Two tracks, of which a filter left the second, and a spot of none."""
    other = (
        '<Spot ID="9000" name="a" FRAME="0" POSITION_T="0.0" POSITION_X="1.0" POSITION_Y="2.0" POSITION_Z="0.0" />'
    )
    spots, edges = [], []
    for i, place in enumerate(y):
        own = f'<Spot ID="{100 + i}" name="s" QUALITY="7.5" POSITION_T="{i / RATE:.9g}" FRAME="{i}" RADIUS="40.0" '
        own += f'POSITION_X="200.0" POSITION_Y="{scale * place:.9g}" POSITION_Z="0.0" />'
        spots.append(f'<SpotsInFrame frame="{i}">{other.replace("9000", str(9000 + i))}{own}</SpotsInFrame>')
        if i:
            edges.append(f'<Edge SPOT_SOURCE_ID="{99 + i}" SPOT_TARGET_ID="{100 + i}" LINK_COST="1.0" />')
    head = ['<?xml version="1.0" encoding="UTF-8"?>', '<TrackMate version="7.11.1">',
            f'<Model spatialunits="{units}" timeunits="sec">', "<AllSpots>"]  # fmt: skip
    tail = ["</AllSpots>", "<AllTracks>",
            '<Track TRACK_ID="0" name="Track_0"><Edge SPOT_SOURCE_ID="9000" SPOT_TARGET_ID="9001" /></Track>',
            '<Track TRACK_ID="3" name="Track_3">', *edges, "</Track>", "</AllTracks>",
            '<FilteredTracks><TrackID TRACK_ID="3" /></FilteredTracks>', "</Model>", "</TrackMate>"]  # fmt: skip
    return lines(head, [*spots, *tail])


def trackmate_tracks():
    rows = [f'<detection t="{i}" x="116.2" y="{y:.9g}" z="0.0" />' for i, y in enumerate(PIXELS)]
    head = ['<?xml version="1.0" encoding="UTF-8"?>',
            '<Tracks nTracks="1" spaceUnits="pixel" frameInterval="0.004" timeUnits="sec" from="TrackMate v7.12">',
            f'<particle nSpots="{FRAMES}">']  # fmt: skip
    return lines(head, [*rows, "</particle>", "</Tracks>"])


def kinovea_analysis(calibrated):
    """Of a film at 250 frames a second, 512 time stamps a frame, its texts with decimal commas."""
    rows = []
    for i, (row, y) in enumerate(zip(PIXELS, CENTRE, strict=True)):
        user = f'UserX="1,50" UserXInvariant="1.50" UserY="{comma(f"{100 * y:.7f}")}" '
        user += f'UserYInvariant="{100 * y:.7f}" UserTime="0:00:00:{i:02d}"'
        rows.append(f"<TrackPoint {user if calibrated else ''}>200.5;{row:.6f};{512 * (i + 20)}</TrackPoint>")
    length = "cm" if calibrated else "px"
    head = ['<?xml version="1.0" encoding="utf-8"?>', "<KinoveaVideoAnalysis>",
            "<FormatVersion>2.0</FormatVersion>", "<AverageTimeStampsPerFrame>512</AverageTimeStampsPerFrame>",
            "<CaptureFramerate>250</CaptureFramerate>", "<UserFramerate>25</UserFramerate>",
            "<Tracks>", '<Track name="ball">',
            f'<TrackPointList Count="{FRAMES}" UserUnitLength="{length}">']  # fmt: skip
    return lines(head, [*rows, "</TrackPointList>", "</Track>", "</Tracks>", "</KinoveaVideoAnalysis>"])


METRES = {"time": "t", "position": "y", "time_unit": "s", "unit": "m"}
CENTRES = {**METRES, "point": "centre"}
KINOVEA = {"unit": "cm", "point": "centre", "direction": "up", "wall": 0.0}
FILES = {
    "the project's own": (lines(["time_s,gap_m"], csv(T, GAP)), {}),
    "trailing commas": (lines(["time_s,gap_m,,"], [f"{row},," for row in csv(T, GAP)]), {}),
    "a sep line and semicolons": (lines(["sep=;", "time_s;gap_m"], map(comma, csv(T, GAP, sign=";"))), {}),
    "decimal commas in quotes": (
        lines(['"time_s","gap_m"'], [comma(f'"{t:.9g}"; "{y:.9g}"').replace(";", ",")
                                     for t, y in zip(T, GAP, strict=True)]), {}),
    "tabs and a comment line": (lines(["% exported", "t\ty"], csv(T, CENTRE, sign="\t")), CENTRES),
    "names after # and an empty column": (
        lines(["#\tt\tx\ty"], [f"{t:.9g}\t\t1\t{y:.9g}" for t, y in zip(T, CENTRE, strict=True)]), CENTRES),
    "spaces, names after #": (lines(["# i t y"], csv(range(FRAMES), T, CENTRE, sign="   ")), CENTRES),
    "names with units in brackets, apart": (
        lines(["# t (ms)  y (cm)"], csv(1e3 * T, 1e2 * CENTRE, sign=" ")),
        {"time": "t(ms)", "position": "y(cm)", "point": "centre"}),
    "units in the row below": (
        lines(["t;y", "ms;mm"], map(comma, csv(1e3 * T, 1e3 * GAP, sign=";"))), {"time": "t", "position": "y"}),
    "units in the names": (
        lines(["Experiment 4", "", "time [ms],y [mm]"], csv(1e3 * T, 1e3 * GAP)),
        {"time": "time [ms]", "position": "y [mm]"}),
    "D exponents": (lines(["t y"], [f"{t:.9E} {y:.9E}".replace("E", "D") for t, y in zip(T, GAP, strict=True)]),
                    METRES),
    "typographic minus": (
        lines(["t,y"], [row.replace("-", "−") for row in csv(T - 0.1, GAP - 0.01)]),
        {**METRES, "wall": -0.01}),
    "no names": (lines([], csv(T, GAP, sign=" ")), {"time": "1", "position": "2", "time_unit": "s", "unit": "m"}),
    "diameters and fall times": (
        lines(["t_star,gap_over_d"], csv(T / math.sqrt(D / 9.81), GAP / D)),
        {"time": "t_star", "position": "gap_over_d", "time_unit": "sqrt(d/g)", "unit": "d"}),
    "cells and steps": (
        lines(["step gap"], csv(np.arange(FRAMES), GAP / 0.3e-3, sign=" ")),
        {"time": "step", "position": "gap", "time_unit": "4 ms", "unit": "0.3mm"}),
    "settings before the names": (
        lines(["camera;A", "fps;250", "", "t;y"], csv(T, CENTRE, sign=";")), CENTRES),
    "names and units in comments": (
        lines(["# d 4.0", "# nu 5.0", "# t, y", "# [ms] [m]"], csv(1e3 * T, CENTRE, sign=" ")),
        {"time": "t", "position": "y", "point": "centre"}),
    "bars": (lines(["t|y"], csv(T, GAP, sign="|")), METRES),
    "distance fallen": (lines(["time_s,gap_m"], csv(T, GAP[0] - GAP)), {"direction": "down", "wall": "rest"}),
    "TrackMate": (trackmate(), IMAGE),
    "TrackMate, calibrated": (
        lines(["TRACK_ID,POSITION_X,POSITION_Y,POSITION_T,FRAME", "T,X,Y,T,Frame", ",(micron),(micron),(sec),"],
              [f"0,3,{1e6 * y:.6f},{t:.9g},{i}" for i, (t, y) in enumerate(zip(T, 0.03 - CENTRE, strict=True))]),
        {"wall": 30000.0}),
    "TrackMate, its model": (trackmate_model(), {"pixel": "0.05 mm", "wall": ROW}),
    "TrackMate, its model, calibrated": (
        trackmate_model("micron", 1e6, 0.03 - CENTRE), {"wall": 30000.0}),
    "TrackMate, tracks exported": (trackmate_tracks(), {"pixel": "0.05 mm", "wall": ROW}),
    "Kinovea, its analysis": (kinovea_analysis(True), {"point": "centre"}),
    "Kinovea, its analysis in pixels": (
        kinovea_analysis(False), {"pixel": "0.05 mm", "wall": ROW, "point": "centre"}),
    "trackpy": (trackpy(), {**IMAGE, "particle": 0}),
    "DeepLabCut": (deeplabcut(), {**IMAGE, "particle": "ball", "point": "centre"}),
    "DeepLabCut, several animals": (
        lines(["scorer" + ",D" * 6, "individuals,a,a,a,b,b,b", "bodyparts" + ",ball" * 6,
               "coords,x,y,likelihood,x,y,likelihood"],
              [f"{i},1.0,{y:.6f},0.99,,," for i, y in enumerate(PIXELS)]),
        {**IMAGE, "particle": "a/ball", "point": "centre"}),
    "Tracker": (lines(["mass_A", "t\tx\ty"], csv(T, 0 * T, 1e3 * CENTRE, sign="\t")),
                {"unit": "mm", "point": "centre"}),
    "Tracker, two tracks": (tracker_two(), {"unit": "m", "point": "centre", "particle": "mass_A"}),
    "Kinovea": (
        lines(['"Time";"Ball 1/0/X";"Ball 1/0/Y"'],
              [comma(f'"{1e3 * t:.6f}";"1.5";"{1e2 * y:.7f}"') for t, y in zip(T, CENTRE, strict=True)]),
        {"unit": "cm", "point": "centre"}),
    "Kinovea, text": (kinovea_text(), {**KINOVEA, "time_unit": "s", "particle": "ball"}),
    "Kinovea, clock": (kinovea_clock(), {**KINOVEA, "time_unit": "0.4s"}),
    "LAMMPS": (lammps(), {"position": "z", "time_unit": "1e-5 s", "unit": "m", "particle": 1}),
    "TrackMate, calibrated, with columns of counts": (
        lines(["TRACK_ID,QUALITY,POSITION_X,POSITION_Y,POSITION_T,FRAME,MEAN_INTENSITY_CH1",
               "Track ID,Quality,X,Y,T,Frame,Mean", ",(quality),(mm),(mm),(sec),,(counts)"],
              [f"0,7,3,{1e3 * (0.03 - y):.6f},{i / RATE:.9g},{i},99" for i, y in enumerate(CENTRE)]),
        {"wall": 30.0}),
    "Tracker, a name of two words": (
        lines(["mass A;;", "t;x;y"], map(comma, csv(T, 0 * T, CENTRE, sign=";"))),
        {"unit": "m", "point": "centre"}),
    "Tracker, several tracks": (
        lines(["#multi:", ",mass A,,,mass B,,,", "t,x,y,step,x,y,step,"],
              [f"{i / RATE:.9g},0.1,{y:.9g},{i},0.2,-0.004,{i}," for i, y in enumerate(CENTRE)]),
        {"unit": "m", "point": "centre", "particle": "mass A"}),
    "Kinovea, by its own names": (
        lines(['"Time (ms)","Trajectory 1/X","Trajectory 1/Y"'], csv(1e3 * T, 0 * T, 1e2 * CENTRE)),
        {"unit": "cm", "point": "centre"}),
    "ImageJ": (
        lines([" \tArea\tX\tY\tSlice"],
              [f"{i + 1}\t2827\t256.1\t{y:.6f}\t{i}" for i, y in enumerate(PIXELS)]), {**IMAGE, "unit": "px"}),
    "ImageJ, centres of mass": (
        lines([" ,Label,Area,XM,YM,Slice"], [f"{i + 1},a.tif,28,256.1,{y:.6f},{i}" for i, y in enumerate(PIXELS)]),
        {**IMAGE, "unit": "px"}),
    "Fiji's Manual Tracking": (
        lines([" \tTrack n°\tSlice n°\tX\tY\tDistance\tVelocity\tPixel Value"],
              [f"{i + 1}\t1\t{i}\t256\t{y:.6f}\t-1\t-1\t120" for i, y in enumerate(PIXELS)]).encode("cp1252"),
        {**IMAGE, "point": "centre"}),
    "MTrackJ": (
        lines(["MTrackJ 1.5.1 Data File", "Assembly 1 FF0000", "Cluster 1 FF0000", "Track 1 FF0000 true"],
              [*[f"Point {i + 1} 256.0 {y:.6f} 1.0 {i}.0 1.0" for i, y in enumerate(PIXELS)],
               "Track 2 FF0000 true", "Point 1 5.0 5.0 1.0 0.0 1.0", "End of MTrackJ Data File"]),
        {**IMAGE, "point": "centre", "particle": 1}),
    "MTrackJ, points": (
        lines(["Nr\tTID\tPID\tx [pixel]\ty [pixel]\tt [sec]\tI [val]\tv [pixel/sec]"],
              [f"{i}\t1\t{i}\t256.0\t{y:.6f}\t{i / RATE:.9g}\t120\tNA" for i, y in enumerate(PIXELS)]),
        {"pixel": "0.05 mm", "wall": ROW, "point": "centre"}),
    "SLEAP": (
        lines(["track,frame_idx,instance.score,ball.x,ball.y,ball.score"],
              [f"track_0,{i},0.95,256.0,{y:.6f},0.97" for i, y in enumerate(PIXELS)]),
        {**IMAGE, "point": "centre"}),
    "DLTdv": (
        lines(["pt1_cam1_X,pt1_cam1_Y,pt2_cam1_X,pt2_cam1_Y"], [f"256,{y:.6f},NaN,NaN" for y in PIXELS]),
        {**IMAGE, "point": "centre", "direction": "down", "particle": "pt1_cam1"}),
    "idtracker.ai": (
        lines(["seconds,x1,y1,x2,y2"], [f"{t:.9g},256,{y:.6f},3,3" for t, y in zip(T, PIXELS, strict=True)]),
        {"pixel": "0.05 mm", "wall": ROW, "particle": "1"}),
    "Logger Pro": (
        lines(['"Data Set: Time(s)","Data Set: X(m)","Data Set: Y(m)"'], csv(T, 0 * T, CENTRE)),
        {"point": "centre"}),
    "Logger Pro, text": (
        lines(["Vernier Format 2", "drop.cmbl 3/12/2024 10:11:12 .", "Data Set", "Time\tX\tY", "T\tX\tY",
               "s\tm\tm", ""], csv(T, 0 * T, CENTRE, sign="\t")), {"point": "centre"}),
    "LAMMPS, a log": (
        lines(["LAMMPS (2 Aug 2023)", "run 100", "   Step          Time          v_z"],
              [*csv(range(FRAMES), T, CENTRE, sign="   "), "Loop time of 0.1 on 1 procs for 100 steps"]),
        {"position": "v_z", "time_unit": "s", "unit": "m"}),
    "OpenFOAM, a log": (
        lines(["Build  : v2312"],
              [f"Time = {t:.9g}\n\nPIMPLE: iteration 1\n    Centre of mass: (0 0 {y + 1:.9g})\n"
               f"PIMPLE: iteration 2\n    Centre of mass: (0 0 {y:.9g})\nExecutionTime = 3 s  ClockTime = 4 s\n"
               for t, y in zip(T, CENTRE, strict=True)]),
        {"position": "centreOfMass_z", "unit": "m", "point": "centre"}),
    "OpenFOAM, a probe": (
        lines(["# Probe 0 (0 0 0)", "#  Probe    0", "#  Time"],
              [f"{t:.9g}   (0 0 {y:.9g})" for t, y in zip(T, CENTRE, strict=True)]),
        {"position": "4", "unit": "m", "point": "centre"}),
    "OpenFOAM": (openfoam(), {"position": "position_z", "unit": "m", "point": "centre"}),
}  # fmt: skip


def read(tmp_path, content, **settings):
    path = tmp_path / "track.txt"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_track(read_foreign(path, settings.get("decimal")), Settings(**settings), CONDITIONS)


@pytest.mark.parametrize("kind", FILES)
def test_the_same_flight_comes_out_of_every_file(tmp_path, kind):
    content, settings = FILES[kind]
    table = read(tmp_path, content, **settings).table
    shift = 0.1 if kind == "typographic minus" else 0.0
    np.testing.assert_allclose(table["time_s"] + shift, T, atol=2e-6)
    np.testing.assert_allclose(table["gap_m"], GAP, atol=2e-8)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_encodings_of_spreadsheets(tmp_path, encoding):
    content = lines(["time (ms)\theight (µm)"], csv(1e3 * T, 1e6 * GAP, sign="\t")).encode(encoding)
    table = read(tmp_path, content, time="time (ms)", position="height (µm)").table
    np.testing.assert_allclose(table["gap_m"], GAP, atol=1e-10)


@pytest.mark.parametrize("empty", ["", "NaN", "nan", "N/A", "-"])
def test_lost_frames_are_left_out_with_one_note(tmp_path, empty):
    rows = csv(T, GAP)
    for i in (10, 11, 12, 30):
        rows[i] = f"{T[i]:.9g},{empty}"
    found = read(tmp_path, lines(["time_s,gap_m"], rows))
    assert len(found.table) == FRAMES - 4
    [note] = found.notes
    assert "4 frames" in note
    assert "12 to 14" in note  # lines of the file


def test_empty_rows_are_lost_frames_within_the_record_and_nothing_after_it(tmp_path):
    rows = csv(T, CENTRE, sign=";")
    rows[7] = ";"
    found = read(tmp_path, lines(["t;y"], [*rows, ";", ";"]), **CENTRES)
    assert len(found.table) == FRAMES - 1
    assert "row 9" in found.notes[0]


def test_a_title_is_not_the_mark_of_a_program(tmp_path):
    content = lines(["Experiment 4, oil", "t;x;y"], csv(T, T, CENTRE, sign=";"))
    assert read(tmp_path, content, **CENTRES).reading.count("Tracker") == 0


def test_unlikely_positions_of_a_pose_tracker_count_as_lost(tmp_path):
    content = deeplabcut().replace("0.999", "0.2", 3)
    assert len(read(tmp_path, content, **IMAGE, particle="ball", point="centre").table) == FRAMES - 3


def test_velocities_counted_towards_the_wall(tmp_path):
    v = np.gradient(GAP, T)
    content = lines(["t,v"], csv(1e3 * T, -1e3 * v))
    table = read(tmp_path, content, time="t", velocity="v", time_unit="ms", unit="mm/s", direction="down").table
    np.testing.assert_allclose(table["velocity_m_s"], v, atol=1e-8)


REFUSED = {
    "thousands with points": (lines(["t;y"], ["0;1.234,5", "1;1.233,5", "2;1.232,5", "3;1.231,5"]), "thousands"),
    "thousands with commas": (lines(["t;y"], ['0;"1,234.5"', "1;1.5", "2;1.4", "3;1.3"]), "thousands"),
    "thousands with spaces": (lines(["t;y"], ["0;1 234,5", "1;1 233,5", "2;1 232,5", "3;1 231,5"]), "thousands"),
    "a comma that may be for thousands": (lines(["t;y"], ["0;1,234", "1;1,233", "2;1,232", "3;1,231"]), "decimal"),
    "commas and points": (lines(["t;y"], ["0.5;1,2", "1.5;1,1", "2.5;1,0", "3.5;0,9"]), "thousands"),
    "decimal commas between commas": (lines(["t,y"], ["0,0,1,5", "0,1,1,4", "0,2,1,3"]), "decimal sign"),
    "a spreadsheet": (b"PK\x03\x04 and so on", "CSV"),
    "nothing": (b"\n \n", "empty"),
}  # fmt: skip


@pytest.mark.parametrize("kind", REFUSED)
def test_numbers_that_are_not_clear_are_refused_by_name(tmp_path, kind):
    content, said = REFUSED[kind]
    with pytest.raises(InputError, match=said) as error:
        read(tmp_path, content, **METRES)
    assert len(error.value.defects) == 1


def test_the_decimal_sign_may_be_stated(tmp_path):
    content = lines(["t;y"], ["0;1,234", "1;1,233", "2;1,232", "3;1,231"])
    assert read(tmp_path, content, **METRES, decimal=",").table["gap_m"][0] == pytest.approx(1.234)


@pytest.mark.parametrize(
    ("content", "settings", "asked"),
    [
        (trackmate(), {}, ("TrackMate", "--fps", "--pixel", "--wall")),
        (trackpy(), {"particle": 0}, ("trackpy", "--fps", "--pixel", "--wall")),
        (deeplabcut(), {"particle": "ball"}, ("DeepLabCut", "--fps", "--pixel", "--wall")),
        (lines(["mass_A", "t\tx\ty"], csv(T, T, T, sign="\t")), {}, ("Tracker", "--unit", "--point")),
        (lines(["t,y"], csv(T, GAP)), {"time": "t", "position": "y"}, ("--unit", "--time-unit")),
        (lines(["t,z"], csv(T, GAP)), {}, ("time_s=t", "gap_m=z", "--unit", "--time-unit", "--point")),
        (lines([], csv(T, GAP)), {}, ("time_s=1", "gap_m=2")),
        (trackpy(), {}, ("--particle", "0 (90 rows)", "1 (90 rows)", "trackpy", "--fps", "--pixel", "--wall")),
        (deeplabcut(), {}, ("--particle", "ball", "DeepLabCut", "--fps", "--pixel", "--wall", "--point")),
        (lines([" ,Track n°,Slice n°,X,Y"], csv(T, T, T, T, T)), {}, ("time_s='Slice n°'", "gap_m=Y")),
        (tracker_two(), {}, ("--particle", "mass_A", "mass_B")),
        (lammps(), {"particle": 7}, ("--particle", "1 (90 rows)", "2 (90 rows)")),
    ],
)
def test_one_line_asks_for_all_that_is_not_known(tmp_path, content, settings, asked):
    with pytest.raises(InputError) as error:
        read(tmp_path, content, **settings)
    [defect] = error.value.defects
    assert [word for word in asked if word not in str(defect)] == []


def test_how_it_was_read_is_said_in_one_line(tmp_path):
    reading = read(tmp_path, trackmate(), **IMAGE).reading
    said = ("TrackMate", "FRAME", "250", "POSITION_Y", "0.05 mm", "700", "centre")
    assert [word for word in said if word not in reading] == []
    assert read(tmp_path, lines(["time_s,gap_m"], csv(T, GAP))).reading == ""


@pytest.mark.parametrize(
    ("settings", "named"),
    [
        ({"unit": "parsec"}, "--unit"),
        ({"unit": "ms"}, "--unit"),
        ({"time_unit": "0.5"}, "--time-unit"),
        ({"unit": "px", "pixel": "3"}, "--pixel"),
    ],
)
def test_units_that_are_none(tmp_path, settings, named):
    with pytest.raises(InputError, match=named):
        read(tmp_path, lines(["t,y"], csv(T, GAP)), **METRES | settings)


@pytest.mark.parametrize(
    ("content", "options"),
    [
        (
            lines(["frame,cx,cy"], csv(range(FRAMES), 0 * T, PIXELS)),
            ["frame", "cy", "--fps", "--wall", "--direction"],
        ),
        (lines(["Zeit [ms];Höhe [mm]"], csv(1e3 * T, 1e3 * GAP, sign=";")), ["Zeit [ms]", "Höhe [mm]"]),
        (lines(["step id x y z"], [f"{i} 1 0.5 0.25 {y:.9g}" for i, y in enumerate(CENTRE)]), ["step", "z"]),
        (lines(["a,b"], csv(T, GAP)), ["a", "b"]),
    ],
)
def test_columns_are_guessed_in_the_line_that_asks_for_them(tmp_path, content, options):
    """What moves, under whatever name; a unit that the header states is not asked for."""
    with pytest.raises(InputError) as refused:
        read(tmp_path, content)
    (defect,) = refused.value.defects
    assert all(option in defect.rule for option in options)
    assert ("--unit" in defect.rule) == ("[mm]" not in content)


def test_a_unit_against_that_of_the_file_is_said(tmp_path):
    content = lines(["t [ms],y [mm]"], csv(1e3 * T, 1e3 * GAP))
    found = read(tmp_path, content, time="t [ms]", position="y [mm]", time_unit="s", unit="mm")
    (note,) = found.notes
    assert "--time-unit" in note
    assert "ms" in note


BOMB = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 12))


@pytest.mark.parametrize(
    ("text", "named"),
    [
        (f'<?xml version="1.0"?><!DOCTYPE t [<!ENTITY a0 "a">{BOMB}]><Tracks>&a11;</Tracks>', "document type"),
        ("<Tracks>" + "<particle>" * 10**6, "nested"),
        (trackmate_tracks()[:2000], "whole XML"),
        ("<svg><path d='M0 0'/></svg>", "svg"),
        (trackmate_tracks().replace("<detection", "<spot"), "without a point"),
        ('<?xml version="1.0" encoding="no-such"?><Tracks></Tracks>', "without a point"),
    ],
    ids=["entities", "deep", "cut", "another", "empty", "encoding"],
)
def test_other_xml_is_refused(tmp_path, text, named):
    path = tmp_path / "tracks.xml"
    path.write_text(text)
    with pytest.raises(InputError, match=named):
        read_foreign(path)


@pytest.mark.parametrize(
    ("page", "time", "height"),
    [
        ("cp1251", "Время", "Высота"), ("cp1253", "χρόνος", "ύψος"), ("gb18030", "时间", "高度"),
        ("cp1250", "čas", "výška"), ("cp1252", "temps", "hauteur à côté"), ("cp1250", "czas", "wysokość"),
        ("cp932", "時間", "高さ"), ("utf-16", "Время", "Высота"), ("cp1254", "süre", "yükseklik ğ"),
        ("utf-16-le", "Время", "Höhe"), ("utf-16-be", "Время", "Höhe"),
    ],
)  # fmt: skip
def test_columns_are_named_in_any_script(tmp_path, page, time, height):
    path = tmp_path / "track.csv"
    rows = [comma(row) for row in csv(T, 1e3 * GAP, sign=";")]
    path.write_bytes("\n".join([f"{time} (s);{height} (mm)", *rows]).encode(page))
    settings = Settings(time=time, position=height, point="lowest")
    np.testing.assert_allclose(read_track(read_foreign(path), settings, None).table.gap_m, GAP, atol=1e-11)
