"""One track in JSON as programs nest it: the same rows come out of every form; what is not clear is refused."""

import json

import pandas as pd
import pytest

from restitution.errors import InputError
from restitution.foreign import read_foreign

TIMES, HEIGHTS = [0.0, 0.002, 0.004, 0.006, 0.008, 0.010], [5.0, 4.25, 2.5, 3.125, 3.0, 2.0]
ROWS = list(zip(TIMES, HEIGHTS, strict=True))
RECORDS = [{"t": t, "y": y} for t, y in ROWS]
OTHER = [{"t": t, "y": -y} for t, y in ROWS]
COLUMNS = {"t": TIMES, "y": HEIGHTS}


def read(tmp_path, content):
    text = content if isinstance(content, str) else json.dumps(content)
    (tmp_path / "track.json").write_text(text)
    return read_foreign(tmp_path / "track.json")


def values(table, *names):
    k = [table.header.index(name) for name in names]
    return [tuple(float(cells[i]) for i in k) for _, cells in table.rows]


ALONE = {
    "lists": COLUMNS | {"fps": 500, "sizes": [1, 2]},
    "records": RECORDS,
    "records below settings": {"camera": {"fps": 500, "size": [640, 480]}, "frames": RECORDS},
    "lists below settings": {"meta": {"fps": 500}, "data": COLUMNS},
    "deep lists": {"a": {"b": {"c": COLUMNS}}},
    "one track": {"tracks": [{"id": 3, "points": RECORDS}]},
    "lines": "\n".join(map(json.dumps, RECORDS)) + "\n",
    "vectors": [{"t": t, "y": y, "box": [1, 2, 3, 4]} for t, y in ROWS],
}
PANDAS = ["split", "records", "index", "columns", "table"]


@pytest.mark.parametrize("name", ALONE)
def test_a_track_alone(tmp_path, name):
    assert values(read(tmp_path, ALONE[name]), "t", "y") == ROWS


@pytest.mark.parametrize("orient", PANDAS)
def test_forms_of_pandas(tmp_path, orient):
    table = read(tmp_path, pd.DataFrame(COLUMNS).to_json(orient=orient))
    assert values(table, "t", "y") == ROWS


@pytest.mark.parametrize("orient", ["split", "index", "columns", "table"])
def test_times_in_the_index_of_pandas(tmp_path, orient):
    table = read(tmp_path, pd.DataFrame(COLUMNS).set_index("t").to_json(orient=orient))
    assert values(table, "t" if orient == "table" else "index", "y") == ROWS


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ([{"t": t, "pos": {"x": 1.0, "y": y}, "box": [[0, 0], [1, 1]]} for t, y in ROWS], "pos.y"),
        ([{"t": t, "pos": [1.0, y]} for t, y in ROWS], "pos_y"),
        ({"t": TIMES, "pos": {"x": HEIGHTS, "y": HEIGHTS}}, "pos.y"),
        ({"t": TIMES, "pos": [[1.0, y] for y in HEIGHTS]}, "pos_y"),
    ],
)
def test_objects_and_vectors_are_columns(tmp_path, content, name):
    assert values(read(tmp_path, content), "t", name) == ROWS


@pytest.mark.parametrize(
    ("content", "first"),
    [
        ({"tracks": [{"id": 7, "points": RECORDS}, {"id": 8, "points": OTHER}]}, "7"),
        ({"tracks": [{"colour": "red", "points": RECORDS}, {"colour": "blue", "points": OTHER}]}, "1"),
        ({"tracks": [{"id": 7, **COLUMNS}, {"id": 8, "t": TIMES, "y": TIMES}]}, "7"),
        ({"ball": RECORDS, "marker": OTHER}, "ball"),
        ({"fps": 500, "tracks": {"ball": COLUMNS, "marker": {"t": TIMES, "y": TIMES}}}, "ball"),
        ([{"t": t, "objects": [{"id": 7, "y": y}, {"id": 8, "y": -y}]} for t, y in ROWS], "7"),
    ],
)  # fmt: skip
def test_several_tracks_are_asked_for(tmp_path, content, first):
    table = read(tmp_path, content)
    assert len(table.particles()) == 2
    assert values(table.of_particle(first), "t", "y") == ROWS


def test_a_frame_without_a_position_is_a_lost_one(tmp_path):
    records = [{"t": t, "pos": {"y": y} if t != 0.004 else None} for t, y in ROWS]
    table = read(tmp_path, records)
    assert table.header == ["t", "pos.y"]
    assert [cells[1] == "" for _, cells in table.rows] == [False, False, True, False, False, False]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ({"a": {"b": 1}}, "JSON, no table"),
        ([], "JSON, no table"),
        ({"t": TIMES}, "JSON, no table"),
        ({"fall": COLUMNS, "rise": {"time": TIMES, "z": HEIGHTS}}, "several: fall .6 rows., rise"),
        ({"frames": RECORDS, "lights": [{"a": 1, "b": 2}] * 6}, "several: frames .6 rows., lights"),
        ('{"t": [1, 2', "not JSON"),
    ],
)
def test_what_is_no_clear_table_is_one_line(tmp_path, content, why):
    with pytest.raises(InputError, match=why) as refused:
        read(tmp_path, content)
    assert len(refused.value.defects) == 1


def test_depth_and_width_end(tmp_path):
    deep = RECORDS
    for _ in range(60):
        deep = {"a": deep, "b": deep} if _ < 12 else {"a": deep}
    for content in (deep, [{f"c{k}": k for k in range(5000)}] * 3):
        with pytest.raises(InputError):
            read(tmp_path, content)
