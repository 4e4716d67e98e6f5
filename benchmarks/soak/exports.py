"""Laws and cases for other programs, with options that mean something or nothing."""

from __future__ import annotations

import re
from collections.abc import Iterator
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.inputs import LAW, PAIR
from benchmarks.soak.outcome import Attempt, Outcome, broken, refused
from benchmarks.soak.running import Done
from benchmarks.soak.trying import tried

TARGETS = (
    "c", "fortran", "python", "julia", "javascript", "octave", "csv", "json", "lammps", "liggghts", "yade",
    "openfoam", "mfix", "openlb", "walberla", "lethe", "liggghts-pfm", "mfc",
)  # fmt: skip
_NUMBER = re.compile(r"(?<![\w.])[-+]?(nan|inf)(?![\w(])", re.IGNORECASE)


def exported(done: Done) -> Outcome:
    """Refused, or a text without a number that is none (comments, and names of functions, may have the words)."""
    if (bad := broken(done)) is not None:
        return bad
    if done.status != 0:
        return refused(done)
    file = done.folder / "out.txt"
    if file.exists() and (found := _NUMBER.search(re.sub(r"(//|#|!|%).*", "", file.read_text("utf-8")))):
        return Outcome("silent", f"no number in the export: {found.group()!r}")
    return Outcome("clean")


def exports(random: Random) -> Iterator[Attempt]:
    """Laws, fits edited by hand and cases, for other programs, with options that mean something or nothing."""
    wrong = ("0", "-1", "nan", "inf", "1e308", "1e-320", "x", "", "1_0")
    while True:
        to = random.choice(TARGETS)
        options = [
            option
            for name in ("--speed", "--cells", "--modulus", "--within", "--st-range", "--e-dry")
            if random.random() < 0.4
            for option in (name, random.choice((*wrong, "1:2", "9:1", "0.5", "12")))
        ]
        level = ("--level", random.choice("012")) if random.random() < 0.5 else ()
        law = random.choice(("eq4_exponential", "legendre_2005", "two_way_lubrication", "brenner_1961", "nothing"))
        command = ("export", law, "--to", to, *PAIR, *options, *level, "--out", "out.txt")
        yield tried(f"export {' '.join((law, to, *options, *level))[:60]}", {}, command, exported)
        constant = f"K={random.choice(wrong)}"
        yield tried(f"export {constant} to {to}", {}, ("export", LAW[1], constant, "--to", to, *PAIR, "--out",
            "out.txt"), exported)  # fmt: skip
        text = inputs.spoiled(inputs.CASE, random)
        solver = random.choice(("walberla", "lethe"))
        yield tried(f"case at random to {solver}", {"case.toml": text},
            ("cases", "export", "case.toml", "--to", solver, "--out", "out.txt"), exported)  # fmt: skip
