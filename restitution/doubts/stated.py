"""What conditions say of themselves and of the size of a record, before any motion is looked at."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restitution.doubts.doubt import Doubt
from restitution.stokes import H_FILM

if TYPE_CHECKING:
    from restitution.conditions import Conditions
    from restitution.tracks import Track

DENSE, THIN = 500.0, 5e-5
"""Density in kg/m3 of what is a liquid, and viscosity in Pa s below which no such liquid is: carbon dioxide at
20 C has 7e-5 at 770 kg/m3, pentane 2e-4, water 1e-3. Kinematic viscosities, in m2/s, are mostly below."""
THINNEST = 2e-6
"""Viscosity in Pa s below that of any fluid that spheres are dropped in: liquid helium has 3e-6, gases 1e-5."""
_STEPS = ((1000.0, "in mm"), (100.0, "in cm"))


def of_fluid(conditions: Conditions) -> list[Doubt]:
    """A kinematic viscosity stated as the dynamic one."""
    fluid = conditions.fluid
    if fluid.viscosity >= (THIN if fluid.density > DENSE else THINNEST):
        return []
    nu = fluid.viscosity * 1e6
    return [
        Doubt(
            "viscosity",
            f"no fluid of {fluid.density:g} kg/m3 has a viscosity of {fluid.viscosity:g} Pa s: is it the "
            f'kinematic one, in m2/s? viscosity = "{nu:g} cSt"',
        )
    ]


def of_size(track: Track, level: float, conditions: Conditions) -> list[Doubt]:
    """A sphere so large that the whole record lies within its film."""
    d = conditions.sphere.diameter
    highest = float(np.max(track.value)) - level
    if track.quantity != "gap" or not 0 < highest < H_FILM * d:
        return []
    likely = [words for factor, words in _STEPS if H_FILM * d / factor < highest]
    unit = f", {likely[0]}" if likely else ""
    return [
        Doubt(
            "size",
            f"the sphere, {d:g} m in diameter, is never farther than {highest:.2g} m, {highest / d:.1g} d, from "
            f"the wall, within its film: is the diameter in another unit{unit} ("
            f'write it, as in diameter = "{d:g} mm"), or the unit of length of the track (--unit)?',
        )
    ]
