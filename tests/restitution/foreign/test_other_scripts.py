"""Headers of spreadsheets in other scripts: their units, and the code pages that they are in."""

import numpy as np
import pytest

from restitution.errors import InputError
from restitution.foreign import Settings, read_foreign, read_track

FRAMES = [(0.0, 5.0), (0.1, 4.0), (0.2, 2.5), (0.3, 3.5), (0.4, 4.5)]
"""Seconds and millimetres."""
HEADERS = {
    "Russian": ("время, с;высота, мм", 1, 1, "utf-8"),
    "Russian of Windows": ("t (с);y (мм)", 1, 1, "cp1251"),
    "smaller units": ("Время (мс);Зазор (см)", 1e3, 0.1, "utf-16"),
    "microns": ("время (с);зазор (мкм)", 1, 1e3, "cp1251"),
    "units below": ("t;y\nс;мм", 1, 1, "utf-8"),
    "units below of Windows": ("t;y\n(с);(мм)", 1, 1, "cp1251"),
    "Greek": ("χρόνος (s);ύψος (μm)", 1, 1e3, "utf-8"),
    "Greek of Windows": ("χρόνος (s);ύψος (μm)", 1, 1e3, "cp1253"),
    "Chinese": ("时间/s;高度/mm", 1, 1, "utf-8"),
    "Chinese of Windows, full width": ("时间（s）;位移（mm）", 1, 1, "gb18030"),
    "Chinese units": ("时间 (秒);高度 (毫米)", 1, 1, "utf-8"),
    "Japanese of Windows": ("時間（秒）;高さ（㎜）", 1, 1, "cp932"),
}


def written(path, header, times, lengths, page):
    rows = "".join(f"{t * times:.4f};{y * lengths:.4f}\n" for t, y in FRAMES)
    path.write_bytes(f"{header}\n{rows}".encode(page))
    return read_foreign(path)


@pytest.mark.parametrize("kind", HEADERS)
def test_units_of_the_header_are_taken(tmp_path, kind):
    table = written(tmp_path / "track.csv", *HEADERS[kind])
    names = HEADERS[kind][0].splitlines()[0].split(";")
    assert table.header == names
    track = read_track(table, Settings(time=names[0], position=names[1], point="lowest"), None).table
    np.testing.assert_allclose(track[["time_s", "gap_m"]], np.array(FRAMES) * [1, 1e-3])


def test_speeds_in_metres_a_second(tmp_path):
    table = written(tmp_path / "track.csv", "t (с);υ (м/с)", 1, 1, "utf-8")
    track = read_track(table, Settings(time="t", velocity="υ"), None).table
    np.testing.assert_allclose(track[["time_s", "velocity_m_s"]], FRAMES)


@pytest.mark.parametrize(
    ("header", "asked"),
    [
        ("время, с;высота, мм", "--column time_s='время, с' --column gap_m='высота, мм'"),
        ("кадр;высота, мм", "--time-unit frame --fps N"),
        ("t (с);υ (м/с)", "--column velocity_m_s='υ (м/с)'"),
        ("время;высота", "--unit m or what it is in"),
    ],
)
def test_what_is_open_is_asked_for_with_the_names_of_the_file(tmp_path, header, asked):
    table = written(tmp_path / "track.csv", header, 1, 1, "utf-8")
    with pytest.raises(InputError) as refused:
        read_track(table, Settings(), None)
    assert asked in str(refused.value)
