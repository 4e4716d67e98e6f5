"""Generated source code agrees with this package: 1000 random points, out of range included, and its own table."""

import shutil
import subprocess

import numpy as np
import pytest

from restitution import laws
from restitution.export import law_closure
from restitution.export.closure import Closure
from restitution.export.drops import NotInstalledError
from restitution.export.languages import LANGUAGES, source_code
from tests import languages
from tests.languages import LAWS, given_by, own, points, run

CLOSED = [name for name, law in laws.REGISTRY.items() if law.formula is not None]
REBOUND = [name for name in laws.names("rebound") if name in CLOSED]


def program(key: str) -> str:
    try:
        return languages.program(key)
    except NotInstalledError as error:
        pytest.skip(str(error))


@pytest.mark.targets
@pytest.mark.parametrize("key", LANGUAGES)
@pytest.mark.parametrize("name", LAWS)
def test_agrees_on_a_thousand_points(name, key, tmp_path):
    program(key)
    rows = points(name)
    given, expected = given_by(law_closure(laws.get(name)), key, rows, tmp_path), own(name, rows)
    # Where a law is a small difference its error is that of its terms, of order 1: e_dry - 36/St near 0.
    terms = 1e-15 if laws.get(name).family == "rebound" else 0.0
    np.testing.assert_allclose(given[:, 0], expected[:, 0], rtol=1e-12, atol=terms)
    # And where a curve is nearly flat, its slope is a small difference of terms of order value over argument.
    flat = 1e-12 * np.nan_to_num(np.abs(expected[:, 0] / rows[:, 0]), nan=0.0, posinf=0.0)
    close = np.isclose(given[:, 1], expected[:, 1], rtol=1e-11, atol=flat, equal_nan=True)
    assert close.all(), (rows[~close], given[~close, 1], expected[~close, 1])
    np.testing.assert_array_equal(given[:, 2], expected[:, 2])


