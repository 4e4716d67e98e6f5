"""The point-particle model in the Fig. 2 report: its lines for a record, their scores, and each force off in turn.

The sphere is released as it was filmed: its first frame, at the mean speed of the approach. One line has the K
that all positions of all measured records give (:mod:`restitution.calibration.trajectories.fit`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution import datasets, laws
from restitution.bounce import Closures, OwnWake, Trajectory, bounce
from restitution.bounce.agreement import release_of
from restitution.bounce.sensitivity import forces_off
from restitution.conditions import Conditions
from restitution.impacts.find import find_impacts
from restitution.stokes import Speed
from restitution.tracks import Track

if TYPE_CHECKING:
    import pandas as pd

DRY, DRY_WAKE, RATIONAL = "point_particle_dry", "point_particle_dry_wake", "point_particle_eq4_rational"
FITTED, FITTED_LAW = "point_particle_eq4_fitted", "eq4_exponential"
_AFTER_S, _STEP_S = 0.3, 1e-4


@dataclass(frozen=True)
class PointLine:
    """A trajectory of the model for a record, ``contact`` in words; times are counted from the first contact."""

    name: str
    record: str
    contact: str
    path: Trajectory

    @property
    def conditions(self) -> Conditions:
        """Those of the record."""
        return self.path.conditions

    @cached_property
    def time_s(self) -> NDArray:
        """The steps of the model, and times between where they are far apart."""
        t = self.path.time_s
        return np.sort(np.concatenate([t, np.arange(t[0], t[-1], _STEP_S)])) - self.path.impacts[0].time_s

    @cached_property
    def gap_m(self) -> NDArray:
        """At ``time_s``."""
        return self.path.gap(self.time_s + self.path.impacts[0].time_s)

    @cached_property
    def velocity_m_s(self) -> NDArray:
        """At ``time_s``."""
        return self.path.velocity(self.time_s + self.path.impacts[0].time_s)

    @property
    def contacts_s(self) -> NDArray:
        """Times of all contacts."""
        return np.array([i.time_s for i in self.path.impacts]) - self.path.impacts[0].time_s

    @property
    def far_speed(self) -> float:
        """Speed of the first approach outside the film, carried to the wall, as the record's camera has it."""
        track, t = datasets.load_track(self.record), self.time_s[[0, -1]]
        frame = float(np.median(np.diff(track.time_s)))
        time = frame * (np.arange(np.ceil(t[0] / frame), np.floor(t[1] / frame)) + 0.5)
        filmed = Track(time, self.path.gap(time + self.path.impacts[0].time_s), "gap", track.sigma)
        return float(find_impacts(filmed, self.conditions, Speed.FAR).rows[0]["impact_speed_m_s"])


def closures() -> dict[str, tuple[str, Closures]]:
    """What is shown: the contact in words, and the closures."""
    return {
        DRY: ("e_dry, cavitating film, no wake", Closures()),
        DRY_WAKE: ("e_dry, cavitating film, wake", Closures(wake=OwnWake())),
        RATIONAL: ("eq4_rational", Closures(rebound=laws.get("eq4_rational"))),
    }


def lines(record: str) -> list[PointLine]:
    """The model's trajectories for a record."""
    conditions, track = datasets.resource(record).conditions, datasets.load_track(record)
    release = release_of(track, conditions)
    end = float(np.ptp(track.time_s)) + _AFTER_S
    found = [
        PointLine(name, record, contact, bounce(conditions, release, chosen, end))
        for name, (contact, chosen) in closures().items()
    ]
    K = fitted_K()
    path = bounce(conditions, release, Closures(rebound=laws.get(FITTED_LAW, K=K), wake=OwnWake()), end)
    return [*found, PointLine(FITTED, record, f"{FITTED_LAW}, K = {K:.1f}, wake", path)]


@cache
def fitted_K() -> float:
    """K of the first-ranked reading by whole trajectories, all measured records, with wake.

    Three digits: the fourth may depend on the machine's arithmetic.
    """
    from restitution.calibration.estimation.plan import Plan
    from restitution.calibration.estimation.rebound_model import model_of
    from restitution.calibration.trajectories.fit import law_fit, observations
    from restitution.report.records import READING, measured

    found = observations(measured((True,)).trajectories[True], READING)
    return float(f"{law_fit(Plan(model_of(FITTED_LAW)), found).maximum.values[0]:.3g}")


def without_forces(record: str) -> pd.DataFrame:
    """Each force of the model with film, cavitation and wake off in turn (:func:`forces_off`)."""
    conditions, track = datasets.resource(record).conditions, datasets.load_track(record)
    end = float(np.ptp(track.time_s)) + _AFTER_S
    return forces_off(conditions, release_of(track, conditions), closures()[DRY_WAKE][1], end, track)
