"""How fast ten Cate's slowest sphere can fall in its tank: resolved at Re 1.4, and in creeping flow.

    python -m benchmarks.tank [CELLS ...]

Case E1 of ten Cate et al. 2002: 15 mm, in a tank of 100 x 100 x 160 mm; a quarter of it. Speeds are over the
terminal one of the source, 0.038 m/s: of the sphere released 120 mm above the floor the greatest within 1.5 s; of
one that creeps (Re 0.1 without walls, from the middle of the tank) the settled one, as if Stokes' law held of the
sphere of E1. Creeping in an infinitely long square duct of half-width l it is

    U/U_Stokes = 1 - 1.903266 a/l + ...      (Happel & Bart, Appl. Sci. Res. 29 (1974) 241)

The next term, of a circular cylinder, is + 2.0865 (a/l)^3 (Haberman & Sayre, DTMB Report 1143, 1958). Neither
paper was opened: the numbers are those by which others quote them.
"""

from __future__ import annotations

import argparse
import math

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.collisions import CANDIDATES
from lbm import Simulation
from lbm.spheres import Sphere, Spheres
from restitution import datasets

RECORD = datasets.resource("tencate2002_e1_gap")
FLUID, SPHERE = RECORD.conditions.fluid, RECORD.conditions.sphere
TERMINAL = RECORD.quoted["terminal_speed_m_s"]
WIDTH, HEIGHT, RELEASE = 0.1, 0.16, 0.12
"""Of the tank, and of the sphere's lowest point over its floor, in m."""
RATES = ("two-relaxation-times", "balanced-by-place", "quiet-by-place, reach 6, blend 0")
RATIO = SPHERE.density / FLUID.density
STOKES = 9.81 * (SPHERE.density - FLUID.density) * SPHERE.diameter**2 / (18 * FLUID.viscosity)
"""Terminal speed in m/s by Stokes' law, without walls."""


def falling(
    cells: float, viscosity: float, gravity: float, height: float, rates: str
) -> tuple[Simulation, Spheres]:
    """A quarter of the tank in lattice units, the sphere ``height`` cells above its floor."""
    wide, high = (round(n * cells / SPHERE.diameter) for n in (WIDTH / 2, HEIGHT))
    faces = {"x-": "free-slip", "y-": "free-slip", "x+": "no-slip", "y+": "no-slip", "z": "no-slip"}
    flow = Simulation((wide, wide, high), CANDIDATES[rates](viscosity), faces=faces, dtype="float32")
    ball = Spheres([Sphere(cells / 2, RATIO, (0.0, 0.0, height + cells / 2))], gravity=(0.0, 0.0, -gravity))
    flow.add(ball)
    return flow, ball


def greatest(cells: float, lattice_speed: float, rates: str, duration: float = 1.5) -> float:
    """Greatest speed within ``duration`` s of the release, the mean over a cell of way, over the terminal one."""
    cell = SPHERE.diameter / cells
    step = lattice_speed / TERMINAL * cell
    viscosity = FLUID.viscosity / FLUID.density * step / cell**2
    flow, ball = falling(cells, viscosity, 9.81 * step**2 / cell, RELEASE / cell, rates)
    flow.run(round(duration / step))
    window = np.full(round(1 / lattice_speed), lattice_speed)
    return float(np.convolve(-ball.track()["vz"], window, "valid").max()) / lattice_speed


def creeping(cells: float, rates: str = RATES[0], viscosity: float = 0.12, reynolds: float = 0.1) -> float:
    """Settled speed over that of Stokes without walls, which is ``reynolds`` viscosity/cells in lattice units."""
    stokes = reynolds * viscosity / cells
    middle = (HEIGHT / SPHERE.diameter * cells - cells) / 2 + 0.3
    flow, ball = falling(cells, viscosity, 18 * viscosity * stokes / (cells**2 * (RATIO - 1)), middle, rates)
    slowest = (WIDTH / SPHERE.diameter * cells) ** 2 / (2 * math.pi**2 * viscosity)
    flow.run(round(3.5 * slowest))
    return -float(ball.track()["vz"][-1]) / stokes


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cells", nargs="*", type=float, default=[9.0, 12.0], help="a diameter")
    console, table = (
        Console(width=110),
        Table("flow", "cells", "lattice speed", "rates", "over the terminal speed"),
    )
    runs = [
        (cells, speed, rates)
        for cells in parser.parse_args().cells
        for speed, rates in ((None, RATES[0]), *((0.02, rates) for rates in RATES), (0.01, RATES[0]))
    ]
    for cells, speed, rates in track(runs, "runs", console=console, transient=True):
        if speed is None:
            share = creeping(cells, rates)
            shown = f"{share * STOKES / TERMINAL:.4f} ({share:.4f} of Stokes' speed without walls)"
            table.add_row("creeping", f"{cells:g}", "", rates, shown)
        else:
            table.add_row("E1", f"{cells:g}", f"{speed:g}", rates, f"{greatest(cells, speed, rates):.4f}")
    duct = 1 - 1.903266 * SPHERE.diameter / WIDTH
    for name, share in (("first term", duct), ("with Haberman's", duct + 2.0865 * (SPHERE.diameter / WIDTH) ** 3)):
        table.add_row("creeping, duct", "", "", name, f"{share * STOKES / TERMINAL:.4f} ({share:.4f})")
    table.add_row("measured", "", "", "", f"{RECORD.quoted['maximum_over_terminal_speed']:.3f}")
    console.print(table)


if __name__ == "__main__":
    main()
