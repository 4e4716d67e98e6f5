"""How the cost of long inputs grows: seconds of the processor for some sizes, and the exponent between them.

    python -m benchmarks.scale                 # some minutes
    python -m benchmarks.scale own compare     # those alone

The goals: a fit with each impact its own source no worse than n^1.2; ``compare`` of 1000 impacts and five laws in
30 s; ``impacts`` of 1e6 rows in 8 s; ``fit --trajectory`` near linear in tracks, 25 bounces in 20 s.
"""

from __future__ import annotations

import contextlib
import io
import math
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from restitution import datasets
from restitution.bounce import Closures, Release, bounce
from restitution.calibration import Plan, estimate, model_of, rank, read, result_of
from restitution.calibration.reading.reading import Reading
from restitution.calibration.trajectories.fit import Measured
from restitution.calibration.trajectories.recordings import read_recordings
from restitution.cli import main as command
from restitution.conditions import Conditions, Fluid, Sphere, read_conditions

LAWS = ("eq4_exponential", "eq4_exponential_over_e", "eq4_rational", "two_way_lubrication", "legendre_2005")
STEEL = Sphere(diameter=0.003, density=7800.0, e_dry=0.97)
OIL = "[fluid]\ndensity = 935.0\nviscosity = 0.01\n[sphere]\ndiameter = 0.003\ndensity = 7800.0\ne_dry = 0.97\n"


def impacts(folder: Path, n: int, sources: int) -> str:
    """A table of made-up impacts of so many sources."""
    rng = np.random.default_rng(1)
    St = np.exp(rng.uniform(math.log(15), math.log(500), n))
    e = np.maximum(0.97 * np.exp(-34 / St) + 0.03 * rng.standard_normal(n), 0.001)
    rows = "".join(f"s{k % sources},{St[k]:.5g},{e[k]:.5g},0.02,0.97,st,far\n" for k in range(n))
    path = folder / f"impacts_{n}_{sources}.csv"
    path.write_text("source,stokes,e_eff,e_eff_sigma,e_dry,stokes_convention,speed_definition\n" + rows)
    return str(path)


def own(folder: Path, n: int) -> None:
    """A fit with each impact its own source, and what is kept of it."""
    result_of(estimate(Plan(model_of("eq4_exponential")), read(impacts(folder, n, n)))).to_json()


def compare(folder: Path, n: int) -> None:
    """Five laws on impacts of five sources."""
    conditions = Conditions(fluid=Fluid(density=935.0, viscosity=0.01), sphere=STEEL)
    observations = read(impacts(folder, n, 5), Reading(conditions=conditions))
    ranking = rank([(law, Plan(model_of(law))) for law in LAWS], observations)
    if ranking.failed:
        raise RuntimeError(str(ranking.failed))


def rows(folder: Path, n: int) -> None:
    """``impacts`` of a track of so many rows."""
    fall, t = 8.4, np.linspace(0, 0.6, n)
    y, begin, speed = np.maximum(0.02 - 0.5 * fall * t**2, 0.0), math.sqrt(0.04 / fall), math.sqrt(0.04 * fall)
    while speed > 0.01:
        speed *= 0.8
        here = (t >= begin) & (t < begin + 2 * speed / fall)
        y[here] = speed * (t[here] - begin) - 0.5 * fall * (t[here] - begin) ** 2
        begin += 2 * speed / fall
    table = np.c_[t, y + 2e-6 * np.random.default_rng(0).standard_normal(n)]
    np.savetxt(folder / "track.csv", table, fmt="%.9g", delimiter=",", header="time_s,gap_m", comments="")
    (folder / "oil.toml").write_text(OIL)


def read_rows(folder: Path, _: int) -> None:
    """What :func:`rows` has written."""
    with contextlib.redirect_stdout(io.StringIO()):
        command(["impacts", str(folder / "track.csv"), "--conditions", str(folder / "oil.toml")])


def bounces(folder: Path, n: int) -> None:
    """A record of so many bounces, with the wake and without."""
    c = Conditions(
        fluid=Fluid(density=1000.0, viscosity=0.001), sphere=STEEL.model_copy(update={"diameter": 0.012})
    )
    path = bounce(c, Release(0.08, 0.0), Closures(measured=(0.93,) * (n + 1)), 6.0, 1e-5)
    t = np.linspace(0, path.impacts[n].time_s * 0.999, 80 * n)
    gap = path.gap(t) + 1e-5 * np.random.default_rng(0).standard_normal(len(t))
    trajectories(folder, [(t, gap)], c)


def tracks(folder: Path, n: int) -> None:
    """So many tracks of one bounce."""
    (folder / "oil.toml").write_text(OIL)
    table, rng = datasets.load("gondret2002_st152").iloc[:45], np.random.default_rng(0)
    t, gap = table.time_s.to_numpy(), table.gap_m.to_numpy()
    some = [(t, gap + 3e-6 * rng.standard_normal(len(gap))) for _ in range(n)]
    trajectories(folder, some, read_conditions(folder / "oil.toml"))


def trajectories(folder: Path, some: Sequence[tuple[np.ndarray, np.ndarray]], c: Conditions) -> None:
    """Records of frames under both models."""
    names = []
    for k, (t, gap) in enumerate(some):
        path = folder / f"record_{k}.csv"
        np.savetxt(path, np.c_[t, gap], fmt="%.8g", delimiter=",", header="time_s,gap_m", comments="")
        names.append(str(path))
    Measured.of(read_recordings(names, Reading(conditions=c)))


TASKS: dict[str, tuple[Callable[[Path, int], None], Callable[[Path, int], None] | None, tuple[int, ...]]] = {
    "own": (own, None, (300, 1000, 3000)),
    "compare": (compare, None, (100, 300, 1000)),
    "impacts": (read_rows, rows, (10_000, 100_000, 1_000_000)),
    "tracks": (tracks, None, (10, 30, 100)),
    "bounces": (bounces, None, (5, 10, 25)),
}


def main(names: Sequence[str]) -> None:
    """One line a task and size."""
    print(f"{'task':10} {'n':>8} {'cpu s':>8} {'exponent':>8}")
    for name in names or TASKS:
        work, prepare, sizes = TASKS[name]
        before = None
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            for n in (sizes[0], *sizes):  # the first one twice: what is compiled and loaded is not counted
                if prepare is not None:
                    prepare(folder, n)
                began = time.process_time()
                work(folder, n)
                cost = time.process_time() - began
                if before is not None:
                    power = f"{math.log(cost / before[1]) / math.log(n / before[0]):8.2f}" if n > before[0] else ""
                    print(f"{name:10} {n:8d} {cost:8.2f} {power}", flush=True)
                before = n, cost


if __name__ == "__main__":
    main(sys.argv[1:])
