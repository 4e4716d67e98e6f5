"""The film between a sphere and a wall that the grid does not resolve: forces that closures add to the fluid's.

Closures are plain callables in lattice units. ``normal(gap, velocity, onset)`` returns the force along the
wall's normal; ``velocity`` is positive away from the wall and ``onset`` the velocity with which the sphere came
through the cut-off, NaN while it leaves. It must be of first degree in ``velocity``, as lubrication is.
``tangential(gap, slip, spin, normal)`` returns force and torque, 3 components each, of a sphere that moves with
``slip`` along the wall and turns with ``spin``, about an axis along the wall; ``normal`` points away from it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lbm.errors import InputError
from lbm.spheres.sampling import sampled

RESOLVED = 0.5
"""Gap in cells from which on there is a cell of fluid between sphere and wall: its centre is half a cell away."""

_SHARES = (0.05, 0.1, 0.2, 0.5, 0.9)
"""Gaps, as parts of the cut-off, at which a description samples the forces."""
_ACROSS = tuple(
    (sign * speed, -onset if sign < 0 else math.nan)
    for sign in (-1, 1)
    for speed in (0.0, 1e-3, 1e-2, 1e-1)
    for onset in ((1e-2, 1e-1) if sign < 0 else (math.nan,))
)
"""Velocities there, and at the cut-off: arriving and leaving."""
_ALONG = tuple(
    (np.array(slip), np.array(spin), np.array(normal))
    for slip, spin, normal in (
        ((1e-2, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        ((0.0, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.0, 1.0)),
        ((5e-2, 2e-2, 0.0), (1e-2, 3e-3, 0.0), (0.0, 0.0, 1.0)),
        ((0.0, 2e-2, 1e-2), (0.0, 2e-3, 1e-3), (-1.0, 0.0, 0.0)),
    )
)
"""Slip and spin along walls of different normals."""

Normal = Callable[[float, float, float], float]
Tangential = Callable[[float, np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Film:
    """What acts on a sphere below the gap ``cut_off``; below ``floor`` forces stay as they are there.

    Parameters
    ----------
    cut_off : in cells.
    floor : in cells, greater than 0 and less than ``cut_off``: the height at which the rough surfaces touch.
    normal, tangential : functions, see the head of this module; None for no such force.

    Raises
    ------
    InputError
        For a floor that does not lie between 0 and the cut-off.
    """

    cut_off: float
    floor: float
    normal: Normal | None = None
    tangential: Tangential | None = None

    def __post_init__(self) -> None:
        if not (0 < self.floor < self.cut_off and math.isfinite(self.cut_off)):
            raise InputError(
                f"film: floor = {self.floor:g} must lie between 0 and cut_off = {self.cut_off:g} cells"
            )

    def describe(self) -> dict:
        """Every number of the film; its forces as they are at a few gaps and motions."""
        gaps = [self.floor, *(share * self.cut_off for share in _SHARES if share * self.cut_off > self.floor)]
        return {
            "cut_off": float(self.cut_off),
            "floor": float(self.floor),
            "normal": sampled(self.normal, [(gap, *motion) for gap in gaps for motion in _ACROSS]),
            "tangential": sampled(
                self.tangential and (lambda *given: np.concatenate(self.tangential(*given))),
                [(gap, *motion) for gap in gaps for motion in _ALONG],
            ),
        }

    def resistance(self, gap: float, velocity: float, onset: float) -> tuple[float, float]:
        """Normal force at velocity zero and its slope; zero where it would drive the sphere on."""
        if self.normal is None or gap >= self.cut_off or velocity == 0:
            return 0.0, 0.0
        gap = max(gap, self.floor)
        force, still = self.normal(gap, velocity, onset), self.normal(gap, 0.0, onset)
        if force * velocity >= 0:
            return 0.0, 0.0
        return still, (force - still) / velocity

    def along(
        self, gap: float, velocity: np.ndarray, spin: np.ndarray, normal: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Force and torque of the motion along the wall."""
        if self.tangential is None or gap >= self.cut_off:
            return np.zeros(3), np.zeros(3)
        slip, turning = velocity - (velocity @ normal) * normal, spin - (spin @ normal) * normal
        return self.tangential(max(gap, self.floor), slip, turning, normal)


def lost_to_grid(gap: float) -> float:
    """The part of the film's resistance 1/gap that the grid lacks, in 1/cells; zero above :data:`RESOLVED`.

    The force is -6 pi mu r^2 v times this. Where the film is thinner than c = 1/2 cell no cell is left, so
    the lattice's film begins where its thickness H = h + s^2/(2 r) is c: no pressure acts further in, and the
    volume squeezed out there is not passed on. Reynolds' equation for what is left,
    dp/dH = -6 mu v r (H - c)/((H - h) H^3), gives the lattice's share ::

        J/c,   J = 2 int_1^inf (s - 1)^2/((s - x) s^3) ds = 4 sum_n x^n/((n + 1)(n + 2)(n + 3)),   x = h/c

    in place of 1/h: 2/(3c) at contact, 1/c at h = c. Nothing in it is fitted; ``benchmarks/README.md`` compares.
    """
    if gap >= RESOLVED:
        return 0.0
    x = gap / RESOLVED
    if x < 0.05:
        share = sum(4 * x**n / ((n + 1) * (n + 2) * (n + 3)) for n in range(8))
    else:
        share = 2 * (-((1 - x) ** 2) * math.log1p(-x) / x**3 + (2 * x - 1) / x**2 - 0.5 / x)
    return 1 / gap - share / RESOLVED
