"""What happens at the six faces of the box.

Periodic, free-slip and still no-slip faces cost nothing: they are in the map of :mod:`lbm.lattice`. A moving
wall, an inlet and an outlet are walls there too, and correct after every step the populations they send back:

* velocity u at the wall (Ladd, J. Fluid Mech. 271 (1994) 285): ``f_k += 6 w_k rho c_k . u`` with the density
  rho of the adjacent cell;
* density rho_w (non-equilibrium extrapolation, Guo, Zheng & Shi, Chinese Phys. 11 (2002) 366):
  ``f_k = f_k^eq((2 rho_w + rho)/3, u) + f_k - f_k^eq(rho, u)`` with everything on the right that of the next
  cell inside: density linear through rho_w on the face, velocity and viscous stress carried outwards.

All walls lie half a cell outside the outermost cell centres. A link through an edge of the box belongs to
the no-slip walls before the inlet before the outlet, and among inlets and among outlets to x before y before
z. Where two no-slip walls meet, both push: each slides along the other, so that neither lets mass through.
"""

from __future__ import annotations

import numbers
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numba import njit, prange

from lbm.cache import kernel
from lbm.errors import InputError, OutsideRangeWarning
from lbm.lattice import BOUNCE, PERIODIC, SLIP, Lattice, incoming, outgoing
from lbm.stencil import C, Q, W

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
    """A wall, moving in its plane with ``velocity``: a vector, an array (n, m, 3) over the face, or a function
    of time that gives either.

    Time and velocity are in lattice units; the function is called half-way between two steps. n and m run
    along the other two axes in the order x, y, z.
    """

    velocity: Velocity = (0.0, 0.0, 0.0)
    kind = BOUNCE


@dataclass(frozen=True)
class Inlet:
    """Fluid enters with ``velocity``, given as for :class:`NoSlip`, but in any direction.

    Sound is reflected fully, here and at an outlet: start the fluid with the velocity it is to have.
    """

    velocity: Velocity
    kind = BOUNCE


@dataclass(frozen=True)
class Outlet:
    """Open face at ``density`` (pressure c_s^2 density); fluid may leave or enter.

    The flow is taken as developed there: no change of velocity along the normal.
    """

    density: float = 1.0
    kind = BOUNCE


Face = Periodic | FreeSlip | NoSlip | Inlet | Outlet
BY_NAME: dict[str, type] = {"periodic": Periodic, "free-slip": FreeSlip, "no-slip": NoSlip, "outlet": Outlet}
_RANK = {NoSlip: 2, Inlet: 1, Outlet: 0}


def resolve(faces: dict[str, Face | str] | None) -> tuple[Face, ...]:
    """The six faces in the order of :data:`FACES`, from a mapping of face or axis names; default periodic."""
    if faces is not None and not isinstance(faces, Mapping):
        raise InputError(f"faces = {faces!r}: give a mapping such as {{'z': 'no-slip'}}")
    chosen: dict[str, Face] = dict.fromkeys(FACES, Periodic())
    for name, value in (faces or {}).items():
        if name not in FACES and name not in tuple(AXES):
            raise InputError(f"face {name!r}: unknown; use one of {', '.join(FACES)}, or x, y, z for both faces")
        if name in FACES and name[0] in faces:
            raise InputError(f"face {name}: given twice, by {name!r} and by {name[0]!r}; keep one of them")
        for face in [name] if name in FACES else [name + "-", name + "+"]:
            chosen[face] = _record(name, value)
    for axis in AXES:
        pair = chosen[axis + "-"], chosen[axis + "+"]
        if sum(isinstance(f, Periodic) for f in pair) == 1:
            raise InputError(f"faces {axis}- and {axis}+: periodic on one side only; choose it for both")
    return tuple(chosen[name] for name in FACES)


def _record(name: str, value: Face | str) -> Face:
    if isinstance(value, str) and value in BY_NAME:
        return BY_NAME[value]()
    if isinstance(value, Face):
        return value
    hint = f"; write {value.__name__}(...)" if isinstance(value, type) else ""
    raise InputError(
        f"face {name}: boundary {value!r} unknown{hint}; use one of {', '.join(BY_NAME)}, or a record of lbm.faces"
    )


def passes(faces: tuple[Face, ...], grid) -> list[Callable[[Lattice, int, object], None]]:
    """The corrections that ``faces`` need after every step: callables of (lattice, step, force)."""
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
            found.append(_OutletPass(face, side, outlets))
        else:
            wall = _WallPass(face, side, grid)
            if wall.moves:
                found.append(wall)
    _warn_of_filling(faces, found)
    return found


