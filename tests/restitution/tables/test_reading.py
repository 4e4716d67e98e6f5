import csv
import io
import math
import subprocess
import sys

import numpy as np
import pytest

from restitution import datasets
from restitution.errors import InputError
from restitution.tables import check_table, read_table

TRACK = "time_s,gap_m\n0,0.003\n0.001,0.002\n0.002,0.001\n0.003,0.0005\n"


@pytest.fixture
def trajectory():
    return datasets.schema("trajectory")


@pytest.fixture
def write(tmp_path):
    def _write(content):
        path = tmp_path / "track.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return _write


def rows(*cells):
    """TRACK with the rows after the first replaced."""
    return "time_s,gap_m\n0,0.003\n" + "".join(f"{c}\n" for c in cells)


LATIN_1 = rows("0.001,1", "0.002,5 µm", "0.003,1").encode("latin-1")
NUL = b"\xef\xbb\xbf" + TRACK.encode().replace(b"0.0005", b"0.\0")


@pytest.mark.parametrize(
    ("content", "row", "field", "value", "rule"),
    [
        (rows("0.001,abc", "0.002,1", "0.003,1"), 3, "gap_m", "abc", "not a number"),
        (rows("0.001,NaN", "0.002,1", "0.003,1"), 3, "gap_m", "NaN", "finite"),
        (rows("0.001,-inf", "0.002,1", "0.003,1"), 3, "gap_m", "-inf", "finite"),
        (rows("0.001,1e999", "0.002,1", "0.003,1"), 3, "gap_m", "1e999", "finite"),
        (rows("0.001,1_0", "0.002,1", "0.003,1"), 3, "gap_m", "1_0", "not a number"),
        (rows("0.001,", "0.002,1", "0.003,1"), 3, "gap_m", "", "empty"),
        (rows('0.001,"0,5"', "0.002,1", "0.003,1"), 3, "gap_m", "0,5", "write 0.5"),
        (rows("0,001,0,5", "0.002,1", "0.003,1"), 3, None, None, "decimal sign a comma"),
        (rows("0.001,1", "0.002", "0.003,1"), 4, None, None, "1 values where the header names 2"),
        (rows("0.001,1", "", "0.002,1", "0.003,1"), 4, None, None, "empty line"),
        (rows("-0.001,1", "0.002,1", "0.003,1"), 3, "time_s", "-0.001", "greater than in row 2"),
        (rows("0.002,1", "0.001,1", "0.003,1"), 4, "time_s", "0.001", "greater than in row 3"),
        (rows("0.001,1", "0.001,2", "0.003,1"), 4, "time_s", "0.001", "repeats the value of row 3"),
        (rows("0.001,1"), None, None, None, "2 rows below the header"),
        ("time_s,gap_m\n", None, None, None, "0 rows below the header"),
        ("", None, None, None, "is empty"),
        ("\ufeff\n\n", None, None, None, "is empty"),
        ("\n" + TRACK, 1, None, None, "first line must name the columns"),
        ("0,1\n1,2\n2,3\n3,4\n", 1, None, None, "no header"),
        (TRACK.replace("gap_m", "gap_m,gap_m").replace("5\n", "5,1\n"), 1, "gap_m", None, "more than once"),
        (TRACK.replace(",", ";"), 1, None, None, "semicolons"),
        (TRACK.replace(",", "\t"), 1, None, None, "tabs"),
        (LATIN_1, 4, None, None, f"byte {LATIN_1.index(0xB5)} of the file is 0xb5"),
        (NUL, 5, None, None, f"NUL byte (byte {NUL.index(0)}"),
        (TRACK.encode("utf-16"), 1, None, None, "UTF-16"),
        (b"PK\x03\x04" + bytes(200) + b"\n\xe6\n\0\n", None, None, None, "spreadsheet"),
        (TRACK + '0.004,"0.1\n', 6, None, None, "not CSV from here on"),
    ],
)
def test_every_defect_is_named_by_row_column_value_and_rule(write, trajectory, content, row, field, value, rule):
    path = write(content)
    defects = check_table(path, trajectory)
    first = defects[0]
    assert (first.file, first.row, first.field, first.value) == (str(path), row, field, value)
    assert rule in first.rule
    with pytest.raises(InputError) as error:
        read_table(path, trajectory)
    assert error.value.defects == tuple(defects)


@pytest.mark.parametrize("name", ["missing.csv", "."])
def test_a_file_that_cannot_be_read(tmp_path, trajectory, name):
    (defect,) = check_table(tmp_path / name, trajectory)
    assert "does not exist" in defect.rule or "folder" in defect.rule


