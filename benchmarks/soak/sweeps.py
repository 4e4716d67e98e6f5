"""Files of sweeps, spoiled by hand and at random."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.outcome import Attempt, either
from benchmarks.soak.trying import may, names, tried

SWEEP = """\
base = "case"
models = ["point particle"]
design = "latin hypercube"
runs = 3
seed = 1
[case]
run.after_contact = 0.05
[vary]
sphere.e_dry = { from = 0.8, to = 0.97 }
fluid.viscosity = { from = "40 mPa s", to = "60 mPa s", scale = "log" }
"""


def sweeps(random: Random) -> Iterator[Attempt]:
    """Files of sweeps: listed, as nothing is run; some of them made by the point particle."""
    command = ("sweep", "sweep.toml", "--list")
    lines = [line.split(" = ")[0] for line in SWEEP.splitlines() if " = " in line]
    choices = list(product((*lines, "nothing", "sphere.nothing", "St", "name"), inputs.WORSE_TOML))
    random.shuffle(choices)
    for value in (10**7, 10**12, -1, "0x" + "f" * 6000):
        text = SWEEP.replace("runs = 3", f"runs = {value}")
        yield tried(f"sweep of {value!s:.9} runs", {"case.toml": inputs.CASE, "sweep.toml": text}, command,
            names("sweep.toml"))  # fmt: skip
    for field, value in choices[:16]:
        text = re.sub(rf"(?m)^{re.escape(field)} = .*\n", "", SWEEP) + f"{field} = {value}\n"
        yield tried(f"sweep {field} = {value[:9]}", {"case.toml": inputs.CASE, "sweep.toml": text}, command, may())
    made = ("sweep", "sweep.toml", "--out", "out", "--processes", "1")
    yield tried("sweep of the point particle", {"case.toml": inputs.CASE, "sweep.toml": SWEEP}, made, either)
    while True:
        text = inputs.spoiled(SWEEP, random)
        yield tried("sweep at random", {"case.toml": inputs.CASE, "sweep.toml": text}, command, may())
        case = inputs.spoiled(inputs.CASE, random)
        yield tried("sweep of a case at random", {"case.toml": case, "sweep.toml": SWEEP}, command, may())
