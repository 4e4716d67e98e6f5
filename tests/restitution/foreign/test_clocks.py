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


@pytest.mark.parametrize("rate", [24, 25, 30000 / 1001, 30, 60])
def test_the_clock_of_a_player_is_taken_as_frames_where_those_of_the_camera_are_stated(tmp_path, rate):
    played = written([f"{n / rate:.6f}" for n in range(6)])
    found = track(tmp_path, played, time="t (s)", frames_per_second=1000.0)
    np.testing.assert_allclose(found.table.time_s, np.arange(6) / 1000, atol=1e-9)
    assert any("as a player does" in note for note in found.notes)
    own = track(tmp_path, played, time="t (s)").table.time_s  # a film of that rate: nothing is guessed
    np.testing.assert_allclose(own, np.arange(6) / rate, atol=2e-6)


def test_hundredths_of_a_player_s_second_and_lost_frames(tmp_path):
    kept = [0, 1, 2, 3, 5, 6]
    cut = [int(100 * n / 30) for n in kept]  # as a clock shows them
    text = "#Kinovea Trajectory data export\n#T X Y\n"
    text += "".join(f"0:00:00:{c:02d} 12.00 {y}\n" for c, y in zip(cut, GAPS, strict=True))
    found = track(
        tmp_path, text, position="Y", unit="mm", direction="up", wall=0.0, frames_per_second=2000.0
    ).table
    np.testing.assert_allclose(found.time_s, np.array(kept) / 2000)


def test_a_frame_counted_as_a_second(tmp_path):
    """TrackMate that was told no rate writes "sec" and one a frame; what it needs is asked for at once."""
    text = "TRACK_ID,POSITION_X,POSITION_Y,POSITION_T,FRAME\nTrack,X,Y,T,F\n,(pixel),(pixel),(sec),\n"
    text += "".join(f"0,1.0,{100 - 10 * y},{n}.0,{n}\n" for n, y in enumerate(GAPS))
    stated = {"position": None, "point": None, "pixel": "0.1 mm", "wall": 100.0}
    with pytest.raises(InputError) as refused:
        track(tmp_path, text, **stated)
    assert "--fps" in str(refused.value)
    found = track(tmp_path, text, **stated, frames_per_second=500.0).table
    np.testing.assert_allclose(found.time_s, np.arange(6) / 500)


def test_what_is_asked_for_names_the_frames_of_the_camera(tmp_path):
    """A film played slowly is told from no other by its times, so that the first question asks for it."""
    text = "mass A\t\t\nt\tx\ty\n" + "".join(f"{n / 30:.6f}\t0\t{y}\n" for n, y in enumerate(GAPS))
    with pytest.raises(InputError) as refused:
        track(tmp_path, text, position=None, point=None)
    assert all(option in str(refused.value) for option in ("--fps", "--unit", "--point"))


def test_frames_a_second_against_another_clock(tmp_path):
    """Forty a second is no player's: one of the two is wrong."""
    with pytest.raises(InputError) as refused:
        track(tmp_path, written([f"{n / 40:.6f}" for n in range(6)]), time="t (s)", frames_per_second=1000.0)
    assert "--time-unit 0.04s" in str(refused.value)


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
