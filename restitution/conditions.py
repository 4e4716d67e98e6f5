"""The conditions of an experiment or a run: fluid, sphere, wall, gravity, in SI; texts with units become SI here.

One record serves measured data (``data/datapackage.json``), users' TOML files and, later, simulation cases.
"""

from __future__ import annotations

import math
import re
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
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "string_type": "must be a text",
    "bool_type": "must be true or false",
    "list_type": "must be a list",
    "tuple_type": "must be a list",
    "finite_number": "must be a finite number",
    "greater_than_equal": "must be {ge} or above",
    "greater_than": "must be above {gt}",
    "less_than_equal": "must be {le} or below",
    "less_than": "must be below {lt}",
    "literal_error": "must be {expected}",
}
_IN_UNION = re.compile(r"\[|^(?:constrained-\w+|int|float|str|bool|tuple|dict|list)$")
"""What names no key of a file but the member of a union that was tried."""


def defects_of(error: ValidationError, file: str | None) -> list[Defect]:
    """Pydantic's findings as defects that name field and value."""
    found: dict[tuple[str, ...], dict[str | None, list[str]]] = {}
    for e in error.errors():
        missing = e["type"] == "missing"
        value = None if missing or isinstance(e["input"], dict | list) else _text(e["input"])
        known, limits = _RULES.get(e["type"]), _plain(e.get("ctx", {}))
        rule = e["msg"].removeprefix("Value error, ") if known is None else known.format(**limits)
        if e["type"] == "float_type" and any(str(key).endswith("_d") for key in e["loc"]):
            rule += " of diameters, without a unit"
        if isinstance(e["input"], float) and not math.isfinite(e["input"]):
            rule = _RULES["finite_number"]
        own = e["loc"][-1:] if e["type"] in ("missing", "extra_forbidden") else ()
        keys = [p for p in e["loc"][: len(e["loc"]) - len(own)] if isinstance(p, int) or not _IN_UNION.search(p)]
        found.setdefault(tuple(map(str, (*keys, *own))), {}).setdefault(value, []).append(rule)
    return [
        Defect(", or ".join(dict.fromkeys(rules)), file=file, field=".".join(keys), value=value)
        for keys, values in found.items()
        for value, rules in values.items()
        if value is not None or not any(keys == other[: len(keys)] != other for other in found)
    ]


def _plain(limits: dict[str, Any]) -> dict[str, Any]:
    return {name: f"{x:g}" if isinstance(x, float) else x for name, x in limits.items()}


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
