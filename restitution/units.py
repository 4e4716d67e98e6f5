"""Units at the door: "10 mPa s" or "0.3mm" become SI, and inside everything stays SI.

A parser of our own, of products, quotients, powers and roots of units: what is asked for is a number in SI and the
dimension that it must have, in length, mass and time. A general library would be a dependency of thousands of
units, and would not know those of a track, which the caller gives as ``symbols``: ``d``, ``frame``, ``px``.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

Dimension = tuple[Fraction, Fraction, Fraction]
"""Powers of length, mass and time."""


class UnitError(ValueError):
    """A text is no quantity, or not one of the dimension that is needed."""


class Quantity(NamedTuple):
    """A number in SI and its dimension."""

    value: float
    dimension: Dimension


def _dimension(length: int, mass: int, time: int) -> Dimension:
    return Fraction(length), Fraction(mass), Fraction(time)


PURE = _dimension(0, 0, 0)
LENGTH = _dimension(1, 0, 0)
TIME = _dimension(0, 0, 1)
SPEED = _dimension(1, 0, -1)
_MASS = _dimension(0, 1, 0)
_PRESSURE = _dimension(-1, 1, -2)
_DYNAMIC = _dimension(-1, 1, -1)
KINEMATIC = _dimension(2, 0, -1)

_WITH_PREFIX = {
    "m": Quantity(1.0, LENGTH),
    "g": Quantity(1e-3, _MASS),
    "s": Quantity(1.0, TIME),
    "Pa": Quantity(1.0, _PRESSURE),
    "Pas": Quantity(1.0, _DYNAMIC),
    "N": Quantity(1.0, _dimension(1, 1, -2)),
    "P": Quantity(0.1, _DYNAMIC),
    "St": Quantity(1e-4, KINEMATIC),
    "Hz": Quantity(1.0, _dimension(0, 0, -1)),
    "l": Quantity(1e-3, _dimension(3, 0, 0)),
    "L": Quantity(1e-3, _dimension(3, 0, 0)),
    "bar": Quantity(1e5, _PRESSURE),
}
_PREFIXES = {"n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "c": 1e-2, "d": 0.1, "k": 1e3, "M": 1e6}
_WORDS = {
    "min": Quantity(60.0, TIME),
    "h": Quantity(3600.0, TIME),
    "in": Quantity(0.0254, LENGTH),
    "inch": Quantity(0.0254, LENGTH),
    "micron": Quantity(1e-6, LENGTH),
    "poise": _WITH_PREFIX["P"],
    "stokes": _WITH_PREFIX["St"],
    **dict.fromkeys(("sec", "second", "seconds"), _WITH_PREFIX["s"]),
    **dict.fromkeys(("meter", "metre", "meters", "metres"), _WITH_PREFIX["m"]),
    **dict.fromkeys(("msec", "millisecond", "milliseconds"), Quantity(1e-3, TIME)),
    **dict.fromkeys(("millimeter", "millimetre", "millimeters", "millimetres"), Quantity(1e-3, LENGTH)),
    **dict.fromkeys(("centimeter", "centimetre", "centimeters", "centimetres"), Quantity(1e-2, LENGTH)),
    **dict.fromkeys(("microns", "micrometer", "micrometre"), Quantity(1e-6, LENGTH)),
    **dict.fromkeys(("сек", "δευτ", "δευτερόλεπτα", "秒", "초"), _WITH_PREFIX["s"]),
    **dict.fromkeys(("мин", "分钟", "분"), Quantity(60.0, TIME)),
    **dict.fromkeys(("毫秒", "ミリ秒", "밀리초"), Quantity(1e-3, TIME)),
    **dict.fromkeys(("微秒", "マイクロ秒"), Quantity(1e-6, TIME)),
    **dict.fromkeys(("米", "公尺", "メートル", "μέτρα"), _WITH_PREFIX["m"]),
    **dict.fromkeys(("厘米", "公分", "センチ", "εκατοστά"), Quantity(1e-2, LENGTH)),
    **dict.fromkeys(("毫米", "公厘", "ミリ", "ミリメートル"), Quantity(1e-3, LENGTH)),
    **dict.fromkeys(("밀리미터", "χιλιοστά"), Quantity(1e-3, LENGTH)),
    **dict.fromkeys(("微米", "ミクロン"), Quantity(1e-6, LENGTH)),
}
"""Names that take no prefix; of other languages those that mean nothing else."""
_CYRILLIC = str.maketrans(
    dict(zip("мгсНлПкдн", "mgsNlPkdn", strict=True)) | {"М": "M", "а": "a", "ц": "z", "т": "t", "С": "S"}
)
"""Letters of the units in Cyrillic, one for one, as in кг, мПа; but for the prefix мк and the с of см, сП, сСт."""
_SHORT = ("м", "с", "мм", "см", "мс", "мкм", "мкс", "μm", "μs", "µm", "µs")
NAMES_BEYOND_ASCII = (*(name for name in _WORDS if not name.isascii()), *_SHORT)
"""Some by which the code page of a text is told."""


def _latin(name: str) -> str:
    """A unit in Cyrillic letters as SI writes it; names in others stay as they are."""
    if name.startswith("Гц") or name[1:] == "Гц":
        return name.replace("Гц", "Hz").translate(_CYRILLIC)
    if len(name) > 1 and name[0] == "с" and name[1:] in ("м", "П", "Ст"):
        return "c" + name[1:].translate(_CYRILLIC)
    return name.replace("мк", "u", 1).translate(_CYRILLIC) if name.startswith("мк") else name.translate(_CYRILLIC)


# Python's float() would also take 1_000 and digits of other scripts.
NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|nan|inf|infinity)", re.IGNORECASE | re.ASCII)

_LONGEST = 60
"""Characters of a text; brackets within it are read by recursion."""
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)|(?P<name>[^\W\d]+)|(?P<sign>\*\*|[-+*/·⋅×^().]))",
)
_POWER = re.compile(r"\s*(?:\*\*|\^)?\s*([-+]?\d+)(?![\d.]*[eE.]\d)")


def number(text: str) -> float:
    """A finite number, of plain digits; raises :class:`UnitError` where the text is none."""
    if not NUMBER.fullmatch(text.strip()):
        raise UnitError("is not a number")
    value = float(text)
    if not math.isfinite(value):
        raise UnitError("is not finite")
    return value


def quantity(text: str, symbols: Mapping[str, Quantity] | None = None) -> Quantity:
    """A text such as "7.8 g/cm3" in SI; raises :class:`UnitError` where it is none."""
    text = text.strip().translate(_SUPERSCRIPTS)
    if not text.isascii():  # ㎜ and letters of full width; digits of other scripts stay what they are
        text = "".join(sign if sign.isdigit() else unicodedata.normalize("NFKC", sign) for sign in text)
    if len(text) > _LONGEST:
        raise UnitError("is too long for a number with a unit")
    try:
        value, dimension = _Parser(text, symbols or {}).whole()
    except (OverflowError, ZeroDivisionError):
        value, dimension = math.inf, PURE
    if not math.isfinite(value):
        raise UnitError("is not finite")
    return Quantity(float(f"{value:.15g}"), dimension)  # 7.8 g/cm3 is 7800 kg/m3, not 7799.999999999999


def in_si(given: float | str, unit: str, symbols: Mapping[str, Quantity] | None = None) -> float:
    """A number, taken to be in ``unit`` (of SI), or a text with a unit of the same dimension."""
    if not isinstance(given, str):
        return given
    found, wanted = quantity(given, symbols), quantity(unit, symbols)
    if found.dimension == wanted.dimension:
        return found.value
    if found.dimension == PURE:
        raise UnitError(f"has no unit: write {given} {unit}")
    raise UnitError(f"is not of the dimension of {unit}")


def measured(unit: str) -> BeforeValidator:
    """For a field of a record: a text with a unit becomes a number in ``unit``; numbers stay as they are."""

    def convert(given: Any) -> Any:
        try:
            return in_si(given, unit)
        except UnitError as error:
            raise PydanticCustomError("unit", "{reason}", {"reason": str(error)}) from None

    return BeforeValidator(convert)


class _Parser:
    """Product := factor (("*" | "/" | nothing) factor)*; factor := (number | unit | root | (product)) power?"""

    def __init__(self, text: str, symbols: Mapping[str, Quantity]):
        self.text, self.symbols, self.at = text, symbols, 0

    def whole(self) -> Quantity:
        if not self.text:
            raise UnitError("is empty")
        sign = -1.0 if self.text[0] in "-−" else 1.0
        self.at = 1 if self.text[0] in "-−+" else 0
        result = self._product()
        if self.at < len(self.text):
            hint = "; the decimal sign is a point" if re.search(r"\d,\d", self.text) else ""
            raise UnitError(f"is no number with a unit{hint}")
        return Quantity(sign * result.value, result.dimension)

    def _token(self) -> re.Match | None:
        return _TOKEN.match(self.text, self.at)

    def _product(self) -> Quantity:
        value, dimension = self._factor()
        while token := self._token():
            sign = token["sign"]
            if sign == ")" or (sign is not None and sign not in "(*/·⋅×."):
                break
            if sign is not None and sign != "(":
                self.at = token.end()
            other = self._factor()
            power = -1 if sign == "/" else 1
            value *= other.value**power
            dimension = _plus(dimension, other.dimension, Fraction(power))
        return Quantity(value, dimension)

    def _factor(self) -> Quantity:
        token = self._token()
        if token is None:
            raise UnitError("is no number with a unit")
        self.at = token.end()
        if token["number"]:
            return Quantity(float(token["number"]), PURE)
        if token["name"] == "sqrt":
            inner = self._factor()
            return Quantity(inner.value**0.5, _times(inner.dimension, Fraction(1, 2)))
        if token["sign"] == "(":
            base = self._product()
            closing = self._token()
            if closing is None or closing["sign"] != ")":
                raise UnitError("has a bracket that is not closed")
            self.at = closing.end()
        elif token["name"]:
            base = self._unit(token["name"])
        else:
            raise UnitError("is no number with a unit")
        if power := _POWER.match(self.text, self.at):
            self.at, exponent = power.end(), int(power[1])
            return Quantity(base.value**exponent, _times(base.dimension, Fraction(exponent)))
        return base

    def _unit(self, name: str) -> Quantity:
        given, name = name, name if name in self.symbols or name in _WORDS else _latin(name)
        for known in (self.symbols, _WORDS, _WITH_PREFIX):
            if name in known:
                return known[name]
        prefix, rest = name[0], name[1:]
        if prefix in _PREFIXES and rest in _WITH_PREFIX:
            unit = _WITH_PREFIX[rest]
            return Quantity(_PREFIXES[prefix] * unit.value, unit.dimension)
        raise UnitError(f"{given!r} is no unit known here, such as mm, ms, Pa s, mPa s, cSt, g/cm3")


def _times(dimension: Dimension, power: Fraction) -> Dimension:
    length, mass, time = dimension
    return length * power, mass * power, time * power


def _plus(a: Dimension, b: Dimension, power: Fraction) -> Dimension:
    length, mass, time = (x + power * y for x, y in zip(a, b, strict=True))
    return length, mass, time
