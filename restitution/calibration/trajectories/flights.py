"""The trajectories of a record by the equation of motion, for what is open at its start and at its bounces."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import Closures, IntegrationError, OwnWake, Release, Trajectory, bounce, terminal_speed
from restitution.bounce.shared import SharedFlights
from restitution.calibration.trajectories.recordings import Recording
from restitution.errors import Defect, InputError

TOLERANCE = 1e-5
"""Relative error of an integration step; the trajectory is then within 1e-4 d of the converged one."""


class Flights:
    """The trajectories of a record under the model, with the wake of the approach or without.

    ``edge`` of the film in diameters: within it e_eff stands for every viscous force.
    """

    def __init__(self, r: Recording, wake: bool, edge: float):
        self.recording, self.wake, self.edge = r, wake, edge
        self._from: dict[float, SharedFlights] = {}

    def __call__(self, x: NDArray) -> Trajectory:
        """The one with ``x``: what is open at the start, and the restitution of each bounce."""
        r, start = self.recording, float(x[0])
        if start not in self._from:
            closures = Closures(measured=(), wake=OwnWake() if self.wake else None, film=self.edge)
            release, end = _release(r, start)
            self._from[start] = SharedFlights(r.conditions, release, closures, end, TOLERANCE)
        return _flown(r, lambda: self._from[start](tuple(map(float, np.clip(x[1:], 0, 1)))))


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