def _warn_of_filling(faces: tuple[Face, ...], found: list) -> None:
    """Without an outlet, what the inlets bring must balance; functions of time are taken on trust."""
    inlets = [p for p in found if isinstance(p, _WallPass) and p.is_inlet]
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


class _WallPass:
    """Adds the momentum of a moving wall or an inlet."""

    def __init__(self, face: NoSlip | Inlet, side: tuple, grid):
        self._side = side
        self._given = face.velocity
        self._name = FACES[2 * side[0] + side[1]]
        self._shape = (*(n for axis, n in enumerate(grid.shape) if axis != side[0]), 3)
        self._velocity = np.empty(self._shape)
        self.is_inlet = isinstance(face, Inlet)
        self.varies = callable(self._given)
        self.area = self._shape[0] * self._shape[1]
        self._set(self._given(0.5) if self.varies else self._given)
        self.moves = self.varies or bool(np.any(self._velocity))

    def _set(self, given) -> None:
        needed = f"give 3 components or an array {self._shape}"
        try:
            velocity = np.asarray(given, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"face {self._name}: velocity {given!r} is not made of numbers; {needed}") from None
        if velocity.shape not in ((3,), self._shape):
            raise InputError(f"face {self._name}: velocity of shape {velocity.shape}; {needed}")
        if not np.isfinite(velocity).all():
            raise InputError(f"face {self._name}: velocity is not finite")
        normal = velocity[..., self._side[0]]
        if not self.is_inlet and np.any(normal):
            raise InputError(
                f"face {self._name}: a no-slip wall moves in its plane only, but its velocity has the normal "
                f"component {normal.flat[np.argmax(np.abs(normal))]:g}; use Inlet to let fluid through"
            )
        self._velocity[...] = velocity

    def inflow(self) -> float:
        """Volume that comes in per step."""
        return float(self._velocity[..., self._side[0]].sum()) * (-1 if self._side[1] else 1)

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        if callable(self._given):
            self._set(self._given(step + 0.5))
        _push(lattice.populations, lattice.grid, lattice.parity, *self._side, self._velocity)


class _OutletPass:
    """Sets the density at an open face."""

    def __init__(self, face: Outlet, side: tuple, outlets: tuple[bool, ...]):
        density = face.density
        if not (isinstance(density, numbers.Real) and np.isfinite(density) and density > 0):
            raise InputError(
                f"face {FACES[2 * side[0] + side[1]]}: density {density!r} must be a positive finite number"
            )
        self._side, self._outlets, self._density = side, outlets, float(density)

    def __call__(self, lattice: Lattice, step: int, force) -> None:
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
def _push(populations, grid, parity, axis, high, beaten_by, velocity):
    for line in prange(velocity.shape[0]):
        for n in range(velocity.shape[1]):
            x, y, z = _cell(grid, axis, high, np.int64(line), n)
            rho = 1.0
            for k in range(Q):
                rho += populations[outgoing(grid, parity, k, x, y, z)]
            u = velocity[line, n]
            for k in range(1, Q):
                if _returns(grid, k, axis, high, beaten_by, x, y, z):
                    add = 6 * W[k] * rho * (C[k, 0] * u[0] + C[k, 1] * u[1] + C[k, 2] * u[2])
                    populations[incoming(grid, parity, k, x, y, z)] += add


@njit
def _equilibrium(k, rho, ux, uy, uz):
    """Equilibrium population k, as deviation from its weight."""
    cu = C[k, 0] * ux + C[k, 1] * uy + C[k, 2] * uz
    uu = ux * ux + uy * uy + uz * uz
    return W[k] * (rho - 1 + rho * (3 * cu + 4.5 * cu * cu - 1.5 * uu))


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
            rho, jx, jy, jz = 1.0, half_force[0], half_force[1], half_force[2]
            for k in range(Q):
                inner[k] = populations[incoming(grid, parity, k, x2, y2, z2)]
                rho += inner[k]
                jx += C[k, 0] * inner[k]
                jy += C[k, 1] * inner[k]
                jz += C[k, 2] * inner[k]
            ux, uy, uz = jx / rho, jy / rho, jz / rho
            rho_here = (2 * density + rho) / 3
            for k in range(1, Q):
                if _returns(grid, k, axis, high, beaten_by, x, y, z):
                    stress = inner[k] - _equilibrium(k, rho, ux, uy, uz)
                    here = _equilibrium(k, rho_here, ux, uy, uz)
                    populations[incoming(grid, parity, k, x, y, z)] = here + stress
