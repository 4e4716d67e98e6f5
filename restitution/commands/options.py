"""Options that more than one command has."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from restitution.foreign.settings import Settings

_MOST_DIGITS = 9
_TRACK_COLUMNS = {"time_s": "time", "gap_m": "position", "velocity_m_s": "velocity"}


TRACK = ("settings", "unit", "time_unit", "fps", "pixel", "direction", "wall", "point", "particle", "sheet")
"""What :func:`add_track` declares."""


def add_columns(parser: argparse.ArgumentParser) -> None:
    """``--column COLUMN=NAME``, repeatable: the file's own names; gathered in ``args.column`` as pairs."""
    parser.add_argument(
        "--column",
        action="append",
        default=[],
        type=_column,
        metavar="COLUMN=NAME",
        help="the file's own NAME for a column, as in gap_m=y; other columns are then ignored; may be repeated",
    )


def add_track(parser: argparse.ArgumentParser, several: bool = False) -> None:
    """The options that say what the numbers of a track mean; ``several``: ``--settings`` takes one file each."""
    group = parser.add_argument_group("what the numbers of a track mean, where its file does not say it")
    if several:
        group.add_argument(
            "--settings", nargs="+", action="extend", metavar="FILE",
            help="all of this in a TOML file, one for all trajectories "
            "or one each in their order; options go before it",
        )  # fmt: skip
    else:
        group.add_argument("--settings", metavar="FILE", help="all of this in a TOML file; options go before it")
    group.add_argument("--unit", metavar="U", help="of positions: m, mm, px, 0.3mm, d; of velocities also mm/s")
    group.add_argument("--time-unit", metavar="U", help="s, ms, frame, 0.5ms, sqrt(d/g)")
    fps = "frames a second, of the camera; times at the pace of a player (24 to 60 a second) are then frames"
    group.add_argument("--fps", type=number, metavar="N", help=fps)
    group.add_argument("--pixel", metavar="LENGTH", help="length of a pixel, as in 0.125mm")
    group.add_argument(
        "--direction", choices=("up", "down"), help="whether values grow away from the wall (up) or towards it"
    )
    group.add_argument(
        "--wall", type=_wall, metavar="X", help="position of the wall in the file's unit, or rest: where it rests"
    )
    group.add_argument("--point", choices=("lowest", "centre"), help="whose position it is, of the sphere's")
    group.add_argument("--particle", metavar="ID", help="which particle or track, where the file has several")
    group.add_argument("--sheet", metavar="NAME", help="which sheet of a spreadsheet, where several have a table")


def add_strict(parser: argparse.ArgumentParser) -> None:
    """``--strict``, of commands that may doubt their input."""
    parser.add_argument("--strict", action="store_true", help="refuse input that is doubtful: exit status 2")


def check_track_columns(columns: Iterable[tuple[str, str]]) -> None:
    """Refuse names that are no columns of a track."""
    from restitution.errors import Defect, InputError

    rule = f"is not a column of a track: {', '.join(_TRACK_COLUMNS)}"
    defects = [Defect(rule, field="--column", value=name) for name, _ in columns if name not in _TRACK_COLUMNS]
    if defects:
        raise InputError(*defects)


def settings_of(args: argparse.Namespace) -> Settings:
    """What the numbers of tracks mean: the options, and the settings file where they say nothing."""
    from restitution.foreign.settings import read_settings

    given = stated_by(args)
    return given.over(read_settings(args.settings)) if args.settings else given


def stated_by(args: argparse.Namespace) -> Settings:
    """What the options say of the numbers of tracks."""
    import math

    from restitution.errors import Defect, InputError
    from restitution.foreign.settings import of_options

    if args.fps is not None and not 0 < args.fps < math.inf:
        raise InputError(Defect("must be positive and finite", field="--fps", value=f"{args.fps:g}"))
    given_columns = once("--column", args.column)
    columns = {_TRACK_COLUMNS[name]: own for name, own in given_columns.items() if name in _TRACK_COLUMNS}
    return of_options(
        unit=args.unit,
        time_unit=args.time_unit,
        frames_per_second=args.fps,
        pixel=args.pixel,
        direction=args.direction,
        wall=args.wall,
        point=args.point,
        particle=args.particle,
        sheet=args.sheet,
        **columns,
    )


