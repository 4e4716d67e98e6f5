"""Measured records of a bouncing sphere, made into impacts by their whole trajectories once for both figures."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from restitution import datasets
from restitution.calibration.reading.reading import Reading
from restitution.calibration.trajectories.fit import Measured
from restitution.calibration.trajectories.recordings import Recording, read_recordings
from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory, whole_trajectories

READING = Reading()
"""How the records are read: as shipped."""


def measured(wakes: Sequence[bool] = (False, True)) -> Measured:
    """All measured records under the models with the wake of the approach, without, or both."""
    return Measured(_recordings(), {wake: _trajectories(wake) for wake in wakes})


@cache
def _recordings() -> tuple[Recording, ...]:
    tracks = [r for r in map(datasets.resource, datasets.names()) if r.table == "trajectory"]
    names = [r.name for r in tracks if r.kind == "measured" and r.conditions.sphere.e_dry is not None]
    return tuple(read_recordings(names, READING))


@cache
def _trajectories(wake: bool) -> list[WholeTrajectory]:
    return whole_trajectories(_recordings(), wake)
