"""Texts for DEM codes: :mod:`.lammps`, :mod:`.liggghts`, :mod:`.yade`.

Level 0 is a constant e with the range of St in which it holds (:mod:`.constant`). Level 1 is the code's own law
with inputs inverted or refitted (:mod:`.viscous_contact` for LIGGGHTS), with the deviation that remains.
:mod:`.snippet` is what the texts share.
"""

from restitution.export.dem.lammps import lammps, lammps_drop_test
from restitution.export.dem.liggghts import liggghts
from restitution.export.dem.snippet import Request
from restitution.export.dem.yade import yade

__all__ = ["Request", "lammps", "lammps_drop_test", "liggghts", "yade"]
