"""The command line as a user meets it: what it prints, and bad input met with one line and status 2."""

import argparse
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from restitution.cli import build_parser, main

TRACK = "time_s,gap_m\n" + "".join(f"{0.002 * i:.3f},{abs(0.0045 - 0.001 * i):.5f}\n" for i in range(10))


@pytest.fixture
def case(tmp_path, capsys, monkeypatch):
    """A folder with a good track and conditions; ``run`` gives status, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    assert main(["impacts", "--template", "."]) == 0
    (tmp_path / "track.csv").rename(tmp_path / "template.csv")
    (tmp_path / "track.csv").write_text(TRACK)
    capsys.readouterr()

    def run(*arguments: str):
        with warnings.catch_warnings():
            warnings.simplefilter("default")
            status = main(list(arguments))
        out = capsys.readouterr()
        return status, out.out, out.err

    run.folder = tmp_path
    return run


def test_template_runs_as_it_is(case):
    status, out, _ = case("impacts", "template.csv", "--conditions", "conditions.toml", "--out", "impacts.csv")
    assert status == 0
    assert "St" in out
    assert case("data", "validate", "impacts.csv")[0] == 0


def test_millimetres_and_own_columns_give_the_same_impacts(case):
    rows = [line.split(",") for line in (case.folder / "template.csv").read_text().splitlines()[1:]]
    text = "x,frame time,y\n" + "".join(f"0,{float(t) * 1e3},{float(y) * 1e3}\n" for t, y in rows)
    (case.folder / "mm.csv").write_text(text)
    options = ["--conditions", "conditions.toml"]
    case("impacts", "template.csv", *options, "--out", "metres.csv")
    mapped = ["--column", "time_s=frame time", "--column", "gap_m=y", "--unit", "mm", "--time-unit", "ms"]
    assert case("impacts", "mm.csv", *options, *mapped, "--out", "millimetres.csv")[0] == 0
    metres, millimetres = (pd.read_csv(case.folder / f"{name}.csv") for name in ("metres", "millimetres"))
    for column in ("stokes", "e_eff", "impact_speed_sigma_m_s"):
        np.testing.assert_allclose(millimetres[column], metres[column], rtol=0.02)
    status, _, error = case("impacts", "mm.csv", *options, *mapped[:4])
    assert (status, "--unit" in error) == (2, True)


BAD_TRACKS = {
    "empty": b"",
    "header only": b"time_s,gap_m\n",
    "wrong header": b"t,y\n0,1\n1,2\n2,3\n3,4\n",
    "text in a number": TRACK.replace("0.00350", "high").encode(),
    "all frames lost": b"time_s,gap_m\n" + b"".join(b"0.00%d,nan\n" % i for i in range(10)),
    "infinity": TRACK.replace("0.00350", "inf").encode(),
    "unsorted": TRACK.replace("0.004,", "0.400,").encode(),
    "duplicate time": TRACK.replace("0.004,", "0.002,").encode(),
    "two rows": b"time_s,gap_m\n0,0.001\n0.002,0.002\n",
    "latin-1": TRACK.replace("0.00350", "0.0035µ").encode("latin-1"),
}


@pytest.mark.parametrize("kind", BAD_TRACKS)
def test_bad_tracks(case, kind):
    (case.folder / "bad.csv").write_bytes(BAD_TRACKS[kind])
    status, out, error = case("impacts", "bad.csv", "--conditions", "conditions.toml", "--out", "out.csv")
    assert status == 2
    assert out == ""
    assert "bad.csv" in error
    assert "Traceback" not in error
    assert not (case.folder / "out.csv").exists()


@pytest.mark.parametrize("content", [TRACK.encode("utf-8-sig"), TRACK.replace("\n", "\r\n").encode()])
def test_byte_order_mark_and_crlf_are_accepted(case, content):
    (case.folder / "good.csv").write_bytes(content)
    assert case("impacts", "good.csv", "--conditions", "conditions.toml")[0] == 0


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["impacts", "missing.csv", "--conditions", "conditions.toml"], "missing.csv"),
        (["impacts", ".", "--conditions", "conditions.toml"], "folder"),
        (["impacts", "track.csv"], "--conditions"),
        (["impacts", "track.csv", "--conditions", "missing.toml"], "missing.toml"),
        (["impacts", "track.csv", "--conditions", "track.csv"], "TOML"),
        (["impacts", "track.csv", "--conditions", "conditions.toml", "--stokes", "st_9"], "st_9"),
        (["impacts", "track.csv", "--conditions", "conditions.toml", "--sigma", "-1"], "--sigma"),
        (["impacts", "track.csv", "--conditions", "conditions.toml", "--frames", "1"], "--frames"),
        (["impacts", "track.csv", "--conditions", "conditions.toml", "--film", "nan"], "--film"),
        (["impacts", "brenner1961"], "resistance"),
        (["laws", "show", "legendre"], "legendre_2005"),
        (["laws", "list", "--family", "none"], "rebound"),
        (["laws", "evaluate", "eq4_exponential", "St=152", "e_dry=0.97", "K=-1", "--stokes", "st"], "K"),
        (["laws", "evaluate", "eq4_exponential", "St=152", "e_dry=0.97", "L=1", "--stokes", "st"], "L"),
        (["laws", "evaluate", "eq4_exponential", "St=152", "e_dry=0.97"], "--stokes"),
        (["laws", "evaluate", "eq4_exponential", "St=152", "--stokes", "st"], "e_dry"),
        (["laws", "evaluate", "eq4_exponential", "St=152", "e_dry=2", "--stokes", "st"], "e_dry"),
        (["laws", "evaluate", "eq4_exponential", "St=nan", "e_dry=0.9", "--stokes", "st"], "St"),
        (["laws", "evaluate", "two_way_lubrication", "St=152", "e_dry=0.9", "--stokes", "st"], "--speed"),
        (["impacts", "track.csv", "--conditions", "conditions.toml", "--out", "track.csv"], "replace"),
        (["impacts", "track.csv", "--conditions", "conditions.toml", "--out", "conditions.toml"], "replace"),
        (["impacts", "track.csv", "--conditions", "conditions.toml", "--out", ""], "--out"),
        (["impacts", "track.csv", "--conditions", "conditions.toml", "--out", "missing/x.csv"], "missing"),
        (["impacts", "--template", "."], "replaces nothing"),
        (["report", "fig1", "--out", ""], "--out"),
        (["laws", "evaluate", "legendre_2005", "St=152", "e_dry=0.97", "--stokes", "st"], "conditions"),
        (["data", "show", "gondret"], "gondret2002_st152"),
        (["report", "fig1", "--out", "track.csv"], "track.csv"),
    ],
)
def test_bad_arguments_are_named(case, arguments, named):
    status, out, error = case(*arguments)
    assert status == 2
    assert out == ""
    assert error.startswith("error: ")
    assert named in error


def parsers(parser=None):
    """The parser of each command and subcommand."""
    parser = parser or build_parser()
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for own in action.choices.values():
                yield from parsers(own)


def refusal(capsys, *arguments):
    """The one line with which a command line is refused."""
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    out, error = capsys.readouterr()
    assert (stopped.value.code, out, error.count("\n")) == (2, "", 1)
    return error


def test_no_command_takes_an_abbreviated_option(capsys):
    """Each option of each command, one letter short: no value is taken by it, and the option is asked for."""
    commands = list(parsers())
    assert len(commands) > 20
    for parser in commands:
        for action in parser._actions:
            action.required = False
        options = {o for o in parser._option_string_actions if o.startswith("--")}
        for option in sorted(options):
            short = option[:-1]
            if short in options or len(short) < 3:
                continue
            with pytest.raises(SystemExit):
                parser.parse_args([short])
            error = capsys.readouterr().err
            assert error.startswith(f"error: {short} is no option of this command"), parser.prog
            assert option in error


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["design", "fit.json", "--st", "nan"], "--st-sigma"),
        (["fit", "my.csv", "--column", "frame="], "nothing after the ="),
        (["fit", "my.csv", "--column", "=y"], "nothing before the ="),
        (["impacts", "my.csv", "--column", "frame"], "gap_m=y"),
        (["predict", "fit.json", "--fluid", "density="], "density is given no value"),
        (["laws", "evaluate", "eq4_exponential", "K="], "K is given no value"),
        (["fit", "my.csv", "--speed", "fast"], "'contact'"),
        (["laws", "list", "rebound"], "'rebound'"),
        (["lawz"], "'laws'"),
        (["laws", "evaluate"], "NAME"),
        (["fit", "my.csv", "--\x1bsto"], "x1b"),
    ],
)
def test_what_is_no_command_is_one_line(capsys, arguments, words):
    assert words in refusal(capsys, *arguments)


def test_unwritable_folder_leaves_nothing(case):
    before = sorted(p.name for p in case.folder.iterdir())
    status, *_ = case("impacts", "track.csv", "--conditions", "conditions.toml", "--out", "conditions.toml/x.csv")
    assert status == 2
    assert sorted(p.name for p in case.folder.iterdir()) == before


def test_an_output_that_cannot_be_written_is_said(tmp_path):
    """A full device: status 2 and one line, no traceback."""
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "restitution", "laws", "list"]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1


def test_evaluate_converts_with_conditions(case):
    """exp(-35/St*) with St* = 50 (1 + 935/15600), by hand: 0.97 exp(-35/52.997) = 0.50114."""
    arguments = ["laws", "evaluate", "legendre_2005", "St=50", "e_dry=0.97", "--stokes", "st"]
    status, out, _ = case(*arguments, "--conditions", "conditions.toml")
    assert status == 0
    assert float(out) == pytest.approx(0.50114, abs=1e-5)


def test_out_of_range_warns_in_one_line(case):
    status, out, error = case("laws", "evaluate", "eq4_exponential", "St=5000", "e_dry=0.97", "--stokes", "st")
    assert (status, error.count("\n")) == (0, 1)
    assert "warning" in error
    assert float(out) < 0.97


@pytest.mark.parametrize("module", ["numpy", "pandas", "sympy", "scipy", "matplotlib", "pydantic", "rich"])
def test_heavy_libraries_are_not_imported_for_help(module):
    code = f"import sys, restitution.cli as c; c.build_parser(); sys.exit({module!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
