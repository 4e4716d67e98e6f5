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

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincinv, stdtrit

from restitution.calibration.estimation.likelihood import OFFSET, SCATTER, Likelihood
from restitution.calibration.estimation.parameters import prior_precision

MOST_IMPACTS = 2000
"""Above it the degrees of freedom are not computed: dense matrices, and nothing to gain."""


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
        tau, omega = self.deviations(values)
        w = 1 / np.maximum(self.variance + tau**2, 1e-24)
        weighted = w[:, None] * self.J
        information = self.J.T @ weighted + self.precision
        if omega > 0:
            sums = weighted.T @ self._members
            shrink = omega**2 / (1 + omega**2 * (w @ self._members))
            information = information - (sums * shrink) @ sums.T
        return information

    def score(self, values: NDArray, r: NDArray) -> NDArray:
        """J^T V^-1 r of the residuals of the measured impacts."""
        tau, omega = self.deviations(values)
        w = 1 / np.maximum(self.variance + tau**2, 1e-24)
        score = self.J.T @ (w * r)
        if omega > 0:
            shrink = omega**2 / (1 + omega**2 * (w @ self._members))
            score = score - (self.J.T @ (w[:, None] * self._members)) @ (shrink * ((w * r) @ self._members))
        return score

    @cached_property
    def _members(self) -> NDArray:
        """Which impact is of which source, (n, sources) of 0 and 1."""
        return (self.sources[:, None] == np.arange(self.sources.max() + 1)).astype(float)

    def degrees_of_freedom(self, values: NDArray) -> NDArray:
        """Satterthwaite's nu of each parameter of the law, at least 1; infinity for a large set."""
        n, p = self.J.shape
        if n > MOST_IMPACTS:
            return np.full(p, np.inf)
        tau, omega = self.deviations(values)
        same = (self.sources[:, None] == self.sources).astype(float)
        V = np.diag(np.maximum(self.variance + tau**2, 1e-24)) + omega**2 * same
        parts = [part for part, place in zip((np.eye(n), same), self.places, strict=True) if place is not None]
        inverse = np.linalg.inv(V)
        VJ = inverse @ self.J
        C = np.linalg.inv(self.J.T @ VJ + self.precision)
        P = inverse - VJ @ C @ VJ.T
        Pk = [P @ part for part in parts]
        information = np.array([[0.5 * np.sum(a * b.T) for b in Pk] for a in Pk])
        slopes = np.stack([np.diag(C @ VJ.T @ part @ VJ @ C) for part in parts], axis=1)
        A = np.linalg.pinv(information, rcond=1e-10, hermitian=True)
        spread = np.einsum("jk,kl,jl->j", slopes, A, slopes)
        with np.errstate(divide="ignore"):
            return np.maximum(2 * np.diag(C) ** 2 / spread, 1.0)


def threshold(level: float, nu: float) -> float:
    """By how much -2 ln L_R rises to the ends of an interval: the quantile of chi^2 for nu = inf."""
    if not np.isfinite(nu):
        return float(2 * gammaincinv(0.5, level))
    return float(nu * np.log1p(stdtrit(nu, 0.5 * (1 + level)) ** 2 / nu))
