"""Cells that a moving sphere uncovers get populations: equilibrium of the surface, non-equilibrium of the fluid.

    f_k = f_k^eq(rho, u_w) + (f_k - f_k^eq)(next cell along the outward normal)

with rho of that cell too, after the extrapolation of Guo, Zheng & Shi, Phys. Fluids 14 (2002) 2007. Where that
cell is no fluid, the mean over the fluid neighbours takes its place.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from lbm.fluid.cache import kernel
from lbm.fluid.equilibrium import equilibrium
from lbm.fluid.lattice import incoming
from lbm.fluid.stencil import C, Q
from lbm.spheres.surface import inside, inside_any, surface_velocity, wrapped


@kernel(parallel=False)
def refill(populations, grid, parity, before, surfaces, s):
    """Fill the cells that sphere ``s`` covered with the centres ``before`` and no sphere covers now.

    Returns the mass that the fluid gains: the deviations from rest of these cells, less those of the cells that
    the sphere has covered.
    """
    radius, centre = surfaces.radii[s], surfaces.centres[s]
    around = radius + 0.5
    gain = 0.0
    for plane in range(math.floor(before[s, 2] - around), math.ceil(before[s, 2] + around) + 1):
        z = wrapped(plane, grid.nz, grid.z_low)
        if z < 0:
            continue
        for row in range(math.floor(before[s, 1] - around), math.ceil(before[s, 1] + around) + 1):
            y = wrapped(row, grid.ny, grid.y_low)
            if y < 0:
                continue
            for cell in range(math.floor(before[s, 0] - around), math.ceil(before[s, 0] + around) + 1):
                x = wrapped(cell, grid.nx, grid.x_low)
                if x < 0:
                    continue
                dx, dy, dz = cell + 0.5 - before[s, 0], row + 0.5 - before[s, 1], plane + 0.5 - before[s, 2]
                was = inside(dx, dy, dz, radius)
                if was == inside(cell + 0.5 - centre[0], row + 0.5 - centre[1], plane + 0.5 - centre[2], radius):
                    continue
                if not was:
                    if not inside_any(grid, x, y, z, before, surfaces.radii):
                        gain -= _deviation(populations, grid, parity, x, y, z)
                elif not inside_any(grid, x, y, z, surfaces.centres, surfaces.radii):
                    u = surface_velocity(surfaces, s, dx, dy, dz)
                    _fill(populations, grid, parity, (cell, row, plane), (dx, dy, dz), u, before, surfaces)
                    gain += _deviation(populations, grid, parity, x, y, z)
    return gain


@njit
def _deviation(populations, grid, parity, x, y, z):
    """Density less that at rest of a cell, of the populations that come in."""
    drho = 0.0
    for k in range(Q):
        drho += populations[incoming(grid, parity, k, x, y, z)]
    return drho


@njit
def _fill(populations, grid, parity, place, normal, u, before, surfaces):
    cell, row, plane = place
    x = wrapped(cell, grid.nx, grid.x_low)
    y = wrapped(row, grid.ny, grid.y_low)
    z = wrapped(plane, grid.nz, grid.z_low)
    best, best_along = 0, -2.0
    neighbours = 0
    for k in range(1, Q):
        if not _was_fluid(grid, cell + C[k, 0], row + C[k, 1], plane + C[k, 2], before, surfaces):
            continue
        neighbours += 1
        along = (C[k, 0] * normal[0] + C[k, 1] * normal[1] + C[k, 2] * normal[2]) / math.sqrt(
            C[k, 0] ** 2 + C[k, 1] ** 2 + C[k, 2] ** 2
        )
        if along > best_along:
            best, best_along = k, along
    if neighbours == 0:
        for k in range(Q):
            populations[incoming(grid, parity, k, x, y, z)] = equilibrium(k, 0.0, u[0], u[1], u[2])
        return
    i = wrapped(cell + C[best, 0], grid.nx, grid.x_low)
    j = wrapped(row + C[best, 1], grid.ny, grid.y_low)
    l = wrapped(plane + C[best, 2], grid.nz, grid.z_low)  # noqa: E741
    drho = jx = jy = jz = 0.0
    for k in range(Q):
        f = np.float64(populations[incoming(grid, parity, k, i, j, l)])
        drho += f
        jx += C[k, 0] * f
        jy += C[k, 1] * f
        jz += C[k, 2] * f
    rho = 1 + drho
    for k in range(Q):
        f = np.float64(populations[incoming(grid, parity, k, i, j, l)])
        beyond = f - equilibrium(k, drho, jx / rho, jy / rho, jz / rho)
        populations[incoming(grid, parity, k, x, y, z)] = equilibrium(k, drho, u[0], u[1], u[2]) + beyond


@njit
def _was_fluid(grid, cell, row, plane, before, surfaces):
    x = wrapped(cell, grid.nx, grid.x_low)
    y = wrapped(row, grid.ny, grid.y_low)
    z = wrapped(plane, grid.nz, grid.z_low)
    if x < 0 or y < 0 or z < 0:
        return False
    radii = surfaces.radii
    return not (inside_any(grid, x, y, z, before, radii) or inside_any(grid, x, y, z, surfaces.centres, radii))
