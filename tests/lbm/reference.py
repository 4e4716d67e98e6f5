"""The method written plainly and densely in NumPy, independent of the compiled kernels."""

from __future__ import annotations

import numpy as np

from lbm.fluid.moments import NORMS, M, equilibrium
from lbm.fluid.stencil import OPPOSITE, C, Q, W, mirrored


def collide(f: np.ndarray, rates, force: np.ndarray) -> np.ndarray:
    """m* = m - S (m - m_eq) + (I - S/2) M F for populations (19, ...), deviations from rest."""
    shape = (3,) + (1,) * (f.ndim - 1)
    force = np.asarray(force, dtype=float).reshape(shape)
    c = C.astype(float)
    rho = 1 + f.sum(axis=0)
    u = (np.tensordot(c.T, f, axes=1) + force / 2) / rho
    weights = W.reshape((Q,) + (1,) * (f.ndim - 1))
    cu, cf = np.tensordot(c, u, axes=1), np.tensordot(c, force + 0 * u, axes=1)
    guo = weights * (3 * (cf - np.sum(u * force, axis=0)) + 9 * cu * cf)
    s = rates.diagonal().reshape((Q,) + (1,) * (f.ndim - 1))
    m, m_eq, m_force = (np.tensordot(M, a, axes=1) for a in (f, equilibrium(rho, u), guo))
    after = m - s * (m - m_eq) + (1 - s / 2) * m_force
    return np.tensordot(M.T / NORMS, after, axes=1)


def stream(f: np.ndarray, kinds: tuple[str, str, str]) -> np.ndarray:
    """Move populations (19, nx, ny, nz) by one step; each axis "periodic", "free-slip" or "no-slip"."""
    n = f.shape[1:]
    index = np.indices(n)
    moved = np.empty_like(f)
    for k in range(Q):
        came_from = [index[a] - C[k, a] for a in range(3)]
        crossed = [(came_from[a] < 0) | (came_from[a] >= n[a]) for a in range(3)]
        number = np.full(n, k)
        bounced = np.zeros(n, dtype=bool)
        for a in range(3):
            if kinds[a] == "periodic":
                came_from[a] = came_from[a] % n[a]
            elif kinds[a] == "free-slip":
                number = np.where(crossed[a], mirrored(a)[number], number)
                came_from[a] = np.where(crossed[a], index[a], came_from[a])
            else:
                bounced |= crossed[a]
        source = [np.where(bounced, index[a], came_from[a]) for a in range(3)]
        number = np.where(bounced, OPPOSITE[k], number)
        moved[k] = f[number, source[0], source[1], source[2]]
    return moved
