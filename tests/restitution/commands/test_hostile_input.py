"""What no experiment gives: one line a cause naming where it stands, status 2, nothing written."""

import json
import re

import pytest

from restitution import datasets
from restitution.cli import main

FLUID = "[fluid]\ndensity = 935\nviscosity = 0.01\n[sphere]\ndiameter = 0.003\ndensity = 7800\ne_dry = 0.97\n"
IMPACTS = "source,stokes,e_eff,e_dry,stokes_convention,speed_definition\n" + "".join(
    f"{{name}},{St},{e},0.97,st,far\n" for St, e in ((20, 0.17), (40, 0.41), (80, 0.62), (160, 0.79), (320, 0.87))
)
LAW = ["--law", "eq4_exponential"]


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "impacts.csv").write_text(IMPACTS.format(name="A"))
    return tmp_path


def refused(capsys, *command):
    """The lines of a refusal, which has left nothing behind."""
    try:
        status = main(list(command))
    except SystemExit as stopped:
        status = stopped.code
    lines = capsys.readouterr().err.splitlines()
    assert status == 2
    assert len(lines) <= 20
    assert all(line.isprintable() for line in lines)
    return lines


SIZES = ["1e308", "1e300", "1e-320", "1e13", '"1e200 km"', "inf", "nan", "9" * 400, "true", '"１ m"']


@pytest.mark.parametrize("value", SIZES)
@pytest.mark.parametrize("field", ["density", "viscosity", "diameter"])
def test_sizes_beyond_anything_are_refused_by_field(field, value, here, capsys):
    text = re.sub(rf"\b{field} = .*", f"{field} = {value}", FLUID, count=1)
    (here / "conditions.toml").write_text(text)
    (here / "track.csv").write_text(datasets.load("gondret2002_st152").iloc[:45].to_csv(index=False))
    lines = refused(capsys, "impacts", "track.csv", "--conditions", "conditions.toml")
    assert lines[0].startswith("error: conditions.toml: ")


@pytest.mark.parametrize(
    "options",
    [["--wall", "1e300"], ["--wall", "-1e13"], ["--unit", "1e-200m"], ["--unit", "1e300m"],
     ["--time-unit", "1e300s"], ["--time-unit", "1e-300s"], ["--unit", "d", "--pixel", "1e300m"],
     ["--fps", "1e13"]],
)  # fmt: skip
@pytest.mark.parametrize("command", ["impacts", "fit"])
def test_tracks_of_no_size_are_refused(options, command, here, capsys):
    """Numbers whose squares or differences overflow, whichever option or unit has made them."""
    (here / "conditions.toml").write_text(FLUID)
    (here / "track.csv").write_text(datasets.load("gondret2002_st152").iloc[:45].to_csv(index=False))
    flight = ["--trajectory", "--wake", "off"] if command == "fit" else []
    if options[-2] == "--pixel":
        options = ["--unit", "px", *options[-2:]]
    lines = refused(capsys, command, "track.csv", "--conditions", "conditions.toml", *flight, *options)
    assert any(word in lines[-1] for word in ("track.csv", "--unit", "--time-unit", "--fps", "--wall"))


@pytest.mark.parametrize("time", ["inf", "1e12", "-1e300", "nan", "-0.5"])
def test_a_first_contact_outside_the_trajectory_is_refused(time, here, capsys):
    (here / "track.csv").write_text(datasets.load("gondret2002_st152").to_csv(index=False))
    command = ("validate", "--trajectory", "track.csv", "--case", "gondret-st152", "--out", "card")
    assert "first" in refused(capsys, *command, f"--first-contact={time}")[-1]
    assert not list((here / "card").glob("*"))


@pytest.mark.parametrize("size", ["1e300m", "1e-300m", "1e17mm"])
def test_releases_of_no_size_are_refused(size, here, capsys):
    (here / "conditions.toml").write_text(FLUID)
    (here / "track.csv").write_text(datasets.load("gondret2002_st152").iloc[:45].to_csv(index=False))
    command = ("fit", "track.csv", "--conditions", "conditions.toml", "--trajectory", "--wake", "off")
    assert "release" in refused(capsys, *command, "--release", size)[-1]


