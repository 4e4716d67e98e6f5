r"""Each impact, or each source, predicted from the others: by fits to the others, or by weights of draws.

A fit to the others is exact and costs a fit. For many impacts one set of draws from the posterior serves all
(Vehtari, Gelman & Gabry, Stat. Comput. 27, 1413 (2017)): with draws theta_k of density q about the estimate

    p(y_i | others) = sum_k W_ik p(y_i | y_-i, theta_k) / sum_k W_ik,
    W_ik = p(theta_k | y) / [q(theta_k) p(y_i | y_-i, theta_k)],

the largest weights W smoothed by a Pareto distribution, whose shape k says whether they can be trusted (Vehtari et
al., J. Mach. Learn. Res. 25, 72 (2024)): where k is above :data:`TRUSTED`, the impact is left out by a fit after
all. That the draws are not of the posterior is weighed in (Magnusson et al., ICML 2019). Impacts of one source
share its offset, so that y_i is predicted given those of its source that stay (Buerkner, Gabry & Vehtari, Comput.
Stat. 36, 1243 (2021)); limits enter given the measured ones. Smoothing: the library arviz-stats.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from restitution.calibration.estimation.fitting import Fit
from restitution.calibration.estimation.likelihood import Likelihood
from restitution.calibration.estimation.parameters import HalfNormal, log_prior

FEWEST = 200
"""Fits to be made from which draws are weighed instead."""
DRAWS = 2000
"""Of the parameters."""
TRUSTED = min(0.7, 1 - 1 / np.log10(DRAWS))
"""Largest shape k with which weights of so many draws are trusted (Vehtari et al. 2024)."""
_TAILS = 7.0
"""Degrees of freedom of Student's t that the draws are taken from: tails wider than those of the posterior."""
_WIDE = 0.1
"""Part of the draws of a standard deviation that is from its prior."""


@dataclass(frozen=True)
class LeftOut:
    """Log predictive densities, one each; how many were refitted, and the largest shape k of those weighed."""

    elpd: NDArray
    refitted: int
    largest_k: float | None = None


class LeavingOut:
    """What a fit gives for each of its impacts or sources when it is left out.

    ``refit`` gives it exactly, for a mask of the impacts; ``say`` is told how far it has come.
    """

    def __init__(
        self, fit: Fit, refit: Callable[[NDArray], float], seed: int = 0, say: Callable[[str], None] | None = None
    ):
        self._fit, self._refit, self._seed = fit, refit, seed
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
        if n >= FEWEST and weighable:
            draws, log_ratio = self._posterior()
            each = np.array([densities(self._fit.likelihood, values) for values in draws])
            elpd, k = weighed(each, log_ratio)
            elpd[k > TRUSTED] = np.nan
        again = np.flatnonzero(np.isnan(elpd))
        for done, i in enumerate(again):
            self._say(f"{done} of {len(again)} left out by fits")
            elpd[i] = self._refit(groups == i)
        kept = k[k <= TRUSTED]
        return LeftOut(elpd, len(again), float(kept.max()) if len(kept) else None)

    def _posterior(self) -> tuple[NDArray, NDArray]:
        """Draws about the estimate, and the logarithm of the posterior over their own density.

        Of the law's parameters a multivariate t; standard deviations apart, each a t folded at zero, and a part of
        them from their prior, which bounds their weights however little the data say of them.
        """
        if self._draws is not None:
            return self._draws
        best = self._fit.maximum
        rng, n = np.random.default_rng([self._seed, DRAWS]), len(best.values)
        mean = np.array([p.mean for p in best.parameters], bool)
        x = np.array([p.inward(v) for p, v in zip(best.parameters, best.values, strict=True)])
        slope = np.array([p.slope(v) for p, v in zip(best.parameters, x, strict=True)])
        C = best.covariance / np.outer(slope, slope)
        C[np.ix_(mean, ~mean)] = C[np.ix_(~mean, mean)] = 0.0
        C[np.ix_(~mean, ~mean)] *= np.eye(int((~mean).sum()))
        root = np.linalg.cholesky(C + 1e-300 * np.eye(n))
        stretch = np.sqrt(_TAILS / rng.chisquare(_TAILS, (DRAWS, n)))
        stretch[:, mean] = stretch[:, mean][:, :1]  # one for all of the law
        z = rng.standard_normal((DRAWS, n)) * stretch
        drawn = x + z @ root.T
        log_q = _log_t((z[:, mean] ** 2).sum(axis=1), int(mean.sum()))
        for j in np.flatnonzero(~mean):
            wide, prior = rng.random(DRAWS) < _WIDE, best.parameters[j].prior
            scale = prior.sigma if isinstance(prior, HalfNormal) else root[j, j]
            drawn[:, j] = np.abs(np.where(wide, scale * rng.standard_normal(DRAWS), drawn[:, j]))
            near = [_density_t((drawn[:, j] - side * x[j]) / root[j, j]) / root[j, j] for side in (1, -1)]
            of_prior = 2 * np.exp(-0.5 * (drawn[:, j] / scale) ** 2) / (scale * math.sqrt(2 * math.pi))
            log_q = log_q + np.log((1 - _WIDE) * sum(near) + _WIDE * of_prior)
        values = np.array([[p.outward(v) for p, v in zip(best.parameters, row, strict=True)] for row in drawn])
        log_p = np.array([self._log_posterior(v, row) for v, row in zip(values, drawn, strict=True)])
        self._draws = values, log_p - log_q
        return self._draws

    def _log_posterior(self, values: NDArray, x: NDArray) -> float:
        """Up to a constant, as a density in the coordinates x; nothing beyond the bounds."""
        parameters = self._fit.likelihood.parameters
        for p, at in zip(parameters, x, strict=True):
            low, high = p.limits
            if (low is not None and at < low) or (high is not None and at > high):
                return -np.inf
        jacobian = sum(at for p, at in zip(parameters, x, strict=True) if p.scale == "log")
        total = log_prior(parameters, values, every=True) + jacobian - self._fit.likelihood(values)
        return float(total) if np.isfinite(total) else -np.inf


def _density_t(z: NDArray) -> NDArray:
    """Of Student's t."""
    return (
        np.exp(_log_t(z**2, 1))
        * math.gamma(0.5 * (_TAILS + 1))
        / math.gamma(0.5 * _TAILS)
        / math.sqrt(_TAILS * math.pi)
    )


def _log_t(square: NDArray, n: int) -> NDArray:
    """Logarithm of the density of Student's t in n dimensions, up to a constant."""
    return -0.5 * (_TAILS + n) * np.log1p(square / _TAILS)


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
