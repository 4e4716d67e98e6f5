"""A sphere that is moved before it is set free, and what the history force remembers of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import exprel

from restitution.errors import Defect, InputError


@dataclass(frozen=True)
class Drive:
    """Moved towards the wall at u(t) = ``speed`` (1 - exp(-t/``ramp``)) over ``way``, in m/s, s and m.

    The fluid was at rest before.
    """

    speed: float
    ramp: float
    way: float

    def __post_init__(self) -> None:
        for name in ("speed", "ramp", "way"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise InputError(Defect("must be a positive number", field=f"drive.{name}", value=f"{value:g}"))

    @cached_property
    def duration(self) -> float:
        """Time in s that the way takes."""
        c = self.way / (self.speed * self.ramp)
        return self.ramp * float(brentq(lambda x: x + math.expm1(-x) - c, c, c + 1, xtol=1e-15 * (c + 1)))

    def velocity(self, time: NDArray | float) -> NDArray:
        """u(t) in m/s."""
        return -self.speed * np.expm1(-np.asarray(time) / self.ramp)

    def distance(self, time: NDArray | float) -> NDArray:
        """Way in m done by ``time`` (s)."""
        time = np.asarray(time)
        return self.speed * (time + self.ramp * np.expm1(-time / self.ramp))

    def lagged(self, rates: NDArray) -> NDArray:
        """Z_j at the end: the solution of dZ/dt = lambda (-u - Z), Z = 0 at the start."""
        t, a = self.duration, 1 / self.ramp
        # (e^{-at} - e^{-lambda t})/(lambda - a), without its cancellation at lambda = a
        between = t * np.exp(-np.minimum(rates, a) * t) * exprel(-np.abs(rates - a) * t)
        return self.speed * (np.expm1(-rates * t) + rates * between)
