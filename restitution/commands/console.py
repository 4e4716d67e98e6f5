"""What the commands print: to a terminal in its width, elsewhere plain and unbroken, one line a row."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from restitution.errors import printable

if TYPE_CHECKING:
    from rich.console import RenderableType

    from restitution.conditions import Conditions

_LONG = 200
"""Rows from which on a table is printed plainly."""


def show(what: RenderableType) -> None:
    """Print a text or a rich table."""
    from rich.console import Console

    if isinstance(what, str):
        what = printable(what, keep="\n")
    console = Console(highlight=False, markup=False, soft_wrap=isinstance(what, str))
    if not console.is_terminal:
        console.width = 10_000
    with console.capture() as capture:
        console.print(what)
    if sys.stdout is None:  # closed by the caller (`>&-`)
        return
    sys.stdout.write("".join(f"{line.rstrip()}\n" for line in capture.get().splitlines()))


def now_and_then(seconds: float = 10.0) -> Callable[[str], None]:
    """Tells the standard error how far a long work has come: each of its lines at most every so many seconds.

    A terminal is told at once and then each second, a log of a batch job after as many seconds.
    """
    terminal = sys.stderr is not None and sys.stderr.isatty()
    every = 1.0 if terminal else seconds
    last = time.monotonic() - (every if terminal else 0.0)

    def say(text: str) -> None:
        nonlocal last
        if sys.stderr is not None and time.monotonic() - last >= every:
            last = time.monotonic()
            print(f"{printable(text)} ...", file=sys.stderr, flush=True)  # noqa: T201

    return say


def show_rows(headings: Sequence[str], rows: Iterable[Sequence[str]], right: Iterable[str] = ()) -> None:
    """Print a table; the columns named in ``right`` are aligned right. One too long to be read is not folded."""
    from rich.table import Table

    rows = list(rows)
    if len(rows) > _LONG:
        _show_plainly(headings, rows, set(right))
        return
    table = Table(box=None, padding=(0, 1, 0, 0), header_style="bold")
    for heading in headings:
        table.add_column(printable(heading), justify="right" if heading in set(right) else "left", overflow="fold")
    for row in rows:
        table.add_row(*map(printable, row))
    show(table)


def _show_plainly(headings: Sequence[str], rows: Sequence[Sequence[str]], right: set[str]) -> None:
    """The same columns without the library that fits them to a terminal, which takes milliseconds a row."""
    cells = [[printable(cell) for cell in row] for row in (headings, *rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    sides = [str.rjust if heading in right else str.ljust for heading in headings]
    if sys.stdout is not None:
        sys.stdout.write(
            "".join(
                " ".join(side(cell, width) for cell, side, width in zip(row, sides, widths, strict=True)).rstrip()
                + "\n"
                for row in cells
            )
        )


def show_facts(facts: Iterable[tuple[str, str]]) -> None:
    """Print names and what is to be said of each, in two columns."""
    from rich.table import Table

    table = Table.grid("key", "value", padding=(0, 2))
    table.columns[0].style, table.columns[0].no_wrap = "bold", True
    for key, value in facts:
        table.add_row(printable(key), printable(value, keep="\n"))
    show(table)


def show_doubts(doubts: Iterable[object]) -> None:
    """Print what is doubtful, one line each, none twice."""
    for doubt in dict.fromkeys(map(str, doubts)):
        show(f"doubt: {doubt}")


def doubt_aside(conditions: Conditions | None, where: str | None = None) -> None:
    """Say on the standard error what is doubtful about fluid and sphere, where the output is for a program."""
    from restitution.doubts import of_conditions

    for doubt in of_conditions([conditions], where or ""):
        if sys.stderr is not None:
            print(f"doubt: {printable(str(doubt))}", file=sys.stderr)  # noqa: T201


def cell(value: object) -> str:
    """A value of a table as text; nothing for a missing one."""
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.9g}"
    return str(value)