def _wall(text: str) -> float | str:
    if text == "rest":
        return text
    from restitution.units import UnitError
    from restitution.units import number as finite

    try:
        return finite(text)
    except UnitError:
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number nor 'rest'") from None


def number(text: str) -> float:
    """A number as an argument type, of the same form as in tables; what is not finite is refused by its option."""
    from restitution.units import NUMBER

    if not NUMBER.fullmatch(text.strip()):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number")
    return float(text)


def diameters(text: str) -> float:
    """A number of diameters as an argument type: 0.1, 0.1d, 0.1 d; a length is refused with what to give."""
    from restitution.units import UnitError, in_si

    try:
        return number(text.strip().removesuffix("d"))
    except argparse.ArgumentTypeError as none:
        try:
            in_si(text, "m")
        except UnitError:
            raise argparse.ArgumentTypeError(f"{text!r} is no number of diameters, as 0.1 or 0.1d") from none
        raise argparse.ArgumentTypeError(
            f"{text!r} is a length, and a number of diameters is meant, as 0.1 or 0.1d: divide by the sphere's"
        ) from None


def whole(text: str) -> int:
    """A whole number, 0 or above, as an argument type."""
    if not (text.isascii() and text.isdecimal() and len(text) <= _MOST_DIGITS):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0 to 2^31")
    return int(text)


def once(option: str, pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Pairs as a mapping; raises :class:`InputError` for a name that is given twice."""
    from restitution.errors import Defect, InputError

    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise InputError(Defect(f"{name} is given twice", field=option))
        found[name] = value
    return found


def pair(text: str) -> tuple[str, str]:
    """``NAME=VALUE`` as an argument type."""
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text!r} has no = in it: it must be of the form NAME=VALUE")
    if not name.strip():
        raise argparse.ArgumentTypeError(f"{text!r} has nothing before the =: whose value is it?")
    if not value.strip():
        raise argparse.ArgumentTypeError(f"{text!r} has nothing after the =: {name} is given no value")
    return name, value


def _column(text: str) -> tuple[str, str]:
    """``COLUMN=NAME`` as an argument type."""
    try:
        return pair(text)
    except argparse.ArgumentTypeError as error:
        rule = f"{error}; give the file's own name of a column, as in gap_m=y"
        raise argparse.ArgumentTypeError(rule) from None


def assignment(text: str) -> tuple[str, float]:
    """``NAME=NUMBER`` as an argument type."""
    name, value = pair(text)
    return name, number(value)


def amount(text: str) -> tuple[str, float | str]:
    """``NAME=NUMBER``, or ``NAME=NUMBER UNIT`` for what knows its unit, as an argument type."""
    name, value = pair(text)
    try:
        return name, number(value)
    except argparse.ArgumentTypeError:
        return name, value


def numbers_in(unit: str) -> Callable[[str], list[float]]:
    """The argument type of positive numbers separated by commas, in ``unit`` or with a unit of their own."""

    def numbers(text: str) -> list[float]:
        from restitution.units import UnitError, in_si

        try:
            parsed = [_plain_or_in_si(part, unit, in_si) for part in text.split(",")]
        except UnitError as error:
            raise argparse.ArgumentTypeError(f"{text!r}: {error}") from None
        if not all(0 < x < float("inf") for x in parsed):
            raise argparse.ArgumentTypeError(f"{text!r} must be positive and finite")
        return parsed

    return numbers


def _plain_or_in_si(part: str, unit: str, in_si: Callable[[str, str], float]) -> float:
    try:
        return number(part)
    except argparse.ArgumentTypeError:
        return in_si(part, unit)


def check_output(option: str, out: str | None, inputs: Iterable[str] = ()) -> None:
    """Refuse a file to write that would replace one of the ``inputs`` or cannot be written, before any work."""
    from pathlib import Path

    from restitution.errors import Defect, InputError
    from restitution.files import check_place

    if out is None:
        return
    if not out:
        raise InputError(Defect("names no file", field=option))
    if any(Path(given).exists() and Path(out).resolve() == Path(given).resolve() for given in inputs):
        raise InputError(Defect("would replace an input", file=out, field=option))
    check_place(out)
