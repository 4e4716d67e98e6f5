r"""Each impact, or each source, predicted from the others: by fits to the others, or by weights of draws.

A fit to the others is exact and costs a fit. For many impacts one set of draws from the posterior serves all
(Vehtari, Gelman & Gabry, Stat. Comput. 27, 1413 (2017)): with draws theta_k of density q about the estimate

    p(y_i | others) = sum_k W_ik p(y_i | y_-i, theta_k) / sum_k W_ik,
    W_ik = p(theta_k | y) / [q(theta_k) p(y_i | y_-i, theta_k)],

the largest weights W smoothed by a Pareto distribution, whose shape k says whether they can be trusted (Vehtari et
al., J. Mach. Learn. Res. 25, 72 (2024)): where k is above :data:`TRUSTED`, the impact is left out by a fit after
all. So are :data:`CHECKED` of the others, drawn at random; how far they are from their weights says how far the
sum of the rest may be from that of fits (the difference estimator of Magnusson et al., PMLR 108, 341 (2020)). Part
of it is no error: draws leave scatter and offsets open, which fits hold at their estimates. The draws are those of
:mod:`.estimation.draws`, weighed towards the posterior (Magnusson et al., ICML 2019).
Impacts of one source share its offset, so that y_i is predicted given those of its source that stay (Buerkner,
Gabry & Vehtari, Comput. Stat. 36, 1243 (2021)); limits enter given the measured ones. Smoothing: the library
arviz-stats.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from restitution.calibration.estimation.draws import weighted
from restitution.calibration.estimation.fitting import Fit
from restitution.calibration.estimation.likelihood import Likelihood

CHECKED = 60
"""Of those weighed, how many are left out by fits as well."""
FEWEST = 200
"""Fits to be made from which draws are weighed instead."""
DRAWS = 2000
"""Of the parameters."""
TRUSTED = min(0.7, 1 - 1 / np.log10(DRAWS))
"""Largest shape k with which weights of so many draws are trusted (Vehtari et al. 2024)."""


@dataclass(frozen=True)
class LeftOut:
    """Log predictive densities, one each, and which of them are of fits to the others.

    ``error`` is how far the sum of the others, which are weighed, may be from that of fits, one standard error;
    ``largest_k`` the largest shape among them; ``distrusted`` those whose shape was too large.
    """

    elpd: NDArray
    refitted: NDArray
    error: float = 0.0
    largest_k: float | None = None
    distrusted: NDArray = field(default_factory=lambda: np.zeros(0, int))


class LeavingOut:
    """What a fit gives for each of its impacts or sources when it is left out.

    ``refit`` gives it exactly, for a mask of the impacts; ``say`` is told how far it has come.
    """

    def __init__(self, fit: Fit, refit: Callable[[NDArray], float], say: Callable[[str], None] | None = None):
        self._fit, self._refit = fit, refit
        self._say = say or (lambda _: None)
        self._draws: tuple[NDArray, NDArray] | None = None

    def impacts(self) -> LeftOut:
        """Each impact alone."""
        return self._each(np.arange(len(self._fit.likelihood.observations)), _of_impacts)

    def sources(self) -> LeftOut:
        """Each source with all its impacts."""
        return self._each(self._fit.likelihood.sources, _of_sources)

    def _each(self, groups: NDArray, densities: Callable[[Likelihood, NDArray], NDArray]) -> LeftOut:
        n = int(groups.max()) + 1
        elpd, k = np.full(n, np.nan), np.full(n, np.inf)
        known = (
            np.isfinite(self._fit.maximum.covariance).all() and (np.diag(self._fit.maximum.covariance) > 0).all()
        )
        weighable = not self._fit.likelihood.robust and len(self._fit.maximum.parameters) > 0 and known
        checked, distrusted = np.zeros(0, int), np.zeros(0, int)
        if n >= FEWEST and weighable:
            draws, log_ratio = self._posterior()
            each = np.array([densities(self._fit.likelihood, values) for values in draws])
            elpd, k = weighed(each, log_ratio)
            distrusted, trusted = np.flatnonzero(~(k <= TRUSTED)), np.flatnonzero(k <= TRUSTED)
            checked = np.random.default_rng(0).choice(trusted, min(CHECKED, len(trusted)), replace=False)
        again = np.sort(np.concatenate([distrusted, checked])) if n >= FEWEST and weighable else np.arange(n)
        by_weights = elpd.copy()
        for done, i in enumerate(again):
            self._say(f"{done} of {len(again)} left out by fits")
            elpd[i] = self._refit(groups == i)
        refitted = np.zeros(n, bool)
        refitted[again] = True
        largest = float(k[~refitted].max()) if not refitted.all() else None
        away = (elpd - by_weights)[checked]
        return LeftOut(elpd, refitted, _error(away, int((~refitted).sum())), largest, distrusted)

    def _posterior(self) -> tuple[NDArray, NDArray]:
        """Draws about the estimate, and the logarithm of the posterior over their own density."""
        if self._draws is None:
            values, weights = weighted(self._fit.likelihood, self._fit.maximum, DRAWS)
            self._draws = values, np.log(weights)
        return self._draws


def _error(away: NDArray, rest: int) -> float:
    """Of a sum over ``rest`` impacts that are as far from fits as ``away``: its mean and that one's error."""
    if not rest or len(away) < 2:
        return 0.0
    return float(rest * np.sqrt(away.mean() ** 2 + away.var(ddof=1) / len(away)))


