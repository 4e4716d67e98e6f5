r"""Central intervals over weighted draws: of values, and of values with normal noise on top.

With weights w_i, values f_i and noises s_i the distribution is the mixture

    F(x) = sum_i w_i Phi[(x - f_i)/s_i],

whose quantiles are found by Newton's method within brackets; without noise they are those of the weighted values,
linear between the middles of their steps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

_LEAST_NOISE = 1e-6
"""Below it, relative to the spread of the values, noise is none."""
_ITERATIONS = 60
_CLOSE = 1e-6
"""Of a quantile, relative to the spread of the mixture."""


def quantiles(values: NDArray, weights: NDArray, parts: tuple[float, ...]) -> NDArray:
    """Of each row of ``values`` (n, draws), shape (n, parts)."""
    order = np.argsort(values, axis=1)
    x, w = np.take_along_axis(values, order, axis=1), weights[order]
    upto = np.cumsum(w, axis=1) - 0.5 * w
    return np.array([np.interp(parts, row, at) for row, at in zip(upto, x, strict=True)])


def noisy_quantiles(values: NDArray, weights: NDArray, noise: NDArray, parts: tuple[float, ...]) -> NDArray:
    """The same of a mixture of normals; ``noise`` is one a draw."""
    mean = values @ weights
    between = np.sqrt(np.maximum((values - mean[:, None]) ** 2 @ weights, 0.0))
    if np.sqrt(weights @ noise**2) <= _LEAST_NOISE * max(float(between.max()), _LEAST_NOISE):
        return quantiles(values, weights, parts)
    scale = np.sqrt(between**2 + weights @ noise**2)
    s = np.maximum(noise, 1e-3 * float(scale.min()))
    result = np.empty((len(values), len(parts)))
    for k, part in enumerate(parts):
        low, high = mean - 40 * scale, mean + 40 * scale
        x = quantiles(values, weights, (part,))[:, 0]
        for _ in range(_ITERATIONS):
            u = (x[:, None] - values) / s
            excess = ndtr(u) @ weights - part
            density = (np.exp(-0.5 * u**2) / (np.sqrt(2 * np.pi) * s)) @ weights
            low, high = np.where(excess < 0, x, low), np.where(excess < 0, high, x)
            with np.errstate(all="ignore"):
                new = x - excess / density
            new = np.where((new > low) & (new < high), new, 0.5 * (low + high))
            moved, x = np.abs(new - x), new
            if (moved < _CLOSE * scale).all():
                break
        result[:, k] = x
    return result
