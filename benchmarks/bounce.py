"""The point-particle sphere against every shipped record: published closures, fitted ones, forces off, speed.

    python -m benchmarks.bounce [--terms]

prints, in sphere diameters, the rms distance between model and frames from the first contact to t* = 8. The fits
are plain least squares, all frames of all records alike; intervals are not their business.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.optimize import least_squares

from restitution import datasets, laws
from restitution.bounce import Closures, OwnWake, Release, bounce
from restitution.bounce.agreement import Agreement, agreement, release_of
from restitution.bounce.sensitivity import forces_off
from restitution.bounce.wake import STRENGTH, STRENGTH_SIGMA
from restitution.calibration.trajectories.flights import DRAG_SIGMA, HISTORY_SIGMA
from restitution.conditions import Conditions
from restitution.laws.cavitation import ATMOSPHERE
from restitution.laws.source_abstract_eq4 import READINGS
from restitution.stokes import H_FILM
from restitution.tracks import Track

GONDRET = ("gondret2002_st152", "gondret2002_st27")
DROPS = tuple(f"li2012_drop{n}" for n in (1, 2, 3, 5, 6))
REBOUND = (
    *READINGS,
    "legendre_2005", "legendre_2006_plain_st", "two_way_lubrication", "barnocky_davis_1988", "ehd_composite",
)  # fmt: skip
HISTORY = ("dorgan_loth_2007", "mei_adrian_1992", "kim_1998", "basset_1888")


@dataclass(frozen=True)
class Record:
    """A record, and how its sphere was released."""

    name: str
    conditions: Conditions
    track: Track
    release: Release
    apex: float

    def compare(self, closures: Closures) -> tuple[Agreement, float]:
        """Agreement, and the first apex over the recorded one less 1."""
        path = bounce(self.conditions, self.release, closures, end=float(np.ptp(self.track.time_s)) + 0.3)
        apexes = path.apexes()
        return agreement(path, self.track), (apexes[0] if len(apexes) else 0.0) / self.apex - 1


def records() -> list[Record]:
    """All bouncing records: Gondret's from their approach or quoted impact, Li's drops from rest."""
    found = []
    for name in (*GONDRET, *DROPS):
        r, track = datasets.resource(name), datasets.load_track(name)
        drop = r.quoted.get("release_gap_m")
        release = Release(drop) if drop else release_of(track, r.conditions)
        found.append(Record(name, r.conditions, track, release, r.quoted["apex_m"][0]))
    return found


def fit(chosen: list[Record], closures: Callable[..., Closures], start: list[float]) -> np.ndarray:
    """Constants of the closures that bring all frames of the records closest, in diameters."""

    def residuals(x: np.ndarray) -> np.ndarray:
        each = (r.compare(closures(*x))[0].residual_m / r.conditions.sphere.diameter for r in chosen)
        return np.concatenate(list(each))

    return least_squares(residuals, start, diff_step=1e-2).x


def cells(chosen: Iterable[Record], closures: Closures) -> list[str]:
    """``rms (first apex %)`` of each record."""
    found = (r.compare(closures) for r in chosen)
    return [f"{a.rms_d:.3f} ({100 * apex:+.0f}%)" for a, apex in found]


def table(title: str, first: str, chosen: list[Record]) -> Table:
    """An empty table with one column a record."""
    made = Table(title=title)
    for column in (first, *(r.name.split("_")[1] for r in chosen)):
        made.add_column(column, no_wrap=True)
    return made


def published(everything: list[Record]) -> Iterable[Table]:
    """Every rebound law, and the resolved film, with every history kernel."""
    for kernel in (*HISTORY, None):
        history = laws.get(kernel) if kernel else None
        made = table(f"as published; history: {kernel or 'none'}", "rebound", everything)
        for name in REBOUND:
            made.add_row(name, *cells(everything, Closures(rebound=laws.get(name), history=history)))
        for what, tension in (("cavitates at 1 atm", ATMOSPHERE), ("holds", math.inf)):
            made.add_row(f"e_dry, film {what}", *cells(everything, Closures(history=history, tension=tension)))
        yield made


def resolved_film(everything: list[Record]) -> Table:
    """The dry rebound under a film that holds any suction, or cavitates at a tension; with the wake or without."""
    made = table("dry restitution, film resolved: nothing fitted but A = 2 of the wake", "film", everything)
    for wake in (None, OwnWake()):
        for tension in (math.inf, 2 * ATMOSPHERE, ATMOSPHERE, ATMOSPHERE / 2):
            bears = "holds" if math.isinf(tension) else f"cavitates at {tension / ATMOSPHERE:g} atm"
            what = f"{bears}, wake" if wake else bears
            made.add_row(what, *cells(everything, Closures(tension=tension, wake=wake)))
    return made


def fitted(everything: list[Record]) -> Table:
    """One or two constants, for one record or for all."""
    made = table("fitted (K of Eq. (4) or f_1 of the kernel; A = 2 is not fitted)", "closures", everything)
    first, drops = everything[:1], everything[2:]

    def eq4(name: str, kernel: str, wake: OwnWake | None = None, film: float = H_FILM) -> Callable[..., Closures]:
        return lambda K, f_1=None: Closures(
            rebound=laws.get(name, K=float(np.clip(K, 0, 200))),
            history=laws.get(kernel, **({} if f_1 is None else {"f_1": float(np.clip(f_1, 1e-3, 100))})),
            wake=wake,
            film=film,
        )

    for name in ("eq4_exponential", "eq4_rational"):
        for kernel in HISTORY[:3]:
            for who, chosen in (("St 152", first), ("drops", drops)):
                K = fit(chosen, eq4(name, kernel), [12.0])
                made.add_row(f"{name}, {kernel}, {who}: K {K[0]:.1f}", *cells(everything, eq4(name, kernel)(*K)))
            for who, chosen in (("St 152", first), ("all", everything)):
                K = fit(chosen, eq4(name, kernel, OwnWake()), [12.0])
                line = f"the same with wake, {who}: K {K[0]:.1f}"
                made.add_row(line, *cells(everything, eq4(name, kernel, OwnWake())(*K)))
        for film in (0.05, 0.2, 0.3):
            closures = eq4(name, HISTORY[0], OwnWake(), film)
            K = fit(first, closures, [12.0])
            made.add_row(f"{name}, wake, film {film} d, St 152: K {K[0]:.1f}", *cells(everything, closures(*K)))
        x = fit(first, eq4(name, "mei_adrian_1992"), [12.0, 0.2])
        line = f"{name}, mei_adrian_1992, St 152: K {x[0]:.1f}, f_1 {x[1]:.2f}"
        made.add_row(line, *cells(everything, eq4(name, "mei_adrian_1992")(*x)))
    return made


def switched_off(record: Record, closures: Closures, title: str) -> Table:
    """Each force off in turn."""
    found = forces_off(record.conditions, record.release, closures, 0.3, record.track)
    made = Table(title=f"{record.name}: forces off; {title}")
    for column in ("off", "apex 1 [mm]", "change 1", "change 2", "change 3", "from whole [d]", "from record [d]"):
        made.add_column(column)
    for row in found.itertuples():
        changes = (f"{100 * c:+.1f}%" for c in (row.apex_1_change, row.apex_2_change, row.apex_3_change))
        made.add_row(row.off, f"{1e3 * row.apex_1_m:.2f}", *changes, f"{row.change_d:.3f}", f"{row.rms_d:.3f}")
    return made


def speed(record: Record) -> Table:
    """Time of a whole trajectory to t = 0.2 s after warm-up, median of 30."""
    made = Table(title=f"{record.name}: time of a trajectory")
    for column in ("closures", "ms", "steps", "energy imbalance"):
        made.add_column(column)
    law = laws.get("legendre_2005")
    for what, closures in {
        "rebound law": Closures(rebound=law),
        "rebound law, no history": Closures(rebound=law, history=None),
        "rebound law, wake": Closures(rebound=law, wake=OwnWake()),
        "film resolved, cavitates": Closures(),
        "film resolved, holds": Closures(tension=math.inf),
    }.items():
        took = []
        for _ in range(31):
            began = time.perf_counter()
            path = bounce(record.conditions, record.release, closures, end=0.2)
            took.append(time.perf_counter() - began)
        made.add_row(what, f"{1e3 * np.median(took[1:]):.1f}", str(len(path.time_s)), f"{path.imbalance:.1e}")
    return made


def terms(record: Record) -> Table:
    """Each term of the forces as far off as it is known, or by another law: first apex and distance."""
    whole = Closures(rebound=laws.get("eq4_exponential", K=10.65), wake=OwnWake())
    made = table(
        "what moves the first apex: Eq. (4) with K = 10.65, the wake of the resolved runs", "term", [record]
    )
    made.add_row("nothing", *cells([record], whole))
    for name in ("brown_lawler_2003", "schiller_naumann_1935", "abraham_1970"):
        made.add_row(f"drag: {name}", *cells([record], replace(whole, drag=laws.get(name))))
    for name in (*HISTORY[1:], None):
        history = laws.get(name) if name else None
        made.add_row(f"history: {name or 'none'}", *cells([record], replace(whole, history=history)))
    for sign in (-1, 1):
        forces = {"drag_factor": 1 + sign * DRAG_SIGMA}, {"history_factor": 1 + sign * HISTORY_SIGMA}
        for change in forces:
            ((name, value),) = change.items()
            made.add_row(f"{name} {value:g}", *cells([record], replace(whole, **change)))
        c = STRENGTH + sign * STRENGTH_SIGMA
        made.add_row(f"strength of the wake {c:.2f}", *cells([record], replace(whole, wake=OwnWake(c))))
        K = 10.65 - 2 * sign
        made.add_row(f"K {K:g}", *cells([record], replace(whole, rebound=laws.get("eq4_exponential", K=K))))
    for c in (0.0, 0.5, 0.6, 1.0):
        made.add_row(f"strength of the wake {c:g}", *cells([record], replace(whole, wake=OwnWake(c))))
    return made


def main() -> None:
    """Print all tables, or those that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--terms", action="store_true", help="what moves the first apex of St 152, alone")
    only = parser.parse_args().terms
    console, everything = Console(width=200), records()
    if only:
        console.print(terms(everything[0]))
        return
    for made in published(everything):
        console.print(made)
    console.print(resolved_film(everything))
    console.print(fitted(everything))
    eq4 = Closures(rebound=laws.get("eq4_exponential", K=10.9), wake=OwnWake())
    console.print(
        switched_off(everything[0], Closures(rebound=laws.get("legendre_2005")), "Legendre, as published")
    )
    console.print(switched_off(everything[0], eq4, "Eq. (4) with K = 10.9, wake"))
    console.print(switched_off(everything[0], Closures(), "film resolved, e_dry"))
    console.print(switched_off(everything[0], Closures(wake=OwnWake()), "film resolved, e_dry, wake"))
    console.print(switched_off(everything[-1], replace(eq4, wake=None), "Eq. (4) with K = 10.9"))
    console.print(speed(everything[0]))


if __name__ == "__main__":
    main()
