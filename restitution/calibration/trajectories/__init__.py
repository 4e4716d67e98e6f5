"""Fits to all positions of a track.

Read :mod:`.recordings` and :mod:`.recording_checks` (the frames), :mod:`.unknowns` (what is estimated of a
record), :mod:`.flight_map` (trajectories, interpolated), :mod:`.correlated_noise`, :mod:`.likelihood`,
:mod:`.whole_trajectories` (the restitution of each bounce), :mod:`.doubts` (signs that the model is not that of
the flight), :mod:`.fit` (the law); :mod:`.synthetic` makes records of known truth.
"""
