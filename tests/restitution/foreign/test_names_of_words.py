"""Names of several words, titles below them, and what a message guesses of them."""

import pytest

from restitution.errors import InputError
from restitution.foreign import Settings, read_foreign, read_track

ROWS = [(0.0, 5.0), (0.1, 4.0), (0.2, 2.5), (0.3, 3.5), (0.4, 4.5)]


def written(tmp_path, head, sign=" ", encoding="utf-8", rows=ROWS):
    path = tmp_path / "track.txt"
    path.write_text(head + "".join(sign.join(map(str, row)) + "\n" for row in rows), encoding=encoding)
    return path


@pytest.mark.parametrize(
    ("head", "names"),
    [
        ("t, s y, mm\n", ["t, s", "y, mm"]),
        ("Time (s)   Gap of the ball (mm)\n", ["Time (s)", "Gap of the ball (mm)"]),
        ("Time (s) Gap of the ball (mm)\n", ["Time (s)", "Gap of the ball (mm)"]),
        ("elapsed time [s]\tgap below [mm]\n", ["elapsed time [s]", "gap below [mm]"]),
        ("% Model: a.mph\n% Time (s)       Position, z component (mm)\n",
         ["Time (s)", "Position, z component (mm)"]),
    ],
)  # fmt: skip
def test_names_with_spaces_above_columns_that_spaces_separate(tmp_path, head, names):
    table = read_foreign(written(tmp_path, head))
    assert (table.header, list(table.units.values())) == (names, ["s", "mm"])


def test_names_of_fewer_words_than_there_are_columns_are_refused(tmp_path):
    with pytest.raises(InputError, match="names"):
        read_foreign(written(tmp_path, "time position\n", rows=[(*row, 1.0, 2.0) for row in ROWS]))


def test_a_title_below_the_names(tmp_path):
    rows = [(n, 1.0, y) for n, (_, y) in enumerate(ROWS)]
    table = read_foreign(written(tmp_path, "Frame\tX1\tY1\nTracks 1 to 1\n", "\t", rows=rows))
    assert (table.header, len(table.rows)) == (["Frame", "X1", "Y1"], len(ROWS))


def test_a_frame_in_which_nothing_was_found(tmp_path):
    path = tmp_path / "track.txt"
    path.write_text("".join("null\n" if n == 2 else f"400.1 {y}\n" for n, (_, y) in enumerate(4 * ROWS)))
    stated = {"time": "row", "position": "2", "time_unit": "frame", "unit": "mm", "point": "lowest"}
    found = read_track(read_foreign(path), Settings(**stated, frames_per_second=10.0), None)
    assert found.table.time_s.round(9).tolist()[:4] == [0.0, 0.1, 0.3, 0.4]
    assert len(found.notes) == 1


@pytest.mark.parametrize(
    ("head", "guess"),
    [
        ("Trial time;X center;Y center;Velocity", ("Trial time", "Y center")),
        ("Image;Time from Trigger;P1 X;P1 Y", ("Time from Trigger", "P1 Y")),
        ("Frame;Time[sec];Point1-X[mm];Point1-Y[mm]", ("Time[sec]", "Point1-Y[mm]")),
        ("n;Time;Points:0;Points:2", ("Time", "Points:2")),
    ],
)
def test_the_columns_that_a_message_guesses(tmp_path, head, guess):
    from restitution.foreign.asking import what_is_needed

    rows = [(n, t, 1.0, y) for n, (t, y) in enumerate(ROWS)]
    if head.startswith("Trial"):
        rows = [(t, 1.0, y, abs(y)) for t, y in ROWS]  # a speed has no sign, and is no velocity
    rule = what_is_needed(read_foreign(written(tmp_path, head + "\n", ";", rows=rows))).rule
    assert all(name in rule.partition("position:")[2].partition(" (or")[0] for name in guess)


def test_words_of_central_europe_tell_the_code_page(tmp_path):
    path = written(tmp_path, "Czas [s];Wysokość [mm]\n", ";", "cp1250")
    assert read_foreign(path).header == ["Czas [s]", "Wysokość [mm]"]


def test_remarks_below_names_and_units(tmp_path):
    """Origin's export: long names, units, comments."""
    table = read_foreign(written(tmp_path, "Time\tHeight\ns\tmm\n\tRun 7\n", "\t"))
    assert (table.header, table.units) == (["Time", "Height"], {"Time": "s", "Height": "mm"})


def test_seconds_written_beside_each_number(tmp_path):
    """MATLAB's table of times: "0.1 sec"."""
    table = read_foreign(written(tmp_path, "Time,height\n", ",", rows=[(f"{t} sec", y) for t, y in ROWS]))
    assert (table.units, [cells[0] for _, cells in table.rows]) == ({"Time": "s"}, [f"{t}" for t, _ in ROWS])
