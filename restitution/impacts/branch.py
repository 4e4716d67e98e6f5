"""One branch of the motion next to a contact, as polynomials averaged over windows and orders.

How many frames to use, and with which polynomial, is a choice that moves a slope as much as the noise does.
Instead of making it, every window of the n frames nearest to the contact is fitted, and each fit weighs
exp(-AIC/2),

    AIC = chi^2_aug + 2 k + 2 n_cut,

k being the number of coefficients, n_cut that of the frames left out and chi^2_aug the misfit augmented by that
of a prior (Jay & Neil, Phys. Rev. D 103, 114502 (2021), doi:10.1103/PhysRevD.103.114502). An approach is smooth:
all orders from 1 to 5 take part. After a rebound the sphere's own wake brakes it, most in the first
milliseconds; lower orders fit the frames as well but extrapolate too steadily, so a rebound is always of order 5
and the prior keeps its coefficients to what gravity, drag and wake can do. Draws from the mixture carry both the
noise and the choice of window.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions

APPROACH = (1, 2, 3, 4, 5)
REBOUND = (5,)
_COEFFICIENTS = 6
MOST_FRAMES = 64
"""Frames used at most: in a longer branch the penalty for leaving frames out would outweigh what is near."""
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

    free flight with buoyancy and added mass, g_eff = g (rho_p - rho_f)/(rho_p + rho_f/2), whose speed V drag and
    wake may change by its own size within T. (After the first rebound of the 3 mm sphere of Gondret et al. 2002
    they brake it with 2.6 g, V/T being 2.9 g.)
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

    def sigma(self, V: float) -> NDArray:
        """Their standard deviations for a branch of speed ``V``."""
        higher = [V * self.T ** (1 - k) / math.factorial(k) for k in range(2, _COEFFICIENTS)]
        return np.array([np.inf, np.inf, higher[0] + self.g_eff / 4, *higher[1:]])


_NO_PRIOR = np.zeros(6), np.full(6, np.inf)


def _speed(tau: NDArray, value: NDArray, quantity: str) -> float:
    """The speed scale of a branch: the greatest among its nearest four frames."""
    if quantity == "velocity":
        return float(np.max(np.abs(value[:4])))
    return float(np.max(np.abs((value[1:4] - value[0]) / (tau[1:4] - tau[0]))))


def average(tau: NDArray, value: NDArray, sigma: float, quantity: str, prior: Prior, rebound: bool) -> Branch:
    """Fit all windows and orders to the frames of a branch, nearest to the contact first.

    ``tau`` in s from the origin, ``value`` a gap in m or a velocity in m/s; of a velocity the gap polynomial
    without its constant is fitted. At least two frames are needed. Where no fit with four or more degrees of
    freedom comes within twice the noise (chi^2_aug over degrees of freedom above 4), the noise is scaled up to
    that of the best one.
    """
    tau, value = tau[:MOST_FRAMES], value[:MOST_FRAMES]
    N, first = len(tau), _first(quantity)
    normal = prior.mean(), prior.sigma(_speed(tau, value, quantity))
    orders = REBOUND if rebound else APPROACH
    coefficients, roots, misfit, unknowns, windows = [], [], [], [], []
    for p in orders:
        lengths = _windows(2 - first, N)  # gap and velocity have no prior, so they need that many frames
        c, root, chi2 = _fit(tau, value, lengths, sigma, quantity, p, normal)
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
        return average(tau, value, sigma * np.sqrt(scale) * (1 + 1e-6), quantity, prior, rebound)
    aic = misfit + 2 * unknowns + 2 * (N - windows)
    weights = np.exp(-0.5 * (aic - aic.min()))
    reaches = np.maximum.accumulate(np.abs(tau))[windows - 1]
    return Branch(np.concatenate(coefficients), np.concatenate(roots), weights / weights.sum(), reaches)


def line(tau: NDArray, value: NDArray, sigma: float, quantity: str) -> Branch:
    """The straight line through all frames by least squares: the mean slope, no average, no prior."""
    everything = np.array([len(tau)])
    coefficients, roots, _ = _fit(tau, value, everything, sigma, quantity, 1, _NO_PRIOR)
    return Branch(coefficients, roots, np.ones(1), np.max(np.abs(tau), keepdims=True))


def _fit(
    tau: NDArray,
    value: NDArray,
    windows: NDArray,
    sigma: float,
    quantity: str,
    p: int,
    prior: tuple[NDArray, NDArray],
) -> tuple[NDArray, NDArray, NDArray]:
    """Least-squares polynomials of order p over the windows: coefficients, covariance roots, chi^2_aug."""
    used = slice(_first(quantity), p + 1)
    powers = np.arange(_COEFFICIENTS)[used]
    # Fitted in units of the window, for the conditioning; frames outside a window get no weight.
    scale = np.maximum.accumulate(np.abs(tau))[windows - 1][:, None]
    scale[scale == 0] = 1.0
    x = (tau / scale)[:, :, None]
    design = x**powers if quantity == "gap" else powers * x ** (powers - 1) / scale[:, :, None]
    inside = (np.arange(len(tau)) < windows[:, None]) / sigma
    unscale = scale ** -powers.astype(float)
    A = np.concatenate(
        [inside[:, :, None] * design, np.eye(len(powers)) * (unscale / prior[1][used])[:, None]], axis=1
    )
    expected = np.broadcast_to(prior[0][used] / prior[1][used], (len(windows), len(powers)))
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
