"""Fits to all positions of a track.

Read :mod:`.recordings` and :mod:`.recording_checks` (the frames), :mod:`.starts` (how they start),
:mod:`.unknowns` (what is estimated of a record), :mod:`.flights` (its trajectories), :mod:`.flight_map` (the same,
interpolated), :mod:`.correlated_noise`, :mod:`.likelihood`, :mod:`.whole_trajectories` (the restitution of each
bounce), :mod:`.films` (one film for all), :mod:`.doubts` (signs that the model is not that of the flight),
:mod:`.fit` (the law); :mod:`.synthetic` makes records of known truth.
"""

from restitution.calibration.trajectories.fit import Measured, TrajectoryFit, fit_law
from restitution.calibration.trajectories.recordings import Recording, read_recordings
from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory

__all__ = [
    "Measured",
    "Recording",
    "TrajectoryFit",
    "WholeTrajectory",
    "fit_law",
    "read_recordings",
]
