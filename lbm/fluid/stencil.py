"""The D3Q19 stencil as data.

Populations are ordered as the one at rest, then pairs of opposite velocities, so that population ``k`` and
its opposite are neighbours and sums and differences of a pair are read off directly.

Source: Qian, d'Humieres & Lallemand, Europhys. Lett. 17 (1992) 479; weights 1/3, 1/18, 1/36.
"""

from __future__ import annotations

import numpy as np

__all__ = ["CS2", "OPPOSITE", "C", "Q", "W", "mirrored"]

Q = 19
CS2 = 1.0 / 3.0
"""Square of the speed of sound in lattice units."""

_FORWARD = [
    (1, 0, 0), (0, 1, 0), (0, 0, 1),
    (1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1),
]  # fmt: skip

C = np.array([(0, 0, 0)] + [tuple(s * c for c in v) for v in _FORWARD for s in (1, -1)], dtype=np.int64)
"""Velocities, shape (19, 3), columns x, y, z."""

W = np.array([{0: 1 / 3, 1: 1 / 18, 2: 1 / 36}[int(np.sum(c * c))] for c in C])
"""Weights, shape (19,)."""

OPPOSITE = np.array([0] + [k + 1 if k % 2 else k - 1 for k in range(1, Q)], dtype=np.int64)
"""``C[OPPOSITE[k]] == -C[k]``."""


def mirrored(axis: int) -> np.ndarray:
    """Index of the velocity with the component along ``axis`` reversed, for each velocity."""
    flipped = C.copy()
    flipped[:, axis] *= -1
    return np.array([int(np.flatnonzero((c == C).all(axis=1))[0]) for c in flipped], dtype=np.int64)
