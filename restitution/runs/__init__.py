"""Runs of a case, and those that are kept.

A run: :mod:`~restitution.runs.closures` and :mod:`~restitution.runs.measured` (laws and records as the solver
takes them), :mod:`~restitution.runs.setup` (all that it is given), :mod:`~restitution.runs.resolved` (the flow
resolved), :mod:`~restitution.runs.simulate` (from a case to its files), :mod:`~restitution.runs.results` and
:mod:`~restitution.runs.filmed` (tables), :mod:`~restitution.runs.record` (``run.json``);
:mod:`~restitution.runs.progress` and :mod:`~restitution.runs.flow_pictures` look on.

Whether a kept run still holds: :mod:`~restitution.runs.kept`, by what it was told (:mod:`~restitution.runs.told`)
and what the program computes (:mod:`~restitution.runs.physics`); :mod:`~restitution.runs.program` is a shortcut,
:mod:`~restitution.runs.key` is for checkpoints.

:mod:`~restitution.runs.point_particle` is the same case as a point particle.
"""
