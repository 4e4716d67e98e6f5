"""The orthogonal moments of D3Q19, generated from their polynomials.

Source: d'Humieres, Ginzburg, Krafczyk, Lallemand & Luo, Phil. Trans. R. Soc. A 360 (2002) 437, section 2.
The compiled collision (:mod:`lbm.fluid.collision`) is this transformation unrolled; here it is plain and dense.
"""

from __future__ import annotations

import numpy as np

from lbm.fluid.stencil import C, Q, W

_x, _y, _z = C.T.astype(float)
_c2 = _x**2 + _y**2 + _z**2

POLYNOMIALS = {
    "rho": np.ones(Q),
    "e": 19 * _c2 - 30,
    "eps": (21 * _c2**2 - 53 * _c2 + 24) / 2,
    "j_x": _x,
    "q_x": (5 * _c2 - 9) * _x,
    "j_y": _y,
    "q_y": (5 * _c2 - 9) * _y,
    "j_z": _z,
    "q_z": (5 * _c2 - 9) * _z,
    "p_xx": 3 * _x**2 - _c2,
    "pi_xx": (3 * _c2 - 5) * (3 * _x**2 - _c2),
    "p_ww": _y**2 - _z**2,
    "pi_ww": (3 * _c2 - 5) * (_y**2 - _z**2),
    "p_xy": _x * _y,
    "p_yz": _y * _z,
    "p_xz": _x * _z,
    "m_x": (_y**2 - _z**2) * _x,
    "m_y": (_z**2 - _x**2) * _y,
    "m_z": (_x**2 - _y**2) * _z,
}
"""Value of each moment's polynomial at the 19 velocities."""

NAMES = tuple(POLYNOMIALS)
M = np.array(list(POLYNOMIALS.values()))
"""Rows: moments; columns: populations. ``M @ f`` are the moments of f."""

NORMS = np.sum(M * M, axis=1)
"""Squared norms of the rows: ``M.T @ (m / NORMS)`` are the populations of moments m."""


def equilibrium(rho: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Second-order equilibrium populations, as deviations from ``W``.

    ``f_k - w_k`` with ``f_k = w_k rho (1 + 3 c.u + 9/2 (c.u)^2 - 3/2 u.u)``; ``rho`` of shape S, ``u`` of
    shape (3, *S); returns shape (19, *S).
    """
    rho, u = np.asarray(rho, dtype=float), np.asarray(u, dtype=float)
    cu = np.tensordot(C.astype(float), u, axes=1)
    shape = (Q,) + (1,) * rho.ndim
    return W.reshape(shape) * ((rho - 1) + rho * (3 * cu + 4.5 * cu**2 - 1.5 * np.sum(u * u, axis=0)))


def guo_force(u: np.ndarray, force: np.ndarray) -> np.ndarray:
    """``w_k (3 (c - u) + 9 (c.u) c) . F``, shape (19,), for one cell (Guo, Zheng & Shi 2002, Eq. 20)."""
    c = C.astype(float)
    return W * (3 * (c @ force - u @ force) + 9 * (c @ u) * (c @ force))
