"""Generated source code agrees with this package: 1000 random points, out of range included, and its own table."""

import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from restitution import laws
from restitution.export import law_closure
from restitution.export.closure import Closure
from restitution.export.languages import LANGUAGES, source_code

RNG = np.random.default_rng(18)
CLOSED = [name for name, law in laws.REGISTRY.items() if law.formula is not None]
REBOUND = [name for name in laws.names("rebound") if name in CLOSED]
OTHERS = ("clift_grace_weber_1978", "nijssen_2022", "eq3_velocity_difference", "kim_1998", "thornton_1997")
TOOLS = {"c": "gcc", "fortran": "gfortran", "python": sys.executable, "javascript": "node", "octave": "octave-cli",
         "julia": "julia"}  # fmt: skip


def program(key: str) -> str:
    tool = shutil.which(TOOLS[key])
    if tool is None:
        pytest.skip(f"{TOOLS[key]} is not installed: {LANGUAGES[key].title} was not tried")
    return tool


def run(*command: str, given: str = "") -> str:
    done = subprocess.run(command, input=given, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def own(name: str, rows: np.ndarray) -> np.ndarray:
    """Value, slope and whether in range, by the law itself, not by the exporter's closure."""
    law, low, high = laws.get(name), *laws.get(name).validity
    x, other = rows.T[0], rows.T[1:]
    good = (rows > 0).all(axis=1)
    if law.family != "rebound":
        value, slope = np.full(len(rows), np.nan), np.full(len(rows), np.nan)
        value[good], slope[good] = law._value(*rows[good].T), law._derivative(*rows[good].T)
    else:
        dry = other[0]
        admissible, hits = (dry > 0) & (dry <= 1), good & (dry <= 1)
        value, slope = np.where(admissible, 0.0, np.nan), np.where(admissible, 0.0, np.nan)
        e = law._value(x[hits], dry[hits])
        value[hits] = np.clip(e, 0.0, dry[hits])
        slope[hits] = np.where((e >= 0) & (e <= dry[hits]), law._derivative(x[hits], dry[hits]), 0.0)
    return np.stack([value, slope, (x >= low) & (x <= high) & (x > 0)], axis=1)


def points(name: str, n: int = 1000) -> np.ndarray:
    """Arguments in the range and far outside, some of them without a meaning."""
    law = laws.get(name)
    low, high = law.validity
    low, high = max(low, 1e-4), min(high, 1e5)
    columns = [np.exp(RNG.uniform(np.log(low / 20), np.log(20 * high), n))]
    for variable in law.variables[1:]:
        if variable == "e_dry":
            columns.append(RNG.uniform(0.01, 1.0, n))
        else:
            typical = [check.inputs[variable] for check in law.checks]
            columns.append(np.exp(RNG.uniform(np.log(min(typical) / 3), np.log(3 * max(typical)), n)))
    rows = np.stack(columns, axis=1)
    rows[:20, 0], rows[20:40, -1] = RNG.uniform(-5, 0, 20), RNG.uniform(-1, 0, 20)
    if law.family == "rebound":
        rows[40:60, 1] = RNG.uniform(1.0001, 2, 20)
    return rows


def calls(closure: Closure, key: str, rows: np.ndarray) -> str:
    """The program that reads rows and prints value, slope and flag of each, in the language."""
    name, n, m = closure.name, len(rows), len(closure.variables)
    if key == "c":
        x = ", ".join(f"x[{j}]" for j in range(m))
        read = " && ".join(f'scanf("%lf", x + {j}) == 1' for j in range(m))
        return (
            f'#include "{name}.h"\n#include <stdio.h>\nint main(void) {{ double x[{m}]; while ({read}) '
            f'printf("%.17g %.17g %d\\n", {name}({x}), {name}_slope({x}), {name}_in_range(x[0])); return 0; }}\n'
        )
    if key == "fortran":
        x = ", ".join(f"x({j + 1})" for j in range(m))
        return (
            f"program main\n use {name}_module\n implicit none\n double precision :: x({m})\n integer :: i\n"
            f" do i = 1, {n}\n  read *, x\n  print '(es30.17e3, es30.17e3, i3)', {name}({x}), &\n"
            f"   {name}_slope({x}), {name}_in_range(x(1))\n end do\nend program\n"
        )
    if key == "python":
        return (
            f"import sys\nfrom {name} import *\nfor line in sys.stdin:\n    x = [float(w) for w in line.split()]\n"
            f"    print(repr({name}(*x)), repr({name}_slope(*x)), {name}_in_range(x[0]))\n"
        )
    if key == "javascript":
        return (
            f'const law = require("./{name}.js");\nrequire("fs").readFileSync(0, "utf8").trim().split("\\n")'
            f'.forEach(line => {{ const x = line.split(" ").map(Number); console.log(law.{name}(...x), '
            f"law.{name}_slope(...x), law.{name}_in_range(x[0])); }});\n"
        )
    if key == "octave":
        return (
            f"law = {name}(); rows = dlmread('rows.txt');\nfor i = 1:size(rows, 1)\n  x = num2cell(rows(i, :));\n"
            "  printf('%.17g %.17g %d\\n', law.value(x{:}), law.slope(x{:}), law.in_range(x{1}));\nend\n"
        )
    return (
        f'include("{name}.jl")\nusing .{name}_module\nfor line in eachline(stdin)\n'
        "    x = parse.(Float64, split(line))\n"
        f"    println({name}(x...), ' ', {name}_slope(x...), ' ', {name}_in_range(x[1]))\nend\n"
    )


def given_by(closure: Closure, key: str, rows: np.ndarray, folder) -> np.ndarray:
    """What the generated code gives at the rows."""
    tool, name, language = program(key), closure.name, LANGUAGES[key]
    (folder / f"{name}{language.suffix}").write_text(source_code(closure, key, derivative=True))
    (folder / f"main{language.suffix.replace('.h', '.c')}").write_text(calls(closure, key, rows))
    text = "\n".join(" ".join(map(repr, map(float, row))) for row in rows) + "\n"
    (folder / "rows.txt").write_text(text)
    os.chdir(folder)
    if key == "c":
        run(tool, "-std=c99", "-Wall", "-Wextra", "-Wno-unused-function", "-Werror", "main.c", "-lm", "-o", "main")
    if key == "fortran":
        run(tool, "-std=f2008", f"{name}.f90", "main.f90", "-o", "main")
    command = {"c": ["./main"], "fortran": ["./main"], "octave": [tool, "--norc", "-q", "main.m"]}
    printed = run(*command.get(key, [tool, f"main{language.suffix}"]), given=text)
    return np.array([[float(x) for x in line.split()] for line in printed.splitlines()])


@pytest.mark.targets
@pytest.mark.parametrize("key", LANGUAGES)
@pytest.mark.parametrize("name", ["eq4_exponential", "two_way_lubrication", *OTHERS[:3]])
def test_agrees_on_a_thousand_points(name, key, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = points(name)
    given, expected = given_by(law_closure(laws.get(name)), key, rows, tmp_path), own(name, rows)
    # Where a law is a small difference its error is that of its terms, of order 1: e_dry - 36/St near 0.
    terms = 1e-15 if laws.get(name).family == "rebound" else 0.0
    np.testing.assert_allclose(given[:, 0], expected[:, 0], rtol=1e-12, atol=terms)
    np.testing.assert_allclose(given[:, 1], expected[:, 1], rtol=1e-11)
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


@pytest.mark.parametrize("name", REBOUND)
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
