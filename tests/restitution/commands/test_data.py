from pathlib import Path

import pytest

from restitution import datasets
from restitution.cli import main

TRACK = "t,y\n0,3\n0.001,2\n0.002,1\n0.003,0.5\n"


def test_list_names_every_table_on_one_line(capsys):
    assert main(["data", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()[1:]
    assert [line.split()[0] for line in lines] == datasets.names()
    assert max(map(len, lines)) <= 88
    row = next(line for line in lines if line.startswith("gondret2002_st152"))
    assert row.split()[1:5] == ["measured", "trajectory", "98", "152"]


@pytest.mark.parametrize(("rows", "printed"), [("3", 3), ("all", 21)])
def test_show_says_what_is_known_then_the_rows(capsys, rows, printed):
    assert main(["data", "show", "gondret2002_st27", "--rows", rows]) == 0
    about, _, table = capsys.readouterr().out.partition("\n\n")
    for fact in ("10.1063/1.1427920", "0.518 +- 0.005 m/s", "965 kg/m3", "not stated", "3 %"):
        assert fact in about
    lines = table.splitlines()
    assert lines[0].split() == ["time_s", "gap_m"]
    assert lines[1].split() == ["0.00063012", "0.0001578"]
    assert len([line for line in lines[1:] if "rows" not in line]) == printed


def test_the_shipped_package_is_valid(capsys):
    assert main(["data", "validate"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(datasets.names())


@pytest.mark.parametrize("name", ["gondret2002_st152", "tencate2002_e1_velocity", "goldman1967"])
def test_the_kind_of_table_is_told_by_its_header(capsys, name):
    path = datasets.folder() / datasets.resource(name).path
    assert main(["data", "validate", str(path)]) == 0
    assert f"valid {datasets.resource(name).table} table" in capsys.readouterr().out


def test_own_columns_in_millimetres(tmp_path, capsys):
    path = tmp_path / "track.csv"
    path.write_text(TRACK)
    mapped = ["--column", "time_s=t", "--column", "gap_m=y", "--unit", "mm"]
    assert main(["data", "validate", str(path), *mapped]) == 0
    assert "valid trajectory table" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("content", "options", "said"),
    [
        (TRACK, [], "name the kind or map its columns"),
        (TRACK, ["--schema", "trajectory"], "track.csv:1: gap_m: is missing"),
        (TRACK, ["--schema", "trajectories"], "did you mean trajectory"),
        (TRACK, ["--column", "time_s=t", "--column", "velocity_m_s=y", "--unit", "mm"], "has no gap_m"),
        (TRACK.replace(",", ";"), [], "semicolons"),
        ("time_s,gap_m\n0,1\n1,x\n2,1\n3,inf\n", [], "track.csv:3: gap_m = 'x': is not a number"),
        (None, [], "does not exist"),
    ],
)
def test_defects_are_lines_on_stderr_with_status_2(tmp_path, capsys, content, options, said):
    path = tmp_path / "track.csv"
    if content is not None:
        path.write_text(content)
    assert main(["data", "validate", str(path), *options]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert said in err
    assert all(line.startswith("error: ") for line in err.splitlines())


def test_a_flood_of_defects_is_cut_short(tmp_path, capsys):
    path = tmp_path / "track.csv"
    path.write_text("time_s,gap_m\n" + "".join(f"{i},0.1{',' * i}\n" for i in range(80, 0, -1)))
    assert main(["data", "validate", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) <= 51


def test_a_defect_of_every_row_is_one_line_with_the_first_row_and_how_many(tmp_path, capsys):
    path = tmp_path / "track.csv"
    path.write_text("time_s,gap_m\n" + "".join(f"{i},x\n" for i in range(80)))
    assert main(["data", "validate", str(path)]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert "track.csv:2: gap_m" in line
    assert "79 more rows, the last 81" in line


@pytest.mark.parametrize("option", [["--column", "gap_m"], ["--unit", "cm"]])
def test_misused_options(capsys, option):
    with pytest.raises(SystemExit) as stop:
        main(["data", "validate", "x.csv", *option])
    assert stop.value.code == 2
    capsys.readouterr()


def test_unknown_dataset(capsys):
    assert main(["data", "show", "gondret152"]) == 2
    assert "did you mean gondret2002_st152" in capsys.readouterr().err


def test_a_folder_without_a_package(tmp_path, capsys):
    assert main(["data", "validate", str(tmp_path)]) == 2
    assert "datapackage.json" in capsys.readouterr().err


FIELD_CASES = Path(__file__).parents[2] / "field_cases"


@pytest.mark.parametrize(
    ("track", "conditions", "named"),
    [
        ("slow_motion_8x.csv", "conditions.toml", "--fps"),
        ("ordinary.csv", "conditions_cP.toml", "mPa s"),
        ("distance_fallen.csv", "conditions.toml", "--direction down"),
        ("mistracked_frames.csv", None, "no flight passes through"),
    ],
)
def test_what_is_valid_but_doubtful_is_said_and_refused_where_asked(track, conditions, named, capsys):
    command = ["data", "validate", str(FIELD_CASES / track)]
    command += ["--conditions", str(FIELD_CASES / conditions)] if conditions else []
    assert main(command) == 0
    (doubt,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("doubt: ")]
    assert named in doubt
    assert main([*command, "--strict"]) == 2
    assert named in capsys.readouterr().err


def test_nothing_is_doubtful_about_an_ordinary_track(capsys):
    command = ["data", "validate", str(FIELD_CASES / "ordinary.csv"), "--strict"]
    assert main([*command, "--conditions", str(FIELD_CASES / "conditions.toml")]) == 0
    assert "doubt" not in capsys.readouterr().out


def test_impacts_are_held_against_all_measured_ones(tmp_path, capsys):
    points = (FIELD_CASES / "stokes_without_the_nine.csv").read_text().split()[1:]
    path = tmp_path / "impacts.csv"
    head = "stokes,e_eff,stokes_convention,speed_definition,e_dry\n"
    path.write_text(head + "".join(f"{point},st,far,0.97\n" for point in points))
    assert main(["data", "validate", str(path)]) == 0
    assert "without its 9" in capsys.readouterr().out
    assert main(["data", "validate", str(path), "--strict"]) == 2
