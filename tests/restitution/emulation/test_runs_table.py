"""A table of runs: what it may be, and each thing that can be wrong with it in one line."""

import pytest

from restitution.emulation import read_runs
from restitution.errors import InputError

TRACK = "time_s,gap_m\n0,1\n"
GOOD = ["a,1,1e5,gondret2002_st152,t.csv", "b,2,1e5,gondret2002_st152,t.csv", "c,3,2e5,gondret2002_st152,t.csv"]


def table(folder, lines, header="run,film.cut_off_d,film.tension,record,track"):
    (folder / "t.csv").write_text(TRACK)
    (folder / "runs.csv").write_text("\n".join([header, *lines]) + "\n")
    return folder / "runs.csv"


def wrong(folder, lines, **how):
    with pytest.raises(InputError) as error:
        read_runs(table(folder, lines, **how))
    return error.value.defects


def test_parameters_are_what_is_no_column_of_its_own(tmp_path):
    (runs,) = read_runs(table(tmp_path, GOOD))
    assert runs.parameters == ("film.cut_off_d", "film.tension")
    assert runs.records == ("gondret2002_st152",)
    assert [run.values for run in runs.runs] == [(1.0, 1e5), (2.0, 1e5), (3.0, 2e5)]


def test_the_folder_of_a_sweep_is_its_table(tmp_path):
    table(tmp_path, GOOD)
    assert read_runs(tmp_path)[0].parameters == ("film.cut_off_d", "film.tension")


def test_runs_are_grouped_by_cells_and_by_words(tmp_path):
    header = "run,numerics.cells_per_diameter,film.form,x,record,track"
    lines = [f"{k},{cells},{form},{k},gondret2002_st152,t.csv" for k, (cells, form) in
             enumerate([(10, "a"), (10, "a"), (16, "a"), (16, "a"), (16, "b"), (16, "b")])]  # fmt: skip
    groups = read_runs(table(tmp_path, lines, header=header))
    assert [dict(g.group) for g in groups] == [
        {"numerics.cells_per_diameter": c, "film.form": f} for c, f in (("10", "a"), ("16", "a"), ("16", "b"))
    ]
    assert all(g.parameters == ("x",) for g in groups)


def test_runs_that_failed_take_no_part(tmp_path):
    header = "run,state,x,record,track"
    lines = [
        "a,finished,1,gondret2002_st152,t.csv",
        "b,diverged,,gondret2002_st152,",
        "c,,2,gondret2002_st152,t.csv",
    ]
    (runs,) = read_runs(table(tmp_path, lines, header=header))
    assert [run.name for run in runs.runs] == ["a", "c"]
    assert "1 of 3" in runs.notes[0]


def test_a_parameter_that_is_constant_is_doubted_and_left_out(tmp_path):
    lines = [line.replace("2e5", "1e5") for line in GOOD]
    (runs,) = read_runs(table(tmp_path, lines))
    assert runs.parameters == ("film.cut_off_d",)
    assert [doubt.name for doubt in runs.doubts] == ["constant"]


@pytest.mark.parametrize(
    ("line", "field", "row"),
    [
        ("d,nan,1e5,gondret2002_st152,t.csv", "film.cut_off_d", 5),
        ("d,inf,1e5,gondret2002_st152,t.csv", "film.cut_off_d", 5),
        ("d,thin,1e5,gondret2002_st152,t.csv", "film.cut_off_d", 5),
        ("d,,1e5,gondret2002_st152,t.csv", "film.cut_off_d", 5),
        ("d,4,1e5,gondret2002_st152,", "track", 5),
        ("d,4,1e5,gondret2002_st152,none.csv", "track", 5),
        ("d,4,1e5,gondret,t.csv", "record", 5),
        ("a,4,1e5,gondret2002_st152,t.csv", "run", 5),
        (",4,1e5,gondret2002_st152,t.csv", "run", 5),
        ("d,2,1e5,gondret2002_st152,t.csv", "run", 5),
    ],
    ids=[
        "nan",
        "inf",
        "text",
        "empty",
        "no track",
        "track not there",
        "record",
        "name twice",
        "no name",
        "repeated",
    ],
)
def test_each_cause_is_one_defect_at_its_place(tmp_path, line, field, row):
    defects = wrong(tmp_path, [*GOOD, line])
    assert [(d.field, d.row) for d in defects] == [(field, row)]


def test_columns_that_are_needed_are_named(tmp_path):
    assert {d.field for d in wrong(tmp_path, ["1,2"], header="x,y")} == {"run", "track", "record"}
    assert "varies nothing" in str(wrong(tmp_path, [line.replace(",2,", ",1,") for line in GOOD[:1]])[0])
