"""How wide a table may be: asked of its lines before one of them is cut into cells."""

from __future__ import annotations

from collections.abc import Sequence

from restitution.errors import Defect, InputError

MOST_COLUMNS = 4096
"""A tracker's table of a hundred animals of thirteen points, x, y and likelihood each, has 3900."""
LONGEST_LINE = 2**17
"""Characters: of 4096 columns 32 each. The csv module takes no longer cell."""
_SEPARATORS = (",", ";", "\t", "|")


def check_widths(lines: Sequence[str], file: str) -> None:
    """Raise :class:`InputError` for a line of more than :data:`LONGEST_LINE` characters or :data:`MOST_COLUMNS`
    columns, by whatever separates them.
    """
    wide = [(number, line) for number, line in enumerate(lines, 1) if len(line) > MOST_COLUMNS]
    for number, line in wide:
        if len(line) > LONGEST_LINE:
            rule = f"is a line of {len(line)} characters; at most {LONGEST_LINE} are read"
        elif (columns := _columns(line)) > MOST_COLUMNS:
            rule = f"has {columns} columns; at most {MOST_COLUMNS} are read"
        else:
            continue
        raise InputError(Defect(rule, file=file, row=number))


def _columns(line: str) -> int:
    """By the separator that stands there most."""
    return max(len(line.split()), *(line.count(sign) + 1 for sign in _SEPARATORS))
