"""What a moving sphere costs over the fluid's own step, and what two steps at once and a quarter of the box save.

    python -m benchmarks.sphere_cost [--rounds 15] [--precision float64] [--json FILE]

Each round times, one after the other, the bare step, the step with the sphere, its parts, a step of two made at
once, and lbmpy's kernels (:mod:`benchmarks.peers`) for as many cells of fluid alone; the table has medians of the
rounds' own ratios. The bare fluid makes one step a sweep; rates are those of cases.
"""

from __future__ import annotations

import argparse
import itertools
import json
import time
from pathlib import Path

import numba
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.peers import lbmpy_steps
from lbm import Body, RatesByPlace, Simulation
from lbm.spheres import Sphere, Spheres
from restitution.files import write_whole

BOXES = {
    "10": (10, (80, 80, 240)),
    "10, a quarter": (10, (40, 40, 240)),
    "20": (20, (160, 160, 480)),
    "20, a quarter": (20, (80, 80, 480)),
}
"""Cells of the diameter and of the box."""
TARGETS = {10: 0.15, 20: 0.10}
PRECISIONS = ("float32", "float64")
_STEPS = 10


class _Timed(Body):
    """A body whose calls are timed; it says what it reaches only if two steps are to be made at once."""

    def __init__(self, body, at_once=False):
        self.body, self.at_once, self.seconds = body, at_once, 0.0

    def __call__(self, lattice, step, force):
        start = time.perf_counter()
        self.body(lattice, step, force)
        self.seconds += time.perf_counter() - start

    def reach(self, lattice):
        return self.body.reach(lattice) if self.at_once else None

    def describe(self) -> dict:
        return {}


def measure(name: str, rounds: int, precision: str) -> dict:
    """Seconds a step, the shares of the sphere and of its kernels in the bare step, the speed over lbmpy's."""
    diameter, shape = BOXES[name]
    sides = {"x": "free-slip", "y": "free-slip"} if "quarter" in name else {}
    place = (0, 0) if sides else (shape[0] / 2 + 0.17, shape[1] / 2 + 0.17)
    bodies = [_Timed(lambda lattice, step, force: None)]
    for at_once in (False, True):
        sphere = Sphere(diameter / 2, 8.0, (*place, shape[2] / 2 + 0.17), velocity=(0.0, 0.0, -0.05))
        bodies.append(_Timed(Spheres([sphere], gravity=(0.0, 0.0, -1e-5)), at_once))
    flows = []
    for body in bodies:
        flow = Simulation(shape, RatesByPlace.balanced(0.02), faces={"z": "no-slip", **sides}, dtype=precision)
        if flows:
            flow.lattice.populations = flows[0].lattice.populations  # the same memory for all
        flow.add(body)
        flow.run(2)
        flows.append(flow)
    edge = round(np.prod(shape) ** (1 / 3))
    peers = list(lbmpy_steps(edge, np.dtype(precision), numba.get_num_threads()).values())
    same_cells = np.prod(shape) / edge**3
    seconds = []
    for _ in range(rounds):
        times = []
        bodies[1].seconds = 0.0
        for flow in flows:
            start = time.perf_counter()
            flow._advance(flow.steps + _STEPS)
            times.append(time.perf_counter() - start)
        theirs = []
        for two_steps in peers:
            start = time.perf_counter()
            for _ in range(_STEPS // 2):
                two_steps()
            theirs.append((time.perf_counter() - start) * same_cells)
        seconds.append((*times, bodies[1].seconds, min(theirs, default=np.nan)))
    plain, whole, twice, own, peer = np.array(seconds).T / _STEPS
    return {
        "name": name,
        "diameter": diameter,
        "shape": list(shape),
        "threads": numba.get_num_threads(),
        "bare_step_s": float(np.median(plain)),
        "mlups": float(np.prod(shape) / np.median(plain) / 1e6),
        "sphere_s": float(np.median(own)),
        "sphere_share": float(np.median(own / plain)),
        "step_ratio": float(np.median(whole / plain)),
        "at_once_s": float(np.median(twice)),
        "at_once_gain": float(np.median(whole / twice)),
        "over_lbmpy": float(np.median(peer / twice)) if peers else None,
        "precision": precision,
        "target": TARGETS[diameter],
    }


def main() -> None:
    """Measure, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--box", nargs="+", choices=BOXES, default=list(BOXES))
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--precision", nargs="+", choices=PRECISIONS, default=list(PRECISIONS))
    parser.add_argument("--json", type=Path, default=Path("benchmarks/sphere_cost.json"))
    arguments = parser.parse_args()
    table = Table(
        "d", "box", "precision", "threads", "bare step", "sphere", "sphere / bare", "step / bare", "target",
        "of two at once", "gain", "over lbmpy",
    )  # fmt: skip
    results = []
    for name, precision in itertools.product(arguments.box, arguments.precision):
        row = measure(name, arguments.rounds, precision)
        results.append(row)
        table.add_row(
            name, " x ".join(map(str, row["shape"])), precision, str(row["threads"]),
            f"{row['bare_step_s'] * 1e3:.2f} ms", f"{row['sphere_s'] * 1e3:.3f} ms",
            f"{row['sphere_share']:.1%}", f"{row['step_ratio']:.3f}", f"{row['target']:.0%}",
            f"{row['at_once_s'] * 1e3:.2f} ms", f"{row['at_once_gain']:.2f}",
            "" if row["over_lbmpy"] is None else f"{row['over_lbmpy']:.2f}",
        )  # fmt: skip
    Console(width=115).print(table)
    write_whole(arguments.json, json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
