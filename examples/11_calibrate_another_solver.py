"""Task: calibrate another solver, here an equation of motion in Python, by a table of its runs and a record.

The solver has two numbers that it does not know: the gap at which its film ends, and the added mass. The record is
the solver's own flight at known values of them, filmed every 2 ms with an error of 10 um, so that one can see that
they are found again. For a solver of your own: write the table, then `restitution calibrate-solver runs.csv`.
Printed: each number with its 95 % interval beside the true one; their correlation; what the emulator is worth.
Source: lubrication of a sphere at a wall, F = 6 pi mu r^2 v/h (Brenner 1961); drag of Schiller & Naumann 1933.
"""

import math
import tempfile
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.stats import qmc

from restitution.calibration import Reading
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.emulation import calibrate, read_runs

RHO, MU, D, RHO_P, E_DRY, G = 935.0, 0.01, 3e-3, 7800.0, 0.97, 9.81
TRUE = {"floor": 3e-7, "added_mass": 0.55}
RANGES = {"floor": (3e-8, 3e-6), "added_mass": (0.3, 0.9)}


def fly(floor, added_mass, end=0.2):
    """Time in s and gap in m, from a fall at 0.58 m/s on."""
    volume = math.pi / 6 * D**3

    def motion(_, y):
        h, v = y
        drag = 3 * math.pi * MU * D * (1 + 0.15 * (RHO * abs(v) * D / MU) ** 0.687)
        film = 6 * math.pi * MU * (D / 2) ** 2 / (max(h, 0.0) + floor) * (h < D / 2)
        return v, -((RHO_P - RHO) * volume * G + (drag + film) * v) / ((RHO_P + added_mass * RHO) * volume)

    def touch(_, y):
        return y[0]

    touch.terminal, touch.direction = True, -1
    t, h, start, y = [], [], 0.0, [9e-3, -0.58]
    while start < end - 1e-6 and len(t) < 6:
        times = np.arange(start, end, 1e-4)
        leg = solve_ivp(motion, (start, end), y, t_eval=times, events=touch, rtol=1e-7, atol=1e-10)
        t, h = [*t, leg.t[:-1]], [*h, leg.y[0][:-1]]
        start, y = (leg.t_events[0][0], [1e-9, -E_DRY * leg.y_events[0][0][1]]) if leg.status else (end, y)
    return np.concatenate(t), np.concatenate(h)


def write(path, t, h):
    """A trajectory as a table."""
    path.write_text("time_s,gap_m\n" + "".join(f"{a:.6f},{b:.8f}\n" for a, b in zip(t, h, strict=True)))


def main():
    """Median, 95 % interval and truth by name; correlation; part of unseen runs that is predicted."""
    low, high = np.array([RANGES["floor"], RANGES["added_mass"]]).T
    design = qmc.scale(qmc.Sobol(2, rng=1).random(16), [math.log(low[0]), low[1]], [math.log(high[0]), high[1]])
    with tempfile.TemporaryDirectory() as folder:
        rows, place = ["run,floor,added_mass,record,track"], Path(folder)
        for k, (ln_floor, added_mass) in enumerate(design):
            write(place / f"{k}.csv", *fly(math.exp(ln_floor), added_mass))
            rows.append(f"{k},{math.exp(ln_floor):.6g},{added_mass:.6g},filmed.csv,{k}.csv")
        (place / "runs.csv").write_text("\n".join(rows) + "\n")
        frames = np.arange(1e-3, 0.18, 2e-3)
        gap = np.interp(frames, *fly(**TRUE)) + 1e-5 * np.random.default_rng(5).standard_normal(len(frames))
        write(place / "filmed.csv", frames, gap)
        conditions = Conditions(
            fluid=Fluid(density=RHO, viscosity=MU), sphere=Sphere(diameter=D, density=RHO_P, e_dry=E_DRY)
        )
        found = calibrate(read_runs(place / "runs.csv")[0], how=Reading(conditions=conditions))
    for p in found.told:
        print(f"{p.name}: {p.median:.3g}, 95 % {p.intervals[0.95][0]:.3g} to {p.intervals[0.95][1]:.3g}", end="")
        print(f"; true {TRUE[p.name]:.3g}")
    print(f"correlation {found.correlation[0, 1]:+.2f}; unseen runs predicted: {found.used[0].predicts:.2%}")
    return {"told": {p.name: (p.median, p.intervals[0.95], TRUE[p.name]) for p in found.told}, "found": found}


if __name__ == "__main__":
    main()
