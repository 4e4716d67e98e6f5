"""The fluid that an approach leaves moving, as the resolved runs have it: what the model lacks.

    python -m benchmarks.wake [--runs FOLDER]

Along the motion of kept runs, and of shorter ways and smaller Re of which FOLDER keeps the runs (made there where
they are missing, a minute or two each), all forces of the point particle but the drag are evaluated: inertia with
the wall's added mass, weight, the wall's resistance, the history force with all that went before. What they
leave of the equation of motion is a drag; the speed u of the fluid towards the wall with which the steady drag,
D(v + u), is that, is printed over the impact speed U, by time after the contact in d/U, of the rise. The runs
impose e_eff, so the film is none of it. The constants of the wake (:mod:`restitution.bounce.wake`) are then fitted
to the first rises by least squares, all alike, beside other forms. No measured record takes part.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.optimize import least_squares
from scipy.signal import savgol_filter

from restitution.bounce import Closures
from restitution.bounce.added_mass import added_mass_slope
from restitution.bounce.forces import forces
from restitution.bounce.tables import look
from restitution.cases import Case, read_case
from restitution.cases.case import ContactModel
from restitution.runs.record import read_record
from restitution.runs.simulate import simulate

RUNS = Path("reports/runs")
WAYS = (3.0, 5.0, 7.0)
"""Of the sphere of St 152, in diameters, beside those of the kept runs."""
VISCOSITIES = (0.02735, 0.0547)
"""In Pa s: of its oil at Re 60 and 30, with a way of 9 d."""
CASES = (
    "gondret_st152_10_imposed", "gondret_st152_10_small_imposed", "gondret_st152_16_small_imposed",
    "gondret_st152_20_small_imposed", "gondret_st27_imposed", "li_drop2_imposed", "li_drop3_imposed",
    "li_drop5_imposed", "li_drop6_imposed", "gondret_st100",
)  # fmt: skip
TIMES = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Ends of the intervals in d/U."""
FILM_D = 0.1
_SPEEDS = np.linspace(-3, 3, 12001)


@dataclass(frozen=True)
class Rebound:
    """u/U after a contact by intervals of :data:`TIMES`; ``way`` of the approach and ``gap`` in diameters."""

    name: str
    bounce: int
    Re: float
    way: float
    gap: NDArray
    speed: NDArray


