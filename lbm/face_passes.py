"""What moving walls, inlets and outlets do to the populations that come back from them, after every step.

In the map of :mod:`lbm.lattice` all three are walls at rest. Then

* velocity u at the wall (Ladd, J. Fluid Mech. 271 (1994) 285): ``f_k += 6 w_k c_k . (rho u + <rho> (u_k - u))``
  with rho and u at the adjacent cell, u_k where the link crosses the face, for a diagonal link half-way between
  two cells, and <rho> the mean over the face. Second order also where u varies along the face; the first part
  conserves mass cell by cell, the second over the face, as between two cells one link brings what the other
  takes;
* density rho_w (non-equilibrium extrapolation, Guo, Zheng & Shi, Chinese Phys. 11 (2002) 366):
  ``f_k = f_k^eq((2 rho_w + rho)/3, u) + f_k - f_k^eq(rho, u)`` with everything on the right that of the next
  cell inside: density linear through rho_w on the face, velocity and viscous stress carried outwards.

A link through an edge of the box belongs to the no-slip walls before the inlet before the outlet, and among
inlets and among outlets to x before y before z. Where two no-slip walls meet, both push: each slides along the
other, so that neither lets mass through.
"""

from __future__ import annotations

import warnings

import numpy as np
from numba import njit, prange

from lbm import arguments
from lbm.cache import kernel
from lbm.equilibrium import equilibrium
from lbm.errors import InputError, OutsideRangeWarning
from lbm.faces import FACES, Face, FreeSlip, Inlet, NoSlip, Outlet, Periodic
from lbm.fields import sent_density
from lbm.lattice import BOUNCE, Lattice, incoming
from lbm.stencil import C, Q, W

_RANK = {NoSlip: 2, Inlet: 1, Outlet: 0}


