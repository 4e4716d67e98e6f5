"""Spheres whose centre lies on a free-slip face: the face is a plane of symmetry of sphere and flow.

The box then holds half of such a sphere, or a quarter where two faces meet in its centre; the rest is the mirror
image, which needs no cells. What is summed over the surface within the box is a half or a quarter of the whole;
of vectors only the components that a mirror leaves as they are can differ from zero: with n the normal of the
face, of a force those along the face, of a torque and a spin that along n.
"""

from __future__ import annotations

import numpy as np

from lbm.errors import InputError
from lbm.faces.records import AXES
from lbm.fluid.lattice import SLIP, Grid

Mirrors = tuple[bool, bool, bool]
"""For each axis whether a free-slip face normal to it goes through the centre of a sphere."""


def mirrored_axes(grid: Grid, centre: np.ndarray) -> Mirrors:
    """The :data:`Mirrors` of a sphere with this ``centre``."""
    x, y, z = (
        (low == SLIP and c == 0) or (high == SLIP and c == n)
        for low, high, n, c in zip(grid.faces[::2], grid.faces[1::2], grid.shape, centre.tolist(), strict=True)
    )
    return x, y, z


def parts(mirrors: Mirrors) -> int:
    """How many times the part within the box the whole is."""
    return 2 ** sum(mirrors)


def of_whole(mirrors: Mirrors, force: np.ndarray, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force and torque on the whole sphere from those on its surface within the box."""
    if not any(mirrors):
        return force, torque
    n = parts(mirrors)
    return np.where(mirrors, 0.0, n * force), np.where(_reverses_spin(mirrors), 0.0, n * torque)


def refuse_asymmetric(mirrors: Mirrors, name: str, vector: np.ndarray) -> None:
    """Raise :class:`InputError` for a velocity or force ``vector`` that leads out of a plane of symmetry."""
    _refuse(mirrors, name, vector, "lead out of")


def refuse_asymmetric_spin(mirrors: Mirrors, name: str, spin: np.ndarray) -> None:
    """Likewise for a spin that turns the sphere out of it."""
    _refuse(_reverses_spin(mirrors), name, spin, "turn it out of")


def _refuse(zero: Mirrors, name: str, vector: np.ndarray, what: str) -> None:
    axis = next((axis for axis in range(3) if zero[axis] and vector[axis] != 0), None)
    if axis is not None:
        raise InputError(
            f"{name}: component {AXES[axis]} = {vector[axis]:g} would {what} a plane of symmetry, the "
            "free-slip face through the centre of the sphere: take the whole box"
        )


def _reverses_spin(mirrors: Mirrors) -> Mirrors:
    """A mirror reverses the components of a spin that lie in its plane."""
    x, y, z = mirrors
    return y or z, x or z, x or y
