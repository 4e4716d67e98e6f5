"""Files for plots and of instruments: Tecplot, Fluent, LabVIEW; a file a frame of OpenPTV; tracks of Icy."""

import pytest

from restitution.errors import InputError
from restitution.foreign import Settings, read_foreign, read_track

HEIGHTS = [5.0, 4.0, 2.5, 3.5, 4.5]
TIMES = [0.0, 0.002, 0.004, 0.006, 0.008]


def written(tmp_path, text, name="track.dat"):
    (tmp_path / name).write_text(text)
    return read_foreign(tmp_path / name)


def seen(table, particle=None, **stated):
    one = read_track(table, Settings(point="lowest", particle=particle, **stated), None).table
    return one.time_s.round(9).tolist(), (1e3 * one.gap_m).round(9).tolist()


def test_zones_of_tecplot_are_steps_of_time(tmp_path):
    text = 'TITLE = "B00001"\nVARIABLES = "x [mm]", "y [mm]"\n'
    for t, y in zip(TIMES, HEIGHTS, strict=True):
        text += f'ZONE T="Frame", I=1, F=POINT\nSTRANDID=1, SOLUTIONTIME={t}\n 10.1 {y}\n'
    assert seen(written(tmp_path, text), position="y [mm]") == (TIMES, HEIGHTS)


def test_variables_of_tecplot_one_a_line(tmp_path):
    text = 'VARIABLES = "t (s)"\n"y (mm)"\nZONE I=5\n'
    text += "".join(f"{t} {y}\n" for t, y in zip(TIMES, HEIGHTS, strict=True))
    assert seen(written(tmp_path, text), time="t (s)", position="y (mm)") == (TIMES, HEIGHTS)


def test_curves_of_a_plot_of_fluent(tmp_path):
    text = '(title "y")\n(labels "Flow Time (s)" "y (mm)")\n'
    for name, factor in (("ball", 1), ("wall", 0)):
        rows = "".join(f"{t}\t{factor * y}\n" for t, y in zip(TIMES, HEIGHTS, strict=True))
        text += f'\n((xy/key/label "{name}")\n{rows})\n'
    table = written(tmp_path, text)
    assert table.particles() == {"ball": 5, "wall": 5}
    assert seen(table, "ball", time="Flow Time (s)", position="y (mm)") == (TIMES, HEIGHTS)


def test_sets_of_grace(tmp_path):
    text = '# Grace project file\n@version 50122\n@    xaxis  label "t (s)"\n@    yaxis  label "y (mm)"\n'
    for factor in (1, 0.5):
        text += "@type xy\n" + "".join(f"{t} {factor * y}\n" for t, y in zip(TIMES, HEIGHTS, strict=True)) + "&\n"
    table = written(tmp_path, text)
    assert table.particles() == {"1": 5, "2": 5}
    assert seen(table, "1", time="t (s)", position="y (mm)") == (TIMES, HEIGHTS)


@pytest.mark.parametrize("with_times", [True, False])
def test_a_measurement_of_labview(tmp_path, with_times):
    text = "LabVIEW Measurement\t\nSeparator\tTab\nTime_Pref\tRelative\n***End_of_Header***\t\n\t\n"
    text += "Channels\t2\t\t\nY_Unit_Label\tmm\tV\t\nX_Dimension\tTime\tTime\t\nX0\t0.0\t0.0\t\n"
    text += "Delta_X\t0.002\t0.002\t\n***End_of_Header***\t\t\t\nX_Value\tHeight\tTrigger\tComment\n"
    for t, y in zip(TIMES, HEIGHTS, strict=True):
        text += f"{t if with_times else ''}\t{y}\t0.01\n"
    assert seen(written(tmp_path, text), position="Height") == (TIMES, HEIGHTS)


def test_a_file_a_frame_of_openptv(tmp_path):
    """The ball is the second row in every other frame, where something else was seen above it."""
    for n, y in enumerate(HEIGHTS):
        before, after = n - 1 if n == 0 else int(n % 2 == 0), -2
        ball = f"{before} {after} 10.0 {y} 3.0\n"
        rows = [f"-1 -2 40.0 {n}.5 1.0\n", ball] if n % 2 else [ball]
        (tmp_path / f"ptv_is.{10001 + n}").write_text(f"{len(rows)}\n" + "".join(rows))
    table = read_foreign(tmp_path / "ptv_is.10001")
    assert read_foreign(tmp_path).rows == table.rows  # the folder of all frames
    assert list(table.particles().values()) == [5, 1, 1]
    found = seen(table, "1", position="y", frames_per_second=500.0)
    assert found == (pytest.approx([10001 / 500 + t for t in TIMES]), HEIGHTS)


def test_a_row_of_openptv_that_is_cut(tmp_path):
    (tmp_path / "ptv_is.1").write_text("1\n-1 -2 1.0\n")
    with pytest.raises(InputError, match="previous next x y z"):
        read_foreign(tmp_path / "ptv_is.1")


def test_tracks_of_icy(tmp_path):
    spots = "".join(f'<detection t="{n}" x="1" y="{100 - 10 * y}" z="0"/>' for n, y in enumerate(HEIGHTS))
    text = f'<root><trackfile version="1"/><trackgroup><track id="7">{spots}</track></trackgroup></root>'
    table = written(tmp_path, text, "icy.xml")
    assert seen(table, frames_per_second=500.0, pixel="0.1 mm", wall=100.0) == (TIMES, HEIGHTS)


def test_a_measurement_of_labview_that_states_no_step(tmp_path):
    text = "LabVIEW Measurement\t\n***End_of_Header***\t\nChannels\t1\n***End_of_Header***\t\n"
    text += "X_Value\tHeight\n\t5.0\n"
    with pytest.raises(InputError, match="X0"):
        written(tmp_path, text)
