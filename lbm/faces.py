"""What happens at the six faces of the box.

Periodic, free-slip and still no-slip faces cost nothing: they are in the map of :mod:`lbm.lattice`. A moving
wall, an inlet and an outlet are walls there too, and correct after every step the populations they send back:

* velocity u at the wall (Ladd, J. Fluid Mech. 271 (1994) 285): ``f_k += 6 w_k c_k . u``;
* density rho_w (anti-bounce-back, Ginzburg, Verhaeghe & d'Humieres, Commun. Comput. Phys. 3 (2008) 427):
  ``f_k = -f_k' + 2 w_k rho_w (1 + 9/2 (c_k . u)^2 - 3/2 u . u)`` with u of the adjacent cell.

All walls lie half a cell outside the outermost cell centres. A link through an edge of the box belongs to
the no-slip wall before the inlet before the outlet, and among equals to x before y before z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit, prange

from lbm.cache import kernel
from lbm.errors import InputError
from lbm.lattice import BOUNCE, PERIODIC, SLIP, Lattice, incoming, outgoing
from lbm.stencil import OPPOSITE, C, Q, W

Velocity = tuple[float, float, float] | np.ndarray | Callable[[float], tuple[float, float, float]]
AXES = "xyz"
FACES = ("x-", "x+", "y-", "y+", "z-", "z+")


@dataclass(frozen=True)
class Periodic:
    """Opposite faces are joined; choose it for both."""

    kind = PERIODIC


@dataclass(frozen=True)
class FreeSlip:
    """No flow through the face and no shear on it: a plane of symmetry."""

    kind = SLIP


@dataclass(frozen=True)
class NoSlip:
    """A wall, moving with ``velocity``: a vector, an array (n, m, 3) over the face, or a function of time.

    Time and velocity are in lattice units; the function is called half-way between two steps. n and m run
    along the other two axes in the order x, y, z.
    """

    velocity: Velocity = (0.0, 0.0, 0.0)
    kind = BOUNCE


@dataclass(frozen=True)
class Inlet:
    """Fluid enters with ``velocity``, given as for :class:`NoSlip`."""

    velocity: Velocity
    kind = BOUNCE


@dataclass(frozen=True)
class Outlet:
    """Open face at ``density`` (pressure c_s^2 density); fluid may leave or enter."""

    density: float = 1.0
    kind = BOUNCE


Face = Periodic | FreeSlip | NoSlip | Inlet | Outlet
BY_NAME: dict[str, type] = {"periodic": Periodic, "free-slip": FreeSlip, "no-slip": NoSlip, "outlet": Outlet}
_RANK = {NoSlip: 2, Inlet: 1, Outlet: 0}


def resolve(faces: dict[str, Face | str] | None) -> tuple[Face, ...]:
    """The six faces in the order of :data:`FACES`, from a mapping of face or axis names; default periodic."""
    chosen: dict[str, Face] = dict.fromkeys(FACES, Periodic())
    for name, value in (faces or {}).items():
        if name not in FACES and name not in AXES:
            raise InputError(f"face {name!r}: unknown; use one of {', '.join(FACES)}, or x, y, z for both faces")
        if isinstance(value, str):
            if value not in BY_NAME:
                raise InputError(f"face {name}: boundary {value!r} unknown; use one of {', '.join(BY_NAME)}")
            value = BY_NAME[value]()
        for face in [name] if name in FACES else [name + "-", name + "+"]:
            chosen[face] = value
    for axis in AXES:
        pair = chosen[axis + "-"], chosen[axis + "+"]
        if sum(isinstance(f, Periodic) for f in pair) == 1:
            raise InputError(f"faces {axis}- and {axis}+: periodic on one side only; choose it for both")
    return tuple(chosen[name] for name in FACES)


def passes(faces: tuple[Face, ...], grid) -> list[Callable[[Lattice, int, object], None]]:
    """The corrections that ``faces`` need after every step: callables of (lattice, step, force)."""
    found = []
    for number, face in enumerate(faces):
        still = isinstance(face, NoSlip) and not callable(face.velocity) and not np.any(face.velocity)
        if face.kind != BOUNCE or still:
            continue
        beaten_by = tuple(
            other.kind == BOUNCE and (_RANK[type(other)], -(n // 2)) > (_RANK[type(face)], -(number // 2))
            for n, other in enumerate(faces)
        )
        side = number // 2, number % 2 == 1, beaten_by
        found.append(_OutletPass(face, side) if isinstance(face, Outlet) else _WallPass(face, side, grid))
    return found


class _WallPass:
    """Adds the momentum of a moving wall or an inlet."""

    def __init__(self, face: NoSlip | Inlet, side: tuple, grid):
        self._side = side
        self._given = face.velocity
        self._shape = (*(n for axis, n in enumerate(grid.shape) if axis != side[0]), 3)
        self._velocity = np.empty(self._shape)
        if not callable(self._given):
            self._set(self._given)

    def _set(self, velocity) -> None:
        name = FACES[2 * self._side[0] + self._side[1]]
        try:
            self._velocity[...] = velocity
        except ValueError:
            raise InputError(
                f"face {name}: velocity of shape {np.shape(velocity)}; give 3 components or an array {self._shape}"
            ) from None
        if not np.isfinite(self._velocity).all():
            raise InputError(f"face {name}: velocity is not finite")

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        if callable(self._given):
            self._set(self._given(step + 0.5))
        _push(lattice.populations, lattice.grid, lattice.parity, *self._side, self._velocity)


class _OutletPass:
    """Sets the density at an open face."""

    def __init__(self, face: Outlet, side: tuple):
        if not (np.isfinite(face.density) and face.density > 0):
            raise InputError(f"face {FACES[2 * side[0] + side[1]]}: density {face.density:g} must be positive")
        self._side, self._density = side, float(face.density)

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        half_force = np.zeros(3) if force is None else np.array(force, dtype=float) / 2
        _open(lattice.populations, lattice.grid, lattice.parity, *self._side, self._density, half_force)


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
def _push(populations, grid, parity, axis, high, beaten_by, velocity):
    for line in prange(velocity.shape[0]):
        for n in range(velocity.shape[1]):
            x, y, z = _cell(grid, axis, high, np.int64(line), n)
            for k in range(1, Q):
                if _returns(grid, k, axis, high, beaten_by, x, y, z):
                    u = velocity[line, n]
                    add = 6 * W[k] * (C[k, 0] * u[0] + C[k, 1] * u[1] + C[k, 2] * u[2])
                    populations[incoming(grid, parity, k, x, y, z)] += add


@kernel
def _open(populations, grid, parity, axis, high, beaten_by, density, half_force):
    lines = grid.ny if axis == 0 else grid.nx
    length = grid.ny if axis == 2 else grid.nz
    for line in prange(lines):
        for n in range(length):
            x, y, z = _cell(grid, axis, high, np.int64(line), n)
            rho, jx, jy, jz = 1.0, -half_force[0], -half_force[1], -half_force[2]
            for k in range(Q):
                f = populations[outgoing(grid, parity, k, x, y, z)]
                rho += f
                jx += C[k, 0] * f
                jy += C[k, 1] * f
                jz += C[k, 2] * f
            ux, uy, uz = jx / rho, jy / rho, jz / rho
            uu = ux * ux + uy * uy + uz * uz
            for k in range(1, Q):
                if _returns(grid, k, axis, high, beaten_by, x, y, z):
                    cu = C[k, 0] * ux + C[k, 1] * uy + C[k, 2] * uz
                    even = W[k] * (density - 1 + density * (4.5 * cu * cu - 1.5 * uu))
                    sent = populations[outgoing(grid, parity, OPPOSITE[k], x, y, z)]
                    populations[incoming(grid, parity, k, x, y, z)] = 2 * even - sent
