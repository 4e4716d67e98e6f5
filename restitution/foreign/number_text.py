"""Numbers as programs and spreadsheets write them, made plain: typographic minus, D exponents, decimal commas."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from datetime import date
from typing import Literal

from restitution.units import NUMBER

Decimal = Literal[".", ","]

_TYPOGRAPHIC = str.maketrans(dict.fromkeys("−–‒﹣－", "-") | {"\u00a0": " ", "\u202f": " ", "\u2009": " "})
_EXPONENT = re.compile(r"([+-]?(?:\d+[.,]?\d*|[.,]\d+))[dDqQ]([+-]?\d+)", re.ASCII)
_COMMA = re.compile(r"[+-]?(\d+,\d*|,\d+)(e[+-]?\d+)?", re.IGNORECASE | re.ASCII)
_POINT = re.compile(r"[+-]?(\d+\.\d*|\.\d+)(e[+-]?\d+)?", re.IGNORECASE | re.ASCII)
_THOUSANDS = re.compile(
    r"[+-]?\d{1,3}((,\d{3})+\.\d*|(\.\d{3})+,\d*|(,\d{3}){2,}|(\.\d{3}){2,}|([ '’]\d{3})+([.,]\d*)?)", re.ASCII
)
_AS_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
_CLOCK = re.compile(
    r"((?P<date>\d{4}[-/]\d\d[-/]\d\d|\d{1,2}[-./](\d{1,2}|[A-Za-z]{3})[-./]\d{2,4})[T ])?"
    r"(?P<h>\d{1,3}):(?P<min>[0-5]\d):(?P<s>[0-5]\d)([.,](?P<part>\d+))?(Z| ?(?P<half>[AaPp])[Mm])?",
    re.ASCII,
)
_DURATION = re.compile(r"([+-]?\d+(?:\.\d*)?(?:e[+-]?\d+)?) sec", re.ASCII)
_LOST = {"", "na", "n/a", "#n/a", "null", "none", "-", "--", "nan", "+nan", "-nan", "nan(ind)", "-nan(ind)"}


def seconds(cell: str) -> str | None:
    """The seconds of a time of day, 10:15:03.250, of a date and a time, of MATLAB's "0.25 sec"; else None.

    Days are counted from the last thousandth, so that microseconds remain.
    """
    match = _CLOCK.fullmatch(cell.strip())
    if match is None:
        duration = _DURATION.fullmatch(cell.strip())
        return None if duration is None else duration[1]
    try:
        day = _day(match["date"]) if match["date"] else 0
    except ValueError:
        return None
    hours = int(match["h"])
    if match["half"]:
        hours = hours % 12 + 12 * (match["half"] in "Pp")
    whole = 86400 * day + 3600 * hours + 60 * int(match["min"]) + int(match["s"])
    return f"{whole}.{match['part'] or 0}"


def _day(text: str) -> int:
    """A date as a number that the next day has one more of, the day before the month or after it."""
    parts = re.split(r"[-./]", text)
    if len(parts[0]) == 4:
        return date(*map(int, parts)).toordinal() % 1000
    return sum(int(part) for part in parts[:2] if part.isdigit())


def plain(cell: str, decimal: Decimal = ".") -> str:
    """The cell as Python writes numbers; as it is where it is no number."""
    if NUMBER.fullmatch(cell):
        return cell  # most are
    if (time := seconds(cell)) is not None:
        return time
    text = _ascii(cell).strip()
    if _EXPONENT.fullmatch(text):
        text = _EXPONENT.sub(r"\1e\2", text)
    if decimal == "," and _COMMA.fullmatch(text):
        text = text.replace(",", ".")
    return text if text != cell and NUMBER.fullmatch(text) else cell


def is_number(cell: str) -> bool:
    """Whether a cell is a number under either decimal sign."""
    return bool(NUMBER.fullmatch(plain(cell, ",")))


def as_number(cell: str) -> float:
    """A plain cell as a number; NaN where it is none."""
    try:
        return float(cell)
    except ValueError:
        return math.nan


def is_lost(cell: str) -> bool:
    """Whether a cell says that there is no value: empty, NaN, N/A."""
    return cell.strip().lower() in _LOST


def has_thousands(cell: str) -> bool:
    """Whether a cell is a number with thousands separators, which are never guessed away."""
    return bool(_THOUSANDS.fullmatch(_ascii(cell).strip())) and not NUMBER.fullmatch(cell)


def _ascii(cell: str) -> str:
    return cell if cell.isascii() else cell.translate(_TYPOGRAPHIC)


def decimal_of(cells: Iterable[str]) -> tuple[Decimal | None, str]:
    """The decimal sign of the numbers among ``cells``; None and why where it is not clear.

    A comma is a decimal one if any number shows it, as in 0,5 or 1,25. Where every comma has one to three digits
    before it and three after, as in 1,234, it may stand for thousands.
    """
    cells = list(cells)
    commas = [text for cell in cells if "," in cell and _COMMA.fullmatch(text := plain(cell))]
    if not commas:
        return ".", ""
    point = next((text for cell in cells if "." in cell and _POINT.fullmatch(text := plain(cell))), None)
    if point is not None:
        return None, f"has commas and points in its numbers, {commas[0]} and {point}: thousands separators?"
    if all(_AS_THOUSANDS.fullmatch(text) for text in commas):
        return None, f"has numbers such as {commas[0]}: is the comma a decimal sign or for thousands?"
    return ",", ""