@pytest.mark.parametrize(
    "option",
    ["--unit", "--time-unit", "--pixel", "--particle", "--column=gap_m=", "--column=time_s=", "--release"],
)
def test_options_of_tracks_that_are_empty_are_refused_by_name(option, here, capsys):
    (here / "conditions.toml").write_text(FLUID)
    (here / "track.csv").write_text(datasets.load("gondret2002_st152").iloc[:45].to_csv(index=False))
    given = [option] if "=" in option else [option, ""]
    lines = refused(capsys, "fit", "track.csv", "--conditions", "conditions.toml", "--trajectory", *given)
    assert option.partition("=")[0] in " ".join(lines)


@pytest.mark.filterwarnings("ignore:The 'float_precision'")  # of pandas 3.1; what it asks for rounds in older ones
@pytest.mark.parametrize("times", [1e200, 1e-200])
@pytest.mark.parametrize("rows", [45, 90_000])
def test_gaps_of_no_size_are_refused(times, rows, here, capsys):
    """By the reader of long tracks as by the general one."""
    (here / "conditions.toml").write_text(FLUID)
    lines = [f"{0.001 * k:.9f},{times * (1.0 + abs(k % 20 - 10)):.12g}\n" for k in range(rows)]
    (here / "track.csv").write_text("time_s,gap_m\n" + "".join(lines))
    assert "track.csv" in refused(capsys, "impacts", "track.csv", "--conditions", "conditions.toml")[0]


@pytest.mark.parametrize("key", ["release.speed", "release.gap_d", "numerics.height_d", "run.after_contact"])
@pytest.mark.parametrize("value", ["1e308", "1e13", "9" * 300])
def test_cases_beyond_anything_are_refused_by_field(key, value, here, capsys):
    section, name = key.split(".")
    (here / "case.toml").write_text(f'base = "gondret_st152_10"\n[{section}]\n{name} = {value}\n')
    lines = refused(capsys, "bounce", "case.toml", "--out", "out")
    assert lines[0].startswith(f"error: case.toml: {key}")
    assert not (here / "out").exists()


def test_more_rows_than_can_be_kept_are_refused(here, capsys):
    (here / "case.toml").write_text('base = "gondret_st152_10"\n[run]\nafter_contact = 1e9\n')
    assert "run.after_contact" in refused(capsys, "bounce", "case.toml")[0]


def test_a_hundred_thousand_defects_are_few_lines(here, capsys):
    rows = "".join(f"{'ab'[k % 2] * (k % 97)}{k},{k}x\n" for k in range(100_000))
    (here / "impacts.csv").write_text(f"stokes,e_eff\n{rows}")
    refused(capsys, "data", "validate", "impacts.csv", "--schema", "impact")
    refused(capsys, "fit", "impacts.csv", *LAW, "--stokes", "st", "--speed", "far", "--e-dry", "0.97")


@pytest.mark.parametrize("cell", ["9" * 5000, "x" * 5000, "\x1b[31m"])
def test_a_value_is_shown_cut_and_without_control_characters(cell, here, capsys):
    (here / "impacts.csv").write_text(f"stokes,e_eff\n100,{cell}\n" + "100,0.5\n" * 5)
    lines = refused(capsys, "fit", "impacts.csv", *LAW, "--stokes", "st", "--speed", "far", "--e-dry", "0.97")
    assert max(map(len, lines)) < 1000


@pytest.mark.parametrize(
    "option",
    [
        ["--fix", "K=-5"], ["--fix", "K=1_0"], ["--fix", "K=18", "--fix", "K=19"],
        ["--fix", "K=18", "--free", "K"],
        ["--prior", "K=1e308+-1e308"], ["--prior", "K=18+-１"], ["--law-stokes", "zz"], ["--law-stokes", "st"],
        ["--posterior", "--seed", "-1"], ["--separate", "e_dry=source"], ["--bounds", "K=nan:3"],
    ],
)  # fmt: skip
def test_options_that_mean_nothing_are_refused(option, here, capsys):
    refused(capsys, "fit", "impacts.csv", *LAW, *option)


@pytest.mark.parametrize("value", ["1_0", "１０", "nan", "1e999", "-3", "3,,4", ""])
def test_numbers_of_options_are_those_of_tables(value, here, capsys):
    main(["fit", "impacts.csv", *LAW, "--out", "fit.json"])
    capsys.readouterr()
    refused(capsys, "predict", "fit.json", "--e-dry", "0.97", "--st", value)
    refused(capsys, "predict", "fit.json", "--fluid", "density=935,density=2,viscosity=0.01", "--st", "3")


