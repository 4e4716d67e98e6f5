"""One branch of the motion next to a contact, as polynomials averaged over windows and orders.

How many frames to use, and with which polynomial, is a choice that moves a slope as much as the noise does.
Instead of making it, every window of the n frames nearest to the contact is fitted, and each fit weighs
exp(-AIC/2),

    AIC = chi^2_aug + 2 k + 2 n_cut,

k being the number of coefficients, n_cut that of the frames left out and chi^2_aug the misfit augmented by that of
a prior (Jay & Neil, Phys. Rev. D 103, 114502 (2021), doi:10.1103/PhysRevD.103.114502). An approach is smooth: all
orders from 1 to 5 take part. After a rebound the sphere's own wake brakes it, most in the first milliseconds;
lower orders fit the frames as well but extrapolate too steadily, so a rebound is always of order 5 and the prior
keeps its coefficients to what gravity, drag, history force and wake can do. Draws from the mixture carry both the
noise and the choice of window.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions
from restitution.tracks import differences

APPROACH = (1, 2, 3, 4, 5)
REBOUND = (5,)
_COEFFICIENTS = 6
MOST_SINGLE = 64
"""Frames of a branch up to which each is a point of its own."""
_APPROACH_POINTS, _REBOUND_POINTS = (24, 24), (8, 16)
"""Of a longer branch: the nearest frames that are so, and the means that the others are taken together to,
the longer the farther from the contact. Fewer after a rebound, where what is far tells less of what is
near."""
_MOST_WINDOWS = 24


@dataclass(frozen=True)
class Branch:
    """Fits of gap(tau) = sum_k c_k tau^k, tau in s from the origin: coefficients, covariance roots, weights."""

    coefficients: NDArray  # (fits, 6)
    roots: NDArray  # (fits, 6, 6), a square root of each covariance
    weights: NDArray  # (fits,), sum 1
    reaches: NDArray  # (fits,), how far from the origin in s the window of each fit goes

    def mean(self) -> NDArray:
        """The mean coefficients of the mixture, shape (6,)."""
        return self.weights @ self.coefficients

    @property
    def reach(self) -> float:
        """How far from the origin in s the frames go that the fits are made to, by their weights."""
        return float(self.weights @ self.reaches)

    def draw(self, size: int, rng: np.random.Generator) -> NDArray:
        """``size`` sets of coefficients, shape (size, 6), from the weighted mixture."""
        which = rng.choice(len(self.weights), size, p=self.weights)
        normal = rng.standard_normal((size, _COEFFICIENTS))
        return self.coefficients[which] + np.einsum("sij,sj->si", self.roots[which], normal)


@dataclass(frozen=True)
class Prior:
    """Normal prior of the coefficients c_k: none for gap and velocity, and from k = 2 on

        2 c_2 = -g_eff +- (g_eff/2 + V/T),    k! c_k = 0 +- V T^(1-k),    T = sqrt(d/g):

    free flight with buoyancy and added mass, g_eff = g (rho_p - rho_f)/(rho_p + rho_f/2), whose speed V drag may
    change by its own size within T. After an impact of speed U, history force and wake brake the sphere besides,
    most in the first milliseconds: the covariance has U^2 T^(2-k-l) B_kl more, B being the second moments of
    k! c_k T^(k-1)/U by the point particle outside the film (``python -m benchmarks.after_rebound``). They are
    nearly those of one shape of unknown strength, none being one standard deviation off.
    """

    g_eff: float
    T: float

    @classmethod
    def of(cls, conditions: Conditions) -> Prior:
        """The prior for a sphere under ``conditions``."""
        return cls(conditions.free_fall, math.sqrt(conditions.sphere.diameter / conditions.gravity))

    def mean(self) -> NDArray:
        """Expected coefficients."""
        return np.array([0.0, 0.0, -self.g_eff / 2, 0.0, 0.0, 0.0])

    def root(self, V: float, U: float = 0.0) -> NDArray:
        """A root R of the precision, R^T R, of a branch of speed ``V``, after an impact of speed ``U``."""
        k = np.arange(2, _COEFFICIENTS)
        unit = self.T ** (1.0 - k) / [math.factorial(n) for n in k]
        smooth = V * unit
        smooth[0] += self.g_eff / 4
        covariance = np.diag(smooth**2) + _BRAKE * np.outer(U * unit, U * unit)
        root = np.zeros((_COEFFICIENTS, _COEFFICIENTS))
        size = np.sqrt(np.diag(covariance))  # they are of many orders of magnitude
        root[2:, 2:] = np.linalg.inv(np.linalg.cholesky(covariance / np.outer(size, size))) / size
        return root


_BRAKE = np.array(
    [
        [0.284, -0.937, 2.496, -3.782],
        [-0.937, 3.153, -8.461, 12.875],
        [2.496, -8.461, 22.857, -34.927],
        [-3.782, 12.875, -34.927, 53.659],
    ]
)
"""B for k and l from 2 to 5."""
_NO_PRIOR = np.zeros(6), np.zeros((6, 6))


@dataclass(frozen=True)
class Points:
    """What a branch is fitted to, nearest to the contact first: single frames, or means of neighbouring ones.

    ``moments`` (n, 6) are the means of tau^k over the frames of a point, tau in s from the origin, ``value`` that
    of their gaps in m or velocities in m/s, ``sigma`` its error.
    """

    moments: NDArray
    value: NDArray
    sigma: NDArray

    @property
    def tau(self) -> NDArray:
        """Mean time of each."""
        return self.moments[:, 1]


def speed_of(branch: Points, quantity: str) -> float:
    """The speed scale of a branch: the greatest among its nearest four frames, or as many as it takes to move."""
    tau, value, sigma = branch.tau, branch.value, branch.sigma
    if quantity == "velocity":
        return float(np.max(np.abs(value[:4])))
    steps = max((len(tau) - 1) // 3, 1)
    way = np.abs(value[3 : 3 * steps + 1 : 3] - value[0])
    far = np.flatnonzero(way > _SEEN * sigma[0])
    step = int(far[0]) + 1 if len(far) else steps
    at = slice(step, 3 * step + 1, step)
    open_speed = math.sqrt(2) * sigma[0] / abs(tau[-1] - tau[0])  # of positions that are all the same
    return max(float(np.max(np.abs((value[at] - value[0]) / (tau[at] - tau[0])))), open_speed)


_SEEN = 10.0
"""How far, in errors of a frame, a sphere must have gone to tell its speed."""


def points(tau: NDArray, value: NDArray, sigma: float, rebound: bool) -> Points:
    """The frames of a branch: each for itself, or, of more than ``MOST_SINGLE``, the farther ones as means.

    All frames of a long branch take part. Were they points of their own, the penalty for leaving frames out would
    outweigh what is near the contact.
    """
    moments, errors = tau[:, None] ** np.arange(_COEFFICIENTS), np.full(len(tau), sigma)
    if len(tau) > MOST_SINGLE:
        runs = np.flatnonzero(np.diff(value, prepend=np.nan) != 0)
        if _COEFFICIENTS < len(runs) < len(tau) / 2:  # on a grid: frames that show the same pixel say it once
            errors = _on_pixels(tau, value, runs, sigma)
            moments, value = _means(moments, runs), value[runs]
    N = len(value)
    begins = np.arange(N)
    if N > MOST_SINGLE:
        single, means = _REBOUND_POINTS if rebound else _APPROACH_POINTS
        farther = np.rint(np.geomspace(single, N, means + 1)).astype(int)[:-1]
        begins = np.unique(np.concatenate([np.arange(single), farther]))
    n = np.diff(np.append(begins, N))
    return Points(_means(moments, begins), _means(value, begins), np.sqrt(_means(errors**2, begins) / n))


def _on_pixels(tau: NDArray, value: NDArray, runs: NDArray, sigma: float) -> NDArray:
    """The errors of the middles of runs of frames that show the same pixel, each beginning at one of ``runs``.

    A sphere that crosses a pixel within m frames has come in and gone out at times known to within a frame, so
    that where it was meanwhile is known m times as well as one frame tells it. What the middles scatter beyond
    that, by what neighbouring four of them leave of a parabola, is added. Where the sphere does not cross the
    pixel, as where it turns or the branch ends, its place within it stays open.
    """
    frames = np.diff(np.append(runs, len(value)))
    step = np.sign(np.diff(value[runs]))
    crossed = np.zeros(len(runs), bool)
    crossed[1:-1] = step[1:] == step[:-1]
    ideal = np.where(crossed, sigma / frames, sigma)
    left, weight = differences(_means(tau, runs), value[runs])
    expected = np.sqrt(np.sum(weight**2 * np.lib.stride_tricks.sliding_window_view(ideal, 4) ** 2, axis=1))
    excess = np.median(np.abs(left)) ** 2 / 0.6745**2 - np.median(expected) ** 2
    return np.where(crossed, np.minimum(np.sqrt(ideal**2 + max(excess, 0.0)), sigma), sigma)


def _means(values: NDArray, begins: NDArray) -> NDArray:
    """Means of ``values`` along their first axis, from each of ``begins`` to the next."""
    n = np.diff(np.append(begins, len(values)))
    return np.add.reduceat(values, begins, axis=0) / n.reshape(-1, *[1] * (values.ndim - 1))


def average(branch: Points, quantity: str, prior: Prior, impact_speed: float | None = None) -> Branch:
    """Fit all windows and orders to the points of a branch; after a rebound ``impact_speed`` is that before it.

    Of velocities the gap polynomial without its constant is fitted. At least two points are needed. Where no
    fit with four or more degrees of freedom comes within twice the noise (chi^2_aug over degrees of freedom
    above 4), the noise is scaled up to that of the best one.
    """
    N, first = len(branch.value), _first(quantity)
    normal = prior.mean(), prior.root(speed_of(branch, quantity), impact_speed or 0.0)
    orders = APPROACH if impact_speed is None else REBOUND
    coefficients, roots, misfit, unknowns, windows = [], [], [], [], []
    for p in orders:
        lengths = _windows(2 - first, N)  # gap and velocity have no prior, so they need that many frames
        c, root, chi2 = _fit(branch, lengths, quantity, p, normal)
        coefficients.append(c)
        roots.append(root)
        misfit.append(chi2)
        unknowns.append(np.full(len(lengths), p + 1 - first))
        windows.append(lengths)
    misfit, unknowns, windows = (np.concatenate(x) for x in (misfit, unknowns, windows))
    free = windows - unknowns
    tested = free >= 4
    scale = np.min(misfit[tested] / free[tested], initial=np.inf)
    if 4 < scale < np.inf:  # no polynomial describes the frames within twice the noise: it is larger
        noisier = replace(branch, sigma=branch.sigma * np.sqrt(scale) * (1 + 1e-6))
        return average(noisier, quantity, prior, impact_speed)
    aic = misfit + 2 * unknowns + 2 * (N - windows)
    weights = np.exp(-0.5 * (aic - aic.min()))
    reaches = np.maximum.accumulate(np.abs(branch.tau))[windows - 1]
    return Branch(np.concatenate(coefficients), np.concatenate(roots), weights / weights.sum(), reaches)


def line(branch: Points, quantity: str) -> Branch:
    """The straight line through all points by least squares: the mean slope, no average, no prior."""
    everything = np.array([len(branch.value)])
    coefficients, roots, _ = _fit(branch, everything, quantity, 1, _NO_PRIOR)
    return Branch(coefficients, roots, np.ones(1), np.max(np.abs(branch.tau), keepdims=True))


def _fit(
    branch: Points, windows: NDArray, quantity: str, p: int, prior: tuple[NDArray, NDArray]
) -> tuple[NDArray, NDArray, NDArray]:
    """Least-squares polynomials of order p over the windows: coefficients, covariance roots, chi^2_aug."""
    used = slice(_first(quantity), p + 1)
    powers, value = np.arange(_COEFFICIENTS)[used], branch.value
    # Fitted in units of the window, for the conditioning; points outside a window get no weight.
    scale = np.maximum.accumulate(np.abs(branch.tau))[windows - 1][:, None]
    scale[scale == 0] = 1.0
    of = powers if quantity == "gap" else powers - 1
    design = branch.moments[:, of] / scale[:, :, None] ** of
    if quantity == "velocity":
        design *= powers / scale[:, :, None]
    inside = (np.arange(len(value)) < windows[:, None]) / branch.sigma
    unscale = scale ** -powers.astype(float)
    mean, root = prior[0][used], prior[1][used, used]
    A = np.concatenate([inside[:, :, None] * design, root * unscale[:, None, :]], axis=1)
    expected = np.broadcast_to(root @ mean, (len(windows), len(powers)))
    b = np.concatenate([inside * value, expected], axis=1)
    Q, R = np.linalg.qr(A)
    inverse = np.linalg.inv(R)
    c = np.einsum("wij,wkj,wk->wi", inverse, Q, b)
    misfit = np.sum((b - np.einsum("wki,wi->wk", A, c)) ** 2, axis=1)
    coefficients = np.zeros((len(windows), _COEFFICIENTS))
    roots = np.zeros((len(windows), _COEFFICIENTS, _COEFFICIENTS))
    coefficients[:, used] = unscale * c
    roots[:, used, used] = unscale[:, :, None] * inverse
    return coefficients, roots, misfit


def _first(quantity: str) -> int:
    return 1 if quantity == "velocity" else 0


def _windows(least: int, N: int) -> NDArray:
    """Window lengths from ``least`` to ``N``: all of them, or a geometric choice of a long record."""
    if N - least < _MOST_WINDOWS:
        return np.arange(least, N + 1)
    return np.unique(np.rint(np.geomspace(least, N, _MOST_WINDOWS)).astype(int))