def test_all_defects_come_in_the_order_of_the_file(write, trajectory):
    path = write("gap_m,time,time_s\n1,0,x\n2,nan,0.1\n3,0,0.1\nq,0,inf\n5,0\n")
    found = [(d.row, d.field, d.value) for d in check_table(path, trajectory)]
    assert found == [
        (1, "time", None),
        (2, "time_s", "x"),
        (4, "time_s", "0.1"),
        (5, "gap_m", "q"),
        (5, "time_s", "inf"),
        (6, None, None),
    ]


@pytest.mark.parametrize(
    "content",
    [
        TRACK,
        "\ufeff" + TRACK,
        TRACK.replace("\n", "\r\n"),
        TRACK.replace("\n", "\r"),
        TRACK + "\n\r\n  \n",
        TRACK.rstrip("\n"),
        TRACK.replace(",", " , "),
        '"time_s","gap_m"\n"0","3e-3"\n"1E-3",2e-3\n+0.002,.001\n0.003,"0.0005"\n',
        "gap_m,time_s\n0.003,0\n0.002,0.001\n0.001,0.002\n0.0005,0.003\n",
    ],
)
def test_harmless_forms_give_the_same_table(write, trajectory, content):
    table = read_table(write(content), trajectory)
    assert list(table.columns) == ["time_s", "gap_m"]
    np.testing.assert_array_equal(table, [[0, 0.003], [0.001, 0.002], [0.002, 0.001], [0.003, 0.0005]])


def test_mapped_columns_are_scaled_and_others_ignored(write, trajectory):
    path = write("t,y,note,note\n0,3,a,b\n0.001,2,,\n0.002,1,,\n0.003,0.5,,\n")
    mapped = {"time_s": "t", "gap_m": "y"}
    table = read_table(path, trajectory, mapped, {"gap_m": 1e-3})
    np.testing.assert_allclose(table.gap_m, [0.003, 0.002, 0.001, 0.0005], rtol=1e-15)
    assert {d.field for d in check_table(path, trajectory)} == {"time_s", "gap_m", "t", "y", "note"}
    assert [d.field for d in check_table(path, trajectory, {"gap_m": "z", "time_s": "t"})] == ["z"]
    assert [d.field for d in check_table(path, trajectory, {**mapped, "mass": "y"})] == ["mass"]


REBOUND = {
    "record": "r",
    "impact": "1",
    "kind": "measured",
    "outcome": "rebound",
    "speed_definition": "far",
    "stokes_convention": "st",
    "stokes": "152",
    "e_dry": "0.97",
    "e_eff": "0.79",
}


@pytest.mark.parametrize(
    ("change", "field", "rule"),
    [
        ({"e_eff": ""}, "e_eff", "outcome is rebound"),
        ({"outcome": "not_resolved"}, "e_eff_upper", "outcome is not_resolved"),
        ({"impact": "0"}, "impact", "at least 1"),
        ({"impact": "1.5"}, "impact", "whole number"),
        ({"stokes": "0"}, "stokes", "greater than 0"),
        ({"e_dry": "1.01"}, "e_dry", "at most 1"),
        ({"kind": "guessed"}, "kind", "'measured' or 'simulated'"),
        ({"stokes_convention": ""}, "stokes_convention", "empty"),
    ],
)
def test_rules_of_the_impact_table(write, change, field, rule):
    schema = datasets.schema("impact")
    out = io.StringIO()
    writer = csv.DictWriter(out, [*REBOUND, "e_eff_upper"], lineterminator="\n")
    writer.writeheader()
    writer.writerow(REBOUND)
    writer.writerow(REBOUND | {"impact": "2"} | change)
    (defect,) = check_table(write(out.getvalue()), schema)
    assert (defect.row, defect.field) == (3, field)
    assert rule in defect.rule


def test_a_published_cloud_needs_no_speeds(write):
    content = f"{','.join(REBOUND)}\n{','.join(REBOUND.values())}\n"
    schema = datasets.schema("impact")
    table = read_table(write(content), schema)
    assert tuple(table.columns) == schema.columns
    assert table.impact.dtype == "int64"
    assert table.stokes[0] == 152
    assert math.isnan(table.impact_speed_m_s[0])
    (defect,) = check_table(write(content + ",".join(REBOUND.values())), schema)
    assert defect.row == 3
    assert "repeats row 2" in defect.rule


def test_a_misspelt_rule_is_not_ignored(tmp_path):
    path = tmp_path / "schema.json"
    path.write_text('{"name": "x", "title": "x", "fields": [{"name": "a", "type": "number", "description": "",'
                    ' "constraints": {"minimun": 0}}]}')  # fmt: skip
    from restitution.tables import read_schema

    with pytest.raises(InputError, match="minimun"):
        read_schema(path)


def test_pandas_is_imported_only_to_hold_a_table():
    code = "import sys, restitution.tables; sys.exit('pandas' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
