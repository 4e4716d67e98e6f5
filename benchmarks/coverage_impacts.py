"""Do the intervals of ``restitution impacts`` hold what they promise? Coverage on synthetic tracks with
known truth.

A 6 mm glass sphere falls in a liquid of 6.2 mPa s from 15 to 40 mm, rebounds twice or three times with e from 0.45
to 0.85, and is filmed: gravity, added mass and quadratic drag, in every other track also a wake that brakes
the sphere after its rebound by up to v_in/sqrt(d/g) and dies out in 4 to 20 ms, integrated independently of
this package. Kinds differ in frames a second and in what the frames suffer from; noise is 0.03 mm unless the
kind says otherwise. Printed are, for every rebound that ``impacts`` resolves with the default definition of
speed, the per cent of 68 % intervals of the impact speed and of e_eff that contain the truth, the rebounds
resolved of those that there were, and the median errors.

Each track has its own stream of random numbers. What was measured is kept in
``benchmarks/coverage_impacts.json`` as sums, and a run adds the tracks that are missing there.

    python -m benchmarks.coverage_impacts [--tracks 300] [--only TEXT] [--processes 1]
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass
from multiprocessing import Pool
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from restitution.conditions import Conditions
from restitution.files import write_whole
from restitution.impacts import find_impacts
from restitution.tracks import Track, noise

CONDITIONS = Conditions.model_validate(
    {
        "fluid": {"density": 1110.0, "viscosity": 0.0062},
        "sphere": {"diameter": 6e-3, "density": 2490.0, "e_dry": 0.97},
    }
)
TERMINAL = 0.43
"""Speed of the steady fall, m/s."""
REST = 30e-3
"""How long the sphere is filmed lying at the wall where its rest tells the level, s."""
_AT_ONCE = 20
"""Tracks after which what was measured is written."""
OUT = Path(__file__).with_name("coverage_impacts.json")


@dataclass(frozen=True)
class Kind:
    """How tracks are filmed: ``pixel`` (m) rounds positions, ``level`` (m) is the spread of the wall's place."""

    name: str
    fps: float
    noise: float = 3e-5
    pixel: float = 0.0
    lost: float = 0.0
    level: float = 0.0
    quantity: str = "gap"


KINDS = (
    Kind("200 frames/s", 200.0),
    Kind("1000 frames/s", 1000.0),
    Kind("5000 frames/s", 5000.0),
    Kind("20000 frames/s", 20000.0),
    Kind("pixel steps of 0.1 mm, 1000 frames/s", 1000.0, noise=5e-6, pixel=1e-4),
    Kind("pixel steps of 0.1 mm, 10000 frames/s", 10000.0, noise=5e-6, pixel=1e-4),
    Kind("one frame in five lost, 1000 frames/s", 1000.0, lost=0.2),
    Kind("wall unknown by 0.3 mm, 1000 frames/s", 1000.0, level=3e-4),
    Kind("velocities, noise 5 mm/s, 2000 frames/s", 2000.0, noise=5e-3, quantity="velocity"),
)


