"""The six faces of the box: which boundary each one is.

Periodic, free-slip and still no-slip faces cost nothing: they are in the map of :mod:`lbm.fluid.lattice`. What
moving walls, inlets and outlets do after every step stands in :mod:`lbm.faces.passes`. All faces lie half
a cell outside the outermost cell centres.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from lbm.arguments import shown
from lbm.errors import InputError
from lbm.fluid.lattice import BOUNCE, PERIODIC, SLIP

__all__ = ["AXES", "BY_NAME", "FACES", "Face", "FreeSlip", "Inlet", "NoSlip", "Outlet", "Periodic", "resolve"]

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
    """A wall, at rest or moving in its plane.

    Parameters
    ----------
    velocity : (3,), an array (n, m, 3) over the face, or a function of time that gives either; cells a step.

    Notes
    -----
    Time and velocity are in lattice units; the function is called half-way between two steps, before the
    second, and a function that fails then leaves the first one's flow. n and m run along the other two axes in
    the order x, y, z; the array holds the velocity above the centres of the cells.
    Walls conserve mass in a closed box, also where the velocity varies along them.
    """

    velocity: Velocity = (0.0, 0.0, 0.0)
    kind = BOUNCE

    @property
    def moves(self) -> bool:
        """Whether the wall may move: its velocity is a function, or not zero."""
        return callable(self.velocity) or bool(np.any(np.asarray(self.velocity) != 0))


@dataclass(frozen=True)
class Inlet:
    """Fluid enters with a given velocity.

    Parameters
    ----------
    velocity : as for :class:`NoSlip`, but in any direction.

    Notes
    -----
    Sound is reflected fully, here and at an outlet: start the fluid with the velocity it is to have.

    Beside a no-slip wall the links through the common edge have the wall's velocity. A profile that vanishes
    there is second order (of a parabola on n cells about the part 1 - 1/(2n^2) flows in); of a uniform one,
    which jumps at the walls, n cells between two still walls let the part 1 - 1/(3n) through.
    """

    velocity: Velocity
    kind = BOUNCE


@dataclass(frozen=True)
class Outlet:
    """Open face at a given density; fluid may leave or enter.

    Parameters
    ----------
    density : over the rest density; the pressure is c_s^2 times it.

    Notes
    -----
    The flow is taken as developed there: no change of velocity along the normal.
    """

    density: float = 1.0
    kind = BOUNCE


Face = Periodic | FreeSlip | NoSlip | Inlet | Outlet
BY_NAME: dict[str, type] = {"periodic": Periodic, "free-slip": FreeSlip, "no-slip": NoSlip, "outlet": Outlet}


def resolve(faces: dict[str, Face | str] | None) -> tuple[Face, ...]:
    """The six faces in the order of :data:`FACES`, from a mapping of face or axis names; default periodic."""
    if faces is not None and not isinstance(faces, Mapping):
        raise InputError(f"faces = {shown(faces)}: give a mapping such as {{'z': 'no-slip'}}")
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
        f"face {name}: boundary {shown(value)} unknown{hint}; use one of {', '.join(BY_NAME)}, "
        "or a record of lbm.faces"
    )
