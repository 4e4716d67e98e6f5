"""Task: calibrate another solver by a table of its runs and a record.

The solver here is flights without drag between contacts, with two numbers that it does not know: e, the same at
all contacts, and the added mass. The record is its own flight at known values, filmed every 2 ms with an error of
10 um, so that one can see that they are found. For a solver of your own: `restitution calibrate-solver runs.csv`.
Printed: each number with its 95 % interval beside the true one; their correlation.
Source: free fall with added mass, g (rho_p - rho)/(rho_p + C rho); oil and sphere of Gondret et al. 2002.
"""

import tempfile
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from restitution.calibration import Reading
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.emulation import calibrate, read_runs

TRUE, LOW, HIGH = {"e": 0.78, "added_mass": 0.6}, (0.70, 0.1), (0.86, 1.5)
OIL = Conditions(fluid=Fluid(density=935, viscosity=0.01), sphere=Sphere(diameter=3e-3, density=7800, e_dry=0.97))


def fly(t, e, added_mass, speed=0.5):
    """Gap in m at times in s after the first contact."""
    g = 9.81 * (7800 - 935) / (7800 + added_mass * 935)
    h, begin = -speed * t, 0.0
    for _ in range(6):
        speed *= e
        h = np.where(t >= begin, speed * (t - begin) - 0.5 * g * (t - begin) ** 2, h)
        begin += 2 * speed / g
    return h


def write(path, t, h):
    """A trajectory as a table."""
    np.savetxt(path, np.c_[t, h], fmt="%.9g", delimiter=",", header="time_s,gap_m", comments="")


def main():
    """Median, 95 % interval and truth by name."""
    with tempfile.TemporaryDirectory() as folder:
        place, rows = Path(folder), ["run,e,added_mass,record,track"]
        for k, (e, C) in enumerate(qmc.scale(qmc.Sobol(2, rng=1).random(16), LOW, HIGH)):
            t = np.arange(-0.02, 0.25, 4e-4)
            write(place / f"{k}.csv", t, fly(t, e, C))
            rows.append(f"{k},{e:.9g},{C:.9g},filmed.csv,{k}.csv")
        (place / "runs.csv").write_text("\n".join(rows) + "\n")
        t = np.arange(-0.0143, 0.16, 2e-3)
        write(place / "filmed.csv", t, fly(t, **TRUE) + 1e-5 * np.random.default_rng(5).standard_normal(len(t)))
        found = calibrate(read_runs(place / "runs.csv")[0], how=Reading(conditions=OIL))
    for p in found.told:
        low, high = p.intervals[0.95]
        print(f"{p.name}: {p.median:.4g}, 95 % {low:.4g} to {high:.4g}; true {TRUE[p.name]:.4g}")
    print(f"correlation {found.correlation[0, 1]:+.2f}")
    return {p.name: (*p.intervals[0.95], TRUE[p.name]) for p in found.told}


if __name__ == "__main__":
    main()
