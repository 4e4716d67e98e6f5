"""Relaxation rates that change with the distance to no-slip walls.

A half-way bounce-back wall stays in its place when the odd moments q and m relax slowly, as
(1/s_nu - 1/2)(1/s_odd - 1/2) = 3/16 asks; away from walls such slow moments make a flow noisy, or unstable, from a
grid Reynolds number of about 10 on. Only the moments that are not seen in the Navier-Stokes equations change from
place to place: the viscosity is the same everywhere.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np

from lbm import arguments
from lbm.errors import InputError
from lbm.rates import PRESETS as UNIFORM
from lbm.rates import Rates

__all__ = ["PRESETS", "RatesByPlace"]

REACH, BLEND = 6, 0
"""Layers of cells beside a wall with its own rates, and over which they turn into those of the bulk."""
FAST_REACH = 3
"""The same in fast flow: a sphere bounces at a grid Reynolds number of 100; with six layers it diverges at 60."""


@dataclass(frozen=True)
class RatesByPlace:
    """Rates ``near_walls`` in the cells next to no-slip faces, moving ones included, ``bulk`` in all others.

    Parameters
    ----------
    bulk, near_walls : rates of the same viscosity.
    reach : layers of cells beside a wall that relax as ``near_walls`` says, at least 1.
    blend : layers over which the one set turns into the other, beyond ``reach``.

    Raises
    ------
    InputError
        For rates of two viscosities, or counts that are none.

    Notes
    -----
    In the blend the logarithms of L = 1/s - 1/2 are interpolated linearly. A jump of L_q or L_m between two
    layers makes the velocity jump by about (L_1 - L_2) d^2u/dn^2.
    """

    bulk: Rates
    near_walls: Rates
    reach: int
    blend: int = 0

    def __post_init__(self) -> None:
        arguments.count("reach of the rates near walls, in cells", self.reach, least=1)
        arguments.count("blend of the rates near walls, in cells", self.blend)
        if self.bulk.nu != self.near_walls.nu:
            raise InputError(
                f"rates by place: viscosity {self.bulk.viscosity:g} in the bulk, {self.near_walls.viscosity:g} "
                "near walls; give both the same one"
            )

    @classmethod
    def quiet(cls, viscosity: float, reach: int = REACH, blend: int = BLEND) -> RatesByPlace:
        """:meth:`Rates.two_relaxation_times` near walls, :meth:`Rates.quiet` elsewhere."""
        return cls(Rates.quiet(viscosity), Rates.two_relaxation_times(viscosity), reach, blend)

    @classmethod
    def balanced(cls, viscosity: float, reach: int = REACH, blend: int = BLEND) -> RatesByPlace:
        """:meth:`Rates.two_relaxation_times` near walls, :meth:`Rates.balanced` elsewhere.

        Then also the surface of a sphere far from walls stays where it is, and films of a cell are not lost.
        """
        return cls(Rates.balanced(viscosity), Rates.two_relaxation_times(viscosity), reach, blend)

    @classmethod
    def dhumieres(cls, viscosity: float, reach: int = FAST_REACH, blend: int = BLEND) -> RatesByPlace:
        """:meth:`Rates.slow_odd` near walls, :meth:`Rates.dhumieres2002` elsewhere: for fast flow.

        Stable and quiet about spheres where the others are not, for which they are meant: they do not leave the
        surface of a sphere in its place.
        """
        return cls(Rates.dhumieres2002(viscosity), Rates.slow_odd(viscosity), reach, blend)

    @property
    def viscosity(self) -> float:
        """Kinematic shear viscosity in lattice units."""
        return self.bulk.viscosity

    @property
    def bulk_viscosity(self) -> float:
        """Kinematic bulk viscosity in lattice units, away from walls."""
        return self.bulk.bulk_viscosity

    @property
    def grid_reynolds(self) -> float:
        """That of the bulk, for flow is slow beside a wall at rest; see :attr:`Rates.grid_reynolds`."""
        return self.bulk.grid_reynolds

    @property
    def grid_reynolds_at_bodies(self) -> float:
        """That of the bulk; see :attr:`Rates.grid_reynolds_at_bodies`."""
        return self.bulk.grid_reynolds_at_bodies

    @property
    def grid_reynolds_at_moving_walls(self) -> float:
        """That of the rates near walls: a square cavity whose lid moves at 42 diverges (benchmarks/README.md)."""
        return self.near_walls.grid_reynolds_at_moving_walls

    def layers(self) -> tuple[Rates, ...]:
        """Rates of the first, second, ... layer of cells from a wall; the last ones are those of all others."""
        shares = [0.0] * self.reach + [n / (self.blend + 1) for n in range(1, self.blend + 1)]
        return (*(_between(self.near_walls, self.bulk, share) for share in shares), self.bulk)

    def diagonal(self) -> np.ndarray:
        """Rates by layer and moment, shape (layers, 19); see :meth:`Rates.diagonal`."""
        return np.array([rates.diagonal() for rates in self.layers()])


def _between(one: Rates, other: Rates, share: float) -> Rates:
    if share == 0:
        return one
    pairs = zip(astuple(one), astuple(other), strict=True)
    return Rates(
        *(a if a == b else 1 / ((1 / a - 0.5) ** (1 - share) * (1 / b - 0.5) ** share + 0.5) for a, b in pairs)
    )


PRESETS = {
    **UNIFORM,
    "quiet-by-place": RatesByPlace.quiet,
    "balanced-by-place": RatesByPlace.balanced,
    "dhumieres-by-place": RatesByPlace.dhumieres,
}
"""Presets that follow from the viscosity alone, by name."""

FASTER = {
    "Rates.balanced": Rates.balanced,
    "RatesByPlace.dhumieres": RatesByPlace.dhumieres,
    "Rates.dhumieres2002": Rates.dhumieres2002,
}
"""Rates for ever faster flow, by the name that a warning has for them."""
