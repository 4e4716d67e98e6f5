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


def mirrored_axes(grid: Grid, centre: np.ndarray) -> np.ndarray:
    """For each axis whether a free-slip face normal to it goes through ``centre``, booleans (3,)."""
    low, high = (np.array(grid.faces[side::2]) == SLIP for side in (0, 1))
    return (low & (centre == 0)) | (high & (centre == grid.shape))


def parts(mirrors: np.ndarray) -> int:
    """How many times the part within the box the whole is."""
    return 2 ** int(np.count_nonzero(mirrors))


def of_whole(mirrors: np.ndarray, force: np.ndarray, torque: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force and torque on the whole sphere from those on its surface within the box."""
    n = parts(mirrors)
    return np.where(mirrors, 0.0, n * force), np.where(_reverses_spin(mirrors), 0.0, n * torque)


def refuse_asymmetric(mirrors: np.ndarray, name: str, vector: np.ndarray) -> None:
    """Raise :class:`InputError` for a velocity or force ``vector`` that leads out of a plane of symmetry."""
    _refuse(mirrors, name, vector, "lead out of")


def refuse_asymmetric_spin(mirrors: np.ndarray, name: str, spin: np.ndarray) -> None:
    """Likewise for a spin that turns the sphere out of it."""
    _refuse(_reverses_spin(mirrors), name, spin, "turn it out of")


def _refuse(zero: np.ndarray, name: str, vector: np.ndarray, what: str) -> None:
    if np.any(vector[zero]):
        axis = int(np.flatnonzero(zero & (vector != 0))[0])
        raise InputError(
            f"{name}: component {AXES[axis]} = {vector[axis]:g} would {what} a plane of symmetry, the "
            "free-slip face through the centre of the sphere: take the whole box"
        )


def _reverses_spin(mirrors: np.ndarray) -> np.ndarray:
    """A mirror reverses the components of a spin that lie in its plane."""
    return np.array([np.any(np.delete(mirrors, axis)) for axis in range(3)])
