"""The bouncing sphere as a point particle: a whole trajectory over a wall, from closures, in milliseconds.

    from restitution import datasets, laws
    from restitution.bounce import Closures, Release, bounce

    conditions = datasets.resource("gondret2002_st152").conditions
    path = bounce(conditions, Release(gap=9e-3, speed=0.586), Closures(rebound=laws.get("legendre_2005")), end=0.2)
    path.apexes(), path.impact_table(), path.gap(0.05)

Vertical motion, gap h > 0, velocity v = dh/dt:

    d/dt[(m + C_M m_f) v] = 1/2 m_f C_M'(h) v^2 - (m - m_f) g - drag - wall - history.

:mod:`~restitution.bounce.closures` says what may be chosen, :mod:`~restitution.bounce.kernel` how it is
integrated, :mod:`~restitution.bounce.history` how the memory is kept, :mod:`~restitution.bounce.added_mass` what
the wall does to the added mass, :mod:`~restitution.bounce.wake` what a rebound meets,
:mod:`~restitution.bounce.agreement` how far a record is, :mod:`~restitution.bounce.sensitivity` what matters,
:mod:`~restitution.bounce.edges` what an e_eff of one edge of the film is at another.
:mod:`~restitution.bounce.model` puts them together from ``forces``, ``drive`` and ``tables``, ``shared`` for many
restitutions at once; :mod:`~restitution.bounce.unbounded` holds drag and history against references, no wall near.
"""

from restitution.bounce.agreement import distance_from_contact_d, release_of
from restitution.bounce.closures import Closures, Release
from restitution.bounce.drive import Drive
from restitution.bounce.edges import law_at
from restitution.bounce.model import Impact, IntegrationError, Trajectory, bounce
from restitution.bounce.wake import OwnWake
from restitution.laws.drag import terminal_speed

__all__ = [
    "Closures",
    "Drive",
    "Impact",
    "IntegrationError",
    "OwnWake",
    "Release",
    "Trajectory",
    "bounce",
    "distance_from_contact_d",
    "law_at",
    "release_of",
    "terminal_speed",
]