def rebounds(case: Case, folder: Path) -> list[Rebound]:
    """The first two rebounds of a run."""
    d, c = case.sphere.diameter, case.conditions
    t, h, v, contacts = motion(folder)
    f = forces(c, Closures(measured=()), 2 * np.ptp(t))
    memory = history_force(f, t, v, contacts)
    ends = [*(x.time_s for x in contacts[1:]), t[-1]]
    found = []
    for n, (contact, end) in enumerate(zip(contacts[:2], ends, strict=False), 1):
        U, here = contact.speed_in_m_s, (t > contact.time_s) & (t < end) & (v > 0)
        time, gap, speed = t[here] - contact.time_s, h[here], v[here]
        if len(time) < 40:
            continue
        window = max(11, 2 * (len(time) // 40) + 1)
        rate = savgol_filter(speed, window, 2, deriv=1, delta=float(np.median(np.diff(time))))
        eps = np.maximum(gap, 1e-3 * d) / f.radius
        mass = f.mass + f.tail + look(f.added_mass, eps) * f.fluid_mass
        by_place = added_mass_slope(eps) / f.radius * f.fluid_mass
        wall = f.stokes * look(f.wall, eps) / eps * speed
        left = -(mass * rate + 0.5 * by_place * speed**2 + f.weight + wall + memory[here])
        behind = np.interp(left, drag(f, _SPEEDS), _SPEEDS) - speed
        inside = [(time * U / d > a) & (time * U / d <= b) & (gap > FILM_D * d) for a, b in pairwise(TIMES)]
        way = case.release.gap_d if n == 1 else float(h[(t > contacts[0].time_s) & (t < contact.time_s)].max() / d)
        means = [[x[i].mean() if i.any() else np.nan for i in inside] for x in (gap / d, behind / U)]
        found.append(Rebound(case.name, n, U * f.reynolds_per_speed, way, *map(np.array, means)))
    return found


def motion(folder: Path):
    """Times, gaps, velocities and contacts of a run."""
    track, velocity = (pd.read_csv(folder / f"{name}.csv") for name in ("trajectory", "velocity"))
    return (
        track.time_s.to_numpy(), track.gap_m.to_numpy(), velocity.velocity_m_s.to_numpy(),
        read_record(folder).contacts,
    )  # fmt: skip


def history_force(f, t, v, contacts) -> NDArray:
    """Against the motion, in N; the velocity goes straight from row to row, and jumps at contacts."""
    lagged, force = np.zeros_like(f.rates), np.zeros(len(t))

    def along(Z: NDArray, v0: float, v1: float, dt: float) -> NDArray:
        slope = (v1 - v0) / dt
        return v1 - slope / f.rates + (Z - v0 + slope / f.rates) * np.exp(-f.rates * dt)

    for k in range(1, len(t)):
        jump = next((x for x in contacts if t[k - 1] < x.time_s < t[k]), None)
        if jump is None:
            lagged = along(lagged, v[k - 1], v[k], t[k] - t[k - 1])
        else:
            lagged = along(lagged, v[k - 1], -jump.speed_in_m_s, jump.time_s - t[k - 1])
            lagged = along(lagged, jump.speed_out_m_s, v[k], t[k] - jump.time_s)
        at = np.log(max(abs(v[k]) * f.reynolds_per_speed, 1e-12)) - f.memory_start
        i = min(int(max(at * f.memory_per_step, 0.0)), len(f.memory) - 1)
        force[k] = f.history * np.sum(f.weights * f.memory[i] * (v[k] - lagged))
    return force


def drag(f, speed: NDArray) -> NDArray:
    """The steady drag in N at speeds in m/s."""
    return f.stokes * look(f.drag, np.maximum(np.abs(speed) * f.reynolds_per_speed, 1e-9)) * speed


def more_cases() -> Iterator[Case]:
    """Shorter ways, and the same way in thicker oil."""
    base = read_case("gondret_st152_10_small_imposed")
    run = base.run.model_copy(update={"after_contact": 0.06})
    for way in WAYS:
        release = base.release.model_copy(update={"gap_d": way})
        yield base.model_copy(update={"name": f"way_{way:g}", "release": release, "run": run})
    for viscosity in VISCOSITIES:
        fluid = base.fluid.model_copy(update={"viscosity": viscosity})
        contact = {"mode": "effective", "measured": (0.75,), "edge_d": 0.1}
        yield base.model_copy(
            update={
                "name": f"viscosity_{viscosity:g}", "fluid": fluid, "run": run, "contact": ContactModel(**contact),
            }
        )  # fmt: skip


MIDDLE = 0.5 * (np.array(TIMES[1:]) + np.array(TIMES[:-1]))
FORMS: dict[str, tuple[Callable[[NDArray, Rebound], NDArray], tuple[float, ...]]] = {
    "c Re/(Re + a) s^2/(s^2 + L^2) e^-t/T (1 - e^-h/r)": (
        lambda x, r: x[0] * _formed(r, x[1]) * np.exp(-MIDDLE / x[2]) * _near(r) * r.Re / (r.Re + x[3]),
        (0.6, 7.0, 4.0, 20.0),
    ),
    "the same at any Re": (
        lambda x, r: x[0] * _formed(r, x[1]) * np.exp(-MIDDLE / x[2]) * _near(r), (0.6, 7.0, 4.0),
    ),
    "s/(s + L)": (
        lambda x, r: x[0] * r.way / (r.way + x[1]) * np.exp(-MIDDLE / x[2]) * _near(r), (0.6, 7.0, 4.0),
    ),
    "1/(1 + t/T)": (lambda x, r: x[0] * _formed(r, x[1]) / (1 + MIDDLE / x[2]) * _near(r), (0.6, 7.0, 4.0)),
    "at any h": (lambda x, r: x[0] * _formed(r, x[1]) * np.exp(-MIDDLE / x[2]), (0.6, 7.0, 4.0)),
}  # fmt: skip
"""The form that is used first; constants where a search begins."""


def _formed(r: Rebound, way: float) -> float:
    return r.way**2 / (r.way**2 + way**2)


def _near(r: Rebound) -> NDArray:
    return -np.expm1(-2 * r.gap)


def fitted(found: list[Rebound], form: Callable, begin: tuple[float, ...]) -> tuple[NDArray, NDArray, float]:
    """Constants of a form by least squares over all first rises, their errors, and the rms of u/U that is left."""
    first = [r for r in found if r.bounce == 1]

    def away(x: NDArray) -> NDArray:
        return np.concatenate([(form(x, r) - r.speed)[np.isfinite(r.speed)] for r in first])

    fit = least_squares(away, begin, x_scale=begin)
    rms = float(np.sqrt(np.mean(fit.fun**2)))
    return fit.x, np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac))) * rms, rms


def main() -> None:
    """Print the table and the constants."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", metavar="FOLDER")
    folder = parser.parse_args().runs
    runs = [(read_case(name), RUNS / name) for name in CASES]
    if folder is not None:
        for case in more_cases():
            place = Path(folder) / case.name
            if not (place / "run.json").is_file():
                simulate(case, place, every_step=False, show=print)
            runs.append((case, place))
    found = [r for case, place in runs for r in rebounds(case, place)]
    heads = (f"{a:g}-{b:g}" for a, b in pairwise(TIMES))
    table = Table("run", "bounce", "Re", "way, d", *heads, title="u/U by t U/d")
    for r in found:
        table.add_row(r.name, str(r.bounce), f"{r.Re:.0f}", f"{r.way:.2f}", *(f"{u:.3f}" for u in r.speed))
    console = Console(width=130)
    console.print(table)
    for name, (form, begin) in FORMS.items():
        x, sigma, rms = fitted(found, form, begin)
        constants = ", ".join(f"{a:.2f} ± {b:.2f}" for a, b in zip(x, sigma, strict=True))
        console.print(f"{name}: {constants}; rms {rms:.4f}")


if __name__ == "__main__":
    main()