def draw(kind: Kind, seed: int) -> tuple[Track, list[tuple[float, float, float]]]:
    """A track, and time, speed and e of each of its rebounds."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    fall = CONDITIONS.free_fall

    wake = rng.uniform(0, 1) / np.sqrt(CONDITIONS.sphere.diameter / CONDITIONS.gravity) * (seed % 2)
    decay = rng.uniform(4e-3, 20e-3)

    def motion(t: float, state: np.ndarray) -> list[float]:
        brake = wake * met * np.exp(-(t - start[0]) / decay)
        return [state[1], -fall - fall * state[1] * abs(state[1]) / TERMINAL**2 - brake]

    def hit(_: float, state: np.ndarray) -> float:
        return state[0]

    hit.terminal, hit.direction = True, -1
    start, truths, flights = (0.0, rng.uniform(15e-3, 40e-3), -rng.uniform(0.0, 0.3)), [], []
    met = 0.0
    for e in [*rng.uniform(0.45, 0.85, rng.integers(2, 4)), 0.0]:
        path = solve_ivp(
            motion, (start[0], start[0] + 5), start[1:], events=hit, dense_output=True, rtol=1e-9, atol=1e-12
        )
        flights.append((start[0], path.t[-1], path.sol))
        speed = -float(path.y[1, -1])
        if e:
            truths.append((float(path.t[-1]), speed, float(e)))
        start, met = (float(path.t[-1]), 1e-15, e * speed), speed
    time = np.arange(rng.uniform(0, 1 / kind.fps), flights[-1][1] + REST, 1 / kind.fps)
    time = time[rng.random(len(time)) >= kind.lost]
    state = np.zeros((2, len(time)))
    for begin, end, path in flights:
        here = (time >= begin) & (time < end)
        state[:, here] = path(time[here])
    value = state[0 if kind.quantity == "gap" else 1] + kind.noise * rng.standard_normal(len(time))
    value += kind.level * rng.standard_normal()
    if kind.pixel:
        value = kind.pixel * np.round(value / kind.pixel)
    return Track(time, value, kind.quantity, noise(time, value)), truths


def one(task: tuple[Kind, int]) -> tuple[bool, int, int, list[list[float]]]:
    """Whether with a wake, rebounds that there were, rows that belong to none, errors and sigmas of each
    resolved.
    """
    kind, seed = task
    track, truths = draw(kind, seed)
    found, invented = [], 0
    for row in find_impacts(track, CONDITIONS).rows:
        _, speed, e = min(truths, key=lambda t: abs(t[0] - row["time_s"]))
        if row["outcome"] != "rebound":
            continue
        if min(abs(t[0] - row["time_s"]) for t in truths) > 0.02:
            invented += 1
            continue
        found.append(
            [row["impact_speed_m_s"] - speed, row["impact_speed_sigma_m_s"], row["e_eff"] - e, row["e_eff_sigma"]]
        )
    return bool(seed % 2), len(truths), invented, found


@dataclass
class Cell:
    """Sums over the first ``tracks`` tracks of one kind."""

    kind: str
    tracks: int = 0
    rebounds: int = 0
    resolved: int = 0
    invented: int = 0
    held_v: int = 0
    held_e: int = 0
    resolved_wake: int = 0
    held_e_wake: int = 0
    pull_v: float = 0.0
    pull_e: float = 0.0
    log_sigma_v: float = 0.0
    log_sigma_e: float = 0.0

    def add(self, results: list) -> None:
        """Take in further tracks, in their order."""
        for wake, rebounds, invented, found in results:
            self.tracks += 1
            self.rebounds += rebounds
            self.invented += invented
            for v, v_sigma, e, e_sigma in found:
                self.resolved += 1
                self.held_v += abs(v) < v_sigma
                self.held_e += abs(e) < e_sigma
                self.resolved_wake += wake
                self.held_e_wake += wake and abs(e) < e_sigma
                self.pull_v += v / v_sigma
                self.pull_e += e / e_sigma
                self.log_sigma_v += float(np.log(v_sigma))
                self.log_sigma_e += float(np.log(e_sigma))

    def line(self) -> str:
        """One line of the table."""
        n = max(self.resolved, 1)
        v, e = (100 * x / n for x in (self.held_v, self.held_e))
        apart = (
            (self.held_e - self.held_e_wake) / max(n - self.resolved_wake, 1),
            self.held_e_wake / max(self.resolved_wake, 1),
        )
        sigma_v, sigma_e = np.exp(self.log_sigma_v / n), np.exp(self.log_sigma_e / n)
        return (
            f"| {self.kind} | {self.tracks} | {self.resolved} of {self.rebounds} | {v:.1f} | {e:.1f} | "
            f"{100 * apart[0]:.0f} / {100 * apart[1]:.0f} | "
            f"{self.pull_v / n:+.2f} | {self.pull_e / n:+.2f} | {1e3 * sigma_v:.1f} | {sigma_e:.3f} | "
            f"{self.invented} |"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tracks", type=int, default=300)
    parser.add_argument("--only", default="", help="kinds whose name contains this")
    parser.add_argument("--processes", type=int, default=1)
    args = parser.parse_args()
    rows = json.loads(OUT.read_text()) if OUT.exists() else []
    cells = {row["kind"]: Cell(**row) for row in rows}
    print(
        "| kind | tracks | resolved | v_in | e_eff | no wake / wake | bias v | bias e | sigma v, mm/s | "
        "sigma e | invented |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    with Pool(args.processes) as pool:
        for kind in KINDS:
            cell = cells.setdefault(kind.name, Cell(kind.name))
            while args.only in kind.name and cell.tracks < args.tracks:
                tasks = [(kind, seed) for seed in range(cell.tracks, min(cell.tracks + _AT_ONCE, args.tracks))]
                cell.add(pool.map(one, tasks))
                write_whole(OUT, json.dumps([asdict(c) for c in cells.values() if c.tracks], indent=1) + "\n")
            if cell.tracks:
                print(cell.line(), flush=True)


if __name__ == "__main__":
    main()
