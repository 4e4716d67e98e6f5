"""Texts for DEM codes: :mod:`.lammps`, :mod:`.liggghts`, :mod:`.yade`.

Level 0 is a constant e with the range of St in which it holds (:mod:`.constant`). Level 1 is the code's own law
with inputs inverted or refitted (:mod:`.viscous_contact` for LIGGGHTS), with the deviation that remains. Level 2
is the law at the speed of first contact: :mod:`.lammps_law`, :mod:`.liggghts_law`, :mod:`.yade_law`, which share
:mod:`.at_impact`. :mod:`.snippet` is what all texts share.
"""

from restitution.export.dem.lammps import lammps
from restitution.export.dem.liggghts import liggghts
from restitution.export.dem.snippet import Request
from restitution.export.dem.yade import yade

__all__ = ["Request", "lammps", "liggghts", "yade"]
