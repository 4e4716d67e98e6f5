r"""Flights at parameters that were not run: principal components of those that were, each by a Gaussian process.

    q(theta) = <q> + sum_k w_k(theta) phi_k + r,      w_k ~ GP(0, K_k),
    K(x, x') = a Matern_5/2(x - x'; l_1 ... l_p) + b x.x' + c delta,

x the parameters from -1/2 to 1/2 over the range of the runs, in the logarithm where the runs lie more evenly
so. phi_k are the components of the weighted q (:mod:`.registered`), so many that the rest r has less than 1e-6
of its variance, at most 8 (Higdon, Gattiker, Williams & Rightley, J. Am. Stat. Assoc. 103 (2008) 570). b is a
trend, c what a run scatters by, as with the place of the sphere between cells. a, b, c and the lengths l are
those of maximum likelihood, from several starts of one seed (scikit-learn). The error of a prediction is that
of each w_k, with c and r.

That error takes a, b, c and l to be known, which so few runs do not tell: it is too small. So it is widened by how
far it is too small on runs left out, a fifth at a time, a, b, c and l found without them,

    s_k = max(1, sqrt(< ((w_k - m_k)/sigma_k)^2 >)),

its scale by cross-validation (Bachoc, Comput. Stat. Data Anal. 66 (2013) 55) for each component. Errors of runs
left out with a, b, c and l kept would be no measure: maximum likelihood has made their mean square 1.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from restitution.calibration.estimation.parameters import Scale
from restitution.errors import InputError

UNEXPLAINED = 1e-6
"""Part of the variance that the components may leave out."""
MOST_COMPONENTS = 8
LEAST_RATIO = 3.0
"""Of the greatest to the least value of a parameter below which its logarithm is as good as itself."""
LENGTHS = (0.15, 30.0)
"""Bounds of the lengths, in ranges of a parameter."""
STARTS = 4
"""Of the search for them, beside the first."""
FOLDS = 5
"""Parts of the runs that are left out in turn."""


@dataclass(frozen=True)
class Process:
    """One component: the numbers of its kernel and what predictions need, over all runs."""

    matern: float
    lengths: NDArray
    trend: float
    scatter: float
    alpha: NDArray
    root: NDArray
    """Inverse of the lower Cholesky factor of the kernel of the runs; its square would lose small variances."""
    widened: float
    """s_k, times by which the error that follows from these is widened."""


@dataclass(frozen=True)
class Emulator:
    """Predicts q for parameters within the ``ranges`` of its runs, (p, 2)."""

    names: tuple[str, ...]
    ranges: NDArray
    scales: tuple[Scale, ...]
    runs: NDArray
    """x of the runs, (runs, p)."""
    mean: NDArray
    components: NDArray
    """phi_k over the weights, (K, q)."""
    rest: NDArray
    """r of the runs, (runs, q)."""
    processes: tuple[Process, ...]

    def place(self, theta: NDArray) -> NDArray:
        """X of parameters, (..., p)."""
        return _place(theta, self.ranges, self.scales)

    def scores(self, theta: NDArray) -> tuple[NDArray, NDArray]:
        """Mean and variance of w, both (B, K), at parameters (B, p)."""
        x = self.place(theta)
        away = x[:, None, :] - self.runs[None, :, :]
        trend = x @ self.runs.T
        square = np.einsum("bi,bi->b", x, x)
        means, variances = np.empty((len(x), len(self.processes))), np.empty((len(x), len(self.processes)))
        for k, process in enumerate(self.processes):
            r = np.sqrt(5 * np.einsum("bni,i->bn", away**2, process.lengths**-2.0))
            K = process.matern * (1 + r + r**2 / 3) * np.exp(-r) + process.trend * trend
            means[:, k] = K @ process.alpha
            own = process.matern + process.trend * square + process.scatter
            variances[:, k] = process.widened**2 * (own - np.sum((K @ process.root.T) ** 2, axis=1))
        return means, np.maximum(variances, 1e-12)

    def flight(self, scores: NDArray) -> NDArray:
        """Q of scores, (..., K) to (..., q)."""
        return self.mean + scores @ self.components

    def draws(self, theta: NDArray, rng: np.random.Generator) -> NDArray:
        """Q at each of the parameters (B, p), the errors of w drawn, r as one of the runs had it."""
        mean, variance = self.scores(theta)
        w = mean + np.sqrt(variance) * rng.standard_normal(mean.shape)
        return self.flight(w) + self.rest[rng.integers(0, len(self.rest), len(theta))]


def emulate(
    names: Sequence[str],
    theta: NDArray,
    q: NDArray,
    weight: NDArray,
    ranges: NDArray | None = None,
    scales: tuple[Scale, ...] | None = None,
) -> Emulator:
    """An emulator of runs at ``theta`` (runs, p) that gave ``q`` (runs, entries); of theirs: ranges and scales."""
    ranges = np.stack([theta.min(axis=0), theta.max(axis=0)], axis=1) if ranges is None else ranges
    scales = scales or tuple(scale_of_design(x) for x in theta.T)
    x, mean = _place(theta, ranges, scales), q.mean(axis=0)
    U, s, V = np.linalg.svd((q - mean) * weight, full_matrices=False)
    left = 1 - np.cumsum(s**2) / max(float(np.sum(s**2)), 1e-300)
    K = min(int(np.argmax(left < UNEXPLAINED)) + 1, MOST_COMPONENTS, len(s) - 1)
    size = s[:K] / np.sqrt(len(q))
    w = U[:, :K] * np.sqrt(len(q))
    components = size[:, None] * V[:K] / weight
    rest = q - mean - w @ components
    processes = tuple(_process(x, w[:, k], k) for k in range(K))
    return Emulator(tuple(names), ranges, scales, x, mean, components, rest, processes)


def folds(n: int) -> Iterator[tuple[NDArray, NDArray]]:
    """Runs that are left out, and the others; which belong together is drawn with a fixed seed."""
    order, parts = np.random.default_rng(0).permutation(n), min(FOLDS, n)
    for k in range(parts):
        out = order[k::parts]
        yield out, np.setdiff1d(order, out)


def scale_of_design(values: NDArray) -> Scale:
    """The scale on which a parameter was varied: the one on which its values lie more evenly."""

    def uneven(x: NDArray) -> float:
        """Kolmogorov's distance from a uniform distribution over their range."""
        x = np.sort((x - x.min()) / np.ptp(x))
        return float(np.max(np.abs(x - (np.arange(len(x)) + 0.5) / len(x))))

    positive = values.min() > 0 and values.max() > LEAST_RATIO * values.min()
    return "log" if positive and uneven(np.log(values)) < uneven(values) else "linear"


