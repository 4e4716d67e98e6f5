"""First rebounds of the committed sweeps as one tidy table, which the Fig. 1 report draws and fits.

    for s in ratio_8 ratio_8_fast ratio_2.5 ratio_2.5_fast ratio_1.5 ratio_1.5_fast; do
        restitution sweep reports/rebounds/$s.toml --out build/rebounds/$s
    done
    python -m benchmarks.simulated_rebounds build/rebounds/*

A row a run and definition of speed, in the columns of the impact table and before them density ratio, St of the
drive, cells a diameter and rates; a run that diverged has one row, whose outcome says so.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import pandas as pd

from restitution import datasets
from restitution.campaigns.manifest import FINISHED, Manifest
from restitution.campaigns.plan import RUNS, read_plan
from restitution.runs.record import read_record

OUT = Path("reports/rebounds/rebounds.csv")
OF_THE_RUN = ("density_ratio", "stokes_of_drive", "cells_per_diameter", "rates")


def rows_of(folder: Path) -> list[dict]:
    """Rows of all runs of a sweep that are over."""
    manifest, rows, lost = Manifest(folder), [], []
    common: dict[str, object] = {}
    for run in read_plan(folder):
        standing, place = manifest.of(run.run), folder / RUNS / run.run
        told = {
            "stokes_of_drive": run.parameters["St"],
            "cells_per_diameter": run.parameters["numerics.cells_per_diameter"],
        }
        if standing.over and standing.state != FINISHED:
            lost.append(told | {"outcome": standing.state, "e_dry": run.parameters["sphere.e_dry"]})
        elif standing.over:
            case = read_record(place).case_as_run
            common = {
                "density_ratio": case["sphere"]["density"] / case["fluid"]["density"],
                "rates": case["numerics"]["rates"],
            }
            impacts = pd.read_csv(place / "impacts.csv")
            rows += [common | told | row for row in impacts[impacts.impact == 1].to_dict("records")]
    return rows + [common | row for row in lost]


def main() -> None:
    """Write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path, metavar="SWEEP")
    parser.add_argument("--out", type=Path, default=OUT)
    args = parser.parse_args()
    columns = [*OF_THE_RUN, *datasets.schema("impact").columns]
    table = pd.DataFrame([row for folder in args.folders for row in rows_of(folder)], columns=columns)
    order = [*OF_THE_RUN, "e_dry", "speed_definition"]
    table.sort_values(order).to_csv(args.out, index=False, float_format="%.6g", lineterminator="\n")


if __name__ == "__main__":
    main()
