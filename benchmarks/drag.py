"""Drag and force noise of a sphere held in a stream, against the towing experiments of Roos & Willmarth (1971).

    python -m benchmarks.drag [--fast] [--rates NAME ...] [--only TEXT] [--json FILE]

The stream goes along x from an inlet to an outlet, 0.6 of the box's width ahead of the sphere and 0.9 behind it;
the sides are free-slip. Below the Reynolds number of 212 at which a wake loses its axis of symmetry a quarter of
the box is enough, above it a half, for the wake of Re 300 has a plane of symmetry (Johnson & Patel, J. Fluid Mech.
378 (1999) 19). The flow starts from that of an inviscid fluid, so that it makes little sound.

What the box adds falls with the square of its width at given proportions: two widths, at 8 cells a diameter, give
the share that is taken off. The order is that of the differences between 8, 12 and 16 cells at one lattice speed.
Each figure is written as soon as it is measured; a second call measures what is missing.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table
from scipy.optimize import brentq

from benchmarks.collisions import CANDIDATES
from lbm import DivergenceError, Inlet, Simulation
from lbm.problems.held_sphere import inviscid
from lbm.spheres import Sphere, Spheres
from restitution import datasets
from restitution.files import write_whole

RATES = ("balanced",)
"""What cases have far from walls."""
UNSTEADY = 212.0
"""Reynolds number from which a wake has no axis: Natarajan & Acrivos, J. Fluid Mech. 254 (1993) 323."""
CUT = 1.0
"""Force that changes faster, in f d/U, is noise: seven times the frequency of shedding at Re 300, 0.137."""


@dataclass(frozen=True)
class Stream:
    """A sphere held in a stream: what is set."""

    rates: str
    reynolds: float
    diameter: int
    width: float = 5.0
    speed: float = 0.05
    place: float = 0.0
    """Along the stream, in cells."""
    until: float = 16.0
    """In d/U."""
    part: int = 0
    """Half or a quarter of the box as 2 or 4, the whole as 1; by Reynolds number as 0."""

    @property
    def name(self) -> str:
        """What distinguishes it."""
        part = f", 1/{self.part}" if self.part else ""
        return (
            f"{self.rates}: Re {self.reynolds:g}, d {self.diameter}, width {self.width:g} d, "
            f"U {self.speed:g}, place {self.place:g}, until {self.until:g} d/U{part}"
        )


def forces(stream: Stream) -> np.ndarray:
    """Drag coefficient at each step."""
    d, u, part = stream.diameter, stream.speed, stream.part or (2 if stream.reynolds > UNSTEADY else 4)
    wide = round(stream.width * d)
    across = (wide // (2 if part > 1 else 1), wide // (2 if part > 3 else 1))
    shape = (round(1.5 * stream.width * d), *across)
    y, z = np.where([part > 1, part > 3], 0, np.array(across) / 2 + (0.2, 0.3))
    centre = np.array([round(0.6 * stream.width * d) + stream.place, y, z])
    faces = {"x-": Inlet((u, 0, 0)), "x+": "outlet", "y": "free-slip", "z": "free-slip"}
    flow = Simulation(shape, CANDIDATES[stream.rates](u * d / stream.reynolds), faces=faces, dtype="float32")
    flow.set_flow(*inviscid(shape, centre, d / 2, u))
    ball = Spheres([Sphere(d / 2, 1.0, tuple(centre))], drive=lambda step, gap: (0.0, 0.0, 0.0))
    flow.add(ball)
    flow.run(round(stream.until * d / u))
    return ball.track()["fx"] / (0.5 * u**2 * np.pi / 4 * d**2)


def measured(stream: Stream) -> dict[str, float | str]:
    """C_D over the last quarter of the time, how far the one before was from it, spread and noise of the last."""
    try:
        found = forces(stream)
    except DivergenceError as error:
        return {"diverged": str(error).split(";")[0]}
    n = len(found) // 4
    last, before = found[-n:], found[-2 * n : -n]
    drag = float(last.mean())
    return {
        "C_D": drag,
        "settled": float(before.mean()) / drag - 1,
        "spread": float(last.std()) / drag,
        "noise": noise(last, stream.diameter / stream.speed) / drag,
    }


def noise(values: np.ndarray, time: float) -> float:
    """rms of what changes faster than :data:`CUT`; ``time`` is d/U in steps."""
    window = np.hanning(len(values))
    trend = np.polyval(np.polyfit(np.linspace(-1, 1, len(values)), values, 3), np.linspace(-1, 1, len(values)))
    power = np.abs(np.fft.rfft((values - trend) * window)) ** 2
    power[np.fft.rfftfreq(len(values)) * time < CUT] = 0
    return math.sqrt(2 * power.sum() / len(values) / (window**2).sum())


def towed(reynolds: float) -> tuple[float, float]:
    """C_D by the 47 points of Roos & Willmarth at Re 10 to 400 and its relative standard error.

    The logarithm of C_D as a polynomial of the second degree in that of Re.
    """
    table = datasets.load("roos_willmarth1971")
    table = table[table.reynolds.between(10, 400)]
    fit, covariance = np.polyfit(np.log(table.reynolds / 80), np.log(table.drag_coefficient), 2, cov=True)
    powers = np.vander([math.log(reynolds / 80)], 3)[0]
    return math.exp(powers @ fit), math.sqrt(powers @ covariance @ powers)


STEADY = (100.0, 20.0, 164.0, 50.0)
SHEDDING = 300.0
COARSE, MIDDLE, FINE = 8, 12, 16
NARROW, WIDE = 5.0, 7.5


def streams(rates: str) -> list[Stream]:
    """All that is measured with these rates."""
    boxes = ((COARSE, NARROW), (COARSE, WIDE), (MIDDLE, NARROW), (FINE, NARROW))
    steady = [Stream(rates, re, d, width=width) for re in STEADY for d, width in boxes]
    whole = Stream(rates, 100.0, COARSE, speed=0.08, until=32.0, part=1)
    shedding = [
        Stream(rates, SHEDDING, d, width=width, speed=0.08, until=40.0) for d, width in (*boxes, (10, NARROW))
    ]
    return [*steady, whole, *shedding]


FAST = ((220.0, 10), (250.0, 10), (300.0, 10), (400.0, 8), (800.0, 8))
"""Reynolds number and cells: 22 to 100 a cell."""


def fast(rates: str) -> list[Stream]:
    """Fast streams in a small quarter of a box: what noise there is, and whether the flow stays together."""
    return [Stream(rates, re, d, width=4.0, speed=0.08, until=32.0, part=4) for re, d in FAST]


def free_of_box(narrow: float, wide: float) -> float:
    """C_D without a box over that in the narrow one."""
    a, b = NARROW**-2, WIDE**-2
    return (wide * a - narrow * b) / (a - b) / narrow


def order(coarse: float, middle: float, fine: float) -> float:
    """Of the differences between three grids; NaN where they do not shrink as a power of the cell."""
    ratio = (coarse - middle) / (middle - fine)

    def missed(p: float) -> float:
        return (COARSE**-p - MIDDLE**-p) / (MIDDLE**-p - FINE**-p) - ratio

    return brentq(missed, 0.1, 6) if missed(0.1) * missed(6) < 0 else math.nan


def main() -> None:
    """Measure what is missing, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rates", nargs="+", choices=CANDIDATES, metavar="NAME", default=RATES)
    parser.add_argument("--fast", action="store_true", help="fast streams alone")
    parser.add_argument("--only", metavar="TEXT", default="", help="streams with this in their name")
    parser.add_argument("--json", type=Path, default=Path("benchmarks/drag.json"))
    arguments = parser.parse_args()
    console = Console(width=150)
    known = json.loads(arguments.json.read_text()) if arguments.json.exists() else {}
    chosen = fast if arguments.fast else streams
    wanted = [s for rates in arguments.rates for s in chosen(rates) if arguments.only in s.name]
    for stream in track([s for s in wanted if s.name not in known], "measuring", console=console):
        known[stream.name] = measured(stream)
        write_whole(arguments.json, json.dumps(known, indent=1) + "\n")
    _show(known, arguments.rates, console)


