"""Million lattice-cell updates per second, beside the memory's own speed and lbmpy's, in one run.

    python -m benchmarks.mlups [--cells 128 192] [--dtype float64 float32] [--rounds 30] [--json FILE]

Every round times every contestant once, one after the other, so that what disturbs the machine disturbs all
alike; the table shows medians over the rounds, and ratios as medians of the rounds' own ratios.
"""

from __future__ import annotations

import os

# Idle OpenMP threads of one contestant must not spin while another is timed.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import argparse
import json
import platform
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import numba
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.peers import lbmpy_steps
from lbm import Body, Rates, Simulation
from lbm.fluid.stencil import Q
from lbm.problems.roofline import read_and_write


class _Nothing(Body):
    """A body that leaves the fluid alone."""

    def __call__(self, lattice, step, force):
        pass

    def describe(self):
        return {}


class _SingleSteps(Simulation):
    """Makes one step a sweep, as a simulation with bodies or moving walls does."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        self.add(_Nothing())


def _contestants(n: int, dtype, threads: int) -> dict[str, Callable[[], None]]:
    """By name, a function that makes two steps (or moves the bytes of two)."""
    shape, rates = (n, n, n), Rates.dhumieres2002(0.02)
    fluids = {
        "one step a sweep": _SingleSteps(shape, rates, dtype=dtype, threads=threads),
        "one step a sweep, six walls": _SingleSteps(
            shape, rates, faces=dict.fromkeys("xyz", "no-slip"), dtype=dtype, threads=threads
        ),
        "two steps a sweep": Simulation(shape, rates, dtype=dtype, threads=threads),
        "two steps a sweep, six walls": Simulation(
            shape, rates, faces=dict.fromkeys("xyz", "no-slip"), dtype=dtype, threads=threads
        ),
    }
    # One lattice for all: the contestants differ in their faces, not in their populations.
    populations = fluids["one step a sweep"].lattice.populations
    for fluid in fluids.values():
        fluid.lattice.populations = populations
        fluid.compile()

    def memory():
        for _ in range(2):
            read_and_write(populations, populations.dtype.type(1))

    timed = {"in-place read + write": memory}
    for name, fluid in fluids.items():
        timed[name] = lambda fluid=fluid: fluid._advance(fluid.steps + 2)
    if threads == numba.config.NUMBA_NUM_THREADS:
        timed |= lbmpy_steps(n, dtype, threads)
    return timed


def measure(n: int, dtype, rounds: int) -> dict:
    """Times of all contestants at n^3 cells; MLUPS is what a time of two steps means."""
    counts = sorted({1, numba.config.NUMBA_NUM_THREADS})
    contestants = {threads: _contestants(n, dtype, threads) for threads in counts}
    seconds: dict[tuple[str, int], list[float]] = defaultdict(list)
    for turn in range(rounds + 1):
        for threads in counts:
            numba.set_num_threads(threads)
            for name, run in contestants[threads].items():
                start = time.perf_counter()
                run()
                if turn > 0:  # the first round warms up
                    seconds[name, threads].append(time.perf_counter() - start)
    bytes_per_cell = 2 * Q * np.dtype(dtype).itemsize
    memory_bytes = 2 * contestants[1]["in-place read + write"].__closure__[0].cell_contents.nbytes
    rows = []
    for (name, threads), times in seconds.items():
        times = np.array(times)
        roof = np.array(seconds["in-place read + write", threads]) * bytes_per_cell * n**3 / memory_bytes
        row = {
            "contestant": name,
            "threads": threads,
            "mlups": 2 * n**3 / np.median(times) / 1e6,
            "mlups_best": 2 * n**3 / times.min() / 1e6,
            "of_roofline": float(np.median(roof / times)),
            "of_roofline_best": float(roof.min() / times.min()),
            "speed_up": float(np.median(np.array(seconds[name, 1]) / times)) if (name, 1) in seconds else None,
        }
        if name == "in-place read + write":
            row["mlups"], row["mlups_best"] = (
                2 * n**3 / np.median(roof) / 1e6, 2 * n**3 / roof.min() / 1e6
            )  # fmt: skip
            row["of_roofline"] = row["of_roofline_best"] = 1.0
        rows.append(row)
    peers = [np.array(t) for (name, _), t in seconds.items() if name.startswith("lbmpy")]
    if peers:
        best = min(peers, key=np.median)
        for row in rows:
            times = np.array(seconds[row["contestant"], row["threads"]])
            row["of_lbmpy"] = float(np.median(best / times))
    return {
        "cells": n,
        "dtype": np.dtype(dtype).name,
        "bytes_per_cell_moved": bytes_per_cell,
        "memory_of_populations": Simulation((n, n, n), Rates.bgk(0.1), dtype=dtype).bytes_per_cell
        / (Q * np.dtype(dtype).itemsize),
        "gigabytes_per_second": {
            threads: float(memory_bytes * 2 / np.median(seconds["in-place read + write", threads]) / 1e9)
            for threads in counts
        },
        "rows": rows,
    }


def start_up_seconds() -> dict[str, float]:
    """Wall time of a process that makes one step: with an empty cache of kernels, and again."""
    import subprocess
    import tempfile

    script = (
        "from lbm import Rates, Simulation\nSimulation((16, 16, 16), Rates.two_relaxation_times(0.1)).run(2)\n"
    )
    taken = {}
    with tempfile.TemporaryDirectory() as directory:
        environment = {**os.environ, "LBM_CACHE_DIR": directory}
        for name in ("first process", "second process"):
            start = time.perf_counter()
            subprocess.run([sys.executable, "-c", script], env=environment, check=True, capture_output=True)
            taken[name] = time.perf_counter() - start
    return taken


def _show(result: dict, console: Console) -> None:
    bandwidth = ", ".join(f"{gb:.1f} GB/s on {t}" for t, gb in result["gigabytes_per_second"].items())
    table = Table(
        "contestant", "threads", "MLUPS", "best", "of roofline", "(best)", "speed-up", "of lbmpy",
        title=f"{result['cells']}^3 {result['dtype']}: {bandwidth}",
    )  # fmt: skip
    for row in result["rows"]:
        ratios = [row["of_roofline"], row["of_roofline_best"], row["speed_up"], row.get("of_lbmpy")]
        table.add_row(
            row["contestant"], str(row["threads"]), f"{row['mlups']:.0f}", f"{row['mlups_best']:.0f}",
            *("" if ratio is None else f"{ratio:.2f}" for ratio in ratios),
        )  # fmt: skip
    console.print(table)
    console.print(f"memory: {result['memory_of_populations']:.3f} x 19 populations a cell\n")


def main() -> None:
    """Measure, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, nargs="+", default=[128, 192])
    parser.add_argument("--dtype", nargs="+", default=["float64", "float32"])
    parser.add_argument("--rounds", type=int, default=30)
    parser.add_argument("--json", type=Path, default=Path("benchmarks/mlups.json"))
    arguments = parser.parse_args()
    console = Console(width=120)
    results = []
    for dtype in arguments.dtype:
        for n in arguments.cells:
            results.append(measure(n, dtype, arguments.rounds))
            _show(results[-1], console)
    start_up = start_up_seconds()
    console.print("start-up: " + ", ".join(f"{name} {seconds:.1f} s" for name, seconds in start_up.items()))
    versions = {"python": platform.python_version(), "numba": numba.__version__, "numpy": np.__version__}
    arguments.json.write_text(
        json.dumps({"machine": _processor(), **versions, "results": results, "start_up_s": start_up}, indent=1)
        + "\n"
    )
    console.print(f"written to {arguments.json}")


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text().splitlines():
            if line.startswith("model name"):
                return f"{line.split(':')[1].strip()}, {os.cpu_count()} cores"
    return f"{platform.processor()}, {os.cpu_count()} cores"


if __name__ == "__main__":
    main()
