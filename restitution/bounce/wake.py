"""The wake that a sphere meets when it turns back: a force that drag, added mass and history leave out.

The history kernels hold for small changes of a steady motion. A sphere that rebounds flies back through the fluid
that its own approach has set moving towards the wall. At the height y, passed with the speed U(y) against the drag
D(U), the approach has left the momentum D/U per unit of length. Over an area that begins as A frontal areas and
spreads by viscosity, this is the speed

    u(y, t) = D(U) / {U rho_f [A pi r^2 + 4 pi nu (t - t_0(y))]},   never more than U,

t_0(y) being the time of the passage; it is taken to die out at the wall as 1 - exp(-h/r). Until the next contact
the steady drag is that of the motion relative to this fluid, D(v + u). A wake that an earlier or a rising flight
has left, and the way that the fluid goes with its own motion, are left out.

Momentum and spreading are derived; A and the decay at the wall over one radius are not: A = 2 was chosen as the
round number near which the first flight of Gondret's 3 mm sphere is reproduced. Nothing published was found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from restitution.errors import Defect, InputError

_POINTS = 256


@dataclass(frozen=True)
class OwnWake:
    """``area``: A, the frontal areas over which the wake's momentum is spread when it is left behind."""

    area: float = 2.0

    def __post_init__(self) -> None:
        if not 0.1 <= self.area <= 100:  # also NaN
            raise InputError(
                Defect("must lie in [0.1, 100] frontal areas", field="wake.area", value=f"{self.area:g}")
            )


class Wake(NamedTuple):
    """What the kernel reads: speed(h)/(1 + rate (t - time(h))) (1 - exp(-h/r)), 0 above the table."""

    speed: NDArray
    """At t_0, in m/s, negative being towards the wall, on an equidistant grid of gaps from 0."""
    time: NDArray
    """t_0 in s."""
    per_gap: float
    rate: float


NONE = Wake(np.zeros(0), np.zeros(0), 0.0, 0.0)


def left_behind(
    law: OwnWake, time: NDArray, gap: NDArray, velocity: NDArray, steady: bool, drag: NDArray, nu: float,
    density: float, radius: float,
) -> Wake:  # fmt: skip
    """The wake of an approach given by its steps (gap falling) and the steady drag in N at each.

    ``steady``: it was in steady motion before the first step, so that the wake goes on above.
    """
    speed = drag / np.maximum(np.abs(velocity), 1e-12) / (density * law.area * np.pi * radius**2)
    speed = -np.minimum(np.abs(speed), np.abs(velocity))
    if steady:
        above = 20 * radius
        time = np.append(time[0] - above / abs(velocity[0]), time)
        gap = np.append(gap[0] + above, gap)
        speed = np.append(speed[0], speed)
    grid = np.linspace(0, gap[0], _POINTS)
    order = slice(None, None, -1)
    return Wake(
        np.interp(grid, gap[order], speed[order]),
        np.interp(grid, gap[order], time[order]),
        (_POINTS - 1) / gap[0],
        4 * nu / (law.area * radius**2),
    )