def _show(known: dict[str, dict], rates: list[str], console: Console) -> None:
    every = Table("stream", "figures")
    for name, figures in known.items():
        every.add_row(
            name, ", ".join(f"{k} {v if isinstance(v, str) else format(v, '.4g')}" for k, v in figures.items())
        )
    table = Table("rates", "Re", "cells", "C_D without box", "measured", "error", "standard error", "order")
    for name, re in itertools.product(rates, (*STEADY, SHEDDING)):
        own = {
            (s.diameter, s.width): known[s.name]["C_D"]
            for s in streams(name)
            if s.reynolds == re and s.part == 0 and "C_D" in known.get(s.name, {})
        }
        if not {(COARSE, NARROW), (COARSE, WIDE)} <= own.keys():
            continue  # the share of the box is not known where the coarsest grid diverges
        finest = max(d for d, width in own if width == NARROW)
        drag = own[finest, NARROW] * free_of_box(own[COARSE, NARROW], own[COARSE, WIDE])
        grids = [own.get((d, NARROW), math.nan) for d in (COARSE, MIDDLE, FINE)]
        expected, sigma = towed(re)
        table.add_row(
            name, f"{re:g}", f"{finest}", f"{drag:.4f}", f"{expected:.4f}", f"{drag / expected - 1:+.1%}",
            f"{sigma:.1%}", f"{order(*grids):.2f}",
        )  # fmt: skip
    console.print(every, table)


if __name__ == "__main__":
    main()
