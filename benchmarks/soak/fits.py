"""Numbers that are well formed and yet strange: fits and simulations of them are refused, or finite."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.kills import SHORT
from benchmarks.soak.outcome import Attempt, Outcome, either, refused
from benchmarks.soak.running import Workshop
from benchmarks.soak.trying import tried

HEADS = (
    "source,stokes,stokes_sigma,e_eff,e_eff_sigma,outcome,e_eff_upper,e_dry,stokes_convention,speed_definition\n"
)


def rows(points) -> str:
    """A table of impacts of (St, e, sigma) or, without a rebound, (St, None, limit)."""
    lines = [
        f"A,{St:g},,{e:g},{s:g},rebound,,0.97,st,far\n"
        if e is not None
        else f"A,{St:g},,,,no_rebound,{s:g},0.97,st,far\n"
        for St, e, s in points
    ]
    return HEADS + "".join(lines)


def points(random: Random) -> Iterator[Attempt]:
    """Few, equal, flat, stuck, censored, exact, wild, beyond one and below nought."""
    line = [(St, 0.97 * 2.718281828 ** (-34 / St), 0.02) for St in (15, 25, 40, 70, 120, 200, 400)]
    sets = {
        "one": line[:1], "two": line[:2], "none": [], "all at one St": [(50, 0.5, 0.02)] * 5, "flat": [(St, 0.5,
        0.02) for St, _, _ in line],
        "all nought": [(St, 0.0, 0.02) for St, _, _ in line], "above one": [(St, 1.2, 0.02) for St, _, _ in line],
        "below nought": [(St, -0.2, 0.02) for St, _, _ in line], "limits alone": [(St, None, 0.05) for St, _,
        _ in line],
        "without errors": [(St, e, 0.0) for St, e, _ in line], "errors of 1e-12": [(St, e, 1e-12) for St, e,
        _ in line],
        "errors of 1e6": [(St, e, 1e6) for St, e, _ in line], "St of 1e-9": [(St * 1e-9, e, s) for St, e,
        s in line],
        "St of 1e12": [(St * 1e12, e, s) for St, e, s in line], "falling": [(St, 1 - e, s) for St, e, s in line],
        "the same point": [(50, 0.5, 0.02)], "one outlier": [*line[:-1], (400, 0.0, 0.02)],
    }  # fmt: skip
    ways = ((*inputs.LAW,), (*inputs.LAW, "--robust"), ("--law", "legendre_2005"), ("--law",
        "e_dry*exp(-(a/St)**n)", "--bounds", "a=5:100", "--bounds", "n=0.3:3"))  # fmt: skip
    for name, some in sets.items():
        yield tried(f"fit of {name}", {"i.csv": rows(some)}, ("fit", "i.csv", *random.choice(ways)), either)
    while True:
        some = [
            (10 ** random.uniform(-2, 6), random.choice((random.random(), None)), 10 ** random.uniform(-6, 0))
            for _ in range(random.randint(1, 9))
        ]
        yield tried("fit at random", {"i.csv": rows(some)}, ("fit", "i.csv", *random.choice(ways)), either)


def simulations(random: Random) -> Iterator[Attempt]:
    """Densities, viscosities, sizes and drives, through the point particle, and the solver where it is short."""
    while True:
        text = inputs.CASE
        for key, low, high in (
            ("density = 7800", 0, 4.3),
            ("viscosity = 0.05", -4, 1),
            ("diameter = 0.004", -4, -1),
            ("speed = 0.5", -3, 1),
        ):
            if random.random() < 0.5:
                text = text.replace(key, f"{key.split(' = ')[0]} = {10 ** random.uniform(low, high):.3g}")
        name = ", ".join(line for line in text.splitlines() if line not in inputs.CASE.splitlines())
        yield tried(f"bounce with {name}", {"case.toml": text}, ("bounce", "case.toml", "--out", "out"), either)
        density = random.choice((1.0, 936, 1000, 2500, 20000))
        short = SHORT + f"[sphere]\ndensity = {density}\n"
        yield Attempt(f"simulate with density {density}", lambda shop, t=short: simulated(shop, t))


def simulated(shop: Workshop, text: str) -> Outcome:
    """A short simulation, or a refusal that names the case."""
    shop.write("case.toml", text)
    done = shop.process("simulate", "case.toml", "--out", "out")
    return either(done) if done.status == 0 else refused(done)
