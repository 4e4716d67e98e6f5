"""The lid-driven cavity at Re 1000, square and cubic, against spectral solutions: extrema and their order.

    python -m benchmarks.cavity [--only NAME ...] [--rates NAME ...] [--json FILE]

The lid is the face z+ and moves along x; the cube ends at its plane of symmetry. Each grid but the coarsest starts
from the flow on half as many cells. A figure is written as soon as it is measured; a second call measures what is
missing.
"""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.collisions import CANDIDATES
from lbm import DivergenceError, NoSlip, Simulation
from restitution.files import write_whole

REYNOLDS = 1000.0
SQUARE = {"least u": -0.3885698, "largest w": 0.3769447, "least w": -0.5270771}
"""O. Botella & R. Peyret, Comput. Fluids 27 (1998) 421, over the lid's speed; w on the horizontal centre line."""
CUBE = {"least u": -0.2803833, "largest w": 0.2466511, "least w": -0.4350186}
"""S. Albensoeder & H. C. Kuhlmann, J. Comput. Phys. 206 (2005) 536."""
LID_TIMES = {24: 100.0, 32: 60.0, 48: 60.0, 96: 40.0, 192: 25.0}
"""Cells over lid times that the flow is given from its start."""


@dataclass(frozen=True)
class Cavity:
    """Rates, cells along each side, ``cube`` or square, and the lid's speed."""

    rates: str
    cells: int
    cube: bool = False
    speed: float = 0.1

    @property
    def name(self) -> str:
        """What distinguishes it."""
        return f"{self.rates}: {'cube' if self.cube else 'square'}, {self.cells} cells, lid {self.speed:g}"

    @property
    def depth(self) -> int:
        """Cells along y."""
        return self.cells // 2 if self.cube else 4


def flow(cavity: Cavity, start: np.ndarray | None) -> tuple[np.ndarray, float]:
    """Velocity (3, n, depth, n) over the lid's speed; the change of the least u in the last tenth of the time."""
    n, speed = cavity.cells, cavity.speed
    faces = {"x": "no-slip", "z-": "no-slip", "z+": NoSlip((speed, 0, 0))}
    if cavity.cube:
        faces |= {"y-": "free-slip", "y+": "no-slip"}
    rates = CANDIDATES[cavity.rates](speed * n / REYNOLDS)
    run = Simulation((n, cavity.depth, n), rates, faces=faces, dtype="float32")
    if start is not None:
        for axis, times in ((1, 2), (2, 2 if cavity.cube else 1), (3, 2)):
            start = start.repeat(times, axis=axis)
        run.set_flow(velocity=speed * start)
    steps = round(LID_TIMES[n] * n / speed)
    run.run(steps - steps // 10)
    before = extrema(run.velocity / speed)["least u"]
    run.run(steps // 10)
    velocity = run.velocity / speed
    return velocity, extrema(velocity)["least u"] - before


def extrema(velocity: np.ndarray) -> dict[str, float]:
    """Extrema on the centre lines of the plane of symmetry, by a parabola through three cells."""
    n = velocity.shape[1]
    middle = slice((n - 1) // 2, n // 2 + 1)
    plane = velocity[:, :, 0]
    u, w = plane[0, middle].mean(axis=0), plane[2, :, middle].mean(axis=1)
    return {"least u": -_largest(-u), "largest w": _largest(w), "least w": -_largest(-w)}


def _largest(line: np.ndarray) -> float:
    at = int(np.argmax(line))
    through = np.polynomial.Polynomial.fit([-1, 0, 1], line[at - 1 : at + 2], 2)
    return float(through(through.deriv().roots()[0]))


def measure(rates: str, cube: bool, cells: list[int], speed: float, known: dict, save) -> None:
    """Errors of the extrema on grid after grid, as far as they are not known."""
    start, exact = None, CUBE if cube else SQUARE
    grids = [Cavity(rates, n, cube, speed) for n in cells]
    if all(grid.name in known for grid in grids):
        return
    for grid in grids:
        try:
            start, change = flow(grid, start)
        except DivergenceError as error:
            start, known[grid.name] = None, {"diverged": str(error).split(";")[0]}
        else:
            errors = {name: value / exact[name] - 1 for name, value in extrema(start).items()}
            known[grid.name] = errors | {"change of least u": change}
        save(known)


def main() -> None:
    """Measure what is missing, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rates", nargs="+", choices=CANDIDATES, metavar="NAME", default=["balanced", "quiet"])
    parser.add_argument("--cells", nargs="+", type=int, choices=LID_TIMES, default=[24, 48, 96])
    parser.add_argument("--speed", type=float, default=0.1, help="of the lid, in cells a step")
    parser.add_argument("--only", choices=["square", "cube"])
    parser.add_argument("--json", type=Path, default=Path("benchmarks/cavity.json"))
    arguments = parser.parse_args()
    known = json.loads(arguments.json.read_text()) if arguments.json.exists() else {}
    for cube in [kind == "cube" for kind in ("square", "cube") if arguments.only in (None, kind)]:
        for rates in arguments.rates:
            measure(
                rates, cube, arguments.cells, arguments.speed, known,
                lambda all_of_it: write_whole(arguments.json, json.dumps(all_of_it, indent=1) + "\n"),
            )  # fmt: skip
    table = Table("cavity", *SQUARE, "order", "change of least u")
    for name, figures in known.items():
        half = known.get(name.replace(f", {(n := _cells(name))} cells", f", {n // 2} cells"), {})
        if "diverged" in figures:
            table.add_row(name, figures["diverged"])
            continue
        orders = [math.log2(abs(half[e] / figures[e])) for e in SQUARE] if "least u" in half else []
        table.add_row(
            name, *(f"{figures[e]:+.2%}" for e in SQUARE), ", ".join(f"{order:.2f}" for order in orders),
            f"{figures['change of least u']:.1e}",
        )  # fmt: skip
    Console(width=150).print(table)


def _cells(name: str) -> int:
    return int(name.split(",")[1].split()[0])


if __name__ == "__main__":
    main()
