"""What a moving sphere costs over the fluid's own step, as a ratio within one run.

    python -m benchmarks.sphere_cost [--rounds 15] [--json FILE]

Each round times the bare step, the step with the sphere, and the sphere's parts, one after the other; the table
shows medians of the rounds' own ratios. float32; the bare fluid makes one step a sweep, as it does with a sphere.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numba
import numpy as np
from rich.console import Console
from rich.table import Table

from lbm import Body, Rates, Simulation
from lbm.spheres import Sphere, Spheres
from restitution.files import write_whole

BOXES = {10: (80, 80, 240), 20: (160, 160, 480)}
"""Cells of the box by cells of the diameter."""
TARGETS = {10: 0.15, 20: 0.10}
_STEPS = 10


class _Timed(Body):
    """A body whose calls are timed."""

    def __init__(self, body):
        self.body, self.seconds = body, 0.0

    def __call__(self, lattice, step, force):
        start = time.perf_counter()
        self.body(lattice, step, force)
        self.seconds += time.perf_counter() - start

    def describe(self) -> dict:
        return {}


def measure(diameter: int, shape: tuple[int, int, int], rounds: int) -> dict:
    """Seconds a step, and the shares of the sphere and of its kernels in the bare step."""
    rates = Rates.two_relaxation_times(0.02)
    bare = Simulation(shape, rates, faces={"z": "no-slip"}, dtype=np.float32)
    bare.add(_Timed(lambda lattice, step, force: None))  # a body, so that both make one step a sweep
    full = Simulation(shape, rates, faces={"z": "no-slip"}, dtype=np.float32)
    full.lattice.populations = bare.lattice.populations  # the same memory for both
    centre = tuple(n / 2 + 0.17 for n in shape)
    ball = Spheres([Sphere(diameter / 2, 8.0, centre, velocity=(0.0, 0.0, -0.05))], gravity=(0.0, 0.0, -1e-5))
    timed = _Timed(ball)
    full.add(timed)
    bare.run(2)
    full.run(2)
    seconds = []
    for _ in range(rounds):
        start = time.perf_counter()
        bare._advance(bare.steps + _STEPS)
        middle = time.perf_counter()
        timed.seconds = 0.0
        full._advance(full.steps + _STEPS)
        seconds.append((middle - start, time.perf_counter() - middle, timed.seconds))
    plain, whole, own = np.array(seconds).T / _STEPS
    return {
        "diameter": diameter,
        "shape": list(shape),
        "threads": numba.get_num_threads(),
        "bare_step_s": float(np.median(plain)),
        "mlups": float(np.prod(shape) / np.median(plain) / 1e6),
        "sphere_s": float(np.median(own)),
        "sphere_share": float(np.median(own / plain)),
        "step_ratio": float(np.median(whole / plain)),
        "target": TARGETS[diameter],
    }


def main() -> None:
    """Measure, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--diameter", type=int, nargs="+", choices=BOXES, default=list(BOXES))
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--json", type=Path, default=Path("benchmarks/sphere_cost.json"))
    arguments = parser.parse_args()
    table = Table("d", "box", "threads", "bare step", "sphere", "sphere / bare", "step / bare", "target")
    results = []
    for diameter in arguments.diameter:
        row = measure(diameter, BOXES[diameter], arguments.rounds)
        results.append(row)
        table.add_row(
            str(diameter), " x ".join(map(str, row["shape"])), str(row["threads"]),
            f"{row['bare_step_s'] * 1e3:.2f} ms", f"{row['sphere_s'] * 1e3:.3f} ms",
            f"{row['sphere_share']:.1%}", f"{row['step_ratio']:.3f}", f"{row['target']:.0%}",
        )  # fmt: skip
    Console(width=115).print(table)
    write_whole(arguments.json, json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
