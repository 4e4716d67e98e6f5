"""What the numbers of a track mean: stated by options or by a small file, never guessed.

    gap = s (x - x_wall) L - (d/2 where x is the height of the centre),    t = L_t t_file,

s being 1 where positions grow away from the wall and -1 where they grow towards it (``direction`` "down", as the
rows of an image do), L and L_t the units of length and time. A velocity is s v L / L_t.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, ValidationError

from restitution.conditions import LARGEST, SMALLEST, Conditions, Positive, Record, defects_of
from restitution.errors import Defect, InputError
from restitution.foreign.number_text import Decimal
from restitution.inputs import read_toml
from restitution.units import LENGTH, PURE, SPEED, TIME, Dimension, Quantity, UnitError, quantity

Text = Annotated[str, Field(min_length=1)]
_OPTIONS = {"frames_per_second": "--fps", "time_unit": "--time-unit"} | dict.fromkeys(
    ("time", "position", "velocity"), "--column"
)


class Settings(Record):
    """Keys of a settings file; what is not given is as the file of the track says it.

    ``time``, ``position``, ``velocity``: names of the columns. ``time_unit``: "ms", "frame", "sqrt(d/g)";
    ``unit``: "mm", "px", "0.3 mm", "d". ``frames_per_second`` and ``pixel`` say what a frame and a pixel are.
    ``direction``: "up" where positions and velocities grow away from the wall. ``wall``: where the wall is, in the
    unit of the positions, or "rest": where the sphere comes to rest. ``point``: whose position it is.
    ``sheet``: which one of a spreadsheet.
    ``release``: the gap from which the sphere was let go at rest, as "25.3 mm", for a fit to whole trajectories.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, coerce_numbers_to_str=False)

    time: Text | None = None
    position: Text | None = None
    velocity: Text | None = None
    particle: Text | int | None = None
    time_unit: Text | None = None
    unit: Text | None = None
    frames_per_second: Positive | None = None
    pixel: Text | None = None
    direction: Literal["up", "down"] | None = None
    wall: Annotated[float, Field(allow_inf_nan=False, strict=True)] | Literal["rest"] | None = None
    point: Literal["lowest", "centre"] | None = None
    release: Text | None = None
    decimal: Decimal | None = None
    sheet: Text | None = None

    def over(self, other: Settings) -> Settings:
        """These, and the ``other`` ones where these say nothing."""
        return Settings(**{**other.stated(), **self.stated()})

    def stated(self) -> dict[str, Any]:
        """What is given."""
        return self.model_dump(exclude_none=True)


def of_options(**given: Any) -> Settings:
    """Settings of the command line's options, which a defect names."""
    try:
        return Settings(**given)
    except ValidationError as error:
        # A field that may be of several types has a defect of each.
        found = {f"{d.field}".partition(".")[0]: d for d in defects_of(error, None)}
    raise InputError(*(replace(d, field=_OPTIONS.get(name, f"--{name}")) for name, d in found.items()))


def read_settings(path: str | Path) -> Settings:
    """The settings in a TOML file; raises :class:`InputError` naming every key that is wrong."""
    try:
        return Settings.model_validate(read_toml(path))
    except ValidationError as error:
        raise InputError(*defects_of(error, str(path))) from None


