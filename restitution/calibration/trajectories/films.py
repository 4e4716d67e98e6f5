"""One resolved film for all bounces of a record, in place of an e of each: h_min, tension, e_dry, correlations.

The model is that of a case with ``contact = dry``: all forces act down to the gap h_min, where the sphere rebounds
with e_dry; on its way out the film holds no more than the tension (:class:`restitution.bounce.Closures`). The
three are correlated: a thinner film loses more, for which a higher e_dry makes up. What several records say of
e_dry together is the mean of their likelihoods, each posterior less its prior; where they scatter more than their
errors, the error grows by sqrt(chi^2/(n - 1)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restitution.calibration.trajectories.flights import E_DRY, Films
from restitution.calibration.trajectories.recordings import Recording
from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory, settle
from restitution.doubts import Doubt

DRY_IMPACTS = (0.97, 0.02)
"""e_dry of steel and glass on a hard wall in air, by dry impacts: Joseph & Hunt 2004, as quoted, and others."""
_FAR = 2.0
"""Standard deviations above 1 from which on an e_dry says that the model loses too much elsewhere."""


@dataclass(frozen=True)
class FilmFit:
    """What a record says of its film."""

    trajectory: WholeTrajectory

    @classmethod
    def of(cls, r: Recording, wake: bool) -> FilmFit:
        """Of one record; raises :class:`InputError` where it cannot be fitted."""
        return cls(settle(Films(r, wake)))

    @property
    def name(self) -> str:
        """Of the record."""
        return self.trajectory.recording.name

    @property
    def e_dry(self) -> tuple[float, float]:
        """Mean and standard deviation; above 1 the model loses more than the record elsewhere."""
        return self.trajectory.unknowns[E_DRY]

    def factor(self, name: str) -> tuple[float, float]:
        """Median of what ``name`` is the logarithm of, and its standard deviation as a factor."""
        mean, sigma = self.trajectory.unknowns[name]
        return math.exp(mean), math.exp(sigma)

    def correlation(self, one: str, other: str) -> float:
        """Of two unknowns."""
        t = self.trajectory
        i, j = t.names.index(one), t.names.index(other)
        return float(t.covariance[i, j] / math.sqrt(t.covariance[i, i] * t.covariance[j, j]))

    @property
    def doubts(self) -> list[Doubt]:
        """An e_dry beyond what any has."""
        mean, sigma = self.e_dry
        if mean - 1 <= _FAR * sigma:
            return []
        rule = f"e_dry comes out as {mean:.3f} +- {sigma:.3f}: film, drag or wake of the model lose too much"
        return [Doubt("e_dry", rule, self.name)]


@dataclass(frozen=True)
class Combined:
    """e_dry by several records: mean, standard deviation, chi^2 of their scatter about the mean."""

    mean: float
    sigma: float
    chi_square: float
    records: int


def combined(fits: Sequence[FilmFit]) -> Combined:
    """What records say of one e_dry together."""
    priors = [next(o for o in Films(f.trajectory.recording, False).open if o.name == E_DRY) for f in fits]
    weights, means = [], []
    for (mean, sigma), prior in zip((f.e_dry for f in fits), priors, strict=True):
        weight = max(1 / sigma**2 - 1 / prior.sigma**2, 1e-9)
        weights.append(weight)
        means.append((mean / sigma**2 - prior.mean / prior.sigma**2) / weight)
    w, x = np.array(weights), np.array(means)
    mean = float(w @ x / w.sum())
    chi_square = float(w @ (x - mean) ** 2)
    wider = max(1.0, chi_square / (len(x) - 1)) if len(x) > 1 else 1.0
    return Combined(mean, math.sqrt(wider / w.sum()), chi_square, len(x))
