"""Restitution of each bounce by whole trajectories, of the record and of the kept runs filmed as the record was.

    python -m benchmarks.simulated_bounces [CASE ...]

A run's gap is taken at the record's own frame times, with the record's error of reading (fixed seed), and fitted
as the record is, with the wake of the approach: what differs is the sphere's motion, not how it is looked at.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from restitution import datasets
from restitution.calibration.trajectories.recordings import recording
from restitution.calibration.trajectories.whole_trajectories import whole_trajectory
from restitution.cases import read_case
from restitution.runs.kept import read_run
from restitution.tracks import Track

RECORD = "gondret2002_st152"
CASES = ("gondret_st152_10", "gondret_st152_16", "gondret_st152_20")
RUNS = Path("reports/runs")
BOUNCES = 3


def filmed(case: str) -> Track:
    """A kept run as the record's camera would have it."""
    run, record = read_run(read_case(case), RUNS), datasets.load_track(RECORD)
    if run is None:
        raise SystemExit(f"{case}: no kept run; restitution report fig2 --full makes it")
    time, gap = (run.trajectory[name].to_numpy(float) for name in ("time_s", "gap_m"))
    frames = record.time_s[(record.time_s >= time[0]) & (record.time_s <= time[-1])]
    noise = record.sigma * np.random.default_rng(0).standard_normal(len(frames))
    return Track(frames, np.interp(frames, time, gap) + noise, "gap", record.sigma)


def main() -> None:
    """Print e of each bounce, scale and distance, the record first."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", default=list(CASES), metavar="CASE")
    conditions = datasets.resource(RECORD).conditions
    table = Table("trajectory", *(f"e {n}" for n in range(1, BOUNCES + 1)), "scale", "rms/d")
    tracks = {RECORD: datasets.load_track(RECORD)} | {name: filmed(name) for name in parser.parse_args().cases}
    for name, track in tracks.items():
        found = whole_trajectory(recording(name, track, conditions), True)
        shown = [*found.restitutions[:BOUNCES], found.unknowns["scale"]]
        table.add_row(name, *(f"{m:.3f} ± {s:.3f}" for m, s in shown), f"{found.rms_d:.3f}")
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