def _place(theta: NDArray, ranges: NDArray, scales: Sequence[Scale]) -> NDArray:
    logarithmic = np.array([scale == "log" for scale in scales])
    with np.errstate(divide="ignore", invalid="ignore"):
        value, ends = (np.where(logarithmic, np.log(v), v) for v in (theta, ranges.T))
    return (value - ends[0]) / (ends[1] - ends[0]) - 0.5


def _process(x: NDArray, w: NDArray, seed: int) -> Process:
    """The Gaussian process of one component, by scikit-learn."""
    try:
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, DotProduct, Matern, WhiteKernel
        from threadpoolctl import threadpool_limits  # of scikit-learn's own dependencies
    except ImportError:
        raise InputError("an emulator needs scikit-learn: pip install 'restitution[emulator]'") from None
    kernel = (
        ConstantKernel(1.0, (1e-4, 1e3)) * Matern(np.ones(x.shape[1]), LENGTHS, nu=2.5)
        + ConstantKernel(1.0, (1e-4, 1e3)) * DotProduct(0.0, "fixed")
        + WhiteKernel(1e-4, (1e-8, 1.0))
    )
    regressor = GaussianProcessRegressor(kernel, n_restarts_optimizer=STARTS, random_state=seed)
    # Threads of the algebra cost ten times what they save on matrices of so few runs.
    with warnings.catch_warnings(), threadpool_limits(1):
        warnings.simplefilter("ignore", ConvergenceWarning)  # a length at its bound is a flat direction
        fitted = regressor.fit(x, w).kernel_
        errors = np.empty(len(w))
        for out, kept in folds(len(w)):  # the search begins at the numbers of all runs: once is enough
            mean, sigma = GaussianProcessRegressor(fitted).fit(x[kept], w[kept]).predict(x[out], return_std=True)
            errors[out] = (w[out] - mean) / sigma
    (matern, trend), scatter = (fitted.k1.k1, fitted.k1.k2), fitted.k2
    root = solve_triangular(regressor.L_, np.eye(len(w)), lower=True)
    return Process(
        float(matern.k1.constant_value), np.atleast_1d(matern.k2.length_scale).astype(float),
        float(trend.k1.constant_value), float(scatter.noise_level), np.ravel(regressor.alpha_), root,
        max(1.0, float(np.sqrt(np.mean(errors**2)))),
    )  # fmt: skip
