"""Files of users, whatever is in them: what they say, or one short defect that names the file."""

import json
import os
import threading
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from restitution.errors import MOST_LINES, Defect, InputError, first_of, printable
from restitution.inputs import read_bytes, read_json, read_toml
from restitution.units import UnitError, number

SAME_FOLDER = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**20), 10**20) | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)  # fmt: skip
KEYWORDS = [
    b"[",
    b"{",
    b'"',
    b"=",
    b".",
    b"1e999",
    b"nan",
    b"a",
    b"\xff",
    b"\0",
    b"9" * 400,
    b"\n",
    b",",
    b":",
    b"}",
]


@SAME_FOLDER
@given(JSON)
def test_json_says_what_was_written(tmp_path, content):
    path = tmp_path / "a.json"
    path.write_text(json.dumps(content))
    assert read_json(path) == content


@SAME_FOLDER
@given(st.binary() | st.lists(st.sampled_from(KEYWORDS)).map(b"".join))
@pytest.mark.parametrize("read", [read_json, read_toml])
def test_any_bytes_are_read_or_refused_in_one_line(read, tmp_path, content):
    path = tmp_path / "a.txt"
    path.write_bytes(content)
    said = ""
    try:
        read(path)
    except InputError as error:
        said = str(error)
    assert len(said.splitlines()) <= 1
    assert not said or said.startswith(str(path))
    assert len(said) < 1000


HOSTILE = {
    "nested": "[" * 100_000,
    "closed": "[" * 100_000 + "]" * 100_000,
    "objects": '{"a":' * 50_000,
    "integer": '{"a": ' + "9" * 5000 + "}",
    "overflow": '{"a": 1e999}',
    "nan": '{"a": NaN}',
    "twice": '{"a": 1, "a": 2}',
    "dotted": "a." * 30_000 + "a = 1",
    "brackets": "a = " + "[" * 1900,
    "hexadecimal": "a = 0x" + "f" * 60_000,
    "many dotted": "\n".join(f"{chr(97 + k)}{'.a' * 900} = 1" for k in range(20)) + "\na = [",
}


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("read", [read_json, read_toml])
def test_what_would_exhaust_a_parser_is_refused_at_once(read, name, tmp_path):
    path = tmp_path / "a.txt"
    path.write_text(HOSTILE[name])
    began = time.process_time()
    with pytest.raises(InputError) as refused:
        read(path)
    assert time.process_time() - began < 10  # and not the minutes that the parser would take
    assert len(str(refused.value)) < 1000


@pytest.mark.parametrize("what", ["/dev/zero", "folder", "missing", "x" * 300, "a\0b", "large"])
def test_what_is_no_file_is_refused_at_once(what, tmp_path):
    (tmp_path / "folder").mkdir()
    with (tmp_path / "large").open("wb") as stream:
        stream.truncate(2**40)  # takes no room on the disk
    with pytest.raises(InputError) as refused:
        read_bytes(tmp_path / what)
    assert len(str(refused.value).splitlines()) == 1


def test_a_pipe_may_be_asked_twice(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    writer = threading.Thread(target=(tmp_path / "pipe").write_bytes, args=(b"1,2\n",))
    writer.start()
    assert [read_bytes(tmp_path / "pipe") for _ in range(2)] == [b"1,2\n"] * 2
    writer.join()


@given(st.text())
def test_what_is_printed_is_one_line_without_control_characters(text):
    shown = str(Defect(text, file=text, row=3, field=text, value=text))
    assert shown.isprintable()
    assert len(shown) < 1200
    assert printable(text, keep="\n").replace("\n", "").isprintable()


@given(st.lists(st.builds(Defect, st.text(), field=st.text()), max_size=60))
def test_no_flood_of_defects(defects):
    lines = first_of(defects)
    assert len(lines) <= MOST_LINES
    if defects:
        assert lines[0].field == defects[0].field


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_what_it_was_written_as(value):
    assert number(repr(value)) == value


@pytest.mark.parametrize(
    "text", ["1_0", "１０", "٣", "nan", "inf", "-inf", "1e999", "9" * 400, "", "0x1", "1,5", "1 2"]
)
def test_one_parser_says_what_a_number_is(text):
    with pytest.raises(UnitError):
        number(text)


@pytest.mark.parametrize(
    ("text", "line"),
    [("a = 1\nb == 2\nc = 3\n", "b == 2"), ("a = 1\n[part\n", "[part"), ("a = 1\na = 2\nb = 3\n", "a = 2")],
)
def test_the_line_that_is_not_toml_is_shown(tmp_path, text, line):
    path = tmp_path / "a.toml"
    path.write_text(text)
    with pytest.raises(InputError) as found:
        read_toml(path)
    assert f": {line}" in str(found.value)


def test_a_name_that_is_empty_is_not_the_folder_one_is_in():
    with pytest.raises(InputError, match="name is empty"):
        read_bytes("")