def check_itself(closure: Closure, key: str, folder, edit=lambda text: text) -> subprocess.CompletedProcess:
    tool, name, language = program(key), closure.name, LANGUAGES[key]
    file = folder / f"{name}{language.suffix}"
    file.write_text(edit(source_code(closure, key, derivative=True)))
    if key == "c":
        run(tool, "-std=c99", "-x", "c", f"-D{name.upper()}_MAIN", str(file), "-lm", "-o", "self")
        command = ["./self"]
    elif key == "fortran":
        (folder / "check.f90").write_text(f"use {name}_module; if ({name}_self_check() /= 0) error stop; end\n")
        run(tool, "-std=f2008", str(file), "check.f90", "-o", "self")
        command = ["./self"]
    elif key == "octave":
        command = [tool, "--norc", "-q", "--eval", f"law = {name}(); exit(law.self_check() ~= 0)"]
    else:
        command = [tool, str(file)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.targets
@pytest.mark.parametrize("key", ["c", "fortran", "python", "javascript", "octave", "julia"])
def test_self_check_passes_and_finds_an_edited_constant(key, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    closure = law_closure(laws.get("legendre_2005"))
    assert check_itself(closure, key, tmp_path).returncode == 0
    edited = check_itself(closure, key, tmp_path, lambda text: text.replace("= 35.0", "= 36.0"))
    assert edited.returncode != 0


@pytest.mark.parametrize("name", CLOSED)
def test_every_law_with_a_formula_checks_itself_in_python(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    closure = law_closure(laws.get(name))
    assert check_itself(closure, "python", tmp_path).returncode == 0
    statements = [line for line in source_code(closure, "fortran").splitlines() if line.lstrip()[:1] != "!"]
    assert max(map(len, statements)) <= 132  # the standard's longest


@pytest.mark.targets
def test_header_serves_c_plus_plus(tmp_path, monkeypatch):
    if shutil.which("g++") is None:
        pytest.skip("g++ is not installed: C++ was not tried")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.h").write_text(
        source_code(law_closure(laws.get("two_way_lubrication")), "c", derivative=True)
    )
    run("g++", "-std=c++11", "-Wall", "-Wextra", "-Werror", "-DTWO_WAY_LUBRICATION_MAIN", "-x", "c++", "law.h",
        "-o", "self")  # fmt: skip
    run("./self")


@pytest.mark.targets
@pytest.mark.parametrize("where", ["law.mjs", "package/law.js"])
def test_javascript_of_an_es_module_says_what_it_is_not(where, tmp_path, monkeypatch):
    node = program("javascript")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "package.json").write_text('{"type": "module"}')
    text = source_code(law_closure(laws.get("legendre_2005")), "javascript")
    (tmp_path / where).write_text(text)
    done = subprocess.run([node, where], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "no ES module" in done.stderr
    (tmp_path / "package" / "law.cjs").write_text(text)
    (tmp_path / "package" / "use.js").write_text(
        'import { legendre_2005 } from "./law.cjs"; console.log(legendre_2005(35, 1));'
    )
    assert float(run(node, "package/use.js")) == pytest.approx(np.exp(-1), rel=1e-14)


@pytest.mark.targets
def test_octave_refuses_arrays_and_knows_an_infinite_gap(tmp_path, monkeypatch):
    tool = program("octave")
    monkeypatch.chdir(tmp_path)
    for name in ("legendre_2005", "brandle_de_motta_2013"):
        (tmp_path / f"{name}.m").write_text(source_code(law_closure(laws.get(name)), "octave", derivative=True))
    asked = "law = brandle_de_motta_2013(); disp([law.value(Inf), law.slope(Inf)]); law = legendre_2005(); "
    asked += "try; law.value([-1 50], 0.9); catch error; disp(error.message); end"
    numbers, said = run(tool, "--norc", "-q", "--eval", asked).splitlines()
    assert [float(x) for x in numbers.split()] == [0.0, 0.0]  # beyond its cut-off
    assert "arrayfun" in said


@pytest.mark.parametrize("name", [n for n in REBOUND if n != "eq4_rational"])  # which is never 0
def test_slopes_of_no_rebound_are_0(name):
    space = module_of(law_closure(laws.get(name)))
    assert space[f"{name}_slope"](1e-300, 0.9) == 0.0


def module_of(closure: Closure) -> dict:
    space: dict = {"__name__": "generated"}
    exec(compile(source_code(closure, "python", derivative=True), "generated", "exec"), space)
    return space


@pytest.mark.parametrize("name", REBOUND)
def test_stokes_numbers_of_walls_and_pairs(name):
    """By hand for the 3 mm steel sphere of Gondret et al.: rho v d/(9 mu) = 7800*0.585*0.003/0.09 = 152.1."""
    space, law = module_of(law_closure(laws.get(name))), laws.get(name)
    fluid = {"rho_f": 935.0} if law.convention == "st_star" else {}
    wall = space[f"{name}_stokes"](v=0.585, d=0.003, rho_p=7800.0, mu=0.01, **fluid)
    assert wall == pytest.approx((7800 + (467.5 if fluid else 0)) * 0.585 * 0.003 / 0.09, rel=1e-14)
    sphere = {"d_1": 0.003, "rho_1": 7800.0, "mu": 0.01, **fluid}
    pair = space[f"{name}_stokes_pair"]
    assert pair(v=0.585, d_2=0.003, rho_2=7800.0, **sphere) == pytest.approx(2 * wall, rel=1e-14)
    assert pair(v=0.585, d_2=3e6, rho_2=7800.0, **sphere) == pytest.approx(wall, rel=1e-8)  # a wall again
    # Unequal, by hand: m 1:8, r 1:2; m* = 8/9 m, r* = 2/3 r, so St = (8/9)/(4/9) = 2 of the small sphere's.
    assert pair(v=0.585, d_2=0.006, rho_2=7800.0, **sphere) == pytest.approx(2 * wall, rel=1e-14)


def test_names_of_parameters_may_be_words_of_a_language():
    """A user's formula may call its parameters what C, Fortran or Python keep for themselves."""
    from dataclasses import replace

    from restitution.export.closure import Constant

    closure = replace(
        law_closure(laws.get("legendre_2005")),
        text="e_dry*exp(-(for1 + int + INT)/St)",
        constants=tuple(Constant(n, 1.0, "1", "test") for n in ("for1", "int", "INT")),
        functions={"exp": "exp"},
        evaluate=lambda St, dry: dry * np.exp(-3 / St),
        slope=lambda St, dry: 3 * dry * np.exp(-3 / St) / St**2,
    )
    space = module_of(closure)
    assert space["self_check"]() == 0
    names = source_code(closure, "fortran").lower()
    assert "real(dp) :: for1, int_p, int_p_p, e" in names
