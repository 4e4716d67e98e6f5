"""Task: fit a rebound law to a table of impacts, a CSV file with a row an impact.

Printed: the parameter of Legendre's law, e_eff = e_dry exp(-beta/St*), with its intervals, the scatter from impact
to impact and the offset from source to source; 35 is the value for drops and spheres in the literature.
Source: impacts in five records of steel spheres (Gondret et al. 2002, Li et al. 2012), made into a table here.
"""

import tempfile
from pathlib import Path

import pandas as pd

from restitution import datasets
from restitution.calibration import Plan, estimate, model_of, read, result_of
from restitution.impacts import find_impacts

RECORDS = ("gondret2002_st152", "li2012_drop2", "li2012_drop3", "li2012_drop5", "li2012_drop6")


def main():
    """Value and intervals of beta, and the table of impacts that it was fitted to."""
    tables = [
        find_impacts(
            datasets.load_track(name),
            datasets.resource(name).conditions,
            speed="far",
            stokes="st_star",
            record=name,
        ).table()
        for name in RECORDS
    ]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "impacts.csv"  # `restitution fit --template DIR` writes one to fill in
        pd.concat(tables).to_csv(file, index=False)
        impacts = read(file)

    result = result_of(estimate(Plan(model_of("legendre_2005")), impacts))
    print(impacts)
    print(result)
    beta = next(p for p in result.parameters if p.name == "beta")
    return {"beta": beta.value, "intervals": beta.intervals, "impacts": pd.concat(tables)}


if __name__ == "__main__":
    main()
