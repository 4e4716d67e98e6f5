"""Trajectories from one release that differ in the restitution of their bounces: what they share is flown once.

A fit tries hundreds of restitutions, mostly of the last bounce; the way to its contact is the same for all.
"""

from __future__ import annotations

from dataclasses import replace

from restitution.bounce.closures import Closures, Release
from restitution.bounce.model import Run, Trajectory
from restitution.conditions import Conditions


class SharedFlights:
    """The trajectories of a release for given restitutions, each what :func:`restitution.bounce.bounce` gives."""

    def __init__(
        self,
        conditions: Conditions,
        release: Release,
        closures: Closures,
        end: float,
        tolerance: float,
    ):
        self._begin = conditions, release, closures, end, tolerance
        self._at_wall: dict[tuple[float, ...], Run] = {}

    def __call__(self, measured: tuple[float, ...]) -> Trajectory:
        """The trajectory whose bounces have the restitutions ``measured``, and after them none."""
        conditions, release, closures, end, tolerance = self._begin
        closures = replace(closures, measured=measured)
        known = next((n for n in range(len(measured), -1, -1) if measured[:n] in self._at_wall), None)
        if known is None:
            run = Run(conditions, release, closures, end, tolerance)
            touches = run.fly_to_wall()
        else:
            run, touches = self._at_wall[measured[:known]].branch(closures), True
        while touches:
            self._at_wall.setdefault(measured[: len(run.impacts)], run.branch(closures))
            run.rebound()
            touches = run.fly_to_wall()
        return run.trajectory()
