"""Camera tracks and conditions, spoiled by hand and at random."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.outcome import Attempt, noted
from benchmarks.soak.trying import may, names, tried

IMPACTS_OF = ("impacts", "track.csv", "--conditions", "conditions.toml", "--out", "out.csv")


def tracks(random: Random) -> Iterator[Attempt]:
    """Camera tracks."""
    good = inputs.track()
    about = {"conditions.toml": inputs.CONDITIONS}
    for cell, column in product(inputs.WORSE, (0, 1)):
        bad = {"track.csv": inputs.with_cell(good, 7, column, cell)} | about
        # an empty cell, or nan, is a lost frame
        yield tried(f"track cell {cell[:9]!r}", bad, IMPACTS_OF, may("track.csv"))
    floods = {"rows": "time_s,gap_m\n" + "".join(f"{k},{k}x\n" for k in range(100_000)),
              "columns": ",".join(f"c{k}" for k in range(200_000)) + "\n", "empty": "", "header": "time_s,gap_m\n",
              "digits": f"time_s,gap_m\n0,{'9' * 5000}\n",
              "backwards": "\n".join(good.splitlines()[:1] + good.splitlines()[:0:-1])}  # fmt: skip
    for name, text in floods.items():
        yield tried(f"track {name}", {"track.csv": text} | about, IMPACTS_OF, names("track.csv", left=["out.csv"]))
    scaled = "time_s,gap_m\n" + "".join(
        f"{t},{float(gap) * 1e200:g}\n" for t, gap in (line.split(",") for line in good.splitlines()[1:])
    )
    yield tried("track of gaps of 1e200 m", {"track.csv": scaled} | about, IMPACTS_OF, may("track.csv"))
    while True:
        yield tried(
            "track at random", {"track.csv": inputs.spoiled(good, random)} | about, IMPACTS_OF, may("track.csv")
        )


def conditions(random: Random) -> Iterator[Attempt]:
    """Conditions in TOML."""
    track = {"track.csv": inputs.track()}
    for change, field in (("density = 7800.0", "density = 800.0"), ("viscosity = 0.01", "viscosity = 10.0"),
                          ("viscosity = 0.01", "viscosity = 1e-12"), ("diameter = 0.003",
                          "diameter = 3.0")):  # fmt: skip
        text = inputs.CONDITIONS.replace(change, field)
        yield tried(f"conditions with {field}", {"conditions.toml": text} | track, IMPACTS_OF, noted)
    whole = {"deep": "a = " + "[" * 2000 + "]" * 2000, "dotted": "a." * 30_000 + "a = 1", "empty": "",
             "digits": f"a = {'9' * 5000}", "hexadecimal": f"a = 0x{'f' * 6000}", "twice": inputs.CONDITIONS * 2,
             "latin": inputs.CONDITIONS.replace("[", "# \udce9\n[", 1)}  # fmt: skip
    for name, text in whole.items():
        yield tried(
            f"conditions {name}",
            {"conditions.toml": text} | track,
            IMPACTS_OF,
            names("conditions.toml", left=["out.csv"]),
        )
    lines = [line.split(" = ")[0] for line in inputs.CONDITIONS.splitlines() if " = " in line]
    choices = list(product(lines, inputs.WORSE_TOML))
    random.shuffle(choices)
    for field, value in choices[:20]:
        text = re.sub(rf"\b{field} = .*", f"{field} = {value}", inputs.CONDITIONS, count=1)
        yield tried(
            f"conditions {field} = {value[:9]}",
            {"conditions.toml": text} | track,
            IMPACTS_OF,
            names("conditions.toml"),
        )
    while True:
        text = inputs.spoiled(inputs.CONDITIONS, random)
        yield tried("conditions at random", {"conditions.toml": text} | track, IMPACTS_OF, may("conditions.toml"))
