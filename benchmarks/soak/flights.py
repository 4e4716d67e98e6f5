"""Trajectories scored and fitted whole, and the settings that say what their numbers mean."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import product
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.impacts import FIT
from benchmarks.soak.inputs import LAW
from benchmarks.soak.outcome import Attempt, Outcome, broken, either
from benchmarks.soak.running import Done
from benchmarks.soak.trying import may, tried

SETTINGS = """\
time = "time_s"
position = "gap_m"
time_unit = "s"
unit = "m"
direction = "up"
wall = 0.0
point = "lowest"
"""
SCORE = ("validate", "--trajectory", "track.csv", "--case", "gondret-st152", "--out", "card")


def either_or_worse(*texts: str) -> Callable[[Done], Outcome]:
    """A score may say that a trajectory disagrees, by its status."""

    def judge(done: Done) -> Outcome:
        if done.status in (1, 3):
            return broken(Done(0, done.out, done.err, done.folder, done.late)) or Outcome("clean")
        return either(done, texts)

    return judge


def trajectories(random: Random) -> Iterator[Attempt]:
    """Trajectories scored against a record."""
    good, judge = inputs.track(), either_or_worse("track")
    for option in (("--unit", "0mm"), ("--unit", "parsec"), ("--time-unit", "-1s"), ("--fps", "nan"),
                   ("--wall", "x"),
                   ("--grid-error", "-1"), ("--grid-error", "nan"), ("--first-contact", "inf"),
                   ("--pixel", "1e999mm"),
                   ("--case", "nothing"), ("--name", "a\x1b[31m"), ("--name", "a", "b"), ("--particle", "x"),
                   ("--direction", "down"), ("--depth", "full"), ("--only", "couette"),
                   ("--bless", "x")):  # fmt: skip
        yield tried(f"score {' '.join(option)!r}", {"track.csv": good}, (*SCORE, *option), either_or_worse())
    for factor in (1e-200, 1e-6, 1e3, 1e200):
        rows = (line.split(",") for line in good.splitlines()[1:])
        text = "time_s,gap_m\n" + "".join(f"{t},{float(gap) * factor:g}\n" for t, gap in rows)
        yield tried(f"score of gaps times {factor:g}", {"track.csv": text}, SCORE, judge)
    yield tried("score of a fall alone", {"track.csv": "\n".join(good.splitlines()[:8]) + "\n"}, SCORE, judge)
    yield tried("score of a sphere at rest", {"track.csv": "time_s,gap_m\n" + "".join(
        f"{k * 0.001},0.01\n" for k in range(99))}, SCORE, judge)  # fmt: skip
    while True:
        yield tried("score at random", {"track.csv": inputs.spoiled(good, random)}, SCORE, judge)


def settings(random: Random) -> Iterator[Attempt]:
    """Settings files of tracks."""
    command = ("impacts", "track.csv", "--conditions", "conditions.toml", "--settings", "settings.toml")
    files = {"track.csv": inputs.track(), "conditions.toml": inputs.CONDITIONS}
    lines = [line.split(" = ")[0] for line in SETTINGS.splitlines()]
    choices = list(
        product((*lines, "frames_per_second", "pixel", "decimal", "release", "nothing"), inputs.WORSE_TOML)
    )
    random.shuffle(choices)
    for field, value in choices[:20]:
        text = re.sub(rf"(?m)^{field} = .*\n", "", SETTINGS) + f"{field} = {value}\n"
        yield tried(f"settings {field} = {value[:9]}", files | {"settings.toml": text}, command, may())
    while True:
        text = inputs.spoiled(SETTINGS, random)
        yield tried("settings at random", files | {"settings.toml": text}, command, may())


def whole_flights(random: Random) -> Iterator[Attempt]:
    """Fits to whole trajectories, with priors, starts, films and releases of all kinds."""
    files = {"track.csv": inputs.track(), "conditions.toml": inputs.CONDITIONS, "impacts.csv": inputs.IMPACTS}
    begin = ("fit", "track.csv", "--conditions", "conditions.toml", "--trajectory", "--wake", "off")
    options = [
        ("--release", "x"), ("--release", "-3mm"), ("--release", "1e300m"), ("--release", "0mm"),
        ("--release", "3"),
        ("--film", "--release", "nan"), ("--film", "--start", "K=nan"), ("--start", "nothing=1"),
        ("--start", "K=1_0"),
        ("--prior", "fit.json"), ("--prior", "none.json"), ("--prior", "track.csv"), ("--edge", "1e9"),
        ("--edge", "nan"),
        ("--wall", "1e300"), ("--unit", "1e-300m"), ("--time-unit", "1e300s"), ("--fps", "0"),
        ("--law", "eq4_rational"),
    ]  # fmt: skip
    for option in options:
        yield tried(
            f"flight {' '.join(option)}", files, (*begin, *option), may(), FIT if "fit.json" in option else ()
        )
    by_impacts = ("fit", "impacts.csv", *LAW)
    for option in (("--start", "K=-5"), ("--start", "K=nan"), ("--start", "K=1e300"), ("--prior", "fit.json"),
                   ("--prior", "fit.json", "--prior", "K=18+-1"), ("--prior", "conditions.toml"), ("--film",),
                   ("--release", "3mm")):  # fmt: skip
        yield tried(f"fit {' '.join(option)}", files, (*by_impacts, *option), may(), FIT)
    while True:
        text = inputs.spoiled(inputs.track(), random)
        yield tried("flight at random", files | {"track.csv": text}, begin, may("track.csv"))
