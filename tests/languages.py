"""Exported source code against this package, language by language: ``python -m tests.languages``.

Each law is compiled or run in every language that is installed, at 1000 random points from a twentieth of its
range to 20 times it, some without a meaning; what it gives is compared with the law, not with the exporter.
Of languages that are not installed reports/export/languages.csv keeps its rows; the report puts it on its page.
"""

from __future__ import annotations

import datetime
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from restitution import laws
from restitution.export import law_closure
from restitution.export.closure import Closure
from restitution.export.drops import NotInstalledError
from restitution.export.languages import LANGUAGES, source_code
from restitution.files import write_whole
from restitution.report.delivered.languages import SCHEMA, read_kept
from restitution.tables.writing import table_text

KEPT = Path("reports/export/languages.csv")
LAWS = (
    "eq4_exponential",
    "two_way_lubrication",
    "clift_grace_weber_1978",
    "nijssen_2022",
    "eq3_velocity_difference",
)
RNG = np.random.default_rng(18)
TOOLS = {"c": "gcc", "fortran": "gfortran", "python": sys.executable, "javascript": "node", "octave": "octave-cli",
         "julia": "julia"}  # fmt: skip


def program(key: str) -> str:
    """Where a language's program is."""
    tool = shutil.which(TOOLS[key])
    if tool is None:
        raise NotInstalledError(f"{TOOLS[key]} is not installed: {LANGUAGES[key].title} was not tried")
    return tool


def run(*command: str, given: str = "", folder: Path | None = None) -> str:
    """What a command prints; it must succeed."""
    done = subprocess.run(command, input=given, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stdout + done.stderr)
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


def given_by(closure: Closure, key: str, rows: np.ndarray, folder: Path) -> np.ndarray:
    """What the generated code gives at the rows."""
    tool, name, language = program(key), closure.name, LANGUAGES[key]
    (folder / f"{name}{language.suffix}").write_text(source_code(closure, key, derivative=True))
    (folder / f"main{language.suffix.replace('.h', '.c')}").write_text(calls(closure, key, rows))
    text = "\n".join(" ".join(map(repr, map(float, row))) for row in rows) + "\n"
    (folder / "rows.txt").write_text(text)
    if key == "c":
        run(
            tool,
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-Wno-unused-function",
            "-Werror",
            "main.c",
            "-lm",
            "-o",
            "main",
            folder=folder,
        )
    if key == "fortran":
        run(tool, "-std=f2008", f"{name}.f90", "main.f90", "-o", "main", folder=folder)
    command = {"c": ["./main"], "fortran": ["./main"], "octave": [tool, "--norc", "-q", "main.m"]}
    printed = run(*command.get(key, [tool, f"main{language.suffix}"]), given=text, folder=folder)
    return np.array([[float(x) for x in line.split()] for line in printed.splitlines()])


def version_of(key: str) -> str:
    """The first line that a language's program says of its version."""
    said = run(program(key), "--version").splitlines()[0]
    return f"{TOOLS[key]} {said}" if said.startswith("v") else said


def deviation(given: np.ndarray, expected: np.ndarray) -> float:
    """The greatest relative one; infinite where one is a number, or 0, and the other is not."""
    if (np.isnan(given) != np.isnan(expected)).any() or (given[expected == 0] != 0).any():
        return np.inf
    counted = np.isfinite(expected) & (expected != 0)
    return float(np.abs(given[counted] / expected[counted] - 1).max())


def measure(key: str) -> list[tuple]:
    """A row for each law in one language."""
    rows, today = [], datetime.date.today().isoformat()
    for name in LAWS:
        at = points(name)
        with tempfile.TemporaryDirectory() as folder:
            given = given_by(law_closure(laws.get(name)), key, at, Path(folder))
        value, slope, flag = own(name, at).T
        if (given[:, 2] != flag).any():
            raise SystemExit(f"{key}: {name}_in_range differs")
        far = (deviation(given[:, 0], value), deviation(given[:, 1], slope))
        rows.append((LANGUAGES[key].title, version_of(key), today, name, len(at), *far))
    return rows


def main() -> None:
    """Measure what is installed and keep it."""
    kept = read_kept(KEPT) if KEPT.exists() else None
    rows: list[tuple] = []
    for key, language in LANGUAGES.items():
        try:
            rows += measure(key)
            sys.stdout.write(f"{language.title}: measured\n")
        except NotInstalledError as error:
            sys.stdout.write(f"{error}: kept as it was\n")
            if kept is not None:
                rows += list(kept[kept["language"] == language.title].itertuples(index=False, name=None))
    write_whole(KEPT, table_text(pd.DataFrame(rows, columns=list(SCHEMA.columns)), "%.2g"))


if __name__ == "__main__":
    main()
