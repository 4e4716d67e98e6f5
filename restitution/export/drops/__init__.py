"""What the programs deliver, measured by drop tests.

Read :mod:`.measure`, then :mod:`.deck`, then a program: :mod:`.lammps`, :mod:`.liggghts`, :mod:`.yade`,
:mod:`.openfoam`.
:mod:`.kept` is the table of what was measured, for the report.
"""

from restitution.export.drops.deck import Deck, Installed, NotInstalledError, Program, run_deck
from restitution.export.drops.lammps import LAMMPS
from restitution.export.drops.liggghts import LIGGGHTS
from restitution.export.drops.openfoam import OPENFOAM
from restitution.export.drops.yade import YADE

__all__ = ["PROGRAMS", "Deck", "Installed", "NotInstalledError", "Program", "run_deck"]

PROGRAMS: dict[str, Program] = {"lammps": LAMMPS, "liggghts": LIGGGHTS, "yade": YADE, "openfoam": OPENFOAM}
"""By the names of the targets."""
