"""What is estimated: parameters with bounds, the scale they are searched on, and what is known beforehand.

The search runs over internal coordinates x of which the likelihood is closer to a Gaussian's:

    linear  value = x,          log  value = exp(x),         even  value = |x|   (standard deviations),

``even`` puts a zero standard deviation in the interior of the search. Intervals from the profile do not depend on
the coordinate.

An earlier fit as the prior of a new one has its law's parameters, jointly normal with their correlations,

    ln p = -1/2 (theta - mean)^T C^-1 (theta - mean)      of the parameters that both fits estimate,

the others of the earlier fit integrated out. Scatter and offsets are not handed on: other particles and sources.
What the earlier fit knew beforehand is in its result, so that a prior that the data state is not taken again.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.reading.observations import Observations
from restitution.doubts import Doubt
from restitution.errors import Defect, InputError

Scale = Literal["linear", "log", "even"]
_ALIKE = 1e-9
"""Relative difference of St and e_eff below which two impacts are the same."""


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


@dataclass(frozen=True)
class Earlier:
    """What is taken from a fit: ``names`` of parameters with ``mean`` and ``covariance``, and what it was made of.

    ``impacts`` has a row of St and e_eff for each of its measured impacts, ``files`` the sha256 of its files.
    """

    origin: str
    law: str
    names: tuple[str, ...]
    mean: NDArray
    covariance: NDArray
    convention: str
    speed: str
    edge: float | None
    files: Mapping[str, str]
    impacts: NDArray

    def of(self, names: Sequence[str]) -> Earlier:
        """Of those parameters alone, the others integrated out."""
        kept = [k for k, name in enumerate(self.names) if name in names]
        if not kept:
            rule = f"has none of the parameters that are estimated here: {', '.join(names) or 'none'}"
            raise InputError(Defect(rule, file=self.origin))
        own = tuple(self.names[k] for k in kept)
        return replace(self, names=own, mean=self.mean[kept], covariance=self.covariance[np.ix_(kept, kept)])

    def check(self, law: str, o: Observations) -> None:
        """Raise :class:`InputError` where it is of another law, of other speeds, or of the same data."""
        defects = []
        if law != self.law:
            defects.append(Defect(f"is a fit of another law: {self.law}", file=self.origin, field="--prior"))
        if (str(o.speed), o.edge) != (self.speed, self.edge):
            own, theirs = ((f"{s}, edge {e:g} d" if e is not None else s) for s, e in
                           ((str(o.speed), o.edge), (self.speed, self.edge)))  # fmt: skip
            rule = f"is of the impact speed {theirs}, the data of {own}: its parameters are other quantities"
            defects.append(Defect(rule, file=self.origin, field="--prior"))
        twice = [name for name, digest in o.files.items() if digest in self.files.values()]
        rule = f"was fitted in {self.origin} already: as its prior the same impacts would count twice"
        defects += [Defect(rule, file=name, field="--prior") for name in twice]
        if defects:
            raise InputError(*defects)

    def without_own_priors(self, parameters: Sequence[Parameter]) -> list[Parameter]:
        """The parameters, flat where this prior has them: it knew what they are given already."""
        return [replace(p, prior=Flat(p.scale == "log")) if p.name in self.names else p for p in parameters]

    @property
    def precision(self) -> NDArray:
        """C^-1."""
        scale = np.sqrt(np.diag(self.covariance))
        return np.linalg.inv(self.covariance / np.outer(scale, scale)) / np.outer(scale, scale)

    def doubts(self, o: Observations) -> Iterator[Doubt]:
        """Impacts that are those of the earlier fit, though in another file."""
        if o.convention != self.convention or not len(self.impacts):
            return
        seen = ~o.censored
        pairs = np.stack([o.St[seen], o.e[seen]], axis=1)
        close = np.abs(pairs[:, None] - self.impacts) <= _ALIKE * np.abs(pairs[:, None])
        again = int(close.all(axis=2).any(axis=1).sum())
        if again:
            yield Doubt(
                "twice",
                f"{again} of {len(pairs)} impacts have St and e_eff of impacts of {self.origin}, whose fit is the "
                "prior: are they the same, counted twice?",
            )


@dataclass(frozen=True)
class Placed:
    """-ln p of an earlier fit as a function of all parameters; nothing where there is none."""

    mean: NDArray
    precision: NDArray
    """C^-1, (parameters, parameters), zero for parameters that it has not."""
    has: NDArray

    @classmethod
    def of(cls, earlier: Earlier | None, names: Sequence[str]) -> Placed:
        """Its parameters among ``names``."""
        mean, precision = np.zeros(len(names)), np.zeros((len(names), len(names)))
        places = [names.index(name) for name in earlier.names] if earlier is not None else []
        if earlier is not None:
            mean[places], precision[np.ix_(places, places)] = earlier.mean, earlier.precision
        return cls(mean, precision, np.isin(np.arange(len(names)), places))

    def __call__(self, values: NDArray) -> float:
        away = self.away(values)
        return float(0.5 * away @ self.precision @ away)

    def away(self, values: NDArray) -> NDArray:
        """Values less its means, zero for parameters that it has not."""
        return np.where(self.has, values - self.mean, 0.0)