NAMES = [r"lab $\frac{$", "$", "$$", r"\$x$", "a^{b_", "\x1b]0;title\x07", "<script>", "x" * 400, "日本"]


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_drawn_and_printed_as_text(name, here, capsys):
    content = IMPACTS.format(name=name) + IMPACTS.format(name="B").partition("\n")[2].replace("0,0.", "1,0.")
    (here / "impacts.csv").write_text(content)
    with pytest.MonkeyPatch.context() as patch:  # a sign that the font lacks is drawn as a box, which is said
        patch.setattr("warnings.warn", lambda *_, **__: None)
        assert main(["fit", "impacts.csv", *LAW, "--report", "report"]) == 0
    assert capsys.readouterr().out.replace("\n", "").isprintable()
    page = (here / "report" / "index.html").read_text()
    assert "<script>" not in page
    assert {p["source"] for p in json.loads((here / "report" / "fit.json").read_text())["points"]} == {name, "B"}


@pytest.mark.parametrize(
    "change",
    [
        lambda s: s["fields"].append(s["fields"][0]),
        lambda s: s.update(fields=[]),
        lambda s: s.update({"restitution:rules": {"strictly_increasing": ["nothing"]}}),
        lambda s: s.update({"restitution:rules": {"unique": [["time_s", "nothing"]]}}),
        lambda s: s.update({"restitution:rules": {"required_when": [{"field": "no", "when": {"time_s": "1"}}]}}),
    ],
)
def test_a_schema_is_of_its_own_fields(change, here):
    from restitution.errors import InputError
    from restitution.tables.schema import read_schema

    content = json.loads((datasets.folder() / "schemas" / "trajectory.json").read_text())
    change(content)
    (here / "schema.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match=r"schema\.json"):
        read_schema(here / "schema.json")


@pytest.mark.parametrize("path", ["a\0b", "", "../x", "/etc/passwd", "a\nb"])
def test_the_path_of_a_resource_stays_in_its_package(path, here, capsys):
    content = json.loads((datasets.folder() / "datapackage.json").read_text())
    content["resources"] = content["resources"][:1]
    content["resources"][0]["path"] = path
    (here / "datapackage.json").write_text(json.dumps(content))
    lines = refused(capsys, "data", "validate", ".")
    assert lines[0].startswith("error: datapackage.json: resources.0.path")


DIGITIZED = {
    "ragged": "10,0.1\n20\n40,0.5\n80,0.7\n160,0.8\n",
    "decimal commas": "10,0,3\n20,0,4\n40,0,5\n",
    "endless number": f"10,0.1\n{'9' * 5000},0.5\n40,0.5\n80,0.7\n160,0.8\n",
}


@pytest.mark.parametrize("what", DIGITIZED)
def test_no_value_of_a_digitized_plot_is_dropped(what, here, capsys):
    (here / "plot.csv").write_text(DIGITIZED[what])
    lines = refused(capsys, "fit", "plot.csv", *LAW, "--stokes", "st", "--speed", "far", "--e-dry", "0.97")
    assert lines[0].startswith("error: plot.csv:")


@pytest.mark.parametrize("threads", ["0", "-1", "many", ""])
def test_a_number_of_threads_that_is_none_is_named(threads, here, capsys, monkeypatch):
    monkeypatch.setenv("NUMBA_NUM_THREADS", threads)
    assert "NUMBA_NUM_THREADS" in refused(capsys, "simulate", "gondret_st27")[0]


def test_a_name_too_long_is_said_of_the_input(here, capsys):
    (here / "conditions.toml").write_text(FLUID)
    line = refused(capsys, "impacts", "x" * 300, "--conditions", "conditions.toml")[0]
    assert line.startswith("error: xxx")
    assert "output" not in line


@pytest.mark.parametrize(
    "command", [["fit", "impacts.csv", *LAW, "--report"], ["bounce", "gondret_st27", "--out"]]
)
def test_a_place_under_a_file_is_found_before_the_work(command, here, capsys, monkeypatch):
    monkeypatch.setattr("restitution.calibration.estimation.fitting.estimate", None)
    monkeypatch.setattr("restitution.runs.point_particle.predict", None)
    assert "impacts.csv" in refused(capsys, *command, "impacts.csv/r")[0]
