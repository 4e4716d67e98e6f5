"""A solver whose flights are known in closed form: parabolas between contacts, in a fluid without drag.

With the speed v before the first contact, e the same at all, and the acceleration g' towards the wall,

    D_n = 2 e^n v/g',     H_n = (e^n v)^2/(2 g'),     g' = g (rho_p - rho_f)/(rho_p + C rho_f).
"""

import csv

import numpy as np

from restitution.conditions import Conditions, Fluid, Sphere

D, RHO, RHO_P, G, V = 3e-3, 935.0, 7800.0, 9.81, 0.5
CONDITIONS = Conditions(
    fluid=Fluid(density=RHO, viscosity=0.010), sphere=Sphere(diameter=D, density=RHO_P, e_dry=0.97)
)
TOML = "[fluid]\ndensity = 935.0\nviscosity = 0.010\n[sphere]\ndiameter = 0.003\ndensity = 7800.0\ne_dry = 0.97\n"
END = 0.25
"""Time in s after the first contact up to which is flown."""


def acceleration(C):
    return G * (RHO_P - RHO) / (RHO_P + C * RHO)


def gap(e, C, time_s):
    """Gap in m; the first contact is at time 0."""
    h, begin, speed = -V * time_s, 0.0, V
    for _ in range(6):
        speed *= e
        t = time_s - begin
        h = np.where(t >= 0, speed * t - 0.5 * acceleration(C) * t**2, h)
        begin += 2 * speed / acceleration(C)
    return h


def write_track(path, time_s, gap_m):
    with path.open("w", newline="") as stream:
        rows = csv.writer(stream)
        rows.writerow(("time_s", "gap_m"))
        rows.writerows((f"{t:.7g}", f"{h:.9g}") for t, h in zip(time_s, gap_m, strict=True))


def filmed(e, C, seed, sigma=1e-5):
    """What a camera sees: a frame each 2 ms, with an error of reading."""
    rng = np.random.default_rng(seed)
    time = np.arange(-0.015, 0.16, 2e-3) + 2e-3 * rng.random()
    return time, gap(e, C, time) + sigma * rng.standard_normal(len(time))


def design(n):
    """n points of e and C, the same each time."""
    from scipy.stats import qmc

    return qmc.scale(qmc.LatinHypercube(2, rng=np.random.default_rng(3)).random(n), [0.70, 0.1], [0.86, 1.5])


def write_runs(folder, points, truth=(0.78, 0.6), seed=1):
    """A folder with a table of runs, their tracks, and the record ``filmed.csv``."""
    time = np.arange(-0.02, END, 4e-4)
    lines = ["run,e,C,record,track"]
    for k, (e, C) in enumerate(points):
        write_track(folder / f"{k}.csv", time, gap(e, C, time))
        lines.append(f"r{k},{e:.8g},{C:.8g},filmed.csv,{k}.csv")
    (folder / "runs.csv").write_text("\n".join(lines) + "\n")
    write_track(folder / "filmed.csv", *filmed(*truth, seed))
    (folder / "filmed.toml").write_text(TOML)
    return folder / "runs.csv"
