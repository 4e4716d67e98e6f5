"""How this machine is shared out among the runs of a sweep: processes, threads each, memory each."""

from __future__ import annotations

import os
from collections.abc import Iterable

from restitution.campaigns.plan import Planned
from restitution.campaigns.processes import cores
from restitution.cases.case import Case
from restitution.runs.record import RESOLVED

_OF_THE_PROGRAM = 300e6
"""Bytes of a process with the compiled solver in it; measured 210 to 280 MB."""
_BYTES_PER_CELL = {"float32": 19 * 4 * 1.3, "float64": 19 * 8 * 1.3}
"""Populations of one lattice, and a third for fields, marks and what a checkpoint holds while it is written."""


def memory_of(case: Case) -> float:
    """About how many bytes a resolved run of a case takes."""
    n = case.numerics
    quarter = 0.25 if case.quartered else 1.0
    cells = quarter * n.width_d**2 * n.height_d * n.cells_per_diameter**3
    return _OF_THE_PROGRAM + cells * _BYTES_PER_CELL[n.precision]


def shared_out(runs: Iterable[Planned], processes: int | None, threads: int) -> tuple[int, str]:
    """How many processes, asked for or as many as cores and memory allow, and a line that says so."""
    cases = [r.case for r in runs if r.model == RESOLVED and r.case.numerics is not None]
    each = max(map(memory_of, cases), default=_OF_THE_PROGRAM)
    by_cores, room = max(1, cores() // max(1, threads)), _room()
    by_memory = max(1, int(0.8 * room / each)) if room else by_cores
    count = processes or min(by_cores, by_memory)
    plural = "es" if count > 1 else ""
    told = (
        f"{count} process{plural} of {threads} thread{'s' if threads > 1 else ''}, about {each / 1e6:.0f} MB each"
    )
    if not processes and by_memory < by_cores:
        told += f" (memory for no more; {by_cores} by cores)"
    return count, told


def _room() -> float | None:
    """Bytes of memory that are free; None where the system does not say."""
    try:
        return float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (ValueError, OSError, AttributeError):
        return None