def passes(faces: tuple[Face, ...], grid) -> list[WallPass | OutletPass]:
    """The corrections that ``faces`` need after every step, in their order."""
    found = []
    outlets = tuple(isinstance(face, Outlet) for face in faces)
    # Outlets last: they look at populations that walls and inlets have completed.
    for number in sorted(range(6), key=lambda n: -_RANK.get(type(faces[n]), 0)):
        face = faces[number]
        if face.kind != BOUNCE:
            continue
        beaten_by = tuple(
            other.kind == BOUNCE
            and not isinstance(face, NoSlip)
            and (_RANK[type(other)], -(n // 2)) > (_RANK[type(face)], -(number // 2))
            for n, other in enumerate(faces)
        )
        side = number // 2, number % 2 == 1, beaten_by
        if isinstance(face, Outlet):
            found.append(OutletPass(face, side, outlets))
        else:
            wall = WallPass(face, side, faces, grid)
            if wall.moves:
                found.append(wall)
    _warn_of_filling(faces, found)
    return found


def _warn_of_filling(faces: tuple[Face, ...], found: list) -> None:
    """Without an outlet, what the inlets bring must balance; functions of time are taken on trust."""
    inlets = [p for p in found if isinstance(p, WallPass) and p.is_inlet]
    if any(isinstance(face, Outlet) for face in faces) or any(p.varies for p in inlets):
        return
    inflow = sum(p.inflow() for p in inlets)
    if abs(inflow) > 1e-9 * sum(p.area for p in inlets):
        warnings.warn(
            f"inlets bring a net volume of {inflow:.4g} per step and no face is an outlet: "
            "the mean density will drift; make one face an Outlet() or balance the inlets",
            OutsideRangeWarning,
            stacklevel=4,
        )


class WallPass:
    """Adds the momentum of a moving wall or an inlet."""

    def __init__(self, face: NoSlip | Inlet, side: tuple, faces: tuple[Face, ...], grid):
        self._side = side
        self._given = face.velocity
        self._name = f"face {FACES[2 * side[0] + side[1]]}: velocity"
        along = [axis for axis in range(3) if axis != side[0]]
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
        normal = velocity[..., self._side[0]]
        if not self.is_inlet and np.any(normal):
            raise InputError(
                f"{self._name}: a no-slip wall moves in its plane only, but its velocity has the normal "
                f"component {normal.flat[np.argmax(np.abs(normal))]:g}; use Inlet to let fluid through"
            )
        arguments.speed(self._name, velocity, -1)
        self._velocity[...] = velocity
        for way in range(2):
            _extend(np.moveaxis(self._padded, way, 0), self._joined[way], self._closed[way])

    def inflow(self) -> float:
        """Volume that comes in per step."""
        return float(self._velocity[..., self._side[0]].sum()) * (-1 if self._side[1] else 1)

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
        axis, high, _ = self._side
        _sent_density(lattice.populations, lattice.grid, lattice.parity, axis, high, self._density)
        mean = self._density.mean()
        _push(
            lattice.populations, lattice.grid, lattice.parity, *self._side, self._padded, self._density, mean
        )  # fmt: skip


def _extend(velocity: np.ndarray, joined: bool, closed: bool) -> None:
    """Fill the first and last layer of ``velocity``, beyond two opposite edges of the face.

    The mean with the layer next to it is then the velocity at the edge: that between the two cells where the
    edges are ``joined``, else extrapolated linearly. Between two ``closed`` edges a wall must take out at one
    what it brings in at the other: both get the mean.
    """
    if joined:
        velocity[0], velocity[-1] = velocity[-2], velocity[1]
        return
    low, high = 1.5 * velocity[1] - 0.5 * velocity[2], 1.5 * velocity[-2] - 0.5 * velocity[-3]
    if closed:
        low = high = (low + high) / 2
    velocity[0], velocity[-1] = 2 * low - velocity[1], 2 * high - velocity[-2]


class OutletPass:
    """Sets the density at an open face."""

    def __init__(self, face: Outlet, side: tuple, outlets: tuple[bool, ...]):
        name = f"face {FACES[2 * side[0] + side[1]]}: density"
        self._side, self._outlets, self._density = side, outlets, arguments.number(name, face.density)
        arguments.density(name, np.array(self._density))

    def prepare(self, lattice: Lattice, step: int) -> None:
        """Nothing depends on time."""

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        """Set what comes back."""
        half_force = np.zeros(3) if force is None else np.array(force, dtype=float) / 2
        _open(
            lattice.populations,
            lattice.grid,
            lattice.parity,
            *self._side,
            self._outlets,
            self._density,
            half_force,
        )


@njit
def _cell(grid, axis, high, line, n):
    """Cell number (line, n) of a face, the two counted along the other axes in the order x, y, z."""
    if axis == 0:
        return (grid.nx - 1 if high else 0), line, n
    if axis == 1:
        return line, (grid.ny - 1 if high else 0), n
    return line, n, (grid.nz - 1 if high else 0)


@njit
def _returns(grid, k, axis, high, beaten_by, x, y, z):
    """Whether population k comes back to the cell from this face, and not from one that goes before it."""
    if C[k, axis] != (-1 if high else 1):
        return False
    if (x == 0 and C[k, 0] == 1 and beaten_by[0]) or (x == grid.nx - 1 and C[k, 0] == -1 and beaten_by[1]):
        return False
    if (y == 0 and C[k, 1] == 1 and beaten_by[2]) or (y == grid.ny - 1 and C[k, 1] == -1 and beaten_by[3]):
        return False
    return not (
        (z == 0 and C[k, 2] == 1 and beaten_by[4]) or (z == grid.nz - 1 and C[k, 2] == -1 and beaten_by[5])
    )


@kernel
def _sent_density(populations, grid, parity, axis, high, density):
    for line in prange(density.shape[0]):
        for n in range(density.shape[1]):
            x, y, z = _cell(grid, axis, high, np.int64(line), n)
            density[line, n] = sent_density(populations, grid, parity, x, y, z)


@kernel
def _push(populations, grid, parity, axis, high, beaten_by, velocity, density, mean):
    # ``velocity`` reaches one cell beyond the face on every side
    ahead = 1 if axis == 0 else 0
    sideways = 1 if axis == 2 else 2
    for line in prange(density.shape[0]):
        for n in range(density.shape[1]):
            x, y, z = _cell(grid, axis, high, np.int64(line), n)
            u, rho = velocity[line + 1, n + 1], density[line, n]
            for k in range(1, Q):
                if _returns(grid, k, axis, high, beaten_by, x, y, z):
                    beside = velocity[line + 1 - C[k, ahead], n + 1 - C[k, sideways]]
                    cu = C[k, 0] * u[0] + C[k, 1] * u[1] + C[k, 2] * u[2]
                    cu_beside = C[k, 0] * beside[0] + C[k, 1] * beside[1] + C[k, 2] * beside[2]
                    add = 6 * W[k] * (rho * cu + mean * 0.5 * (cu_beside - cu))
                    populations[incoming(grid, parity, k, x, y, z)] += add


@njit
def _inside(i, n, outlet_low, outlet_high):
    """Coordinate of the next cell whose populations have all arrived: away from every outlet."""
    if i == 0 and outlet_low:
        return 1
    if i == n - 1 and outlet_high:
        return n - 2
    return i


@kernel
def _open(populations, grid, parity, axis, high, beaten_by, outlets, density, half_force):
    lines = grid.ny if axis == 0 else grid.nx
    length = grid.ny if axis == 2 else grid.nz
    for line in prange(lines):
        inner = np.empty(Q)
        for n in range(length):
            x, y, z = _cell(grid, axis, high, np.int64(line), n)
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
                if _returns(grid, k, axis, high, beaten_by, x, y, z):
                    stress = inner[k] - equilibrium(k, drho, ux, uy, uz)
                    here = equilibrium(k, drho_here, ux, uy, uz)
                    populations[incoming(grid, parity, k, x, y, z)] = here + stress
