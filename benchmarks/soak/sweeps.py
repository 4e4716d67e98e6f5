"""Sweeps stopped at any moment; their files, spoiled by hand and at random."""

from __future__ import annotations

import re
import signal
from collections.abc import Iterator
from itertools import product
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.kills import nothing_left
from benchmarks.soak.outcome import CLEAN, Attempt, Outcome, broken, either, sound
from benchmarks.soak.running import Workshop
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


MADE = ("sweep", "sweep.toml", "--out", "out", "--processes", "2")


def stops(random: Random) -> Iterator[Attempt]:
    """A sweep of eight runs stopped once or twice at random, then called again: the table of one that was not."""
    whole: list[bytes] = []
    while True:
        signals = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
        chain = [(random.uniform(0.5, 9), random.choice(signals)) for _ in range(random.randint(1, 2))]
        name = "sweep stopped by " + ", ".join(f"{n.name} at {t:.1f} s" for t, n in chain)
        yield Attempt(name, lambda shop, chain=chain: stopped(shop, chain, whole))


def stopped(shop: Workshop, chain: list, whole: list[bytes]) -> Outcome:
    """One chain of stops, and the call that ends the sweep; ``whole`` keeps the table of a sweep never stopped."""
    shop.write("case.toml", inputs.CASE)
    shop.write("sweep.toml", SWEEP.replace("runs = 3", "runs = 8"))
    if not whole:
        if (outcome := sound(shop.process(*MADE[:3], "whole", *MADE[4:]))).kind != "clean":
            return outcome
        whole.append((shop.folder / "whole" / "impacts.csv").read_bytes())
    for after, number in chain:
        done = shop.stop(shop.start(*MADE), after, number)
        if done.status not in (0, 130, -number) or "Traceback" in done.err:
            return broken(done) or Outcome("unclear", f"status {done.status}: {done.err[-200:]!r}")
    if (outcome := sound(shop.process(*MADE))).kind != "clean":
        return outcome
    if (shop.folder / "out" / "impacts.csv").read_bytes() != whole[0]:
        return Outcome("silent", "another table of impacts after the sweep was stopped")
    return nothing_left(shop.folder / "out") or CLEAN
