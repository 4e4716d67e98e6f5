"""Options that more than one command has."""

from __future__ import annotations

import argparse
from collections.abc import Iterable


def add_columns(parser: argparse.ArgumentParser) -> None:
    """``--column COLUMN=NAME``, repeatable: the file's own names; gathered in ``args.column`` as pairs."""
    parser.add_argument(
        "--column",
        action="append",
        default=[],
        type=pair,
        metavar="COLUMN=NAME",
        help="the file's own NAME for a column, as in gap_m=y; other columns are then ignored; may be repeated",
    )


def pair(text: str) -> tuple[str, str]:
    """``NAME=VALUE`` as an argument type."""
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"{text!r} is not of the form NAME=VALUE")
    return name, value


def assignment(text: str) -> tuple[str, float]:
    """``NAME=NUMBER`` as an argument type."""
    name, value = pair(text)
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{value!r} in {text!r} is not a number") from None


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
