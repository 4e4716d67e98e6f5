"""Solid bodies inside the box: a sparse list of links that cross their surface, corrected after every step.

Linear interpolation (Bouzidi, Firdaouss & Lallemand, Phys. Fluids 13 (2001) 3452), second order for curved
and inclined surfaces. With q the fraction of the link from the fluid cell x along c_k to the surface, k' the
opposite of k, u_w the velocity of the surface, rho the density at x, f* populations as sent by the last step::

    f_k'(x) = 2q f*_k(x) + (1 - 2q) f*_k(x - c_k) + 6 w_k rho c_k'.u_w        q < 1/2
    f_k'(x) = (f*_k(x) + (2q - 1) f*_k'(x) + 6 w_k rho c_k'.u_w) / (2q)       q >= 1/2

The bulk kernel runs over the solid cells as well; what it computes there never reaches the fluid.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from lbm.cache import kernel
from lbm.errors import InputError
from lbm.lattice import Lattice, incoming, outgoing
from lbm.stencil import OPPOSITE, C, Q, W


class FixedBody:
    """A body at rest or with a given velocity of its surface; append it to ``Simulation.passes``.

    Parameters: ``solid`` boolean (nx, ny, nz), true where a cell centre lies inside; ``fraction`` of shape
    (19, nx, ny, nz), the fraction q in (0, 1] of each link that starts in a fluid cell and ends in a solid
    one (other values are not looked at), or None for half-way; ``velocity`` of the surface, 3 components.
    Links are followed through the faces of the box as through periodic ones: keep a body two cells away from
    other faces.
    """

    def __init__(self, solid: np.ndarray, fraction: np.ndarray | None = None, velocity=(0.0, 0.0, 0.0)):
        solid = np.asarray(solid, dtype=bool)
        if solid.ndim != 3 or solid.all():
            raise InputError(
                f"solid: shape {solid.shape} with {solid.sum()} solid cells; give 3 axes and some fluid"
            )
        cells, directions, q = [], [], []
        for k in range(1, Q):
            ends_inside = ~solid & np.roll(solid, -C[k], axis=(0, 1, 2))
            found = np.argwhere(ends_inside)
            cells.append(found)
            directions.append(np.full(len(found), k))
            if fraction is None:
                q.append(np.full(len(found), 0.5))
                continue
            along = np.asarray(fraction, dtype=float)[k][ends_inside]
            if not ((along > 0) & (along <= 1)).all():
                raise InputError(f"fraction: outside (0, 1] on a link along {tuple(C[k])}")
            # Without a fluid cell behind to interpolate from, the surface is taken half-way.
            behind_is_solid = np.roll(solid, C[k], axis=(0, 1, 2))[ends_inside]
            q.append(np.where((along < 0.5) & behind_is_solid, 0.5, along))
        self.shape = solid.shape
        self.links = np.column_stack([np.concatenate(cells), np.concatenate(directions)]).astype(np.int64)
        self.fraction = np.concatenate(q)
        u = np.asarray(velocity, dtype=float)
        if u.shape != (3,) or not np.isfinite(u).all():
            raise InputError(f"body: velocity {velocity!r}; give 3 finite components")
        self.push = -6 * W[self.links[:, 3]] * (C[self.links[:, 3]] @ u)

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        """Correct the populations that come back from the surface."""
        if lattice.grid.shape != self.shape:
            raise InputError(f"body on a grid of {self.shape} in a simulation of {lattice.grid.shape} cells")
        _bounce(lattice.populations, lattice.grid, lattice.parity, self.links, self.fraction, self.push)


@kernel
def _bounce(populations, grid, parity, links, fraction, push):
    for link in prange(links.shape[0]):
        x, y, z, k = links[link]
        back = OPPOSITE[k]
        q = fraction[link]
        sent = populations[outgoing(grid, parity, k, x, y, z)]
        add = push[link]
        if add != 0:
            rho = 1.0
            for i in range(Q):
                rho += populations[outgoing(grid, parity, i, x, y, z)]
            add *= rho
        if q < 0.5:
            value = 2 * q * sent + (1 - 2 * q) * populations[incoming(grid, parity, k, x, y, z)] + add
        else:
            sent_back = populations[outgoing(grid, parity, back, x, y, z)]
            value = (sent + (2 * q - 1) * sent_back + add) / (2 * q)
        populations[incoming(grid, parity, back, x, y, z)] = value
