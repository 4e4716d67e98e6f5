"""Runs of a case, and those that are kept.

A run: :mod:`~restitution.runs.closures` and :mod:`~restitution.runs.measured` (laws and records as the solver
takes them), :mod:`~restitution.runs.setup` (all that it is given), :mod:`~restitution.runs.resolved` (the flow
resolved), :mod:`~restitution.runs.simulate` (from a case to its files), :mod:`~restitution.runs.stand`
(checkpoints), :mod:`~restitution.runs.approach` (the way to the film, which several cases may share),
:mod:`~restitution.runs.results` and :mod:`~restitution.runs.filmed` (tables), :mod:`~restitution.runs.record`
(``run.json``); :mod:`~restitution.runs.progress` and :mod:`~restitution.runs.flow_pictures` look on.

Whether a kept run (:mod:`~restitution.runs.kept`) still holds is the question of :mod:`restitution.runs.validity`.

:mod:`~restitution.runs.point_particle` is the same case as a point particle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from restitution.runs.resolved import ResolvedRun

__all__ = ["ResolvedRun"]


def __getattr__(name: str) -> object:
    """What is handed on, loaded when it is first asked for: with it come the solver and its compiler."""
    if name == "ResolvedRun":
        from restitution.runs.resolved import ResolvedRun

        return ResolvedRun
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
