"""Times that are not those of the camera: a player's clock, times of day, rows without any time."""

import numpy as np
import pytest

from restitution.errors import InputError
from restitution.foreign import Settings, read_foreign, read_track

GAPS = [5.0, 4.0, 2.5, 3.5, 4.5, 5.0]
STATED = {"position": "y (mm)", "point": "lowest"}


def track(tmp_path, text, **stated):
    path = tmp_path / "track.csv"
    path.write_text(text)
    return read_track(read_foreign(path), Settings(**STATED | stated), None)


def written(times):
    return "t (s);y (mm)\n" + "".join(f"{t};{y}\n" for t, y in zip(times, GAPS, strict=True))


def test_frames_a_second_against_the_clock_of_a_player(tmp_path):
    """Thirty frames a second played of a thousand filmed: one of the player's seconds was 0.03 s."""
    played = written([f"{n / 30:.6f}" for n in range(6)])
    with pytest.raises(InputError) as refused:
        track(tmp_path, played, time="t (s)", frames_per_second=1000.0)
    assert "--time-unit 0.03s" in str(refused.value)
    times = track(tmp_path, played, time="t (s)", time_unit="0.03s", frames_per_second=1000.0).table.time_s
    np.testing.assert_allclose(times, np.arange(6) / 1000, atol=2e-5)


def test_frames_a_second_as_the_file_has_them(tmp_path):
    filmed = written([0, 0.002, 0.004, 0.006, 0.010, 0.012])  # one frame lost
    assert len(track(tmp_path, filmed, time="t (s)", frames_per_second=500.0).table) == 6


def test_a_pixel_of_no_use_is_said(tmp_path):
    notes = track(tmp_path, written(range(6)), time="t (s)", pixel="0.1 mm").notes
    assert any("--pixel is not used" in note for note in notes)


@pytest.mark.parametrize("day", ["", "2026-11-03T", "2026-11-03 "])
def test_times_of_day(tmp_path, day):
    times = ["15:59.000", "15:59.250", "15:59.500", "15:59.750", "16:00.000", "16:00.250"]
    text = "t;y (mm)\n" + "".join(f"{day}10:{t};{y}\n" for t, y in zip(times, GAPS, strict=True))
    found = track(tmp_path, text, time="t").table.time_s
    np.testing.assert_allclose(found - found[0], 0.25 * np.arange(6), atol=1e-7)


def test_rows_as_frames_where_no_column_is_a_time(tmp_path):
    text = "y (mm);sure\n" + "".join(f"{y};1\n" for y in GAPS)
    found = track(tmp_path, text, time="row", time_unit="frame", frames_per_second=100.0).table
    np.testing.assert_allclose(found.time_s, np.arange(6) / 100)
    np.testing.assert_allclose(found.gap_m, np.array(GAPS) / 1e3)


def test_units_before_the_name_of_a_run(tmp_path):
    text = "Time (s) Run #1;Position (mm) Run #1\n" + "".join(f"{n};{y}\n" for n, y in enumerate(GAPS))
    found = track(tmp_path, text, time="Time (s) Run #1", position="Position (mm) Run #1").table
    np.testing.assert_allclose(found.gap_m, np.array(GAPS) / 1e3)


def test_tracks_side_by_side_named_in_a_comment(tmp_path):
    text = "#multi:;mass_A;;mass_B;\n#t;x;y;x;y\n" + "".join(f"{n};0;{y};0;{2 * y}\n" for n, y in enumerate(GAPS))
    stated = {"position": "y", "time": "t", "time_unit": "s", "unit": "mm"}
    for name, factor in (("mass_A", 1e-3), ("mass_B", 2e-3)):
        found = track(tmp_path, text, particle=name, **stated).table
        np.testing.assert_allclose(found.gap_m, factor * np.array(GAPS))
