"""Tracks made by another integrator under other forces: does a fit contain the truth, or say a doubt?

    python -m benchmarks.independent_tracks [--tracks 20] [--seed 0] [--own]

Each track has its own fluid, sphere, camera and release. The sphere falls from rest from a height that the fit is
not told, under Cheng's (2009) drag, Bevan & Prieve's (2000) resistance of the wall, Lamb's added mass near it and
no history force, integrated by SciPy's DOP853; within 0.1 d no drag acts, and at the wall it is reversed with its
restitution. So e is the far one of the fits, and the rest is what another physics makes of it. The camera starts
somewhere in the fall, is in error by 10 to 30 um a frame, the scale by 1 %, the zero by 0.005 d, the clock by
anything.

``fit --trajectory`` then has its defaults. A track counts as held where the 95 % intervals of all its bounces
together (Bonferroni's) contain the truth, else as doubted where the fit doubts, as refused where it is. ``--own``
takes tracks of the model itself, drag and history as far from it as they are known, with correlated noise in every
other one: what is doubted there is doubted wrongly.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.integrate import solve_ivp
from scipy.stats import norm

from restitution.calibration.trajectories.doubts import of_records
from restitution.calibration.trajectories.fit import Measured
from restitution.calibration.trajectories.recordings import recording
from restitution.calibration.trajectories.synthetic import CONDITIONS, GAP, Filming, draw
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.errors import InputError
from restitution.tracks import Track, noise

FLUIDS = ((935.0, 0.010), (953.0, 0.020), (1203.0, 0.050), (1150.0, 0.012))
"""Density in kg/m3 and viscosity in Pa s: silicone oils, glycerol in water."""
SPHERES = (7800.0, 7780.0, 2500.0)
BOUNCES = 3
FILM_D = 0.1


@dataclass(frozen=True)
class Made:
    """A track and its truth: the restitution of each bounce, the height of release in m."""

    track: Track
    conditions: Conditions
    e: tuple[float, ...]
    height: float


def make(rng: np.random.Generator, lamb: float = 1.0) -> Made:
    """One track; ``lamb`` as in :func:`fly`."""
    density, viscosity = FLUIDS[rng.integers(len(FLUIDS))]
    d, rho = rng.uniform(3e-3, 9e-3), SPHERES[rng.integers(len(SPHERES))]
    c = Conditions(
        fluid=Fluid(density=density, viscosity=viscosity), sphere=Sphere(diameter=d, density=rho, e_dry=0.97)
    )
    height = d * rng.uniform(1.5, 5.0)
    e = tuple(np.sort(rng.uniform(0.45, 0.9, BOUNCES))[::-1])
    time, gap, contacts = fly(c, height, e, lamb)
    interval = np.sqrt(d / 9.81) / rng.uniform(8, 25)
    begin = contacts[0] * rng.uniform(0.1, 0.75)
    last = contacts[BOUNCES - 1]
    frames = np.arange(begin, last + 0.7 * (contacts[BOUNCES] - last), interval)
    sigma = rng.uniform(1e-5, 3e-5)
    seen = 0.005 * d * rng.standard_normal() + (1 + 0.01 * rng.standard_normal()) * np.interp(frames, time, gap)
    seen += sigma * rng.standard_normal(len(frames))
    frames = frames + rng.uniform(-1, 1)
    return Made(Track(frames, seen, "gap", noise(frames, seen)), c, tuple(map(float, e)), height)


def make_own(rng: np.random.Generator) -> Made:
    """One track of the model that fits it."""
    track, truth = draw(Filming(sigma_u_d=0.01 * int(rng.integers(2)), forces=True), rng)
    return Made(track, CONDITIONS, tuple(truth.e.tolist()), GAP)


def fly(
    c: Conditions, height: float, e: tuple[float, ...], lamb: float = 1.0
) -> tuple[NDArray, NDArray, list[float]]:
    """Times in s, gaps in m and contacts of a fall from rest, one flight after the last restitution included.

    (M v)' = M' v^2/2 - weight - drag, M = m + m_f/2 [1 + ``lamb`` 3/8 (r/(r + h))^3].
    """
    d, rho_f, mu = c.sphere.diameter, c.fluid.density, c.fluid.viscosity
    volume, area = np.pi * d**3 / 6, np.pi * d**2 / 4
    mass, displaced = c.sphere.density * volume, rho_f * volume
    weight = (c.sphere.density - rho_f) * volume * c.gravity

    def motion(_, y):
        h, v = y
        near = (0.5 * d / (0.5 * d + max(h, 0.0))) ** 3
        inertia = mass + displaced * 0.5 * (1 + lamb * 3 / 8 * near)
        push = 0.5 * displaced * 0.5 * lamb * 9 / 8 * near / (0.5 * d + max(h, 0.0)) * v**2 - weight
        if h < FILM_D * d:
            return [v, push / inertia]
        Re = max(rho_f * abs(v) * d / mu, 1e-9)
        C_D = 24 / Re * (1 + 0.27 * Re) ** 0.43 + 0.47 * (1 - np.exp(-0.04 * Re**0.38))
        eps = 2 * h / d
        wall = 3 * np.pi * mu * d * v * ((6 * eps**2 + 9 * eps + 2) / (6 * eps**2 + 2 * eps) - 1)
        return [v, (push - 0.5 * rho_f * C_D * area * abs(v) * v - wall) / inertia]

    def hit(_, y):
        return y[0]

    hit.terminal, hit.direction = True, -1
    t, h, v, times, gaps, contacts = 0.0, height, 0.0, [], [], []
    for restitution in (*e, 0.0):
        found = solve_ivp(motion, (t, t + 10), [h, v], "DOP853", events=hit, rtol=1e-8, atol=1e-11, max_step=5e-4)
        times.append(found.t)
        gaps.append(found.y[0])
        contacts.append(float(found.t[-1]))
        t, h, v = contacts[-1], 0.0, -restitution * found.y[1, -1]
    return np.concatenate(times), np.concatenate(gaps), contacts


@dataclass(frozen=True)
class Outcome:
    """What became of a track: held, doubted, missed or refused; the pulls of its e; doubts, or the reason."""

    verdict: str
    pulls: tuple[float, ...] = ()
    why: str = ""


def judge(made: Made, name: str = "track") -> Outcome:
    """The fit as the command does it."""
    try:
        measured = Measured.of([recording(name, made.track, made.conditions)])
    except InputError as error:
        return Outcome("refused", why=str(error))
    (t,) = measured.trajectories[measured.preferred]
    doubts = "; ".join(doubt.name for doubt in of_records([t]))
    pulls = tuple(float((m - e) / s) for (m, s), e in zip(t.restitutions, made.e, strict=False))
    reach = norm.ppf(1 - 0.025 / len(pulls))
    held = all(abs(p) <= reach for p in pulls)
    return Outcome("held" if held else "doubted" if doubts else "missed", pulls, doubts)


def main() -> None:
    """Print a row a track, and how many of each verdict."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tracks", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--free-mass", action="store_true", help="an added mass of 1/2 at any gap")
    parser.add_argument("--own", action="store_true", help="tracks of the model itself")
    args = parser.parse_args()
    table = Table("track", "verdict", "pulls of e", "doubts", "d mm", "height d", "frames")
    verdicts, doubts = [], 0
    for k in range(args.tracks):
        rng = np.random.default_rng([args.seed, k])
        made = make_own(rng) if args.own else make(rng, 0.0 if args.free_mass else 1.0)
        found = judge(made)
        verdicts.append(found.verdict)
        doubts += bool(found.why) and found.verdict != "refused"
        d = made.conditions.sphere.diameter
        table.add_row(
            str(k), found.verdict, " ".join(f"{p:+.1f}" for p in found.pulls), found.why, f"{1e3 * d:.1f}",
            f"{made.height / d:.1f}", str(len(made.track.time_s)),
        )  # fmt: skip
    console = Console(width=150)
    console.print(table)
    told = ", ".join(f"{v}: {verdicts.count(v)}" for v in dict.fromkeys(verdicts))
    console.print(f"{told}; with a doubt: {doubts}")


if __name__ == "__main__":
    main()
