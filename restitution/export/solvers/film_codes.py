"""Codes that resolve or model the film themselves: e_dry, a least gap by a film law, and the grid's reach.

An e_eff there would count the viscous loss twice. The least gap h_min is the one of a film law of this package
(`roughness`, `yang_hunt_2008`, `nijssen_2022`). That a grid loses the film below half a cell, and that a
difference 1/gap - 1/gap_c begun further out counts twice what the grid still resolves, was measured with the
lattice of this project (benchmarks/README.md), not with these codes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.export.closure import Closure
from restitution.export.heading import NOT_TRIED, comment_lines
from restitution.export.tables import pair_lines

_LOST_BELOW = 0.5
"""Cells: the gap below which the lattice of this project no longer resolves the film."""
_MEASURED = "measured with the lattice of this project, 10 to 20 cells a diameter, not with this code"


@dataclass(frozen=True)
class FilmRequest:
    """Cells a diameter; impact speed in m/s and reduced modulus in Pa where the film law takes them."""

    cells: float | None = None
    speed: float | None = None
    modulus: float | None = None


@dataclass(frozen=True)
class Film:
    """What the codes are told: lengths in m."""

    gap: float
    e_dry: float
    diameter: float
    cell: float | None
    viscosity: float
    roughness: float | None
    """Height of the asperities, of a law that knows it."""


def film_of(
    closure: Closure, conditions: Conditions | None, e_dry: float | None, given: FilmRequest, to: str
) -> Film:
    """The least gap and the rest; raises :class:`InputError` naming what is missing or refused."""
    if closure.rebound:
        rule = (
            "has a lubrication film of its own: an e_eff beside it would count the viscous loss twice. It takes "
            "e_dry and a least gap: export a film law, such as roughness or nijssen_2022"
        )
        raise InputError(Defect(rule, field="--to", value=to))
    if closure.family != "film" or "m" in closure.variables:
        rule = f"takes a film law that gives a least gap; {closure.name} does not: roughness, nijssen_2022"
        raise InputError(Defect(rule, field="--to", value=to))
    if conditions is None:
        rule = "needs fluid and sphere: --fluid density=D,viscosity=MU --sphere diameter=D,density=RHO,e_dry=E"
        raise InputError(Defect(rule, field="--to", value=to))
    sphere, mu = conditions.sphere, conditions.fluid.viscosity
    dry = e_dry if e_dry is not None else sphere.e_dry
    if dry is None or not 0 < dry <= 1:
        raise InputError(Defect("is needed, above 0 and at most 1: --e-dry 0.97", field="e_dry"))
    known = {"r": sphere.diameter / 2, "mu": mu, "v": given.speed, "E_r": given.modulus}
    options = {"v": "--speed", "E_r": "--modulus"}
    for name in closure.variables:
        if known[name] is None:
            raise InputError(Defect(f"is needed: {closure.name} takes it", field=options[name]))
    gap = float(closure.value(*(np.asarray(known[name], float) for name in closure.variables)))
    asperities = next((c.value for c in closure.constants if c.name == "sigma"), None)
    if closure.name == "roughness":
        asperities = gap
    cell = None if given.cells is None else sphere.diameter / given.cells
    return Film(gap, dry, sphere.diameter, cell, mu, asperities)


def _cell(film: Film) -> float:
    if film.cell is None:
        raise InputError(Defect("is needed: cells a diameter", field="--cells"))
    return film.cell


def walberla_keys(film: Film) -> tuple[str, list[str], str]:
    """Name, remarks and keys, one a line, for waLBerla."""
    cells = film.diameter / _cell(film)
    said = [
        "keys of apps/benchmarks/FluidParticleCoupling, as in inputSphereWallCollision.dat",
        f"lubricationCutOffDistance is in cells: its own input has 0.666667. {_LOST_BELOW:g} is where a grid "
        f"loses the film, and from 2/3 on a difference of 1/gap was up to 16 % too strong ({_MEASURED})",
        f"lubricationMinimalGapSizeNonDim is h_min over the radius; its own input has 0.0005, calibrated. "
        f"{cells:g} cells a diameter",
    ]
    keys = (
        f"diameter {cells:g};\nrestitutionCoeff {film.e_dry:.9g};\nuseLubricationCorrection true;\n"
        f"lubricationCutOffDistance {_LOST_BELOW:g};\n"
        f"lubricationMinimalGapSizeNonDim {2 * film.gap / film.diameter:.6g};\n"
    )
    return "waLBerla", said, keys


def lethe_keys(film: Film) -> tuple[str, list[str], str]:
    """Name, remarks and keys for Lethe: one subsection DEM."""
    cell = _cell(film)
    said = [
        "sharp immersed boundary; both ranges are multiples of the smallest cell, "
        f"{cell:.6g} m at {film.diameter / cell:g} cells a diameter",
        "the force is the full one of 1/gap, not the difference to its cut-off: begun at the default of 2 cells "
        "it counts the film twice that the grid resolves. Half a cell is where a grid loses it "
        f"({_MEASURED})",
        "each particle's own subsection has: set restitution coefficient = the same e_dry",
    ]
    keys = (
        "subsection DEM\n  set enable lubrication force = true\n"
        f"  set lubrication range max = {_LOST_BELOW:g}\n  set lubrication range min = {film.gap / cell:.6g}\n"
        "  subsection wall physical properties\n"
        f"    set wall restitution coefficient = {film.e_dry:.9g}\n  end\nend\n"
    )
    return "Lethe", said, keys


def _liggghts_pfm(film: Film) -> tuple[str, list[str], str]:
    if film.roughness is None:
        rule = "takes the height of asperities and finds the elastic gap itself: roughness, nijssen_2022 sigma=H"
        raise InputError(Defect(rule, field="--to", value="liggghts-pfm"))
    said = [
        "hertz/lubricated resolves the film in time down to h_min = max(roughness, elastic gap): e is e_dry, not "
        "e_eff. youngsModulusOriginal and coefficientFrictionLubricated are yours",
        "lubricationCutoff in reduced radii; 1 is advised by its manual. For one atom type",
    ]
    model = "model hertz/lubricated tangential history/lubricated"
    keys = (
        f"fix e all property/global coefficientRestitution peratomtypepair 1 {film.e_dry:.9g}\n"
        f"fix sigma all property/global surfaceRoughness peratomtype {film.roughness:.6g}\n"
        "fix reach all property/global lubricationCutoff scalar 1.0\n"
        f"fix mu all property/atom fluidViscosity scalar yes yes no {film.viscosity:.6g}\n"
        f"pair_style gran {model} correctYoungsModulus on\npair_coeff * *\n"
    )
    return "LIGGGHTS-PFM", said, keys


def _mfc(film: Film) -> tuple[str, list[str], str]:
    said = [
        "immersed bodies with the flow resolved: the film is the grid's, what the grid loses of it is in no model "
        "yet. e is e_dry; the rebound lacks the loss below about half a cell "
        f"({_MEASURED}); h_min = {film.gap:.4g} m is where that loss would end",
        "collision_time and ib_coefficient_of_friction are yours; the contact may pull: e typed is e delivered",
    ]
    return "MFC", said, f"collision_model = 1\ncoefficient_of_restitution = {film.e_dry:.9g}\n"


FILM_CODES: dict[str, tuple[str, str, Callable[[Film], tuple[str, list[str], str]]]] = {
    "walberla": (
        "waLBerla keys: e_dry, least gap, cut-off",
        "7.2 of June 2026, from its source",
        walberla_keys,
    ),
    "lethe": ("Lethe keys: e_dry, lubrication range", "documentation at 17a67db", lethe_keys),
    "liggghts-pfm": (
        "LIGGGHTS-PFM hertz/lubricated: e_dry, roughness",
        "d075b97 of January 2024, from its manual",
        _liggghts_pfm,
    ),
    "mfc": ("MFC keys: e_dry", "64ca703 of 2026, from its source", _mfc),
}
"""Title, what it was written for, and the name, remarks and keys."""


def film_code(
    to: str, closure: Closure, conditions: Conditions | None, e_dry: float | None, given: FilmRequest
) -> str:
    """The text for one of :data:`FILM_CODES`."""
    film = film_of(closure, conditions, e_dry, given, to)
    _, version, write = FILM_CODES[to]
    name, said, keys = write(film)
    lines = [
        NOT_TRIED,
        *pair_lines(conditions),
        f"e_dry {film.e_dry:g}; least gap h_min = {film.gap:.6g} m by {closure.name}"
        + (f" at {given.speed:g} m/s" if "v" in closure.variables else ""),
        *said,
    ]
    sign = "//" if to == "walberla" else "#"
    return comment_lines(closure, name, version, lines, sign) + "\n" + keys