def weighed(log_density: NDArray, log_ratio: NDArray) -> tuple[NDArray, NDArray]:
    """Log predictive density of each column by smoothed weights, and the shape k of each.

    ``log_density`` has a row a draw; ``log_ratio`` is the logarithm of posterior over density of each draw.
    """
    from arviz_stats.base import array_stats
    from scipy.special import logsumexp

    use = np.isfinite(log_ratio) & np.isfinite(log_density).all(axis=1)
    log_density, log_ratio = log_density[use], log_ratio[use]
    weights, k = array_stats.psislw(log_density.T - log_ratio, axis=-1)
    return logsumexp(weights + log_density.T, axis=1) - logsumexp(weights, axis=1), np.asarray(k)


def _of_impacts(likelihood: Likelihood, values: NDArray) -> NDArray:
    """ln p(y_i | y_-i, theta) of each impact: its source's offset as the others of the source tell it."""
    p = _AtDraw(likelihood, values)
    own = np.where(p.seen, p.w, 0.0)
    W, S = p.W[p.sources] - own, p.S[p.sources] - own * p.r
    shrink = p.omega2 / (1 + p.omega2 * W)
    return p.log_density(shrink * S, shrink)


def _of_sources(likelihood: Likelihood, values: NDArray) -> NDArray:
    """ln p(y_s | theta) of each source: its measured impacts together, then its limits given those."""
    p = _AtDraw(likelihood, values)
    n = len(p.W)
    shrink = p.omega2 / (1 + p.omega2 * p.W)
    together = 0.5 * shrink * p.S**2 - 0.5 * np.log1p(p.omega2 * p.W)
    measured = np.where(p.seen, p.log_density(0.0, 0.0), 0.0)
    limits = np.where(p.seen, 0.0, p.log_density((shrink * p.S)[p.sources], shrink[p.sources]))
    return together + np.bincount(p.sources, measured + limits, n)


class _AtDraw:
    """Residuals r and weights w = 1/variance of the impacts at one draw, and their sums over sources."""

    def __init__(self, likelihood: Likelihood, values: NDArray):
        f, self.variance, omega = likelihood.moments(values)
        o = likelihood.observations
        self.seen, self.sources, self.omega2 = ~o.censored, likelihood.sources, omega**2
        self.w = 1 / self.variance
        self.r = np.where(self.seen, o.e, o.upper) - f
        n, w = len(likelihood.source_names), np.where(self.seen, self.w, 0.0)
        self.W, self.S = np.bincount(self.sources, w, n), np.bincount(self.sources, w * self.r, n)

    def log_density(self, offset: NDArray | float, open_part: NDArray | float) -> NDArray:
        """Of each impact under a normal offset: of a limit, the logarithm of its probability."""
        variance, away = self.variance + open_part, self.r - offset
        normal = -0.5 * (away**2 / variance + np.log(2 * np.pi * variance))
        return np.where(self.seen, normal, log_ndtr(away / np.sqrt(variance)))
