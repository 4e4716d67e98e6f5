"""What the edge of the film does to an e_eff: e of every recorded bounce, and K of Eq. (4), by edge.

    python -m benchmarks.film_edges
    python -m benchmarks.film_edges --write

prints the restitutions of all shipped records by whole trajectories, at each edge under the model, with the wake
of the approach or without, that the frames of the record prefer; and K of ``eq4_exponential`` fitted to all
records, and to all but one, so that a record can be scored by a law that has not seen it. ``--write`` keeps the
restitutions where runs with ``measured = "record"`` take them from (:mod:`restitution.runs.measured`).
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from rich.console import Console
from rich.table import Table

from restitution.calibration.estimation.plan import Plan
from restitution.calibration.estimation.rebound_model import model_of
from restitution.calibration.reading.reading import Reading
from restitution.calibration.result.fit_result import result_of
from restitution.calibration.trajectories import Measured, read_recordings
from restitution.calibration.trajectories.fit import law_fit, observations
from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory
from restitution.files import write_whole
from restitution.runs.measured import RESTITUTIONS
from restitution.tables.writing import rows_text

EDGES = (0.05, 0.1, 0.15, 0.2, 0.3)
"""In diameters."""
RECORDS = ("gondret2002_st152", "gondret2002_st27", *(f"li2012_drop{n}" for n in (1, 2, 3, 5, 6)))
LAW = "eq4_exponential"
HEADS = ("record", "film_edge_d", "wake", "ln_evidence", "impact", "e_eff", "e_eff_sigma")


def own_model(measured: Measured, record: str) -> WholeTrajectory:
    """The trajectory of a record under the model that its own frames prefer."""
    both = [t for found in measured.trajectories.values() for t in found if t.recording.name == record]
    return max(both, key=lambda t: t.log_evidence)


def restitutions(everything: list[Measured]) -> Iterator[tuple]:
    """A row a bounce, under :data:`HEADS`."""
    for measured in everything:
        for t in (t for found in measured.trajectories.values() for t in found):
            for n, (e, sigma) in enumerate(t.restitutions, 1):
                about = t.recording.name, f"{t.edge:g}", int(t.wake), f"{t.log_evidence:.2f}"
                yield *about, n, f"{e:.4f}", f"{sigma:.4f}"


def constant(measured: Measured, wake: bool) -> str:
    """K with its 68 % interval, and how many rebounds it is of."""
    o = observations(measured.trajectories[wake], Reading())
    result = result_of(law_fit(Plan(model_of(LAW)), o))
    low, high = result.parameters[0].intervals["68%"]
    return f"{result.values['K']:.2f} ({low:.2f} to {high:.2f}; {result.goodness.measured})"


def by_edge(everything: list[Measured]) -> Table:
    """K at each edge, of all records and of all but one; with what the frames prefer marked."""
    made = Table(title=f"K of {LAW}: value (68 %; rebounds), by edge; * the model that the frames prefer")
    for column in ("records", "wake", *(f"{m.edge:g} d" for m in everything)):
        made.add_column(column)
    for left_out in (None, *RECORDS):
        sets = [m.without(() if left_out is None else (left_out,)) for m in everything]
        for wake in (False, True):
            cells = (constant(m, wake) + ("*" if m.preferred == wake else "") for m in sets)
            made.add_row(f"without {left_out}" if left_out else "all", "yes" if wake else "no", *cells)
    return made


def e_by_edge(everything: list[Measured]) -> Table:
    """The restitutions of every record, by edge."""
    made = Table(title="e of each bounce, by edge; w: with the wake of the approach; (): within the film")
    for column in ("record", *(f"{m.edge:g} d" for m in everything)):
        made.add_column(column)
    for record in RECORDS:
        cells = []
        for t in (own_model(m, record) for m in everything):
            shown = [
                f"{e:.3f} ± {s:.3f}" if out else f"({e:.3f})"
                for (e, s), out in zip(t.restitutions, t.outside(), strict=True)
            ]
            cells.append(", ".join(shown) + (" w" if t.wake else ""))
        made.add_row(record, *cells)
    return made


def main() -> None:
    """Print both tables; keep the restitutions where asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help=f"write {RESTITUTIONS.name}")
    arguments = parser.parse_args()
    records = read_recordings(RECORDS, Reading())
    everything = [Measured.of(records, edge=edge) for edge in EDGES]
    if arguments.write:
        write_whole(RESTITUTIONS, rows_text(HEADS, restitutions(everything)))
    console = Console(width=200)
    console.print(e_by_edge(everything))
    console.print(by_edge(everything))


if __name__ == "__main__":
    main()
