"""Walls that move and inlets: momentum added to what comes back from a face.

In the map of :mod:`lbm.fluid.lattice` both are walls at rest. Then, with the velocity u at the wall (Ladd, J.
Fluid Mech. 271 (1994) 285),

    ``f_k += 6 w_k c_k . (rho u + <rho> (u_k - u))``

with rho and u at the adjacent cell, u_k where the link crosses the face, for a diagonal link half-way between two
cells, and <rho> the mean over the face. Second order also where u varies along the face; the first part conserves
mass cell by cell, the second over the face, as between two cells one link brings what the other takes.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from lbm import arguments
from lbm.errors import InputError
from lbm.faces.records import FACES, Face, FreeSlip, Inlet, NoSlip, Periodic
from lbm.faces.returning import Side, face_cell, returns
from lbm.fluid.cache import kernel
from lbm.fluid.fields import sent_density
from lbm.fluid.lattice import Lattice, incoming
from lbm.fluid.stencil import C, Q, W


class WallPass:
    """Adds the momentum of a moving wall or an inlet."""

    def __init__(self, face: NoSlip | Inlet, side: Side, faces: tuple[Face, ...], grid):
        self._side = side
        self._given = face.velocity
        self._name = f"face {FACES[side.number]}: velocity"
        self._along = along = [axis for axis in range(3) if axis != side.axis]
        pairs = [faces[2 * axis : 2 * axis + 2] for axis in along]
        self._joined = [isinstance(pair[0], Periodic) for pair in pairs]
        walled = NoSlip | FreeSlip
        self._closed = [all(isinstance(other, walled) for other in (face, *pair)) for pair in pairs]
        self._shape = (*(grid.shape[axis] for axis in along), 3)
        self._padded = np.zeros((self._shape[0] + 2, self._shape[1] + 2, 3))
        self._velocity = self._padded[1:-1, 1:-1]
        self._density = np.empty(self._shape[:2])
        self.is_inlet = isinstance(face, Inlet)
        self.varies = callable(self._given)
        self.area = self._shape[0] * self._shape[1]
        self._set(self._given(0.5) if self.varies else self._given)
        self.moves = self.varies or bool(np.any(self._velocity))

    def _set(self, given) -> None:
        velocity = arguments.array(self._name, given)
        if velocity.shape not in ((3,), self._shape):
            raise InputError(
                f"{self._name} of shape {velocity.shape}; give 3 components or an array {self._shape}"
            )
        normal = velocity[..., self._side.axis]
        if not self.is_inlet and np.any(normal):
            raise InputError(
                f"{self._name}: a no-slip wall moves in its plane only, but its velocity has the normal "
                f"component {normal.flat[np.argmax(np.abs(normal))]:g}; use Inlet to let fluid through"
            )
        arguments.speed(self._name, velocity, -1)
        self._velocity[...] = velocity
        for way in range(2):
            _extend(np.moveaxis(self._padded, way, 0), self._along[way], self._joined[way], self._closed[way])

    def inflow(self) -> float:
        """Volume that comes in per step."""
        return float(self._velocity[..., self._side.axis].sum()) * (-1 if self._side.high else 1)

    def prepare(self, lattice: Lattice, step: int) -> None:
        """Take the velocity in the middle of step number ``step``."""
        if self.varies:
            when = step + 0.5
            try:
                self._set(self._given(when))
            except InputError as error:
                raise InputError(f"{error} (at time {when:g})") from None

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        """Push what comes back."""
        populations, grid, parity = lattice.populations, lattice.grid, lattice.parity
        _sent_density(populations, grid, parity, self._side, self._density)
        mean = self._density.mean()
        _push(populations, grid, parity, self._side, self._padded, self._density, mean)


def _extend(velocity: np.ndarray, across: int, joined: bool, closed: bool) -> None:
    """Fill the first and last layer of ``velocity``, beyond two edges of the face that are normal to ``across``.

    The mean with the layer next to it is then the velocity at the edge: that between the two cells where the
    edges are ``joined``, else extrapolated linearly. Between two ``closed`` edges a wall must take out at one
    what it brings in at the other: both get the mean, and nothing of what would cross the walls there. A lid that
    pushed through them would make a cavity of Re 1000 converge at first order (benchmarks/README.md).
    """
    if joined:
        velocity[0], velocity[-1] = velocity[-2], velocity[1]
        return
    low, high = 1.5 * velocity[1] - 0.5 * velocity[2], 1.5 * velocity[-2] - 0.5 * velocity[-3]
    if closed:
        low = high = (low + high) / 2
        low[..., across] = 0
    velocity[0], velocity[-1] = 2 * low - velocity[1], 2 * high - velocity[-2]


@kernel
def _sent_density(populations, grid, parity, side, density):
    for line in prange(density.shape[0]):
        for n in range(density.shape[1]):
            x, y, z = face_cell(grid, side, np.int64(line), n)
            density[line, n] = sent_density(populations, grid, parity, x, y, z)


@kernel
def _push(populations, grid, parity, side, velocity, density, mean):
    # ``velocity`` reaches one cell beyond the face on every side
    ahead = 1 if side.axis == 0 else 0
    sideways = 1 if side.axis == 2 else 2
    for line in prange(density.shape[0]):
        for n in range(density.shape[1]):
            x, y, z = face_cell(grid, side, np.int64(line), n)
            u, rho = velocity[line + 1, n + 1], density[line, n]
            for k in range(1, Q):
                if returns(grid, k, side, x, y, z):
                    beside = velocity[line + 1 - C[k, ahead], n + 1 - C[k, sideways]]
                    cu = C[k, 0] * u[0] + C[k, 1] * u[1] + C[k, 2] * u[2]
                    cu_beside = C[k, 0] * beside[0] + C[k, 1] * beside[1] + C[k, 2] * beside[2]
                    add = 6 * W[k] * (rho * cu + mean * 0.5 * (cu_beside - cu))
                    populations[incoming(grid, parity, k, x, y, z)] += add
