r"""The wake that a sphere meets when it turns back: a force that drag, added mass and history leave out.

The history kernels hold for small changes of a steady motion. A sphere that rebounds flies back through the fluid
that its own approach has set moving towards the wall. Runs with the flow resolved have it: along their motion the
forces of the point particle lack a drag after the contact, as if the fluid moved towards the wall with

    u(h, t) = c U Re/(Re + Re_0) s^2/(s^2 + L^2) exp[-(t - t_0) U/(T d)] [1 - exp(-h/r)],

U being the speed of the impact at t_0, Re = U d/nu, and s the way of the approach since the sphere last turned or
was set free. Until the next contact the steady drag is that of the motion relative to this fluid, D(v + u). Fluid
follows the sphere only once it has fallen far: after 3 d hardly. A steady fall has s = infinity.

The form is empirical. c = 0.74, Re_0 = 24, L = 5.2 d, T = 3.4 were fitted to resolved runs of Re 28 to 164 with
ways of 2.7 to 17 d, which they meet within 0.034 U (``python -m benchmarks.wake``); no measured record takes part.
Grids of 10 and 20 cells differ by a quarter in the first d/U, single runs by as much from the form: hence the
error of c.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from restitution.errors import Defect, InputError

STRENGTH, STRENGTH_SIGMA = 0.74, 0.22
"""c by the resolved runs, and its standard deviation: of grids, ways and Re."""
REYNOLDS, WAY_D, DECAY = 24.0, 5.2, 3.4
"""Re_0, L in diameters and T."""


@dataclass(frozen=True)
class OwnWake:
    """``strength``: c, the speed that the fluid near the wall has, after a long approach, over the impact's."""

    strength: float = STRENGTH

    def __post_init__(self) -> None:
        if not 0 <= self.strength <= 5:  # also NaN
            raise InputError(Defect("must lie in [0, 5]", field="wake.strength", value=f"{self.strength:g}"))


class Wake(NamedTuple):
    """What the kernel reads: speed exp(-rate (t - time)) (1 - exp(-h/r)), negative being towards the wall."""

    speed: float
    time: float
    rate: float


NONE = Wake(0.0, 0.0, 0.0)


def left_behind(law: OwnWake, time: float, speed: float, way: float, diameter: float, nu: float) -> Wake:
    """The wake of an approach that met the wall at ``time`` (s) with ``speed`` (m/s) after a ``way`` in m."""
    formed = 1.0 if math.isinf(way) else way**2 / (way**2 + (WAY_D * diameter) ** 2)
    formed *= speed / (speed + REYNOLDS * nu / diameter)
    return Wake(-law.strength * speed * formed, time, speed / (DECAY * diameter))
