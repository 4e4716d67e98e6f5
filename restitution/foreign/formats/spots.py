"""What a file of tracks that is no text of columns has: a table, and what the file says of it."""

from __future__ import annotations

from dataclasses import dataclass, field

from restitution.foreign.layout import Row
from restitution.foreign.programs import Program

Read = tuple[list[str], list[Row], dict[str, str]]
"""Names, rows, and the units that the file states by name."""


@dataclass(frozen=True)
class Spots:
    """Names and rows of a table, the program that wrote it if known, the units that it states by name."""

    names: list[str]
    rows: list[Row]
    program: Program | None
    units: dict[str, str] = field(default_factory=dict)
