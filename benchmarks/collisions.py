"""Relaxation rates, uniform and by place, on flows that tell them apart: vortex, cavity, held sphere.

    python -m benchmarks.collisions [--only NAME ...] [--rates NAME ...] [--json FILE]

Each figure is written as soon as it is measured; a second call measures what is missing. A flow that diverges has
the message as its figure.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from lbm import DivergenceError, NoSlip, Rates, RatesByPlace, Simulation
from lbm.observers import Sums
from lbm.problems.held_sphere import held_sphere as held
from restitution.files import write_whole


def _m_by_place(nu: float, reach: int) -> RatesByPlace:
    """Even moments as quiet rates have them everywhere; near walls only m is slow."""
    quiet = Rates.quiet(nu)
    return RatesByPlace(quiet, replace(quiet, m=quiet.q), reach)


CANDIDATES: dict[str, Callable] = {
    "two-relaxation-times": Rates.two_relaxation_times,
    "dhumieres2002": Rates.dhumieres2002,
    "bgk": Rates.bgk,
    "regularised": lambda nu: Rates(Rates.bgk(nu).nu, 1.0, 1.0, 1.0, 1.0, 1.0),
    "quiet": Rates.quiet,
    **{
        f"quiet-by-place, reach {reach}, blend {blend}": (
            lambda nu, reach=reach, blend=blend: RatesByPlace.quiet(nu, reach, blend)
        )
        for reach, blend in ((1, 0), (3, 0), (6, 0), (12, 0), (1, 4), (3, 6))
    },
    **{f"m alone by place, reach {reach}": lambda nu, reach=reach: _m_by_place(nu, reach) for reach in (1, 3, 6)},
}
UNIFORM = 5
"""How many of them differ where there is no wall."""

SPECTRAL = {5: 0.8404, 6: 0.7578}
"""E/E0 of the Taylor-Green vortex at Re 400 over t U k, by a spectral code."""
CAVITY = -0.3885698
"""Least u on the centre line of the square cavity, Re 1000: Botella & Peyret, Comput. Fluids 27 (1998) 421."""


def taylor_green(preset: Callable, cells: int = 48, reynolds: float = 400) -> dict[str, float]:
    """Error of E/E0."""
    speed, k = 0.08, 2 * np.pi / cells
    x, y, z = np.meshgrid(*[k * (np.arange(cells) + 0.5)] * 3, indexing="ij")
    velocity = speed * np.array([np.sin(x) * np.cos(y), -np.cos(x) * np.sin(y), 0 * x]) * np.cos(z)
    density = 1 + 3 * speed**2 / 16 * (np.cos(2 * x) + np.cos(2 * y)) * (np.cos(2 * z) + 2)
    flow = Simulation((cells,) * 3, preset(speed / k / reynolds), dtype="float32")
    flow.set_flow(density, velocity)
    sums = Sums(every=10**9)
    sums(flow)
    found = {}
    for t, spectral in SPECTRAL.items():
        flow.run(round(t / (speed * k)) - flow.steps)
        sums(flow)
        found[f"E/E0 at t {t}"] = sums.rows[-1][4] / sums.rows[0][4] / spectral - 1
    return found


def cavity(preset: Callable, cells: int) -> dict[str, float]:
    """Error of the least u on the centre line of a square cavity, lid and still walls, after 100 lid times."""
    speed = 0.1
    faces = {"x": "no-slip", "z-": "no-slip", "z+": NoSlip((speed, 0, 0))}
    flow = Simulation((cells, 4, cells), preset(speed * cells / 1000), faces=faces)
    flow.run(round(100 * cells / speed))
    u = flow.velocity[0, :, 0]
    line = u[(cells - 1) // 2 : cells // 2 + 1].mean(axis=0)
    low = int(np.argmin(line))
    least = np.polynomial.Polynomial.fit([-1, 0, 1], line[low - 1 : low + 2], 2)
    at = least.deriv().roots()[0]
    return {"least u": float(least(at)) / speed / CAVITY - 1}


def held_sphere(preset: Callable, diameter: int, reynolds: float) -> dict[str, float]:
    """Drag coefficient in a box of 5 x 5 x 8 d, and rms of the force about its trend over four d/U."""
    found = held(diameter, reynolds, rates=preset)
    return {"C_D": found.coefficient, "noise": found.noise}


FLOWS: dict[str, tuple[int, Callable]] = {
    "Taylor-Green Re 400, 48^3": (UNIFORM, taylor_green),
    "square cavity Re 1000, 24^2": (len(CANDIDATES), lambda preset: cavity(preset, 24)),
    "square cavity Re 1000, 48^2": (len(CANDIDATES), lambda preset: cavity(preset, 48)),
    "square cavity Re 1000, 96^2": (len(CANDIDATES), lambda preset: cavity(preset, 96)),
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
            except DivergenceError as error:
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
