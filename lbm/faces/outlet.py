"""Open faces: a density is set on them, the flow is carried outwards.

In the map of :mod:`lbm.fluid.lattice` an outlet is a wall at rest. Then, by non-equilibrium extrapolation (Guo,
Zheng & Shi, Chinese Phys. 11 (2002) 366), density rho_w on the face takes

    ``f_k = f_k^eq((2 rho_w + rho)/3, u) + f_k - f_k^eq(rho, u)``

with everything on the right that of the next cell inside: density linear through rho_w on the face, velocity and
viscous stress carried outwards.
"""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from lbm import arguments
from lbm.faces.records import FACES, Outlet
from lbm.faces.returning import Side, face_cell, returns
from lbm.fluid.cache import kernel
from lbm.fluid.equilibrium import equilibrium
from lbm.fluid.fields import half
from lbm.fluid.lattice import Lattice, incoming
from lbm.fluid.stencil import C, Q


class OutletPass:
    """Sets the density at an open face."""

    def __init__(self, face: Outlet, side: Side, outlets: tuple[bool, ...]):
        name = f"face {FACES[side.number]}: density"
        self._side, self._outlets, self._density = side, outlets, arguments.number(name, face.density)
        arguments.density(name, np.array(self._density))

    def prepare(self, lattice: Lattice, step: int) -> None:
        """Nothing depends on time."""

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        """Set what comes back."""
        grid, parity = lattice.grid, lattice.parity
        _open(lattice.populations, grid, parity, self._side, self._outlets, self._density, half(force))


@njit
def _inside(i, n, outlet_low, outlet_high):
    """Coordinate of the next cell whose populations have all arrived: away from every outlet."""
    if i == 0 and outlet_low:
        return 1
    if i == n - 1 and outlet_high:
        return n - 2
    return i


@kernel
def _open(populations, grid, parity, side, outlets, density, half_force):
    lines = grid.ny if side.axis == 0 else grid.nx
    length = grid.ny if side.axis == 2 else grid.nz
    for line in prange(lines):
        inner = np.empty(Q)
        for n in range(length):
            x, y, z = face_cell(grid, side, np.int64(line), n)
            x2 = _inside(x, grid.nx, outlets[0], outlets[1])
            y2 = _inside(y, grid.ny, outlets[2], outlets[3])
            z2 = _inside(z, grid.nz, outlets[4], outlets[5])
            drho, jx, jy, jz = 0.0, half_force[0], half_force[1], half_force[2]
            for k in range(Q):
                inner[k] = populations[incoming(grid, parity, k, x2, y2, z2)]
                drho += inner[k]
                jx += C[k, 0] * inner[k]
                jy += C[k, 1] * inner[k]
                jz += C[k, 2] * inner[k]
            rho = 1 + drho
            ux, uy, uz = jx / rho, jy / rho, jz / rho
            drho_here = (2 * (density - 1) + drho) / 3
            for k in range(1, Q):
                if returns(grid, k, side, x, y, z):
                    stress = inner[k] - equilibrium(k, drho, ux, uy, uz)
                    here = equilibrium(k, drho_here, ux, uy, uz)
                    populations[incoming(grid, parity, k, x, y, z)] = here + stress
