"""The first rebound at St 152 by cells a diameter and lattice speed, in a box that is quick to run.

The case `gondret_st152_10` with a way of 4 d, too short for the wake to form, in a box 5 d wide and 6 d high; the
table gives the speeds at contact, the restitution at the edges 0.1, 0.2 and 0.3 d of a film (both speeds carried
to the wall by free fall), the gap 8.4 ms later and the mean speed from 4.4 ms on. Compressibility falls
with the lattice speed; so does the viscosity in lattice units, below some 0.0015 of which the sphere is slowed.
The point particle of the same case, with potential flow's added mass, all of Brenner's resistance and a history
force, stands below.

    python -m benchmarks.rebound_grid [CELLS:LATTICE_SPEED ...]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
from rich.console import Console
from rich.progress import track
from rich.table import Table

from restitution.bounce import OwnWake
from restitution.cases import Case, read_case
from restitution.runs.point_particle import closures_of, predict
from restitution.runs.resolved import ResolvedRun

GRIDS = ("10:0.05", "10:0.025", "10:0.0125", "16:0.025", "20:0.05", "20:0.025", "20:0.0125")
EARLY_S, LATE_S = 4.4e-3, 8.4e-3
EDGES = (0.1, 0.2, 0.3)
"""Of the film, in diameters."""


def short(cells: int, lattice_speed: float) -> Case:
    """The case, cut down."""
    case = read_case("gondret_st152_10")
    numerics = {
        "cells_per_diameter": float(cells), "lattice_speed": lattice_speed, "width_d": 5.0, "height_d": 6.0,
    }  # fmt: skip
    return case.model_copy(
        update={
            "release": case.release.model_copy(update={"gap_d": 4.0}),
            "numerics": case.numerics.model_copy(update=numerics),
            "run": case.run.model_copy(update={"after_contact": LATE_S + 1e-4}),
        }
    )


def rebound(cells: int, lattice_speed: float, preset: Callable | None = None) -> tuple[float, ...]:
    """Speeds at the wall before and after contact in m/s, e at the edges, mean speed later, the gap then in m.

    ``preset`` gives other rates than the case has, from the viscosity in lattice units.
    """
    run = made(short(cells, lattice_speed), preset)
    contact = run.contacts[0]
    return contact.speed_in_m_s, contact.speed_out_m_s, *_at_edges(run.motion()), *_later(run.motion())


def made(case: Case, preset: Callable | None) -> ResolvedRun:
    """The finished run of a case, with other rates than it has."""
    run = ResolvedRun(case)
    if preset is not None:
        run.setup = replace(run.setup, rates=preset(run.flow.viscosity))
        run.simulation, run.spheres = run.setup.build()
    while not run.finished:
        run.advance()
    return run


def point_particle(wake: OwnWake | None) -> tuple[float, ...]:
    """The same of the point particle."""
    case = short(10, 0.025)
    found = predict(case, closures=replace(closures_of(case), wake=wake))
    contact, motion = found.contacts[0], found.table()
    return contact.speed_in_m_s, contact.speed_out_m_s, *_at_edges(motion), *_later(motion)


def _at_edges(motion: pd.DataFrame) -> list[float]:
    """The restitution at each of :data:`EDGES`: speeds there, carried to the wall by free fall."""
    conditions, found = short(10, 0.025).conditions, []
    time, gap = motion.time_s.to_numpy(), motion.gap_m.to_numpy()
    v = motion["vz_m_s" if "vz_m_s" in motion else "velocity_m_s"].to_numpy()
    for edge in EDGES:
        height = edge * conditions.sphere.diameter
        fallen = 2 * conditions.free_fall * height
        coming, going = (time < 0) & (gap < 2 * height), (time > 0) & (gap < 2 * height) & (v > 0)
        into = np.interp(-height, -gap[coming], v[coming])
        out = np.interp(height, gap[going], v[going])
        found.append(float(np.sqrt((out**2 + fallen) / (into**2 + fallen))))
    return found


def _later(motion: pd.DataFrame) -> tuple[float, float]:
    early, late = np.interp((EARLY_S, LATE_S), motion.time_s, motion.gap_m)
    return (late - early) / (LATE_S - EARLY_S), late


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("grids", nargs="*", default=GRIDS, metavar="CELLS:LATTICE_SPEED")
    console = Console(width=110)
    edges = (f"e at {edge:g} d" for edge in EDGES)
    table = Table("cells", "speed", "in m/s", "out m/s", *edges, "4.4 to 8.4 ms m/s", "gap at 8.4 ms mm")
    for grid in track(parser.parse_args().grids, "runs", console=console, transient=True):
        cells, speed = grid.split(":")
        table.add_row(cells, speed, *_shown(rebound(int(cells), float(speed))))
    for name, wake in (("no wake", None), ("wake", OwnWake())):
        table.add_row("point particle", name, *_shown(point_particle(wake)))
    console.print(table)


def _shown(found: tuple[float, ...]) -> list[str]:
    *speeds, gap = found
    return [*(f"{v:.4f}" for v in speeds), f"{gap * 1e3:.3f}"]


if __name__ == "__main__":
    main()
