"""The six faces of the box: what may be chosen, and what walls, inlets and outlets do after a step.

Read :mod:`~lbm.faces.records` (what may be chosen), :mod:`~lbm.faces.passes` (who acts where), then what they do:
:mod:`~lbm.faces.moving_wall` and :mod:`~lbm.faces.outlet`, on links that :mod:`~lbm.faces.returning` finds.
"""

from lbm.faces.records import Face, FreeSlip, Inlet, NoSlip, Outlet, Periodic

__all__ = [
    "Face",
    "FreeSlip",
    "Inlet",
    "NoSlip",
    "Outlet",
    "Periodic",
]
