"""An earlier fit as the prior of a new one: its law's parameters, jointly normal with their correlations.

    ln p = -1/2 (theta - mean)^T C^-1 (theta - mean)      of the parameters that both fits estimate,

the others of the earlier fit integrated out. Scatter and offsets are not handed on: other particles and sources.
What the earlier fit knew beforehand is in its result, so that a prior that the data state is not taken again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.parameters import Flat, Parameter
from restitution.calibration.reading.observations import Observations
from restitution.doubts import Doubt
from restitution.errors import Defect, InputError

_ALIKE = 1e-9
"""Relative difference of St and e_eff below which two impacts are the same."""


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