@dataclass(frozen=True)
class Units:
    """The units that a track may be in: those of the sphere, and a frame and a pixel where they are stated."""

    symbols: dict[str, Quantity]

    @classmethod
    def of(cls, settings: Settings, conditions: Conditions | None) -> Units:
        """The diameter ``d`` and radius ``r``, gravity ``g``, where these are known, ``frame`` and ``px``."""
        symbols = {}
        if conditions is not None:
            d = conditions.sphere.diameter
            symbols = {
                "d": Quantity(d, LENGTH),
                "r": Quantity(d / 2, LENGTH),
                "g": Quantity(conditions.gravity, quantity("m/s2").dimension),
            }
        if settings.frames_per_second is not None:
            frame = Quantity(1 / settings.frames_per_second, TIME)
            symbols |= dict.fromkeys(("frame", "frames"), frame)
        if settings.pixel is not None:
            try:
                pixel = quantity(settings.pixel, symbols)
            except UnitError as error:
                raise InputError(Defect(str(error), field="--pixel", value=settings.pixel)) from None
            if pixel.dimension != LENGTH or not pixel.value > 0:
                rule = "must be a length, as in 0.125mm"
                raise InputError(Defect(rule, field="--pixel", value=settings.pixel))
            symbols |= dict.fromkeys(("px", "pixel", "pixels"), pixel)
        return cls(symbols)

    def length(self, unit: str) -> float:
        """A unit of length in m."""
        return self._value(unit, "--unit", LENGTH, "a length, such as mm, px, 0.3mm or d")

    def release(self, height: str) -> float:
        """A height of release in m."""
        return self._value(height, "--release", LENGTH, "a length, such as 25.3mm, 2.66 d or 200 px")

    def time(self, unit: str) -> float:
        """A unit of time in s."""
        return self._value(unit, "--time-unit", TIME, "a time, such as ms, frame, 0.5ms or sqrt(d/g)")

    def speed(self, unit: str, time: float) -> float:
        """A unit of speed in m/s: one itself, or a unit of length over the unit of time."""
        if self._quantity(unit, "--unit").dimension == SPEED:
            return self._value(unit, "--unit", SPEED, "a speed")
        return self.length(unit) / time

    def _value(self, unit: str, option: str, dimension: Dimension, what: str) -> float:
        value, found = self._quantity(unit, option)
        if found == PURE:
            raise InputError(Defect(f"has no unit; it must be {what}", field=option, value=unit))
        if found != dimension or not value > 0:
            raise InputError(Defect(f"must be {what}", field=option, value=unit))
        if not SMALLEST <= value <= LARGEST:
            raise InputError(Defect(f"is {value:g} in SI, beyond any size of a track", field=option, value=unit))
        return value

    def _quantity(self, unit: str, option: str) -> Quantity:
        try:
            return quantity(unit, self.symbols)
        except UnitError as error:
            for name, rule in _ASKED.items():
                if name not in self.symbols and re.search(rf"(?<![^\W\d]){name}(?![^\W\d])", unit):
                    raise InputError(Defect(rule, field=option, value=unit)) from None
            raise InputError(Defect(str(error), field=option, value=unit)) from None


_ASKED = {
    "frame": "--fps says how many frames a second there are",
    "frames": "--fps says how many frames a second there are",
    "px": "--pixel says how long one is",
    "d": "--conditions says how large the sphere is",
    "r": "--conditions says how large the sphere is",
}
"""Symbols that need another setting."""

TEMPLATE = """\
# What the numbers of a track mean, for --settings. Take away the # of what your file does not say itself.
# Options of the command (--column, --unit, --time-unit, --fps, ...) go before these.

# time = "FRAME"             # the file's name of the column of times ("1" for the first, where it has no names)
# position = "POSITION_Y"    # of the positions along the normal of the wall, or
# velocity = "vz"            # of the velocities
# particle = 3               # which particle or track, where the file has several

# time_unit = "frame"        # "s", "ms", "frame", "0.5 ms", "sqrt(d/g)"
# frames_per_second = 500.0  # what a frame is: of the camera, not of the film played slowly
# unit = "px"                # "m", "mm", "px", "0.3 mm", "d" (diameters); of velocities also "mm/s"
# pixel = "0.125 mm"         # what a pixel is

# direction = "down"         # positions grow towards the wall, as rows of an image do ("up": away from it)
# wall = 812                 # where the wall is, in the unit of positions; "rest": where the sphere comes to rest
# release = "25.3 mm"        # gap from which it was let go at rest, for fit --trajectory
# point = "centre"           # positions are those of the centre, d/2 above the lowest point ("lowest")
# sheet = "Run 1"            # which sheet of a spreadsheet, where several have a table
# decimal = ","              # the decimal sign, where the numbers leave it open
"""
