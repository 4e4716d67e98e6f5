r"""What few impacts do to intervals when the scatter is estimated with the law, and the remedy.

The maximum of the likelihood takes the scatter too small, since the law has bent itself towards the points; ten
impacts and two parameters lose a tenth of it, and the intervals with it. The remedy for a linear law is exact and
old: the restricted likelihood (Patterson & Thompson 1971),

    ln L_R(theta, phi) = ln L(theta, phi) - 1/2 ln |J^T V(phi)^-1 J + Lambda|,

phi = (tau, omega) being the standard deviations, V the covariance of the impacts, J = df/dtheta, Lambda the
precision of the priors; and Student's t in place of the normal. J is held at the estimate, so that the term weighs
standard deviations and not parameters of the law. The degrees of freedom of the t of each parameter follow from
how well the data determine its variance C_jj (Satterthwaite):

    nu_j = 2 C_jj^2 / (g^T A g),    g = dC_jj/dphi^2,    A = inverse information of phi^2,

n - p where all error is scatter, without limit where all of it is known. The profile of ln L_R is cut at
ln(1 + t^2/nu) nu/2 below its maximum, which gives the t interval exactly where the law is linear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincinv, stdtrit

from restitution.calibration.estimation.likelihood import OFFSET, SCATTER, Likelihood
from restitution.calibration.estimation.parameters import prior_precision


@dataclass(frozen=True)
class Restriction:
    """The term 1/2 ln |J^T V^-1 J + Lambda| of the measured impacts as a function of the standard deviations."""

    J: NDArray  # (n, p), of the measured impacts and the parameters of the law
    variance: NDArray  # (n,), without the scatter
    sources: NDArray
    precision: NDArray
    places: tuple[int | None, int | None]
    """Where scatter and offset stand among the values."""

    @classmethod
    def at(cls, likelihood: Likelihood, values: NDArray) -> Restriction | None:
        """The term at an estimate; None where there is nothing to correct or the impacts do not determine it."""
        names = [p.name for p in likelihood.parameters]
        places = tuple(names.index(n) if n in names else None for n in (SCATTER, OFFSET))
        mean = np.array([p.mean for p in likelihood.parameters])
        if places == (None, None) or not mean.any() or likelihood.robust:
            return None
        seen = ~likelihood.observations.censored
        _, variance, _ = likelihood.moments(values)
        tau = 0.0 if places[0] is None else values[places[0]]
        known = np.maximum(variance - tau**2, 0.0)[seen]
        J = likelihood.jacobian(values)[seen][:, mean]
        precision = (np.diag(prior_precision(likelihood.parameters)) + likelihood.jointly.precision)[mean][:, mean]
        restriction = cls(J, known, likelihood.sources[seen], precision, places)
        singular = np.linalg.cond(restriction.scaled(values)) > 1e12
        return None if singular else restriction

    def __call__(self, values: NDArray) -> float:
        """1/2 ln of the determinant."""
        information = self.information(values)
        if len(information) == 1:  # numpy's takes longer than all else here
            return 0.5 * math.log(abs(information[0, 0])) if information[0, 0] else -math.inf
        return 0.5 * np.linalg.slogdet(information)[1]

    def scaled(self, values: NDArray) -> NDArray:
        """The matrix with a unit diagonal, whose condition says whether the parameters can be told apart."""
        information = self.information(values)
        scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
        return information / np.outer(scale, scale)

    def deviations(self, values: NDArray) -> tuple[float, float]:
        """Scatter and offset among the values; zero where they are not estimated."""
        tau, omega = (0.0 if place is None else abs(values[place]) for place in self.places)
        return tau, omega

    def information(self, values: NDArray) -> NDArray:
        """J^T V^-1 J + Lambda."""
        return self.J.T @ self._weighed(self._weights(values), self.J) + self.precision

    def _weights(self, values: NDArray) -> _Weights:
        tau, omega = self.deviations(values)
        w = 1 / np.maximum(self.variance + tau**2, 1e-24)
        sums = self._sums(w)
        return _Weights(w, sums, 1 / (1 + omega**2 * sums), omega**2)

    def _weighed(self, of: _Weights, x: NDArray) -> NDArray:
        """V^-1 x of columns x. Within a source V^-1 = diag(w) - omega^2/(1 + omega^2 W) w w^T, W = sum w."""
        weighed = of.w[:, None] * x
        if of.omega2 == 0:
            return weighed
        return weighed - of.w[:, None] * (of.omega2 * of.shrink[:, None] * self._sums(weighed))[self.sources]

    def _sums(self, x: NDArray) -> NDArray:
        """The sum over each source, of columns column by column."""
        if x.ndim == 1:
            return np.bincount(self.sources, x, self._n_sources)
        return np.stack([self._sums(column) for column in x.T], axis=1)

    def score(self, values: NDArray, r: NDArray) -> NDArray:
        """J^T V^-1 r of the residuals of the measured impacts."""
        return self.J.T @ self._weighed(self._weights(values), r[:, None])[:, 0]

    @cached_property
    def _n_sources(self) -> int:
        return int(self.sources.max()) + 1

    def degrees_of_freedom(self, values: NDArray) -> NDArray:
        """Satterthwaite's nu of each parameter of the law, at least 1.

        With P = V^-1 - V^-1 J C J^T V^-1 the information of (tau^2, omega^2) is 1/2 tr(P A P B), A and B being the
        unit matrix or that of common sources; all traces are sums over sources, so that the cost grows as n.
        """
        of, wanted = self._weights(values), [place is not None for place in self.places]
        w, W, shrink = of.w, of.sums, of.shrink
        U = self._weighed(of, self.J)
        C = np.linalg.inv(self.J.T @ U + self.precision)
        by_source = self._sums(U)
        common = w[:, None] * (shrink[:, None] * by_source)[self.sources]  # V^-1 Z Z^T U
        w2, w3 = self._sums(w**2), self._sums(w**3)
        k = of.omega2 * shrink
        plain = np.sum(w2 - 2 * k * w3 + k**2 * w2**2)
        traces = np.array([[plain, np.sum(shrink**2 * w2)], [np.sum(shrink**2 * w2), np.sum((W * shrink) ** 2)]])
        once = [U.T @ U, by_source.T @ by_source]
        twice = [
            [U.T @ self._weighed(of, U), U.T @ common],
            [common.T @ U, by_source.T @ ((W * shrink)[:, None] * by_source)],
        ]
        information = np.array(
            [
                [0.5 * (traces[a, b] - 2 * np.trace(C @ twice[a][b]) + np.trace(C @ once[a] @ C @ once[b]))
                 for b in (0, 1) if wanted[b]]
                for a in (0, 1) if wanted[a]
            ]
        )  # fmt: skip
        slopes = np.stack([np.diag(C @ once[a] @ C) for a in (0, 1) if wanted[a]], axis=1)
        A = np.linalg.pinv(information, rcond=1e-10, hermitian=True)
        spread = np.einsum("jk,kl,jl->j", slopes, A, slopes)
        with np.errstate(divide="ignore"):
            return np.maximum(2 * np.diag(C) ** 2 / spread, 1.0)


class _Weights(NamedTuple):
    """Of each impact 1/variance; of each source their sum W and 1/(1 + omega^2 W)."""

    w: NDArray
    sums: NDArray
    shrink: NDArray
    omega2: float


def threshold(level: float, nu: float) -> float:
    """By how much -2 ln L_R rises to the ends of an interval: the quantile of chi^2 for nu = inf."""
    if not np.isfinite(nu):
        return float(2 * gammaincinv(0.5, level))
    return float(nu * np.log1p(stdtrit(nu, 0.5 * (1 + level)) ** 2 / nu))
