"""Tables in which everything is wrong, or that have no end: said in few lines, with little memory."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from restitution.emulation.runs_table import _levels
from restitution.errors import Defect, InputError, first_of, of_rows
from restitution.tables.widths import LONGEST_LINE, MOST_COLUMNS, check_widths

ROWS = 100_000
IMPACTS = "source,speed_definition,stokes_convention,stokes,stokes_sigma,e_dry,e_eff,e_eff_sigma\n"
CONDITIONS = "[fluid]\ndensity = 935\nviscosity = 0.01\n[sphere]\ndiameter = 3e-3\ndensity = 7800\ne_dry = 0.97\n"
MEASURED = """
import re, sys
from pathlib import Path
from restitution.cli import main
status = main(sys.argv[1:])
# Not getrusage: that counts the process that this one was forked from.
print(status, int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1]) / 1024)
"""


def rows(head, line, count=ROWS):
    return head + "".join(line.format(k, k / 500) for k in range(count))


TRACK = ("impacts", "a.csv", "--conditions", "a.toml")
FLOODS = {
    "no numbers": (TRACK, rows("time_s,gap_m\n", "{1},bad{0}\n"), "99999 more rows, the last 100001"),
    "times that go back": (TRACK, rows("time_s,gap_m\n", "-{0},0.1\n"), "99998 more rows, the last 100001"),
    "columns": (TRACK, ",".join(f"c{k}" for k in range(200_000)) + "\n", "a.csv:1: is a line of"),
    "impacts": (
        # 1e5 of them take 330 MB.
        ("data", "validate", "a.csv"),
        rows(IMPACTS, "a,far,st,{0}1,x{0},0.97,b{0},-1\n", 50_000),
        "49999 more rows",
    ),
}  # fmt: skip


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="tells the memory of a process on Linux only")
@pytest.mark.parametrize("flood", FLOODS)
def test_a_flood_is_refused_in_few_lines_and_under_300_mb(flood, tmp_path):
    command, content, said = FLOODS[flood]
    (tmp_path / "a.csv").write_text(content)
    (tmp_path / "a.toml").write_text(CONDITIONS)
    program = [sys.executable, "-c", MEASURED, *command]
    done = subprocess.run(program, cwd=tmp_path, capture_output=True, text=True, check=True)
    lines = done.stderr.splitlines()
    assert 0 < len(lines) <= 8
    assert max(map(len, lines)) < 700
    assert said in done.stderr
    status, megabytes = map(float, done.stdout.split())
    assert status == 2
    assert megabytes < 300


@given(st.lists(st.integers(2, 10**6), min_size=1, max_size=400, unique=True).map(sorted))
def test_of_many_rows_none_is_lost_and_one_line_is_said(numbers):
    defects = list(of_rows(lambda i: f"is {numbers[i]}", numbers, lambda i: f"cell {i}", file="f", field="x"))
    assert [row for d in defects for row in (d.row, *d.others)] == numbers
    (line,) = first_of(defects)
    assert (line.row, line.value, len(line.others)) == (numbers[0], "cell 0", len(numbers) - 1)
    assert ("more row" in str(line)) == (len(numbers) > 1)


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " "])
def test_a_table_is_as_wide_as_its_widest_line(separator):
    good = separator.join("1" * MOST_COLUMNS)
    check_widths(["a", good, "#" * LONGEST_LINE], "f")
    for line in (separator.join("1" * (MOST_COLUMNS + 1)), "x" * (LONGEST_LINE + 1)):
        with pytest.raises(InputError) as refused:
            check_widths(["a", "b", line], "f")
        assert refused.value.defects[0] == Defect(refused.value.defects[0].rule, file="f", row=3)


@given(st.lists(st.sampled_from([0.0, 1.0, 1.0 + 1e-12, -2.5, -2.5 - 1e-12, 1e9, 3.0]), min_size=1))
def test_values_are_alike_where_their_difference_is_rounding(values):
    levels = _levels(np.array(values))
    for a, x in zip(levels, values, strict=True):
        for b, y in zip(levels, values, strict=True):
            assert (a == b) == bool(np.isclose(x, y, rtol=1e-9, atol=0))
