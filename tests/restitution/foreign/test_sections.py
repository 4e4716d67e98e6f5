"""Several tables one below another in one file: each is a track of its own."""

import numpy as np
import pytest

from restitution.errors import InputError
from restitution.foreign import Settings, read_foreign, read_track

A = [(0.0, 5.0), (0.1, 4.0), (0.2, 2.5), (0.3, 3.5), (0.4, 4.5)]
B = [(0.0, 9.0), (0.1, 7.5), (0.2, 6.0), (0.3, 5.0)]


def rows(frames, sign=","):
    return "".join(f"{t}{sign}{y}\n" for t, y in frames)


SEVERAL = {
    "one curve on each line": ("x,ball 1\n" + rows(A) + "\nx,ball 2\n" + rows(B), ["ball 1", "ball 2"]),
    "for gnuplot": ("#x\tc1\n" + rows(A, "\t") + "\n\n#x\tc2\n" + rows(B, "\t"), ["c1", "c2"]),
    "without empty lines": ("x;c1\n" + rows(A, ";") + "x;c2\n" + rows(B, ";"), ["c1", "c2"]),
    "joined": ("time_s,gap_m\n" + rows(A) + "time_s,gap_m\n" + rows(B), ["1", "2"]),
    "titles and units": (
        "ball A\nt y\ns m\n" + rows(A, " ") + "\nball B\nt y\ns m\n" + rows(B, " "),
        ["ball A", "ball B"],
    ),
    "titles in comments": ("t,y\n# ball A\n" + rows(A) + "# ball B\n" + rows(B), ["ball A", "ball B"]),
    "blocks": ("# t y\n" + rows(A, " ") + "\n\n" + rows(B, " "), ["1", "2"]),
    "no names": (rows(A) + "\n" + rows(B), ["1", "2"]),
}


@pytest.mark.parametrize("kind", SEVERAL)
def test_each_table_is_a_track_of_its_own(tmp_path, kind):
    text, names = SEVERAL[kind]
    path = tmp_path / "curves.txt"
    path.write_text(text)
    table = read_foreign(path)
    assert table.particles() == dict(zip(names, (len(A), len(B)), strict=True))
    for name, frames in zip(names, (A, B), strict=True):
        settings = Settings(time="1", position="2", particle=name, time_unit="s", unit="mm", point="lowest")
        track = read_track(table, settings, None).table
        np.testing.assert_allclose(track[["time_s", "gap_m"]], np.array(frames) * [1, 1e-3])


def test_without_a_choice_the_tables_are_named(tmp_path):
    path = tmp_path / "curves.csv"
    path.write_text(SEVERAL["one curve on each line"][0])
    stated = {"time": "x", "time_unit": "s", "unit": "mm", "point": "lowest"}
    with pytest.raises(InputError, match=r"ball 1 \(5 rows\), ball 2 \(4 rows\)"):
        read_track(read_foreign(path), Settings(position="2", **stated), None)
    by_column = read_track(read_foreign(path), Settings(position="ball 2", **stated), None)
    assert len(by_column.table) == len(B)


def test_rows_are_named_by_their_line_in_the_file(tmp_path):
    path = tmp_path / "curves.csv"
    path.write_text("time_s,gap_m\n0,5\n1,4\n\ntime_s,gap_m\n0,9\nx1,8\n2,7\n3,6\n")
    with pytest.raises(InputError) as refused:
        read_track(read_foreign(path), Settings(particle="2"), None)
    assert refused.value.defects[0].row == 7


ONE = {
    "names every so many rows": "time_s,gap_m\n" + rows(A[:2]) + "time_s,gap_m\n" + rows(A[2:]),
    "in comments": "# time_s gap_m\n" + rows(A[:2], " ") + "# time_s gap_m\n" + rows(A[2:], " "),
    "remarks": "time_s,gap_m\n" + rows(A[:2]) + "# light flickered\n\n# here again\n" + rows(A[2:]),
    "empty lines": "time_s,gap_m\n" + "\n\n".join(rows([frame]) for frame in A),
    "a remark as wide as the table": "time_s gap_m\n" + rows(A[:2], " ") + "# sphere hidden\n" + rows(A[2:], " "),
}


@pytest.mark.parametrize("kind", ONE)
def test_one_track_stays_one(tmp_path, kind):
    path = tmp_path / "track.csv"
    path.write_text(ONE[kind])
    np.testing.assert_allclose(read_track(read_foreign(path), Settings(), None).table[["time_s", "gap_m"]], A)


def test_words_amid_the_frames_are_a_defect_of_their_row(tmp_path):
    path = tmp_path / "track.csv"
    path.write_text("time_s,gap_m\n" + rows(A[:2]) + "lost,lost\n" + rows(A[2:]))
    with pytest.raises(InputError) as refused:
        read_track(read_foreign(path), Settings(), None)
    assert {defect.row for defect in refused.value.defects} == {4}
