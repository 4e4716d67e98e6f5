"""The elastohydrodynamic rebound solved from its equations (:mod:`restitution.laws.ehd_solution`), beside the
table.

python -m benchmarks.ehd_rebound
"""

from __future__ import annotations

from rich.console import Console
from rich.progress import track
from rich.table import Table

from restitution.laws.ehd_solution import rebound
from restitution.laws.elastohydrodynamic import NODES_E, NODES_ST


def main(n: int = 200) -> None:
    """Print the rebounds of the table on n and 2 n intervals."""
    table = Table(title=f"e and least film/D* on {n} and {2 * n} intervals, e extrapolated at second order")
    for name in ("St", f"e, {n}", f"e, {2 * n}", "e", "table", "e - table", f"film, {n}", f"film, {2 * n}"):
        table.add_column(name, justify="right")
    for St, tabulated in zip(track(NODES_ST, console=Console(stderr=True)), NODES_E, strict=True):
        coarse, fine = rebound(St, n), rebound(St, 2 * n)
        limit = fine.V + (fine.V - coarse.V) / 3
        values = f"{coarse.V:.5f} {fine.V:.5f} {limit:.5f} {tabulated:.3f} {limit - tabulated:+.4f}"
        table.add_row(f"{St:g}", *values.split(), f"{coarse.film:.5f}", f"{fine.film:.5f}")
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
