"""Task: the impacts in the track of a camera, a CSV file of time and gap.

Printed: of each impact the speed, the Stokes number and e_eff with its error, and the times between contacts.
Source: steel sphere of 3 mm in silicone oil, Gondret, Lance & Petit, Phys. Fluids 14 (2002) 643, Fig. 2; the
shipped record is written to a file as one's own camera would have it.
"""

import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from restitution import datasets
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.impacts import find_impacts
from restitution.tracks import Track


def main():
    """Columns of the table of impacts, those that rebound."""
    conditions = Conditions(
        fluid=Fluid(density=935, viscosity=0.01),  # kg/m3, Pa s
        sphere=Sphere(diameter=3e-3, density=7800, e_dry=0.97),  # m, kg/m3
    )
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "track.csv"  # time_s, and gap_m: of the lowest point, not of the centre
        datasets.load("gondret2002_st152").to_csv(file, index=False)
        track = Track.from_table(pd.read_csv(file))

    impacts = find_impacts(track, conditions, speed="far")  # speeds of the motion outside the film
    table = impacts.table().query("outcome == 'rebound'")
    for row in table.itertuples():
        print(
            f"{row.impact}: {1e3 * row.time_s:6.2f} ms, {row.impact_speed_m_s:.3f} m/s, St {row.stokes:5.1f}, "
            f"e_eff {row.e_eff:.2f} +- {row.e_eff_sigma:.2f}"
        )
    print("ms from contact to contact:", (1e3 * np.diff(table.time_s)).round(1))
    print(*impacts.notes, sep="\n")
    columns = ("time_s", "impact_speed_m_s", "stokes", "e_eff", "e_eff_sigma")
    return {name: table[name].to_numpy(float) for name in columns}


if __name__ == "__main__":
    main()
