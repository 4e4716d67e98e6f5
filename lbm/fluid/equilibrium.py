"""The second-order equilibrium of one population, as the kernels outside the collision take it."""

from __future__ import annotations

from lbm.fluid.cache import inlined
from lbm.fluid.stencil import C, W


@inlined
def equilibrium(k, drho, ux, uy, uz):
    """``w_k (drho + rho (3 c.u + 9/2 (c.u)^2 - 3/2 u.u))``, the deviation from rest, with rho = 1 + ``drho``."""
    cu = 3 * (C[k, 0] * ux + C[k, 1] * uy + C[k, 2] * uz)
    return W[k] * (drho + (1 + drho) * (cu + 0.5 * cu * cu - 1.5 * (ux * ux + uy * uy + uz * uz)))
