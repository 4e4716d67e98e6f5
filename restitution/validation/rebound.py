"""A trajectory against its record: heights, times and restitutions of the bounces, distance; and how sure each is.

One set of measures for whoever made the trajectory: the resolved solver, the point particle, another program.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache

import numpy as np

from restitution import datasets
from restitution.bounce.agreement import distance_from_contact_d
from restitution.cases.case import Case
from restitution.conditions import Conditions
from restitution.impacts.bounces import Bounces, filmed
from restitution.impacts.shipped import impacts_of
from restitution.report.fig2.scores import BOUNCES, BounceByBounce, reference_apexes
from restitution.runs.filmed import simulated_impacts
from restitution.stokes import Speed
from restitution.validation.row import Reference, Values, at_most, near

GRID = 0.027
"""Relative error of a first apex by ten cells a diameter: what 20 fly further (cases *_small_imposed)."""
E_DRY = 0.02
"""Error of a dry restitution: steel and glass spheres in air, 0.97 +- 0.02."""


def quantities(found: Bounces, record: str, case: Case) -> Values:
    """Apexes in mm, times between contacts in ms, distance in d, of a trajectory beside its record.

    e_eff of each bounce is taken as the record's camera would have it (``far``).
    """
    import pandas as pd

    conditions = case.conditions
    bounce = BounceByBounce.of(found, record_bounces(record), record)
    values = {f"apex {k + 1}, mm": 1e3 * bounce.apexes_m[k] for k in range(BOUNCES)}
    values |= {f"flight {k + 1}, ms": 1e3 * bounce.intervals_s[k] for k in range(BOUNCES)}
    values["rms, d"] = distance_from_contact_d(found, record_bounces(record), conditions)
    table = pd.DataFrame({"time_s": found.time_s - found.contacts_s[0], "gap_m": found.gap_m})
    impacts = simulated_impacts(table, case)[0]
    far = impacts[(impacts.speed_definition == str(Speed.FAR)) & (impacts.outcome == "rebound")]
    values |= {f"e {int(n)}": float(e) for n, e in zip(far.impact, far.e_eff, strict=True)}
    return {label: value for label, value in values.items() if math.isfinite(value)}


@cache
def record_bounces(record: str) -> Bounces:
    """The bounces of a shipped record as filmed."""
    r = datasets.resource(record)
    first = 0.0 if r.kind == "simulated" else None  # its zero is the end of its stretched contact
    return filmed(datasets.load_track(record), r.conditions, first)


@dataclass(frozen=True)
class Errors:
    """Relative errors of a first apex: of the ``grid``, and of what the case was ``given`` (e_dry, a law's K)."""

    grid: float = GRID
    given: float = 2 * E_DRY / 0.97

    @property
    def both(self) -> float:
        """Root of the sum of squares."""
        return math.hypot(self.grid, self.given)


def references(record: str, errors: Errors, but: Collection[str] = ()) -> tuple[Reference, ...]:
    """What a trajectory is held against: the record's bounces, each with its error, twice that of reading.

    Of the n-th bounce the apex goes as e^(2n), so a relative error of what was given and of the grid is n times
    that of the first apex; a time goes as the root of a height. ``but``: labels that a run does not reach.
    """
    r, found = datasets.resource(record), record_bounces(record)
    sigma, offset, scale = (
        r.digitisation_error.sigma,
        r.digitisation_error.offset_sigma,
        r.digitisation_error.scale_sigma,
    )
    level = 2e3 * math.hypot(sigma.get("gap_m", 0.0), offset.get("gap_m", 0.0))
    held = [
        near(f"apex {k}, mm", 1e3 * apex, relative=k * errors.both, absolute=level)
        for k, apex in enumerate(reference_apexes(record, found)[:BOUNCES], 1)
    ]
    clock = 2 * scale.get("time_s", 0.0)
    frame = 1e3 * float(np.median(np.diff(found.time_s))) / 2
    held += [
        near(f"flight {k}, ms", 1e3 * span, relative=k * errors.both / 2 + clock, absolute=frame)
        for k, span in enumerate(found.intervals_s[:BOUNCES], 1)
    ]
    for row in impacts_of(record, Speed.FAR).rows:
        if row["outcome"] == "rebound":
            e, own = float(row["e_eff"]), 2 * float(row["e_eff_sigma"])
            held.append(near(f"e {row['impact']}", e, absolute=own + errors.both / 2 * e))
    d = r.conditions.sphere.diameter
    highest = reference_apexes(record, found)[0] / d
    held.append(at_most("rms, d", errors.both * highest / math.sqrt(2) + 2 * offset.get("gap_m", 0.0) / d))
    return tuple(reference for reference in held if reference.label not in but)


def settling_values(velocity_m_s: np.ndarray, record: str) -> Values:
    """Peak speed of a release without contact, over the stated terminal speed."""
    terminal = datasets.resource(record).quoted["terminal_speed_m_s"]
    return {"peak over terminal": float(-np.min(velocity_m_s)) / terminal}


def settling_references(record: str, unbounded: bool) -> tuple[Reference, ...]:
    """That of the measurement; 1 where the box has no end."""
    goal = 1.0 if unbounded else datasets.resource(record).quoted["maximum_over_terminal_speed"]
    return (near("peak over terminal", goal, relative=0.025),)


def same_conditions(one: Conditions, other: Conditions) -> bool:
    """Whether two conditions are of the same experiment, to the digits that are stated."""
    pairs = (
        (one.fluid.density, other.fluid.density), (one.fluid.viscosity, other.fluid.viscosity),
        (one.sphere.diameter, other.sphere.diameter), (one.sphere.density, other.sphere.density),
        (one.gravity, other.gravity),
    )  # fmt: skip
    return all(math.isclose(a, b, rel_tol=1e-3) for a, b in pairs)
