"""Spheres that move in the fluid and meet walls.

Read :mod:`~lbm.spheres.spheres` (a step of a sphere), then its parts in their order: :mod:`~lbm.spheres.surface`,
:mod:`~lbm.spheres.exchange`, :mod:`~lbm.spheres.refill` and :mod:`~lbm.spheres.mass` (sphere and fluid),
:mod:`~lbm.spheres.symmetry` (a sphere that a mirror cuts), :mod:`~lbm.spheres.film`,
:mod:`~lbm.spheres.contact` and :mod:`~lbm.spheres.wall_motion` (sphere and wall), where each kind of contact has a
motion of its own (:mod:`~lbm.spheres.motion`, :mod:`~lbm.spheres.carried`).
:mod:`~lbm.spheres.within` and :mod:`~lbm.spheres.runaway` stop one that leaves the box, or diverges;
:mod:`~lbm.spheres.sampling` tells one film or contact from another, for checkpoints.
"""

from lbm.spheres.contact import SETTLED, Contact, DryRebound, FilmRebound, SoftContact, lattice_added_mass
from lbm.spheres.film import RESOLVED, Film, lost_to_grid
from lbm.spheres.spheres import COLUMNS, Sphere, SphereImpact, Spheres

__all__ = [
    "COLUMNS",
    "RESOLVED",
    "SETTLED",
    "Contact",
    "DryRebound",
    "Film",
    "FilmRebound",
    "SoftContact",
    "Sphere",
    "SphereImpact",
    "Spheres",
    "lattice_added_mass",
    "lost_to_grid",
]
