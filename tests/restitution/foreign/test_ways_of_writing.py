"""One track as other programs print it: names of rows, vectors in cells, settings above, an index of times."""

from time import perf_counter

import numpy as np
import pandas as pd
import pytest

from restitution.errors import InputError
from restitution.foreign import read_foreign
from restitution.foreign.asking import what_is_needed
from restitution.foreign.layout import layout_of, vectors_apart
from restitution.foreign.number_text import seconds

TIMES = [0.001 * n for n in range(8)]
HEIGHTS = [5.0, 4.25, 2.5, 3.125, 3.0, 2.0, 1.0, 2.5]
ROWS = list(zip(TIMES, HEIGHTS, strict=True))


def text(*head, row):
    return "\n".join([*head, *(row(n, t, y) for n, (t, y) in enumerate(ROWS))]) + "\n"


def printed():
    return pd.DataFrame({"t": TIMES, "y": HEIGHTS}).to_string()


WAYS = {
    "R's write.table": (text('"t" "y"', row=lambda n, t, y: f'"{n + 1}" {t:.3f} {y}'), "t", "y"),
    "R's write.table, tabs": (text('"t"\t"y"', row=lambda n, t, y: f'"run{n + 1}"\t{t:.3f}\t{y}'), "t", "y"),
    "R's write.csv": (text('"","t","y"', row=lambda n, t, y: f'"{n + 1}",{t:.3f},{y}'), "t", "y"),
    "a frame that pandas prints": (printed(), "t", "y"),
    "tuples": (text("t,center,r", row=lambda n, t, y: f'{t:.3f},"({n}, {y})",30'), "t", "center_y"),
    "tuples of NumPy 2": (
        text("t,center", row=lambda n, t, y: f'{t:.3f},"(np.float64({n}.5), np.float64({y}))"'), "t", "center_y",
    ),
    "arrays of NumPy": (text("t,pos,r", row=lambda n, t, y: f"{t:.3f},[ {n}.  0.5 {y} ],30"), "t", "pos_z"),
    "Markdown": (text("| t (s) | y |", "|:---|---:|", row=lambda n, t, y: f"| {t:.3f} | {y} |"), "t (s)", "y"),
    "a report": (text("t       y", "-----  ----", row=lambda n, t, y: f"{t:.3f}  {y}"), "t", "y"),
    "settings above, no names": (
        text("NO_OF_FRAMES\t8", "FREQUENCY\t1000", "MARKER_NAMES\tball", row=lambda n, t, y: f"{t:.3f}\t5.0\t{y}"),
        "1", "3",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WAYS)
def test_columns_are_found(tmp_path, name):
    content, time, value = WAYS[name]
    (tmp_path / "track.txt").write_text(content)
    table = read_foreign(tmp_path / "track.txt")
    at = [table.header.index(time), table.header.index(value)]
    found = np.array([[float(cells[k]) for k in at] for _, cells in table.rows])
    np.testing.assert_allclose(found, ROWS, atol=1e-12)


@pytest.mark.parametrize(
    "stamp",
    [
        "2024-05-07 23:59:{:09.6f}",
        "07-May-2024 23:59:{:09.6f}",
        "5/7/2024 11:59:{:09.6f} PM",
        "07.05.2024 23:59:{:09.6f}",
        "23:59:{:09.6f}",
    ],
)
def test_dates_and_times_as_countries_and_programs_write_them(tmp_path, stamp):
    (tmp_path / "track.csv").write_text(text("Time,y", row=lambda n, t, y: f"{stamp.format(2 + t)},{y}"))
    table = read_foreign(tmp_path / "track.csv")
    assert table.units["Time"] == "s"
    times = [float(cells[0]) for _, cells in table.rows]
    np.testing.assert_allclose(np.subtract(times, times[0]), TIMES, atol=2e-6)


@pytest.mark.parametrize(
    ("day", "next_day"),
    [
        ("2024-05-31 23:59:59.5", "2024-06-01 00:00:00.5"),
        ("07-May-2024 23:59:59.5", "08-May-2024 00:00:00.5"),
        ("5/7/2024 11:59:59.5 PM", "5/8/2024 12:00:00.5 AM"),
        ("7.5.2024 23:59:59.5", "8.5.2024 00:00:00.5"),
    ],
)
def test_midnight_is_a_second_like_others(day, next_day):
    assert float(seconds(next_day)) - float(seconds(day)) == pytest.approx(1.0)


def test_a_single_column_is_the_value_that_is_asked_about(tmp_path):
    (tmp_path / "laser.txt").write_text("Distance [mm]\n" + "".join(f"{y}\n" for y in HEIGHTS))
    asked = what_is_needed(read_foreign(tmp_path / "laser.txt")).rule
    assert "gap_m='Distance [mm]'" in asked
    assert "time_s=row" in asked


def test_lines_that_nearly_are_rules_take_no_time():
    begin = perf_counter()
    layout_of(["t,y", "-" * 100000 + "x,1", *(f"{t},{y}" for t, y in ROWS)], "a file")
    vectors_apart(["t", "p"], [(2, ["0", "(" + " " * 100000])])
    assert perf_counter() - begin < 5


def test_a_lost_vector_is_lost_in_all_its_columns(tmp_path):
    lines = ["t,center", '0.0,"(1, 2)"', "0.1,", '0.2,"(1, 3)"', '0.3,"(2, 3)"', "0.4,None", '0.5,"(2, 4)"']
    (tmp_path / "track.csv").write_text("\n".join(lines))
    table = read_foreign(tmp_path / "track.csv")
    assert [cells[1] for _, cells in table.rows] == ["1", "", "1", "2", "", "2"]


@pytest.mark.parametrize("head", ["t y", "frame,t", "gap_m,time_s"])
def test_a_name_that_is_missing_is_not_guessed(tmp_path, head):
    """Nothing tells whose name is missing, the first or the last one's."""
    separator = "," if "," in head else " "
    content = text(head, row=lambda n, t, y: separator.join([f"{n}", f"{t:.3f}", f"{y}"]))
    (tmp_path / "track.txt").write_text(content)
    with pytest.raises(InputError, match="names 2 columns"):
        read_foreign(tmp_path / "track.txt")


def test_units_in_whole_words_and_capitals(tmp_path):
    (tmp_path / "track.csv").write_text(text("Time (Seconds),Y [Millimeters]", row=lambda n, t, y: f"{t:.3f},{y}"))
    units = read_foreign(tmp_path / "track.csv").units
    assert {name: unit.lower() for name, unit in units.items()} == {
        "Time (Seconds)": "seconds",
        "Y [Millimeters]": "millimeters",
    }


@pytest.mark.parametrize(
    ("begin", "what"),
    [
        (b"PAR1\x15\x04", "Parquet"),
        (b"ARROW1\0\0", "Feather"),
        (b"\x80\x05\x95", "pickle"),
        (b"RIFF\0\0\0\0AVI ", "film"),
        (b"\0\0\0\x20ftypisom", "film"),
        (b"\x89PNG\r\n", "picture"),
        (b"1.0,2.0\n\0\0", "binary"),
    ],
)
def test_what_is_no_text_is_told_what_it_is(tmp_path, begin, what):
    (tmp_path / "track").write_bytes(begin + bytes(range(256)))
    with pytest.raises(InputError, match=what) as refused:
        read_foreign(tmp_path / "track")
    assert len(refused.value.defects) == 1
