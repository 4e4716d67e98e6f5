"""What no record of a sphere above a wall has: a way into the wall, holes at contacts, copies of pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restitution.doubts.doubt import Doubt
from restitution.tracks import DETECTION, Contacts, Track, grid_step

if TYPE_CHECKING:
    from restitution.conditions import Conditions

INSIDE_D = 0.1
"""How far below zero, in diameters, a gap falls in no contact, the softest of simulations included."""
HOLE = 10.0
"""Typical times between frames without a frame from which on more than a contact may be missing."""
COPIES = 1.8
"""Mean number of frames with the very same position from which on pictures are there more than once."""
_LEAST = 8
"""Pictures that tell it."""
_LIQUID, _THINNEST_LIQUID = 500.0, 4e-5
"""Above this density in kg/m3 no fluid has less viscosity, in Pa s; dense carbon dioxide has somewhat more."""
_THINNEST = 2e-6
"""Viscosity in Pa s below that of any fluid that spheres are dropped in: liquid helium has 3e-6, gases 1e-5."""


def of_record(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """Doubts that need no motion to be understood."""
    return [*_thin(conditions), *_copies(track), *_holes(track, found), *_inside(track, found, conditions)]


def _inside(track: Track, found: Contacts, conditions: Conditions) -> list[Doubt]:
    """Gaps far below zero; where the sphere comes to rest they are counted from there."""
    if track.quantity != "gap":
        return []
    d, lowest = conditions.sphere.diameter, float(np.min(track.value)) - (found.level or 0.0)
    if lowest > -max(INSIDE_D * d, DETECTION * track.sigma):
        return []
    message = (
        f"the gap falls to {lowest:.2g} m, {lowest / d:.2g} d, below the wall: the wall is lower than it is said "
        "to be (--wall X, or --wall rest where the sphere comes to rest), or this is not the lowest point"
    )
    return [Doubt("wall", message)]


def _holes(track: Track, found: Contacts) -> list[Doubt]:
    """Contacts about which there are no frames for so long that a flight may be missing."""
    step = np.diff(track.time_s)
    if not len(step):
        return []
    doubts = []
    for contact in found.contacts:
        if not (len(contact.approach) and len(contact.rebound)):
            continue
        about = slice(max(contact.approach[-1] - 1, 0), contact.rebound[0] + 1)
        k = about.start + int(np.argmax(step[about]))
        if step[k] > HOLE * np.median(step):
            message = (
                f"no frame between t = {track.time_s[k]:.6g} and {track.time_s[k + 1]:.6g} s, about a contact: "
                "the sphere may have flown there unseen, and speeds are carried far: was it lost?"
            )
            doubts.append(Doubt("hole", message))
    return doubts


def _copies(track: Track) -> list[Doubt]:
    """Neighbouring frames with the same position that lies on no grid of pixels: copies of one picture."""
    value = track.value
    value = value[value != value[-1]]  # without a rest that is written exactly
    runs = 1 + np.count_nonzero(np.diff(value))
    times = len(value) / runs
    if runs < _LEAST or times < COPIES or grid_step(value) > 0:
        return []
    message = (
        f"each position is there {times:.2g} times, as where a film is shown at more frames a second than it was "
        "taken at: keep one of each, at --fps of the camera"
    )
    return [Doubt("copies", message)]


def _thin(conditions: Conditions) -> list[Doubt]:
    """Viscosities that no fluid of this density has."""
    fluid = conditions.fluid
    if fluid.viscosity >= (_THINNEST if fluid.density < _LIQUID else _THINNEST_LIQUID):
        return []
    than = "any gas" if fluid.viscosity < _THINNEST else f"any liquid of {fluid.density:g} kg/m3"
    message = (
        f"the viscosity, {fluid.viscosity:g} Pa s, is below that of {than}: is it kinematic (write its unit, as "
        'in "10 cSt"), or in another unit?'
    )
    return [Doubt("viscosity", message)]
