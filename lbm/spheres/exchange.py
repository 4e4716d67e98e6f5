"""Momentum exchange of spheres and fluid: the links through the surface are found cell by cell and reflected.

Force, torque and the mass that the fluid gains are the sums over the links of what
:func:`lbm.bodies.reflection.exchange_link` gives.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

from lbm.bodies.reflection import Link, exchange_link
from lbm.fluid.cache import kernel
from lbm.fluid.fields import sent_density
from lbm.fluid.lattice import outgoing
from lbm.fluid.stencil import C, Q, W
from lbm.spheres.surface import REACH, cut, image, inside, inside_any, surface_velocity, wrapped


@kernel
def exchange(populations, grid, parity, scheme, surfaces, s, sums):
    """Reflect all links of sphere ``s``; its ``sums`` (planes, 7) get force, torque and mass plane by plane.

    Sums over planes are added in their order by the caller, so they do not depend on the number of threads.
    """
    first = np.int64(math.floor(surfaces.centres[s, 2] - surfaces.radii[s] - REACH - 0.5))
    for plane in prange(sums.shape[0]):
        for i in range(7):
            sums[plane, i] = 0.0
        _exchange_plane(populations, grid, parity, scheme, surfaces, s, first + np.int64(plane), sums[plane])


@njit(error_model="numpy", fastmath={"contract"})
def _exchange_plane(populations, grid, parity, scheme, surfaces, s, plane, sums):
    centres, radii = surfaces.centres, surfaces.radii
    radius, reach = radii[s], radii[s] + REACH
    cx, cy, cz = centres[s, 0], centres[s, 1], centres[s, 2]
    z = wrapped(plane, grid.nz, grid.z_low)
    dz = plane + 0.5 - cz
    if z < 0 or abs(dz) > reach:
        return
    half_y = math.sqrt(reach * reach - dz * dz)
    for row in range(math.floor(cy - half_y - 0.5), math.ceil(cy + half_y - 0.5) + 1):
        y = wrapped(row, grid.ny, grid.y_low)
        dy = row + 0.5 - cy
        left = reach * reach - dz * dz - dy * dy
        if y < 0 or left < 0:
            continue
        half_x = math.sqrt(left)
        for cell in range(math.floor(cx - half_x - 0.5), math.ceil(cx + half_x - 0.5) + 1):
            x = wrapped(cell, grid.nx, grid.x_low)
            dx = cell + 0.5 - cx
            if x < 0 or inside(dx, dy, dz, radius) or inside_any(grid, x, y, z, centres, radii):
                continue
            rho = 0.0
            for k in range(1, Q):
                if not inside(dx + C[k, 0], dy + C[k, 1], dz + C[k, 2], radius):
                    continue
                if (
                    image(cell + C[k, 0], grid.nx, grid.x_low, grid.x_high) < 0
                    or image(row + C[k, 1], grid.ny, grid.y_low, grid.y_high) < 0
                    or image(plane + C[k, 2], grid.nz, grid.z_low, grid.z_high) < 0
                ):
                    continue  # the wall lies in between
                if rho == 0.0:
                    rho = sent_density(populations, grid, parity, x, y, z)
                q = cut(dx, dy, dz, k, radius)
                rx, ry, rz = dx + q * C[k, 0], dy + q * C[k, 1], dz + q * C[k, 2]
                u = surface_velocity(surfaces, s, rx, ry, rz)
                behind = _solid_behind(grid, cell, row, plane, k, centres, radii)
                link = Link(x, y, z, k, q)
                back = W[k] * surfaces.payback[s]
                fx, fy, fz, gain = exchange_link(populations, grid, parity, scheme, link, u, rho, behind, back)
                # What was sent into the sphere goes no further: its cells are swept too, and stay at rest.
                populations[outgoing(grid, parity, k, x, y, z)] = 0.0
                sums[0] += fx
                sums[1] += fy
                sums[2] += fz
                sums[3] += ry * fz - rz * fy
                sums[4] += rz * fx - rx * fz
                sums[5] += rx * fy - ry * fx
                sums[6] += gain


@njit
def _solid_behind(grid, x, y, z, k, centres, radii):
    """Whether the cell behind (x, y, z), against c_k, lies inside a sphere."""
    i = image(x - C[k, 0], grid.nx, grid.x_low, grid.x_high)
    j = image(y - C[k, 1], grid.ny, grid.y_low, grid.y_high)
    l = image(z - C[k, 2], grid.nz, grid.z_low, grid.z_high)  # noqa: E741
    return i >= 0 and j >= 0 and l >= 0 and inside_any(grid, i, j, l, centres, radii)
