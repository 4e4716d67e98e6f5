"""Relaxation rates, uniform and by place, on flows that tell them apart: vortex, channel, spheres.

    python -m benchmarks.collisions [--only NAME ...] [--rates NAME ...] [--json FILE]

Each figure is written as soon as it is measured; a second call measures what is missing. A flow that diverges has
the message as its figure.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.rebound_grid import made, rebound, short
from lbm import DivergenceError, Rates, RatesByPlace, Simulation
from lbm.observers import Sums
from lbm.problems.held_sphere import held_sphere as held
from lbm.problems.spheres import approach, moved_over_held, translation
from lbm.spheres import lost_to_grid
from restitution.errors import DivergedError
from restitution.files import write_whole
from restitution.laws.brenner_1961 import Brenner1961

CANDIDATES: dict[str, Callable] = {
    "two-relaxation-times": Rates.two_relaxation_times,
    "dhumieres2002": Rates.dhumieres2002,
    "bgk": Rates.bgk,
    "regularised": lambda nu: Rates(Rates.bgk(nu).nu, 1.0, 1.0, 1.0, 1.0, 1.0),
    "quiet": Rates.quiet,
    "balanced": Rates.balanced,
    **{
        f"quiet-by-place, reach {reach}, blend {blend}": (
            lambda nu, reach=reach, blend=blend: RatesByPlace.quiet(nu, reach, blend)
        )
        for reach, blend in ((1, 0), (3, 0), (6, 0), (12, 0), (1, 4), (3, 6))
    },
    "balanced-by-place": RatesByPlace.balanced,
    **{
        f"m alone by place, reach {reach}": (
            lambda nu, reach=reach: RatesByPlace(Rates.quiet(nu), Rates.slow_odd(nu), reach)
        )
        for reach in (1, 3, 6)
    },
    "dhumieres-by-place": RatesByPlace.dhumieres,
    "dhumieres-by-place, reach 6": lambda nu: RatesByPlace.dhumieres(nu, 6),
    "dhumieres-by-place, two relaxation times": lambda nu: RatesByPlace(
        Rates.dhumieres2002(nu), Rates.two_relaxation_times(nu), 6
    ),
}
UNIFORM = 6
"""How many of them differ where there is no wall."""

SPECTRAL = {5: 0.8404, 6: 0.7578}
"""E/E0 of the Taylor-Green vortex at Re 400 over t U k, by a spectral code."""
GAPS = (2.0, 1.5, 1.0, 0.75, 0.6, 0.5, 0.45, 0.4, 0.3, 0.2, 0.1, 0.05)
"""Between sphere and wall, in cells."""


def taylor_green(preset: Callable, cells: int = 48, reynolds: float = 400, times=SPECTRAL) -> dict[str, float]:
    """Error of E/E0 at ``times``, whose values are the exact ones; E/E0 itself where there is none."""
    speed, k = 0.08, 2 * np.pi / cells
    x, y, z = np.meshgrid(*[k * (np.arange(cells) + 0.5)] * 3, indexing="ij")
    velocity = speed * np.array([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y), 0 * x]) * np.cos(z)
    density = 1 + 3 * speed**2 / 16 * (np.cos(2 * x) + np.cos(2 * y)) * (np.cos(2 * z) + 2)
    flow = Simulation((cells,) * 3, preset(speed / k / reynolds), dtype="float32")
    flow.set_flow(density, velocity)
    sums = Sums(every=10**9)
    sums(flow)
    found = {}
    for t, spectral in times.items():
        flow.run(round(t / (speed * k)) - flow.steps)
        sums(flow)
        share = sums.rows[-1][4] / sums.rows[0][4]
        found[f"E/E0 at t {t}"] = share if spectral is None else share / spectral - 1
    return found


def channel(preset: Callable, cells: int = 16, viscosity: float = 0.006) -> dict[str, float]:
    """Error of the speed in the cell at the wall, and in the middle, of a channel driven by a force."""
    top, z = 0.02, np.arange(cells) + 0.5
    exact = 4 * top * z * (cells - z) / cells**2
    force = (8 * viscosity * top / cells**2, 0, 0)
    flow = Simulation((4, 4, cells), preset(viscosity), faces={"z": "no-slip"}, force=force)
    flow.set_flow(1.0, exact * np.array([1, 0, 0]).reshape(3, 1, 1, 1) * np.ones((1, 4, 4, 1)))
    flow.run(round(0.7 * cells**2 / viscosity))
    error = flow.velocity[0, 0, 0] / exact - 1
    return {"at the wall": float(error[0]), "in the middle": float(error[cells // 2])}


def held_sphere(preset: Callable, diameter: int, reynolds: float) -> dict[str, float]:
    """Drag coefficient in a box of 5 x 5 x 8 d, and rms of the force about its trend over four d/U."""
    found = held(diameter, reynolds, rates=preset)
    return {"C_D": found.coefficient, "noise": found.noise}


def film(preset: Callable, viscosity: float, speed: float, diameter: int = 10) -> dict[str, float]:
    """Error of the resistance towards a wall, what the grid lacks added: at 2 cells, the worst from 2 to 0.05."""
    made = approach(
        diameter, width=4, height=3, start=2.5 / diameter, speed=speed, viscosity=viscosity, dtype="float32",
        preset=preset,
    )  # fmt: skip
    exact = Brenner1961()(eps=made.gap / made.radius)
    error = (made.resistance + made.radius * np.array([lost_to_grid(h) for h in made.gap])) / exact - 1
    means = [float(error[np.abs(made.gap - h) < 0.05 * h].mean()) for h in GAPS]
    return {"at 2 cells": means[0], "worst": max(means, key=abs)}


def moving(preset: Callable, viscosity: float = 0.003, diameter: int = 10, width: float = 4) -> dict[str, float]:
    """Noise of a sphere that crosses the grid obliquely in a periodic cube ``width`` diameters wide."""
    way = (1, 0.62, 0.37)
    found = translation(diameter, way, viscosity=viscosity, width=width, dtype="float32", preset=preset)
    return {"noise": float(found.noise)}


def moving_over_held(preset: Callable) -> dict[str, float]:
    """Drag at Re 100 of a sphere that moves through fluid at rest over that of one held in a stream, less 1."""
    return {"moving over held": moved_over_held(10, speed=0.05, viscosity=0.005, width=4, preset=preset) - 1}


def first_rebound(preset: Callable, lattice_speed: float) -> dict[str, float]:
    """At St 152: speed at the wall, and the gap 8.4 ms later (:mod:`benchmarks.rebound_grid`)."""
    found = rebound(10, lattice_speed, preset)
    return {"speed at contact, m/s": found[0], "gap, mm": 1e3 * found[-1]}


def fast_rebound(preset: Callable, grid_reynolds: float = 60.0) -> dict[str, float]:
    """The same sphere in a thinner fluid, U/nu = ``grid_reynolds`` a cell: speed at the wall, gap 20 ms later."""
    case = short(10, 0.05)
    thinner = case.fluid.density * case.release.speed * case.sphere.diameter / (10 * grid_reynolds)
    update = {
        "fluid": case.fluid.model_copy(update={"viscosity": thinner}),
        "run": case.run.model_copy(update={"after_contact": 0.02}),
    }
    run = made(case.model_copy(update=update), preset)
    gap = np.interp(0.02, run.motion().time_s, run.motion().gap_m)
    return {"speed at contact, m/s": run.contacts[0].speed_in_m_s, "gap, mm": 1e3 * float(gap)}


FLOWS: dict[str, tuple[int, Callable]] = {
    "Taylor-Green Re 400, 48^3": (UNIFORM, taylor_green),
    "Taylor-Green Re 1600, 96^3": (UNIFORM, lambda preset: taylor_green(preset, 96, 1600, {9: None})),
    "channel of 16 cells, nu 0.006": (len(CANDIDATES), channel),
    "sphere towards a wall, 10 cells, nu 1/6": (len(CANDIDATES), lambda preset: film(preset, 1 / 6, 2e-3)),
    "sphere towards a wall, 10 cells, nu 0.02": (len(CANDIDATES), lambda preset: film(preset, 0.02, 5e-4)),
    "moving sphere, 10 cells, nu 0.003": (UNIFORM, moving),
    "moving sphere, 10 cells, nu 0.003, box 6 d wide": (UNIFORM, lambda preset: moving(preset, width=6)),
    "moving sphere, 16 cells, nu 0.0048": (UNIFORM, lambda preset: moving(preset, 0.0048, 16)),
    "moving sphere, 10 cells, grid Re 30": (UNIFORM, lambda preset: moving(preset, 0.05 / 30)),
    "moving sphere, 10 cells, Re 100": (UNIFORM, moving_over_held),
    "first rebound at St 152, 10 cells, 0.025": (len(CANDIDATES), lambda preset: first_rebound(preset, 0.025)),
    "first rebound at St 152, 10 cells, 0.05": (len(CANDIDATES), lambda preset: first_rebound(preset, 0.05)),
    "rebound at grid Re 60, 10 cells, 0.05": (len(CANDIDATES), fast_rebound),
    "held sphere Re 100, 8 cells": (UNIFORM, lambda preset: held_sphere(preset, 8, 100)),
    "held sphere Re 300, 10 cells": (UNIFORM, lambda preset: held_sphere(preset, 10, 300)),
}
"""How many of the candidates it tells apart, and what is measured."""


def main() -> None:
    """Measure what is missing, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=FLOWS, metavar="FLOW", default=list(FLOWS))
    parser.add_argument("--rates", nargs="+", choices=CANDIDATES, metavar="NAME", default=list(CANDIDATES))
    parser.add_argument("--json", type=Path, default=Path("benchmarks/collisions.json"))
    arguments = parser.parse_args()
    known = json.loads(arguments.json.read_text()) if arguments.json.exists() else {}
    for flow in arguments.only:
        count, measure = FLOWS[flow]
        for name in [n for n in list(CANDIDATES)[:count] if n in arguments.rates]:
            if name in known.setdefault(flow, {}):
                continue
            try:
                known[flow][name] = measure(CANDIDATES[name])
            except (DivergenceError, DivergedError) as error:
                known[flow][name] = {"diverged": str(error).split(";")[0]}
            write_whole(arguments.json, json.dumps(known, indent=1) + "\n")
    table = Table("flow", "rates", "figures")
    for flow, rows in known.items():
        for name, figures in rows.items():
            text = ", ".join(f"{k} {v if isinstance(v, str) else format(v, '.4g')}" for k, v in figures.items())
            table.add_row(flow, name, text)
    Console(width=150).print(table)


if __name__ == "__main__":
    main()
