"""The surfaces of spheres on the lattice: which cell centres lie inside, where a link is cut, how they move."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from lbm.fluid.cache import inlined
from lbm.fluid.lattice import PERIODIC, SLIP
from lbm.fluid.stencil import C

REACH = math.sqrt(2.0)
"""Length of the longest link: no fluid cell further than this from the surface has a link through it."""


class Surfaces(NamedTuple):
    """The spheres as the kernels see them: ``radii`` and :func:`~lbm.spheres.mass.payback` (n,), others (n, 3)."""

    centres: np.ndarray
    radii: np.ndarray
    velocities: np.ndarray
    spins: np.ndarray
    payback: np.ndarray


@inlined
def surface_velocity(surfaces, s, rx, ry, rz):
    """Velocity of sphere ``s`` at the offset (rx, ry, rz) from its centre: v + omega x r."""
    velocity, spin = surfaces.velocities[s], surfaces.spins[s]
    return (
        velocity[0] + spin[1] * rz - spin[2] * ry,
        velocity[1] + spin[2] * rx - spin[0] * rz,
        velocity[2] + spin[0] * ry - spin[1] * rx,
    )


@njit(forceinline=True)
def wrapped(i, n, low):
    """Index of cell ``i`` on an axis of ``n`` cells whose low face is of kind ``low``; -1 outside the box."""
    if 0 <= i < n:
        return i
    return i % n if low == PERIODIC else -1


@njit(forceinline=True)
def image(i, n, low, high):
    """Index of the cell that stands for cell ``i``, its mirror image beyond a free-slip face; -1 beyond others."""
    if i < 0 and low == SLIP:
        return -1 - i
    if i >= n and high == SLIP:
        return 2 * n - 1 - i
    return wrapped(i, n, low)


@njit(forceinline=True)
def offset(i, centre, n, low):
    """Distance from ``centre`` to the centre of cell ``i`` along one axis, to the nearest image if periodic."""
    d = i + 0.5 - centre
    return d - n * round(d / n) if low == PERIODIC else d


@njit(forceinline=True)
def inside(dx, dy, dz, radius):
    """Whether a point at the offset (dx, dy, dz) from the centre lies inside the sphere."""
    return dx * dx + dy * dy + dz * dz < radius * radius


@njit
def inside_any(grid, x, y, z, centres, radii):
    """Whether the centre of cell (x, y, z) lies inside one of the spheres."""
    for s in range(radii.shape[0]):
        dx = offset(x, centres[s, 0], grid.nx, grid.x_low)
        dy = offset(y, centres[s, 1], grid.ny, grid.y_low)
        dz = offset(z, centres[s, 2], grid.nz, grid.z_low)
        if inside(dx, dy, dz, radii[s]):
            return True
    return False


@njit(forceinline=True)
def cut(dx, dy, dz, k, radius):
    """Fraction q in [0, 1] at which the link along c_k, from (dx, dy, dz) outside to inside, meets the sphere.

    The smaller root of ``|d + q c_k| = radius``, written so that nothing cancels.
    """
    cx, cy, cz = C[k, 0], C[k, 1], C[k, 2]
    a = cx * cx + cy * cy + cz * cz
    b = -(dx * cx + dy * cy + dz * cz)
    c = dx * dx + dy * dy + dz * dz - radius * radius
    return max(0.0, c) / (b + math.sqrt(max(0.0, b * b - a * max(0.0, c))))
