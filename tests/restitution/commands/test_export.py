"""``restitution export`` as a user meets it."""

import json
import subprocess
import sys

import numpy as np
import pytest

from restitution.cli import main

FLUID = ["--fluid", "density=935,viscosity=0.01"]
SPHERE = ["--sphere", "diameter=0.003,density=7800,e_dry=0.97"]


@pytest.fixture
def command(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str):
        status = main(["export", *arguments])
        out = capsys.readouterr()
        return status, out.out, out.err

    return run


def test_list_names_every_target(command):
    from restitution.export import TARGETS

    status, out, _ = command("--list")
    assert status == 0
    assert [line.split()[0] for line in out.splitlines()[1:]] == list(TARGETS)


def test_written_file_runs_and_checks_itself(command, tmp_path):
    assert command("eq4_exponential", "K=20", "--to", "python", "--out", "law.py")[0] == 0
    done = subprocess.run([sys.executable, "law.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "eq4_exponential: 0 wrong\n")
    done = subprocess.run(
        [sys.executable, "-c", "import law; print(law.eq4_exponential(100.0, 0.9))"],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert float(done.stdout) == pytest.approx(0.9 * np.exp(-20 * 1.9 / 100), rel=1e-14)


def test_a_law_without_a_formula_has_its_table(command):
    status, out, _ = command("bertin_2024", "--to", "csv", *FLUID, *SPHERE, "--bare")
    assert status == 0
    rows = np.genfromtxt(out.splitlines(), delimiter=",", names=True)
    assert rows["e_eff"][-1] == pytest.approx(0.97 * 0.95, rel=1e-6)  # the end of the solution's table
    assert rows["impact_speed_m_s"][-1] == pytest.approx(500 * 9 * 0.01 / (7800 * 0.003), rel=1e-8)


def test_films_and_drag_export_too(command):
    status, out, _ = command("schiller_naumann_1935", "--to", "json")
    assert status == 0
    assert json.loads(out)["family"] == "drag"


def test_existing_output_is_kept_unless_forced(command, tmp_path):
    (tmp_path / "law.h").write_text("mine")
    status, _, error = command("eq4_exponential", "--to", "c", "--out", "law.h")
    assert (status, "--force" in error, (tmp_path / "law.h").read_text()) == (2, True, "mine")
    assert command("eq4_exponential", "--to", "c", "--out", "law.h", "--force")[0] == 0
    assert "eq4_exponential" in (tmp_path / "law.h").read_text()


def test_a_drop_test_without_the_program_is_its_input(command, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    status, out, error = command("eq4_exponential", "--to", "yade", *FLUID, *SPHERE, "--level", "2", "--drop-test")
    assert (status, error.count("\n")) == (0, 1)
    assert "not installed" in error
    compile(out, "drop.py", "exec")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["eq4_exponential", "--to", "cobol"], "known: c, fortran"),
        (["eq4_exponential", "--to", "pyton"], "did you mean python"),
        (["eq4_exponential"], "--to"),
        (["--to", "c"], "name a law"),
        (["eq4", "--to", "c"], "unknown law"),
        (["missing.json", "--to", "c"], "missing.json"),
        (["bertin_2024", "--to", "c"], "--to csv"),
        (["eq4_exponential", "K=-1", "--to", "c"], "K"),
        (["eq4_exponential", "--to", "csv"], "--fluid"),
        (["eq4_exponential", "--to", "lammps", "--speed", "0.3"], "--sphere"),
        (["eq4_exponential", "--to", "csv", *FLUID, "--sphere", "diameter=0.003,density=7800"], "e_dry"),
        (["eq4_exponential", "--to", "lammps", *FLUID, *SPHERE], "--speed"),
        (["eq4_exponential", "--to", "lammps", *FLUID, *SPHERE, "--speed", "-1"], "--speed"),
        (["bertin_2024", "--to", "yade", *FLUID, *SPHERE, "--level", "2"], "--to csv"),
        (["eq4_exponential", "--to", "liggghts", *FLUID, *SPHERE, "--speed", "0.04"], "0.05 < e"),
        (["eq4_exponential", "--to", "c", *FLUID, *SPHERE, "--drop-test"], "--drop-test"),
        (["eq4_exponential", "--to", "walberla"], "twice"),
        (["taylor_1925", "--to", "yade", *FLUID, *SPHERE, "--speed", "0.3"], "twice"),
        (["eq4_exponential", "--to", "c", "--out", "missing/law.h"], "missing"),
        # What would have no effect, or two meanings, is no input either.
        (["eq4_exponential", "K=5", "K=6", "--to", "c"], "twice"),
        (["eq4_exponential", "--to", "c", "--e-dry", "0.9"], "--e-dry"),
        (["eq4_exponential", "--to", "c", *FLUID], "--fluid"),
        (["eq4_exponential", "--to", "c", "--of", "material=steel"], "--of"),
        (["eq4_exponential", "--to", "csv", *FLUID, *SPHERE, "--e-dry", "0.9"], "--e-dry"),
        (["eq4_exponential", "--to", "csv", *FLUID, *SPHERE, "--conditions", "any.toml"], "--fluid"),
        (["eq4_exponential", "--to", "yade", *FLUID, *SPHERE, "--level", "2", "--within", "0.1"], "--within"),
        (
            ["eq4_exponential", "--to", "yade", *FLUID, *SPHERE, "--speed", "0.3", "--st-range", "20:50"],
            "--st-range",
        ),
    ],
)
def test_bad_input_is_one_line(command, arguments, named):
    status, out, error = command(*arguments)
    assert (status, out) == (2, "")
    assert error.startswith("error: ")
    assert error.count("\n") == 1
    assert named in error
