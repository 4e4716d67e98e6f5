r"""The history force at a cost per step that does not grow: a kernel as a sum of exponentials.

Both kernels of :mod:`restitution.laws.history` are completely monotone, so they are mixtures of exponentials.
With beta = lambda t_c, t_c(Re) being when the kernel leaves Basset's,

    K(t) = sum_j w_j G(lambda_j t_c) exp(-lambda_j t),   t_c = tau_c r^2/nu,
    w_j = ds sqrt(lambda_j r^2/nu),    G(beta) = sqrt(beta) rho(beta)/sqrt(pi),

lambda_j being equidistant in ln(lambda) with the step ds (the trapezoidal rule, whose error falls as
exp(-pi^2/ds): Beylkin & Monzon 2005 for power laws; van Hinsberg, ten Thije Boonkkamp & Clercx, J. Comput. Phys.
230, 1465 (2011), keep a window and such a tail instead), and rho the density with
x^(-1/2) (1 + x^gamma)^(-c_1) = int rho(beta) exp(-beta x) d beta, gamma = 3/(2 c_1); for Basset's kernel G = 1/pi.

The convolution int exp(-lambda_j (t - s)) (dv/ds) ds equals v - Z_j, where

    dZ_j/dt = lambda_j (v - Z_j),

so each term is a drag against a lagged velocity Z_j of the fluid, and a jump of v at an impact needs nothing:
Z_j is continuous there. Terms faster than the fastest are an added mass, terms slower than the slowest one more
term of the same weight and mean rate; both are exact to first order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from restitution.laws.history import FiniteReynolds, HistoryLaw

STEP = 0.7
"""ds: the kernel's relative error is then 2e-6."""
BASSET = 1 / np.pi
"""G of Basset's kernel, and of any other at short lags."""
_LN_BETA = (-30.0, 40.0, 0.05)


@dataclass(frozen=True)
class Modes:
    """Rates lambda_j in 1/s, weights w_j, and ``tail``, the sum of w/lambda beyond the fastest, in s."""

    rates: NDArray
    weights: NDArray
    tail: float


def modes(radius: float, nu: float, slowest: float, fastest: float) -> Modes:
    """The terms for lags between about 1/``fastest`` and 1/``slowest`` (1/s)."""
    count = int(np.ceil(np.log(fastest / slowest) / STEP)) + 1
    rates = fastest * np.exp(-STEP * np.arange(count)[::-1])
    weights = STEP * np.sqrt(rates * radius**2 / nu)
    q = np.exp(-STEP / 2)
    slow_weight = weights[0] * q / (1 - q)  # sum over all slower ones, a geometric series
    slow_rate = rates[0] * (q**3 / (1 - q**3)) / (q / (1 - q))
    tail = weights[-1] / rates[-1] * q / (1 - q)
    return Modes(np.concatenate([[slow_rate], rates]), np.concatenate([[slow_weight], weights]), tail)


@cache
def spectrum(c_1: float) -> tuple[NDArray, NDArray]:
    """ln(beta) and G(beta) of the kernels of finite Re; G tends to 1/pi, Basset's, at large beta.

    rho is the inverse Laplace transform of k(x) = x^(-1/2) (1 + x^gamma)^(-c_1), the contour along the cut of k:
    rho(beta) = -(1/pi) int_0^inf exp(-beta y) Im k(y exp(i pi)) dy. No pole lies on the principal sheet.
    """
    s = np.arange(*_LN_BETA)
    u = np.arange(-60.0, 8.0, 0.04)[None, :]  # ln(beta y)
    gamma = 1.5 / c_1
    out = np.empty_like(s)
    for block in np.array_split(np.arange(len(s)), 16):
        y = np.exp(u - s[block, None])
        k = y**-0.5 * np.real((1 + y**gamma * np.exp(1j * np.pi * gamma)) ** -c_1)
        rho = 0.04 / np.pi * np.sum(np.exp(-np.exp(u)) * k * y, axis=1)
        out[block] = np.exp(s[block] / 2) * rho / np.sqrt(np.pi)
    return s, out


def shape(ln_beta: NDArray, c_1: float) -> NDArray:
    """G at ln(beta), by a cubic spline; relative error 1e-8."""
    return _spline(c_1)(np.clip(ln_beta, _LN_BETA[0], _LN_BETA[1] - 1))


@cache
def _spline(c_1: float) -> Callable:
    from scipy.interpolate import CubicSpline

    return CubicSpline(*spectrum(c_1))


def approximation(law: HistoryLaw, terms: Modes, radius: float, nu: float, time: NDArray, Re: float) -> NDArray:
    """The sum of exponentials at lags ``time`` (s): what the integration uses in place of ``law``."""
    if isinstance(law, FiniteReynolds):
        G = shape(np.log(terms.rates * law.crossover(Re) * radius**2 / nu), law.c_1)
    else:
        G = np.full_like(terms.rates, BASSET)
    return (terms.weights * G * np.exp(-np.multiply.outer(time, terms.rates))).sum(-1)
