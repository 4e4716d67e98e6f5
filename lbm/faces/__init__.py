"""The six faces of the box: what may be chosen, and what walls, inlets and outlets do after a step.

Read :mod:`~lbm.faces.records`, then :mod:`~lbm.faces.passes`.
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
