"""e_eff of each bounce of a measured record, for a simulation that is given the measured values.

The definition is ``far``, that of :class:`lbm.spheres.contact.FilmRebound`; bounces that stay within the film,
which ``far`` does not see, are taken by ``contact``. A bounce that neither resolves ends the list.
"""

from __future__ import annotations

from functools import cache

from restitution.errors import InputError
from restitution.impacts.shipped import impacts_of
from restitution.stokes import Speed


@cache
def measured_restitution(record: str) -> tuple[float, ...]:
    """e_eff of bounce 1, 2, ... of a shipped record; raises :class:`InputError` for one without bounces."""
    found: dict[int, float] = {}
    for speed in (Speed.CONTACT, Speed.FAR):
        for row in impacts_of(record, speed).rows:
            if "e_eff" in row:
                found[row["impact"]] = row["e_eff"]
    bounces = []
    while len(bounces) + 1 in found:
        bounces.append(found[len(bounces) + 1])
    if not bounces:
        raise InputError(f"{record}: no rebound is resolved, so there are no measured values to use")
    return tuple(bounces)
