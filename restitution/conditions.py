"""The conditions of an experiment or a run: fluid, sphere, wall, gravity, in SI; texts with units become SI here.

One record serves measured data (``data/datapackage.json``), users' TOML files and, later, simulation cases.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from restitution.errors import Defect, InputError
from restitution.inputs import read_toml
from restitution.units import KINEMATIC, UnitError, in_si, measured, quantity

SMALLEST, LARGEST = 1e-12, 1e12
"""Of any size of a case, in SI or in diameters: products and powers of what lies between never overflow."""
Positive = Annotated[float, Field(ge=SMALLEST, le=LARGEST, allow_inf_nan=False, strict=True)]
NonNegative = Annotated[float, Field(ge=0, le=LARGEST, allow_inf_nan=False, strict=True)]

Length = Annotated[Positive, measured("m")]
Thickness = Annotated[NonNegative, measured("m")]
Duration = Annotated[Positive, measured("s")]
Velocity = Annotated[Positive, measured("m/s")]
Density = Annotated[Positive, measured("kg/m3")]
Acceleration = Annotated[Positive, measured("m/s2")]


class Record(BaseModel):
    """Base of all that is read from a file: a misspelt key must not pass as an unset one."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class Fluid(Record):
    """``density`` rho_f in kg/m3, dynamic ``viscosity`` mu in Pa s; of a kinematic one, "10.7 cSt", rho_f nu."""

    density: Density
    viscosity: Annotated[Positive, measured("Pa s")]

    @model_validator(mode="before")
    @classmethod
    def _of_kinematic(cls, given: Any) -> Any:
        """Mu = rho_f nu where the viscosity is given as nu, with its unit."""
        if not (isinstance(given, dict) and isinstance(given.get("viscosity"), str)):
            return given
        try:
            nu, density = quantity(given["viscosity"]), in_si(given.get("density"), "kg/m3")
            kinematic = nu.dimension == KINEMATIC and isinstance(density, int | float)
        except UnitError:
            return given  # said of the field itself
        return {**given, "viscosity": nu.value * density} if kinematic else given


class Sphere(Record):
    """``diameter`` d in m, ``density`` rho_p in kg/m3, dry restitution ``e_dry``, ``roughness`` in m.

    ``e_dry`` and ``roughness`` are None where nobody states them.
    """

    diameter: Length
    density: Density
    e_dry: Annotated[float, Field(gt=0, le=1, strict=True)] | None = None
    roughness: Thickness | None = None

    @property
    def radius(self) -> float:
        return self.diameter / 2

    @property
    def mass(self) -> float:
        return self.density * math.pi * self.diameter**3 / 6


class Wall(Record):
    """What is known of the wall: ``roughness`` in m, ``material`` in words."""

    roughness: Thickness | None = None
    material: str | None = None


class QuotedImpact(Record):
    """The speed of the first impact, in m/s, for a record that begins after it."""

    speed: Velocity
    speed_sigma: Annotated[NonNegative, measured("m/s")] = 0.0
    speed_definition: Literal["far", "contact", "window"] = "far"


class Conditions(Record):
    """Everything but the track itself. ``partner`` is the second sphere where there is no wall.

    ``release`` is the gap in m from which the sphere was let go at rest, where that is known.
    """

    fluid: Fluid
    sphere: Sphere
    wall: Wall | None = None
    partner: Sphere | None = None
    impact: QuotedImpact | None = None
    release: Length | None = None
    gravity: Acceleration = 9.81
    source: str | None = None

    @property
    def free_fall(self) -> float:
        """Acceleration in m/s2 of a sphere set free: gravity less buoyancy, over sphere and added mass."""
        excess = self.sphere.density - self.fluid.density
        return self.gravity * excess / (self.sphere.density + 0.5 * self.fluid.density)


_RULES = {
    "missing": "is missing",
    "extra_forbidden": "is not a known key",
    "model_type": "must be a table of keys, as in [fluid]",
    "float_type": "must be a number",
}


def defects_of(error: ValidationError, file: str | None) -> list[Defect]:
    """Pydantic's findings as defects that name field and value."""
    found = []
    for e in error.errors():
        missing = e["type"] == "missing"
        value = None if missing or isinstance(e["input"], dict | list) else _text(e["input"])
        rule = _RULES.get(e["type"], e["msg"].removeprefix("Value error, "))
        found.append(Defect(rule, file=file, field=".".join(str(p) for p in e["loc"]), value=value))
    return found


def _text(value: Any) -> str:
    try:
        return str(value)
    except ValueError:  # an integer of more digits than Python writes
        return f"an integer of {value.bit_length()} bits"


def read_conditions(path: str | Path) -> Conditions:
    """Fluid, sphere, wall and gravity of a TOML file, in SI.

    Parameters
    ----------
    path : a file with tables ``[fluid]`` (density in kg/m3, viscosity in Pa s) and ``[sphere]`` (diameter in m,
        density, ``e_dry``), and ``[wall]``, ``[partner]``, ``gravity`` where they matter; or texts with a unit, as
        in ``viscosity = "10 mPa s"``.

    Raises
    ------
    InputError : naming every field that is wrong, or why the file cannot be read.
    """
    try:
        return Conditions.model_validate(read_toml(path))
    except ValidationError as error:
        raise InputError(*defects_of(error, str(path))) from None
