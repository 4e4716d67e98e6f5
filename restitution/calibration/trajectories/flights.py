"""The trajectories of a record by the equation of motion, for what is open at its start and at its bounces.

A model of the flight has the unknowns ``open``, the first of which is what is open at the start, gives the
trajectory at a point of them, and knows where a search may begin:

- :class:`Bounces`: the effective restitution of each bounce, the film a black box;
- :class:`Films`: one resolved film for all bounces, h_min, the tension at which it cavitates, and e_dry.

No law of drag or history is sure, and an e that is told by flights would be as wrong as they are. So each record
has a factor of both among its unknowns, with the width of what is known of them without a wall
(:mod:`restitution.bounce.unbounded`); with the wake of the approach its strength too, its prior that of the
resolved runs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import Closures, IntegrationError, OwnWake, Release, Trajectory, bounce, terminal_speed
from restitution.bounce.shared import SharedFlights
from restitution.bounce.wake import STRENGTH, STRENGTH_SIGMA
from restitution.calibration.trajectories.recordings import Recording
from restitution.calibration.trajectories.unknowns import Open
from restitution.errors import Defect, InputError
from restitution.laws.cavitation import ATMOSPHERE
from restitution.stokes import H_FILM

TOLERANCE = 1e-5
"""Relative error of an integration step; the trajectory is then within 1e-4 d of the converged one."""
RESTITUTION = (0.5, 1.0)
"""Mean and standard deviation of the prior of each e: told apart from none by no record."""
WAKE, DRAG, HISTORY = "wake_strength", "drag_factor", "history_factor"
DRAG_SIGMA, HISTORY_SIGMA = 0.05, 0.5
"""Of the factors: the standard curve is within 5 % of towed spheres at any Re from 5 to 1000; what laws of the
history force add to the drag of an oscillating sphere is 0.74 to 1.75 times what the default adds."""
_DRAG_STEP, _HISTORY_STEP = 0.05, 0.2
FILM = H_MIN, TENSION = "ln_h_min_m", "ln_tension_Pa"
E_DRY = "e_dry"
_WAKE_STEP = 0.15
_START_STEP = 0.02
"""Greatest step of the first map in what is open at the start, relative."""
_E_STEP = 0.02
"""And in each restitution."""


class FlightModel:
    """What the models have in common: the record, the wake, and the unknowns before those of the contacts."""

    def __init__(self, r: Recording, wake: bool, edge: float = H_FILM):
        self.recording, self.wake, self.edge = r, wake, edge

    @property
    def begin(self) -> tuple[Open, ...]:
        """What is open at the start, the factors of drag and history, and the strength of the wake."""
        s = self.recording.start
        step = min(s.prior.sigma, _START_STEP * s.prior.mean)
        start = Open(s.name, s.prior.mean, s.prior.sigma, 0.0, math.inf, step)
        wake = (Open(WAKE, STRENGTH, STRENGTH_SIGMA, 0.0, 5.0, _WAKE_STEP),) if self.wake else ()
        return (
            start,
            Open(DRAG, 1.0, DRAG_SIGMA, 0.0, 10.0, _DRAG_STEP),
            Open(HISTORY, 1.0, HISTORY_SIGMA, 0.0, 10.0, _HISTORY_STEP),
            *wake,
        )

    def forces(self, x: NDArray) -> dict[str, Any]:
        """The closures that the flight's own unknowns choose, at a point of them."""
        own = {o.name: float(np.clip(value, o.low, o.high)) for o, value in zip(self.begin, x, strict=False)}
        return forces_of(own)

    def before(self, start: float) -> float:
        """Velocity in m/s before the release, of a sphere that was falling; of one at rest 0."""
        return {"height": 0.0, "speed": -start, "impact": -fall_speed(self.recording)}[self.recording.start.kind]


