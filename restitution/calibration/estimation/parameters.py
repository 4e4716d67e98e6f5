"""What is estimated: parameters with bounds, the scale they are searched on, and what is known beforehand.

The search runs over internal coordinates x of which the likelihood is closer to a Gaussian's:

    linear  value = x,          log  value = exp(x),         even  value = |x|   (standard deviations),

``even`` puts a zero standard deviation in the interior of the search. Intervals from the profile do not depend on
the coordinate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from restitution.errors import Defect, InputError

Scale = Literal["linear", "log", "even"]


@dataclass(frozen=True)
class Normal:
    """A normal prior: an independent measurement of the parameter; it takes part in both estimates."""

    mean: float
    sigma: float

    def __str__(self) -> str:
        return f"normal {self.mean:g} +- {self.sigma:g}"

    def log_density(self, value: float) -> float:
        """Up to a constant."""
        return -0.5 * ((value - self.mean) / self.sigma) ** 2


@dataclass(frozen=True)
class HalfNormal:
    """A half-normal prior of a standard deviation; of the posterior only."""

    sigma: float

    def __str__(self) -> str:
        return f"half-normal {self.sigma:g}"

    def log_density(self, value: float) -> float:
        """Up to a constant."""
        return -0.5 * (value / self.sigma) ** 2


@dataclass(frozen=True)
class Flat:
    """Uniform in the value, or in its logarithm, within the bounds; of the posterior only."""

    logarithmic: bool = False

    def __str__(self) -> str:
        return "uniform in the logarithm" if self.logarithmic else "uniform"

    def log_density(self, value: float) -> float:
        """Up to a constant; minus infinity where the logarithm has no value."""
        if not self.logarithmic:
            return 0.0
        return -math.log(value) if value > 0 else -math.inf


@dataclass(frozen=True)
class Parameter:
    """One unknown. ``start`` lies within ``bounds``.

    ``mean`` tells parameters of the law from standard deviations.
    """

    name: str
    start: float
    bounds: tuple[float, float]
    unit: str = "1"
    scale: Scale = "linear"
    prior: Normal | HalfNormal | Flat = Flat()
    mean: bool = True

    def __post_init__(self) -> None:
        low, high = self.bounds
        if not low < high:
            raise InputError(Defect("the lower bound must be below the upper one", field=self.name))
        if not low <= self.start <= high:
            rule = f"starts outside its bounds [{low:g}, {high:g}]"
            raise InputError(Defect(rule, field=self.name, value=f"{self.start:g}"))

    def inward(self, value: float) -> float:
        """The internal coordinate of a value."""
        return math.log(value) if self.scale == "log" else value

    def outward(self, x: float) -> float:
        """The value at an internal coordinate."""
        if self.scale == "log":
            return min(max(math.exp(x), self.bounds[0]), self.bounds[1])  # not beyond them by rounding
        return abs(x) if self.scale == "even" else x

    def slope(self, x: float) -> float:
        """D value / d x."""
        if self.scale == "log":
            return math.exp(x)
        return -1.0 if self.scale == "even" and x < 0 else 1.0

    @property
    def limits(self) -> tuple[float | None, float | None]:
        """Bounds of the internal coordinate, None where there are none."""
        low, high = self.bounds
        if self.scale == "even":
            return (-high, high) if math.isfinite(high) else (None, None)
        if self.scale == "log":
            return math.log(low), math.log(high) if math.isfinite(high) else None
        return (low if math.isfinite(low) else None, high if math.isfinite(high) else None)


def scale_of(bounds: tuple[float, float]) -> Scale:
    """Logarithmic for a positive parameter that may range over more than two decades, else linear."""
    low, high = bounds
    return "log" if low > 0 and high / low > 100 else "linear"


def log_prior(parameters: Sequence[Parameter], values: NDArray, every: bool) -> float:
    """Sum of the log prior densities: of all of them, or of those that stand for measurements (``Normal``)."""
    return sum(
        p.prior.log_density(float(value))
        for p, value in zip(parameters, values, strict=True)
        if every or isinstance(p.prior, Normal)
    )


def prior_precision(parameters: Sequence[Parameter]) -> NDArray:
    """1/sigma^2 of the normal priors, zero for the others."""
    return np.array([p.prior.sigma**-2.0 if isinstance(p.prior, Normal) else 0.0 for p in parameters])
