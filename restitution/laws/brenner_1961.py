"""The exact resistance of a sphere moving normal to a plane wall, and how it is evaluated at speed.

With alpha = arccosh(1 + eps), N = 2n + 1 (Brenner 1961, eq. 2.19)

    lambda = (4/3) sinh(alpha) sum_{n>=1} n(n+1)/((2n-1)(2n+3)) B_n,
    B_n    = [2 sinh(N alpha) + N sinh(2 alpha)] / [4 sinh^2(N alpha/2) - N^2 sinh^2(alpha)] - 1.

Brought over one denominator the numerator of B_n is a sum of positive terms, and the denominator factors into
2 sinh(N alpha/2) +- N sinh(alpha), whose difference is taken through sinh(x) - x; at large gaps the first term
less 1 is taken as a ratio of polynomials in exp(-alpha). So nothing cancels, neither in lambda - 1 nor in its
derivative. But the sum needs about 14/sqrt(eps) terms, so it is not summed for each call: eps (lambda - 1),
which runs smoothly from 1 to 9/8, and -eps^2 dlambda/deps are interpolated once at 151 Chebyshev points of
ln(eps) in [1e-6, 1e3]. Outside, the expansions for small and large gaps are exact to double precision.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import ClassVar

import numpy as np
from numpy.polynomial import Polynomial, chebyshev

from restitution.laws.base import CheckValue, Status
from restitution.laws.resistance import ResistanceLaw

LOW, HIGH = 1e-6, 1e3
"""Gaps between which the interpolant stands for the series."""
_DEGREE = 150

# lambda = 1/eps - ln(eps)/5 + C0 + eps (C1 - ln(eps)/21) + O(eps^2 ln eps). C0 and C1 were fitted to the series
# summed with 40 digits at eps = 2^-6 ... 2^-13, terms to eps^3 ln(eps) included; 0.97128 is the published C0.
_C0, _C1 = 0.971279931, 0.167017


# (8/15) sinh(alpha) B_1 - 1 as a function of q = exp(-alpha).
_FIRST_TOP = Polynomial([0, 135, -100, -150, 52, 103, -72, 32])
_FIRST_BOTTOM = Polynomial([60, -135, 0, 150, 0, -135, 60])


def series(eps: float) -> tuple[float, float]:
    """lambda - 1 and dlambda/deps at one gap by the sum itself, for any eps from 1e-6 up; relative error 1e-15."""
    alpha = 2 * np.arcsinh(np.sqrt(eps / 2))  # arccosh(1 + eps) without its cancellation
    sinh, cosh = np.sqrt(eps * (2 + eps)), 1 + eps
    n = np.arange(1, int(np.ceil(20 / alpha)) + 6)  # the rest is below exp(-40)
    N = 2.0 * n + 1
    x = N * alpha / 2
    top = -2 * np.expm1(-2 * x) + 2 * N * sinh * cosh + (N * sinh) ** 2
    d_top = 2 * N * (np.exp(-2 * x) + np.cosh(2 * alpha) + N * sinh * cosh)
    bottom = (2 * _sinh_less_x(x) - N * _sinh_less_x(alpha)) * (2 * np.sinh(x) + N * sinh)
    d_bottom = 2 * N * _sinh_less_x(2 * x) - N**2 * _sinh_less_x(2 * alpha)
    B = top / bottom
    d_B = (d_top - B * d_bottom) / bottom
    weight = 4 / 3 * n * (n + 1) / ((2 * n - 1) * (2 * n + 3))
    terms = weight * sinh * B
    slopes = weight * (cosh * B + sinh * d_B) / sinh
    if eps < 1:
        return float(np.sum(terms) - 1), float(np.sum(slopes))
    q = np.exp(-alpha)
    first = _FIRST_TOP(q) / _FIRST_BOTTOM(q)
    slope = -q / sinh * (_FIRST_TOP.deriv()(q) - first * _FIRST_BOTTOM.deriv()(q)) / _FIRST_BOTTOM(q)
    return float(first + np.sum(terms[1:])), float(slope + np.sum(slopes[1:]))


def _sinh_less_x(x: np.ndarray) -> np.ndarray:
    """sinh(x) - x for x > 0 without cancellation."""
    small = np.minimum(x, 1.0)
    term = small**3 / 6
    total = term
    for k in range(2, 9):
        term = term * small**2 / (2 * k * (2 * k + 1))
        total = total + term
    return np.where(x < 1, total, np.sinh(x) - x)


@cache
def _interpolants() -> np.ndarray:
    """Chebyshev coefficients of eps (lambda - 1) and of -eps^2 dlambda/deps in ln(eps)."""
    from scipy.fft import dct

    count = _DEGREE + 1
    points = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    eps = np.exp(np.log(LOW) + (points + 1) / 2 * np.log(HIGH / LOW))
    excess, derivative = np.array([series(e) for e in eps]).T
    coefficients = dct([eps * excess, -(eps**2) * derivative]) / count
    coefficients[:, 0] /= 2
    return coefficients


def _position(eps: np.ndarray) -> np.ndarray:
    """eps in [LOW, HIGH] mapped to [-1, 1]."""
    return 2 * np.log(eps / LOW) / np.log(HIGH / LOW) - 1


def _far(eps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """lambda and its derivative for eps > 1e3, by reflections: 1/lambda to order (1 + eps)^-5."""
    k = 1 / (1 + eps)
    inverse = 1 - 9 / 8 * k + k**3 / 2 - 135 / 256 * k**4 - k**5 / 8
    slope = -9 / 8 + 3 / 2 * k**2 - 135 / 64 * k**3 - 5 / 8 * k**4
    return 1 / inverse, slope * k**2 / inverse**2


@dataclass(frozen=True)
class Brenner1961(ResistanceLaw):
    """The exact solution of the Stokes equations: relative error below 1e-14 at every gap, derivative likewise."""

    name: ClassVar = "brenner_1961"
    title: ClassVar = "Brenner 1961, exact"
    formula_note: ClassVar = "series in bispherical coordinates, interpolated in ln(eps) to double precision"
    reference: ClassVar = "Brenner, Chem. Eng. Sci. 16, 242 (1961), eq. 2.19, doi:10.1016/0009-2509(61)80035-3"
    status: ClassVar = Status.VERIFIED
    evidence: ClassVar = "series read in two public codes that cite it; equal to its seven tabulated values"
    checks: ClassVar = tuple(
        CheckValue({"eps": eps}, value, digit / 2, "Brenner 1961, table of 400 terms, all printed digits")
        for eps, value, digit in (
            (0.4, 3.73562, 1e-5), (0.3, 4.61072, 1e-5), (0.2, 6.34089, 1e-5), (0.1, 11.4592, 1e-4),
            (0.05, 21.5858, 1e-4), (0.025, 41.7176, 1e-4), (0.01, 101.896, 1e-3),
        )
    )  # fmt: skip

    def _value(self, eps: np.ndarray) -> np.ndarray:
        near, middle, far = np.minimum(eps, LOW), np.clip(eps, LOW, HIGH), np.maximum(eps, HIGH)
        log = np.log(near)
        return np.select(
            [eps < LOW, eps > HIGH],
            [1 / near - log / 5 + _C0 + near * (_C1 - log / 21), _far(far)[0]],
            1 + chebyshev.chebval(_position(middle), _interpolants()[0]) / middle,
        )

    def _derivative(self, eps: np.ndarray) -> np.ndarray:
        near, middle, far = np.minimum(eps, LOW), np.clip(eps, LOW, HIGH), np.maximum(eps, HIGH)
        return np.select(
            [eps < LOW, eps > HIGH],
            [-1 / near**2 - 1 / (5 * near) - (np.log(near) + 1) / 21 + _C1, _far(far)[1]],
            -chebyshev.chebval(_position(middle), _interpolants()[1]) / middle**2,
        )
