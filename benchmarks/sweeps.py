"""What a sweep costs beside its runs, what a second process gains, what shared approaches save, how fast it lists.

Runs are of the 3 mm sphere of Gondret et al. at 10 and 14 cells a diameter, of one thread each; the load of the
machine is printed beside every figure, for times are by the clock. A sweep's overhead is what its wall time has
beside the seconds that its runs state: start of the processes, set-up, writing, manifest.

    python -m benchmarks.sweeps            # all of it, some minutes
    python -m benchmarks.sweeps listing    # cost, processes, forks, listing: parts of it
"""

from __future__ import annotations

import os
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from restitution.campaigns.manifest import FINISHED, Manifest, line
from restitution.campaigns.plan import Planned, read_plan, write_plan
from restitution.campaigns.sweep import sweep
from restitution.campaigns.table import runs_of
from restitution.runs.record import RESOLVED

CASE = """
base = "gondret_st152_10"
[case]
release = {{ kind = "drive", gap_d = {gap}, speed = 0.3, ramp = 0.0005 }}
numerics.cells_per_diameter = {cells}
numerics.lattice_speed = 0.05
numerics.width_d = 6.0
numerics.height_d = {height}
run.after_contact = {span}
[vary]
film.tension = ["50 kPa", 101325]
sphere.e_dry = {e_dry}
"""
LONG = {"cells": 14, "gap": 1.0, "height": 11.0, "span": 0.3, "e_dry": [0.8, 0.97]}
SHORT = {"cells": 6, "gap": 1.0, "height": 6.0, "span": 0.005, "e_dry": [0.8, 0.9, 0.97]}
APPROACH = {"cells": 14, "gap": 8.0, "height": 11.0, "span": 0.005, "e_dry": [0.8, 0.9, 0.97]}
"""A study of the first rebound: the way to the wall is 8 d, what is recorded after the contact some 0.5 d."""
ENTRIES = 100_000


def made(numbers: dict, processes: int, share: bool) -> tuple[float, float]:
    """Wall time in s of a sweep, and the seconds that its runs state."""
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "sweep.toml"
        file.write_text(CASE.format(**numbers))
        began = time.perf_counter()
        sweep(file, Path(place) / "out", processes=processes, share=share)
        wall = time.perf_counter() - began
        return wall, float(runs_of(Path(place) / "out").seconds.sum())


def load() -> str:
    return f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"


def cost() -> None:
    """In seconds of the processor, which other work on the machine does not lengthen; the runs are counted too."""
    before = worked()
    made(SHORT, 1, share=False)
    used = worked() - before
    print(
        f"cost: six very short runs take {used:.1f} s of the processor in all: less than 2 % of six that "
        f"take {50 * used / 6:.0f} s each"
    )


def worked() -> float:
    """Seconds of the processor of this process and those that it has ended."""
    return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def processes() -> None:
    one, runs = made(LONG, 1, share=False)
    print(
        f"one process: four runs of {runs / 4:.1f} s in {one:.1f} s, {100 * (one / runs - 1):.2f} % more; {load()}"
    )
    both, _ = made(LONG, 2, share=False)
    print(f"two processes: the same in {both:.1f} s, {one / both:.2f} times as fast; {load()}", flush=True)


def shared() -> None:
    apart, _ = made(APPROACH, 1, share=False)
    forked, _ = made(APPROACH, 1, share=True)
    saved = 100 * (1 - forked / apart)
    print(f"forks: {apart:.1f} s apart, {forked:.1f} s from one approach: {saved:.0f} % saved; {load()}")


def listing() -> None:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        names = [f"r{i:012x}" for i in range(ENTRIES)]
        write_plan(folder, [Planned(name, RESOLVED, {"film.tension": 1e5, "sphere.e_dry": 0.9}) for name in names])
        Manifest(folder).append(line(name, FINISHED, seconds=1.0) for name in names)
        began, worked = time.perf_counter(), time.process_time()
        found = Manifest(folder)
        manifest, cpu = time.perf_counter() - began, time.process_time() - worked
        count = sum(found.of(run.run).state == FINISHED for run in read_plan(folder))
        both, of_both = time.perf_counter() - began, time.process_time() - worked
    print(
        f"listing: {count} finished entries in {manifest:.2f} s ({cpu:.2f} s of the processor), with the plan in "
        f"{both:.2f} s ({of_both:.2f} s); {load()}"
    )


PARTS: dict[str, Callable[[], None]] = {"cost": cost, "processes": processes, "forks": shared, "listing": listing}

if __name__ == "__main__":
    for name in sys.argv[1:] or PARTS:
        PARTS[name]()
