"""The rows of the scorecard, by what they are about.

The fluid alone: :mod:`.fluid`, :mod:`.cavity`. Spheres in it: :mod:`.spheres`, :mod:`.wall`, :mod:`.contact`.
Whole rebounds: :mod:`.rebounds` (kept runs of the shipped cases), :mod:`.flights` (short ones, run). The
program: :mod:`.machine`. Without a grid: :mod:`.particle`, :mod:`.closures`.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from restitution.errors import Defect, InputError
from restitution.validation.row import Depth, Row


@dataclass(frozen=True)
class Setting:
    """Where kept runs are, and where they are made ``again`` (None: not), ``anew`` or gone on with."""

    runs: Path = Path("reports/runs")
    again: Path | None = None
    anew: bool = True


def kept_runs() -> Path:
    """Where runs are kept: in a checkout its ``reports/runs``, else those that are installed with the program."""
    own, installed = Setting().runs, Path(__file__).parents[2] / "_runs"
    return installed if installed.is_dir() and not own.is_dir() else own


def all_rows(setting: Setting | None = None) -> dict[str, Row]:
    """All rows by name, in their order. The solver is loaded with them."""
    from restitution.validation.rows import (
        cavity,
        closures,
        contact,
        flights,
        fluid,
        machine,
        particle,
        rebounds,
        spheres,
        wall,
    )

    modules = (fluid, cavity, spheres, wall, contact, flights, machine, particle, closures)
    every = [row for module in modules for row in module.ROWS]
    return {row.name: row for row in (*every, *rebounds.rows(setting or Setting()))}


def chosen(rows: dict[str, Row], depth: Depth, only: Iterable[str] | None = None) -> dict[str, Row]:
    """The rows of a depth, or those named; raises :class:`InputError` for a name that is none."""
    if only is None:
        return {name: row for name, row in rows.items() if row.depth in depth.includes}
    defects = []
    for name in only:
        if name not in rows:
            near = difflib.get_close_matches(name, rows, n=3, cutoff=0.4)
            hint = f"did you mean {', '.join(near)}?" if near else "restitution validate --list names them"
            defects.append(Defect(f"is no row; {hint}", field="--only", value=name))
    if defects:
        raise InputError(*defects)
    return {name: row for name, row in rows.items() if name in set(only)}
