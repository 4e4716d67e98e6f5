"""The impulse that a sphere set moving at once takes from the fluid, against the exact unsteady Stokes flow.

Flow and exact solution are those of :mod:`lbm.problems.impulsive_start`. Viscosity and times are those of the
rebound at St 152 and Re 164. Means over d/c_s, for sound goes to and fro; later it comes back from the periodic
images.

    python -m benchmarks.impulsive_start
"""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from lbm.problems.impulsive_start import REYNOLDS, TIMES, exact, excess

GRIDS = ((10, 0.025), (16, 0.025), (20, 0.025), (10, 0.0125), (20, 0.0125))
"""Cells a diameter, and the lattice speed of the rebound that goes with the viscosity."""


def main() -> None:
    """Print the table."""
    table = Table("cells a diameter", "lattice speed", "viscosity", *(f"t U/d = {t:g}" for t in TIMES))
    for n, speed in GRIDS:
        row = (f"{e:+.3f}" for e in excess(n, speed))
        table.add_row(f"{n}", f"{speed:g}", f"{speed * n / REYNOLDS:.2g}", *row)
    table.add_row("exact J", "", "", *(f"{exact(4 * t / REYNOLDS):.3f}" for t in TIMES))
    Console(width=110).print(table)


if __name__ == "__main__":
    main()
