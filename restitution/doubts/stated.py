"""What conditions say of themselves and of the size of a record, before any motion is looked at."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
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
HEAVY, THIN_AND_HEAVY = 900.0, 1.5e-4
"""The same of heavier liquids: liquid oxygen has 1.9e-4 at 1140 kg/m3, argon 2.6e-4, carbon disulphide 3.6e-4."""
THINNEST = 2e-6
"""Viscosity in Pa s below that of any fluid that spheres are dropped in: liquid helium has 3e-6, gases 1e-5."""
LARGEST = 0.2
"""Diameter in m of a sphere that no vessel of a laboratory is large enough for."""
LIGHT, HEAVIEST = 30.0, 23e3
"""Densities in kg/m3: a solid or a liquid below the first is taken to be in g/cm3; the second is osmium's."""
_GAS = 1e-4
"""Viscosity in Pa s above which no gas is."""
_STEPS = ((1000.0, "in mm"), (100.0, "in cm"))


def of_conditions(conditions: Iterable[Conditions | None], where: str = "") -> list[Doubt]:
    """Fluids and spheres by themselves, where no motion is known that they could be held against."""
    found = [
        doubt
        for c in dict.fromkeys(c for c in conditions if c is not None)
        for doubt in (*of_fluid(c), *of_densities(c), *of_diameter(c))
    ]
    return [replace(doubt, where=where) for doubt in dict.fromkeys(found)]


def of_diameter(conditions: Conditions) -> list[Doubt]:
    """A diameter without its unit."""
    d = conditions.sphere.diameter
    if d < LARGEST:
        return []
    message = (
        f"the sphere is {d:g} m in diameter, more than a laboratory drops: is it in mm or cm? With its unit: "
        f'diameter = "{d:g} mm"'
    )
    return [Doubt("size", message)]


def of_densities(conditions: Conditions) -> list[Doubt]:
    """Densities in g/cm3, which no solid and no liquid has in kg/m3."""
    fluid, sphere = conditions.fluid, conditions.sphere
    liquid = fluid.viscosity > _GAS
    unlikely = [
        f"{name}, {density:g} kg/m3"
        for name, density, wrong in (
            ("the fluid", fluid.density, fluid.density < LIGHT and liquid),
            ("the sphere", sphere.density, sphere.density < LIGHT or sphere.density > HEAVIEST),
        )
        if wrong
    ]
    if not unlikely:
        return []
    message = f"no such material has the density of {' and of '.join(unlikely)}: kg/m3 are meant, not g/cm3"
    return [Doubt("density", message)]


def of_fluid(conditions: Conditions) -> list[Doubt]:
    """A kinematic viscosity stated as the dynamic one, or less than any liquid has."""
    fluid = conditions.fluid
    if fluid.viscosity >= (THIN if fluid.density > DENSE else THINNEST):
        if fluid.density < HEAVY or fluid.viscosity >= THIN_AND_HEAVY:
            return []
        message = (
            f"no liquid of {fluid.density:g} kg/m3 has a viscosity as low as {fluid.viscosity:g} Pa s (water has "
            "0.001): is it a tenth of what is meant?"
        )
        return [Doubt("viscosity", message)]
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


_LIGHT, _THIN_FILM = 3.0, 0.15
"""Density over that of the fluid, and edge of the film in diameters, below which resolved runs rise higher."""


def of_light_rebound(conditions: Conditions, edge_d: float) -> list[Doubt]:
    """A point particle of a light sphere that leaves a thin film: resolved runs rise higher.

    First apexes of resolved runs over those of the point particle, e_eff imposed alike: at an edge of 0.1 d 1.05
    to 1.10 at a density ratio of 1.14 (Re 127 and 287, 16 and 20 cells a diameter), 1.03 and 1.04 at 2.5 (Re 190,
    10 cells), 1.00 at 8.2 (St 65, 8 cells); at 0.2 and 0.3 d 0.98 to 1.01 at 1.14. Speeds at the edge before the
    impact agree within 1.2 %. The likely cause, not shown: the history force of the point particle knows no wall.
    """
    ratio = conditions.sphere.density / conditions.fluid.density
    if not 1 < ratio < _LIGHT or edge_d > _THIN_FILM:
        return []
    return [
        Doubt(
            "light",
            f"a sphere {ratio:.3g} times as heavy as its fluid leaves a film of {edge_d:g} d: resolved runs rise "
            "5 to 10 % higher there at a density ratio of 1.14, 3 to 4 % at 2.5, none at 8.2; from 0.2 d on they "
            "agree within 2 %. Does the history force, which knows no wall here, brake it too much?",
        )
    ]
