"""Does the emulator predict runs it has not seen? Each fifth of the runs in turn, all that it is made of anew.

Of a quantity y with its prediction m and error s in the runs left out:

    Q^2 = 1 - sum (y - m)^2 / sum (y - <y>)^2,     standardised error (y - m)/s,     coverage |y - m| < 1.96 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.emulation.emulator import emulate, folds, scale_of_design
from restitution.emulation.registered import Registration

_DRAWS = 400
"""From which the errors of quantities are taken."""


@dataclass(frozen=True)
class Check:
    """Of each quantity, by its label: what the runs gave, what was predicted without them, and its error."""

    labels: tuple[str, ...]
    given: NDArray
    predicted: NDArray
    sigma: NDArray
    """All (runs, quantities)."""

    @property
    def q2(self) -> NDArray:
        """Part of the variance that is predicted, of each quantity."""
        away = np.sum((self.given - self.predicted) ** 2, axis=0)
        return 1 - away / np.maximum(np.sum((self.given - self.given.mean(axis=0)) ** 2, axis=0), 1e-300)

    @property
    def standardised(self) -> NDArray:
        """Errors over their own standard deviations."""
        return (self.given - self.predicted) / self.sigma

    @property
    def spread(self) -> NDArray:
        """Root of the mean square of the standardised errors: 1 where the emulator knows its error."""
        return np.sqrt(np.mean(self.standardised**2, axis=0))

    @property
    def coverage(self) -> float:
        """Part of all that lies within the 95 % intervals."""
        return float(np.mean(np.abs(self.standardised) < 1.96))

    @property
    def rms(self) -> NDArray:
        """Of the errors of each quantity, in its unit."""
        return np.sqrt(np.mean((self.given - self.predicted) ** 2, axis=0))


def check(names: Sequence[str], theta: NDArray, q: NDArray, r: Registration) -> Check:
    """The check of an emulator of these runs; that which is checked has the runs left out in nothing."""
    rng = np.random.default_rng(0)
    ranges = np.stack([theta.min(axis=0), theta.max(axis=0)], axis=1)
    scales = tuple(scale_of_design(x) for x in theta.T)
    given = r.quantities(q)
    predicted = {label: np.empty(len(q)) for label in given}
    sigma = {label: np.empty(len(q)) for label in given}
    for out, kept in folds(len(q)):
        emulator = emulate(names, theta[kept], q[kept], r.weight, ranges, scales)
        mean, variance = emulator.scores(theta[out])
        noise = rng.standard_normal((_DRAWS, *mean.shape))
        middle = r.quantities(emulator.flight(mean))
        drawn = r.quantities(emulator.flight(mean + np.sqrt(variance) * noise))
        rest = r.quantities(emulator.mean + emulator.rest)
        for label in given:
            predicted[label][out] = middle[label]
            sigma[label][out] = np.sqrt(np.var(drawn[label], axis=0) + np.var(rest[label]))
    stack = [np.stack(list(values.values()), axis=1) for values in (given, predicted, sigma)]
    return Check(tuple(given), *stack)
