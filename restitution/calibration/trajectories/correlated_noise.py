r"""Noise of a series of positions that is independent from frame to frame in part, and in part correlated.

Frame i, read at t_i, is in error by w_i + u(t_i): w_i is normal with the standard deviation sigma_w of a reading,
u an Ornstein-Uhlenbeck process of standard deviation sigma_u and correlation time tau,

    <u(t) u(t')> = sigma_u^2 exp(-|t - t'|/tau),    K = sigma_w^2 1 + <u u>.

u being Markovian, A^T K^-1 B and ln|K| follow from one pass over the frames (Kalman's filter, exact at any times):
with the variance P and the mean m of u before frame i, S = P + sigma_w^2,

    whitened frame = (y - m)/sqrt(S),    m -> m + (P/S)(y - m),    P -> P (1 - P/S),
    to the next frame:    m -> f m,    P -> f^2 P + sigma_u^2 (1 - f^2),    f = exp(-dt/tau).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.bounce.kernel import _kept as kept


@kept
def products(time, columns, sigma_w, sigma_u, tau, gram, log_det):
    """For each pair (sigma_u, tau): columns^T K^-1 columns into ``gram``, ln|K| into ``log_det``.

    ``columns`` is (frames, k), ``gram`` (pairs, k, k).
    """
    n, k = columns.shape
    mean, white = np.zeros(k), np.zeros(k)
    for g in range(len(sigma_u)):
        P = sigma_u[g] ** 2
        mean[:] = 0.0
        total = 0.0
        gram[g] = 0.0
        for i in range(n):
            if i > 0:
                f = math.exp(-(time[i] - time[i - 1]) / tau[g])
                for a in range(k):
                    mean[a] *= f
                P = f * f * P + sigma_u[g] ** 2 * (1 - f * f)
            S = P + sigma_w**2
            gain, root = P / S, 1 / math.sqrt(S)
            total += math.log(S)
            for a in range(k):
                away = columns[i, a] - mean[a]
                mean[a] += gain * away
                white[a] = away * root
            P *= 1 - gain
            for a in range(k):
                for b in range(a + 1):
                    gram[g, a, b] += white[a] * white[b]
        for a in range(k):
            for b in range(a):
                gram[g, b, a] = gram[g, a, b]
        log_det[g] = total


def gram_matrices(
    time: NDArray, columns: NDArray, sigma_w: float, sigma_u: NDArray, tau: NDArray
) -> tuple[NDArray, NDArray]:
    """columns^T K^-1 columns, shape (pairs, k, k), and ln|K|, shape (pairs,), for pairs of sigma_u and tau."""
    pairs, k = len(sigma_u), columns.shape[1]
    gram, log_det = np.empty((pairs, k, k)), np.empty(pairs)
    products(time, np.ascontiguousarray(columns), sigma_w, sigma_u, tau, gram, log_det)
    return gram, log_det


def draw(time: NDArray, sigma_w: float, sigma_u: float, tau: float, rng: np.random.Generator) -> NDArray:
    """One realisation of the noise at ``time``."""
    f = np.exp(-np.diff(time) / tau)
    u = sigma_u * rng.standard_normal(len(time))
    for i in range(1, len(time)):
        u[i] = f[i - 1] * u[i - 1] + math.sqrt(1 - f[i - 1] ** 2) * u[i]
    return u + sigma_w * rng.standard_normal(len(time))