class Bounces(FlightModel):
    """The restitution of each of ``bounces``; within ``edge`` diameters it stands for every viscous force."""

    def __init__(self, r: Recording, wake: bool, edge: float, bounces: int | None = None):
        super().__init__(r, wake, edge)
        self.bounces = len(r.contacts_s) if bounces is None else bounces
        self._from: dict[tuple[float, ...], SharedFlights] = {}

    @cached_property
    def open(self) -> tuple[Open, ...]:
        """Start, strength of the wake, e_1, ..., e_N."""
        e = [Open(restitution_name(n), *RESTITUTION, 0.0, 1.0, _E_STEP) for n in range(1, self.bounces + 1)]
        return *self.begin, *e

    def __call__(self, x: NDArray) -> Trajectory:
        """The one with ``x``; restitutions that are missing at its end are none."""
        r, first = self.recording, len(self.begin)
        begin = tuple(map(float, x[:first]))
        if begin not in self._from:
            closures = Closures(measured=(), film=self.edge, **self.forces(x))
            release, end = _release(r, begin[0])
            self._from[begin] = SharedFlights(r.conditions, release, closures, end, TOLERANCE)
        return _flown(r, lambda: self._from[begin](tuple(map(float, np.clip(x[first:], 0, 1)))))

    def fewer(self, bounces: int) -> Bounces:
        """The same with so many bounces."""
        return Bounces(self.recording, self.wake, self.edge, bounces)

    def guess(self) -> NDArray:
        """Start and wake at their priors; each restitution the one whose flight is nearest to the frames."""
        from scipy.optimize import minimize_scalar

        r, known = self.recording, [x.mean for x in self.begin]
        d, first = r.conditions.sphere.diameter, len(known)
        touches = [r.clock.mean if math.isnan(t) else t for t in r.contacts_s]
        if r.clock_of == "contact":
            touches[0] = r.clock.mean
        ends = [*touches[1:], np.inf]
        for n, (touch, end) in enumerate(zip(touches, ends, strict=True)):
            here = (r.time_s > touch) & (r.time_s < end)
            time, gap = r.time_s[here] - touch, r.gap_m[here]

            def misfit(e: float, n: int = n, time: NDArray = time, gap: NDArray = gap) -> float:
                path = self(np.array([*known, e]))
                if len(path.impacts) <= n:
                    return float(np.sum(gap**2) / d**2)
                after = path.gap(path.impacts[n].time_s + time)
                return float(np.sum((after - gap) ** 2) / d**2)

            nearest = minimize_scalar(misfit, bounds=(0.05, 0.98), method="bounded", options={"xatol": 5e-3})
            known.append(float(nearest.x))
        return np.array(known[: first + self.bounces])


class Films(FlightModel):
    """One resolved film: (ln of) the gap of contact h_min, (ln of) the tension it holds on rebound, e_dry.

    Priors: h_min the roughness stated (else 1e-4 r) within a factor of 3, the tension an atmosphere within one of
    3, e_dry that of the conditions +- 0.1: wide enough for the frames to speak.
    """

    def __init__(self, r: Recording, wake: bool, bounces: int | None = None):
        super().__init__(r, wake)
        self.bounces = len(r.contacts_s) if bounces is None else bounces

    @cached_property
    def open(self) -> tuple[Open, ...]:
        """Start, strength of the wake, ln(h_min/m), ln(tension/Pa), e_dry."""
        c, factor = self.recording.conditions, math.log(3)
        rough = math.log(Closures().film_limit(c))
        tension = math.log(ATMOSPHERE)
        return (
            *self.begin,
            Open(H_MIN, rough, factor, rough - 5, rough + 5, 0.2),
            Open(TENSION, tension, factor, tension - 5, tension + 5, 0.2),
            Open(E_DRY, Closures().dry(c), 0.1, 0.3, 1.0, _E_STEP),
        )  # fmt: skip

    def __call__(self, x: NDArray) -> Trajectory:
        """The one with ``x``."""
        h_min, tension, e_dry = (
            float(np.clip(value, o.low, o.high)) for value, o in zip(x[-3:], self.open[-3:], strict=True)
        )
        closures = Closures(contact=math.exp(h_min), tension=math.exp(tension), e_dry=e_dry, **self.forces(x))
        return flight(self.recording, float(x[0]), closures)

    def fewer(self, bounces: int) -> Films:
        """The same unknowns, told by so many bounces."""
        return Films(self.recording, self.wake, bounces)

    def guess(self) -> NDArray:
        """All at their priors."""
        return np.array([x.mean for x in self.open])


def forces_of(unknowns: Mapping[str, float]) -> dict[str, Any]:
    """Factors of drag and history, and the wake, of unknowns by name, for :class:`restitution.bounce.Closures`."""
    chosen: dict[str, Any] = {name: max(unknowns[name], 0.0) for name in (DRAG, HISTORY)}
    return chosen | ({"wake": OwnWake(max(unknowns[WAKE], 0.0))} if WAKE in unknowns else {})


def restitution_name(n: int) -> str:
    """Of the restitution of bounce ``n``, counted from 1."""
    return f"e_{n}"


def flight(r: Recording, start: float, closures: Closures) -> Trajectory:
    """The trajectory of a record with any closures, released with what is open at its ``start``."""
    release, end = _release(r, start)
    return _flown(r, lambda: bounce(r.conditions, release, closures, end, TOLERANCE))


def fall_speed(r: Recording) -> float:
    """The scale of an approach's speed: terminal, or that of a free fall over a diameter."""
    return min(terminal_speed(r.conditions), math.sqrt(r.conditions.free_fall * r.conditions.sphere.diameter))


def _release(r: Recording, start: float) -> tuple[Release, float]:
    """The release, and a time in s by which a flight from there is over."""
    release = r.start.release(start)
    return release, float(4 * np.ptp(r.time_s) + 3 * release.gap / max(release.speed, fall_speed(r)))


def _flown(r: Recording, fly: Callable[[], Trajectory]) -> Trajectory:
    """What ``fly`` gives; raises :class:`InputError` naming the record where that is no bounce."""
    try:
        path = fly()
    except IntegrationError as error:
        raise InputError(Defect(str(error), file=r.name)) from None
    if not path.impacts:
        raise InputError(Defect("the model does not reach the wall within the record", file=r.name))
    return path
