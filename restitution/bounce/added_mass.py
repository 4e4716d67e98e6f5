r"""Added mass of a sphere moving normal to a plane wall: exact potential flow.

The dipole at the centre of the sphere has an endless row of images in wall and sphere. At height
r + h = r cosh(alpha) of the centre the n-th of those inside the sphere has the strength
[sinh(alpha)/sinh((n + 1) alpha)]^3 of the first (Lamb, Hydrodynamics, art. 98, 99 and 138 for the method), and

    C_M(h) = 1/2 + (3/2) sum_{n>=1} [sinh(alpha)/sinh((n + 1) alpha)]^3,

which is 1/2 far from the wall, 1/2 [1 + (3/8) (r/(r + h))^3] to leading order, and (3/2) zeta(3) - 1 = 0.80309
at contact. Its slope diverges there as ln(h), an integrable force.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CONTACT = 0.8030853547393914
"""(3/2) zeta(3) - 1."""
_TERMS = 400


def added_mass(eps: NDArray | float) -> NDArray:
    """C_M at eps = h/r >= 0, relative error below 1e-9; the force of the added mass is C_M m_f dv/dt + ..."""
    return _sums(eps)[0]


def added_mass_slope(eps: NDArray | float) -> NDArray:
    """dC_M/d eps at eps > 0."""
    return _sums(eps)[1]


def _sums(eps: NDArray | float) -> tuple[NDArray, NDArray]:
    eps = np.asarray(eps, float)
    alpha = 2 * np.arcsinh(np.sqrt(eps / 2))[..., None]  # arccosh(1 + eps) without its cancellation
    n = np.arange(1.0, _TERMS + 1)
    value, slope = _terms(alpha, n)
    total, total_slope = value.sum(-1), slope.sum(-1)
    # The terms beyond, as an integral with the end correction of Euler and Maclaurin, by Gauss-Laguerre in
    # u = 3 alpha (n - N) where they decay exponentially and by their own power law where they do not.
    N = _TERMS + 1.0
    y, weight = _PANELS
    tail_value, tail_slope = _terms(alpha, N * y)
    total += (tail_value * weight * N).sum(-1)
    total_slope += (tail_slope * weight * N).sum(-1)
    first, first_slope = _terms(alpha, np.array([N]))
    step = 1e-3
    total += first[..., 0] / 2 - (_terms(alpha, np.array([N + step]))[0] - first)[..., 0] / step / 12
    total_slope += first_slope[..., 0] / 2
    return 0.5 + 1.5 * total, 1.5 * total_slope


def _panels() -> tuple[NDArray, NDArray]:
    """Nodes y >= 1 and weights of an integral over [1, inf) of what decays at least as y^-2: y = 1/s."""
    s, w = np.polynomial.legendre.leggauss(64)
    s, w = (s + 1) / 2, w / 2
    return 1 / s, w / s**2


_PANELS = _panels()


def _terms(alpha: NDArray, n: NDArray) -> tuple[NDArray, NDArray]:
    """[sinh(alpha)/sinh((n+1) alpha)]^3 and its derivative in eps = cosh(alpha) - 1."""
    k = n + 1
    small = np.maximum(alpha, 1e-12)
    decay = np.exp(-n * small)
    ratio = decay * np.expm1(-2 * small) / np.expm1(-2 * k * small)
    # d ratio^3/d alpha = 3 ratio^3 (coth(alpha) - k coth(k alpha)); both terms diverge as 1/alpha, series there
    x = k * small
    slope = 3 * ratio**3 * (_coth_less(small) - k * _coth_less(x)) / np.sinh(small)
    return ratio**3, slope


def _coth_less(x: NDArray) -> NDArray:
    """coth(x) - 1/x without cancellation: k coth(k a) - coth(a) = k (coth - 1/x)(k a) - (coth - 1/x)(a)."""
    near = np.minimum(x, 0.5)
    series = near / 3 - near**3 / 45 + 2 * near**5 / 945 - near**7 / 4725 + 2 * near**9 / 93555
    far = np.maximum(x, 0.5)
    return np.where(x < 0.5, series, 1 / np.tanh(far) - 1 / far)
