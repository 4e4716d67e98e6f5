"""Do the intervals of ``restitution fit --trajectory`` hold what they promise? Synthetic records with known truth.

A 3 mm steel sphere in oil falls steadily from 9 mm and bounces with the e of ``eq4_exponential``, K = 11, plus, in
one case, a scatter from bounce to bounce. It is filmed every 2 ms until some time after its third bounce: with an
error of 10 um a frame, every twentieth frame missing, the zero of the gap and the scale of the image wrong by
0.005 d and 1 %, the clock starting anywhere, and in some cases correlated noise. The model that makes the records
fits them; what a wrong model does is not in it. Printed are the fractions of sets whose 68 % and 95 % intervals
contain the truth: of K, of all restitutions together, and of scale, start and clock together.

    python -m benchmarks.coverage_trajectory [--sets 100] [--out benchmarks/coverage_trajectory.json]
"""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from restitution import laws
from restitution.bounce import Closures, OwnWake, Release, bounce
from restitution.calibration.correlated_noise import draw as draw_noise
from restitution.calibration.impact_table import Reading
from restitution.calibration.maximum import LEVELS
from restitution.calibration.plan import Plan
from restitution.calibration.rebound_model import model_of
from restitution.calibration.recordings import Recording, recording
from restitution.calibration.trajectory_fit import law_fit, observations
from restitution.calibration.whole_trajectories import whole_trajectory
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.stokes import StokesNumber
from restitution.tracks import Track

K, SPEED, GAP, SIGMA, INTERVAL = 11.0, 0.58, 9e-3, 1e-5, 2e-3
CONDITIONS = Conditions(
    fluid=Fluid(density=935.0, viscosity=0.010), sphere=Sphere(diameter=3e-3, density=7800.0, e_dry=0.97)
)
BOUNCES = 3


@dataclass(frozen=True)
class Case:
    """What the frames suffer from: correlated noise of ``sigma_u_d`` diameters over ``tau_s``; scatter of e."""

    name: str
    sigma_u_d: float = 0.0
    tau_s: float = 0.02
    scatter: float = 0.0
    wake: bool = False


CASES = (
    Case("errors of reading alone"),
    Case("correlated noise", 0.01),
    Case("correlated noise, slow, wake", 0.02, 0.06, 0.0, True),
    Case("correlated noise, scatter of e", 0.01, 0.02, 0.03),
)


@dataclass(frozen=True)
class Truth:
    """What a set was made with."""

    e: np.ndarray
    speed: float
    scale: float
    contact_s: float


def draw(case: Case, seed: int, conditions: Conditions = CONDITIONS) -> tuple[Track, Truth]:
    """One record; every set has its own stream of random numbers."""
    rng = np.random.default_rng([CASES.index(case) if case in CASES else len(CASES), seed])
    d, law = conditions.sphere.diameter, laws.get("eq4_exponential", K=K)
    speed, wake = SPEED * (1 + 0.02 * rng.standard_normal()), OwnWake() if case.wake else None
    release, e = Release(GAP, speed, developed=True), []
    for _ in range(BOUNCES):  # each impact speed follows from the bounces before it
        path = bounce(conditions, release, Closures(measured=(*e, 0.5), wake=wake), 1.0)
        St = StokesNumber.from_speed(path.impacts[len(e)].v_in, conditions)
        e.append(float(law(St, conditions.sphere.e_dry)) + case.scatter * rng.standard_normal())
    path = bounce(conditions, release, Closures(measured=tuple(e), wake=wake), 1.0)
    last = path.impacts[BOUNCES - 1].time_s
    own = np.arange(rng.uniform(0, INTERVAL), last + 0.6 * (path.impacts[BOUNCES].time_s - last), INTERVAL)
    own = own[rng.random(len(own)) > 0.05]
    scale, begin = 1 + 0.01 * rng.standard_normal(), rng.uniform(-0.1, 0.1)
    gap = 0.005 * d * rng.standard_normal() + scale * path.gap(own)
    gap += draw_noise(own, SIGMA, case.sigma_u_d * d, case.tau_s, rng)
    contact = path.impacts[0].time_s
    # The speed that the fit has is the one at its own first frame.
    own_speed = -float(path.velocity(own[0]))
    return Track(begin + own, gap, "gap", SIGMA), Truth(np.array(e), own_speed, scale, begin + contact)


def filmed(track: Track, conditions: Conditions = CONDITIONS) -> Recording:
    """The record as the fit reads it."""
    return recording("synthetic", track, conditions)


def one(case: Case, seed: int) -> dict[str, list]:
    """Whether each interval contains the truth, by level: of K, of each e, of scale, start and clock."""
    track, truth = draw(case, seed)
    found = whole_trajectory(filmed(track), case.wake)
    plan = Plan(model_of("eq4_exponential"), scatter=case.scatter > 0)
    fit = law_fit(plan, observations([found], Reading()))
    pulls = dict(zip(found.names, (found.mean - _true(found.names, truth)) / found.sigma, strict=True))
    e = [pulls[n] for n in found.names if n.startswith("e_")]
    other = [pulls[n] for n in found.names if n in ("scale", "contact_time_s", "release_speed_m_s")]
    held = {"K": [], "e": [], "other": []}
    for level in LEVELS:
        low, high = fit.maximum.intervals[level][0]
        held["K"].append([bool(low <= K <= high)])
        reach = math.sqrt(2) * _erfinv(level)
        held["e"].append([bool(abs(p) <= reach) for p in e])
        held["other"].append([bool(abs(p) <= reach) for p in other])
    return held | {"value": [float(fit.maximum.values[0])], "pulls": [float(p) for p in e]}


def _erfinv(level: float) -> float:
    from scipy.special import erfinv

    return float(erfinv(level))


def _true(names: tuple[str, ...], truth: Truth) -> np.ndarray:
    known = {"scale": truth.scale, "contact_time_s": truth.contact_s, "release_speed_m_s": truth.speed}
    known |= {f"e_{n + 1}": e for n, e in enumerate(truth.e)}
    return np.array([known.get(name, np.nan) for name in names])


def measure(case: Case, sets: int) -> dict:
    """Coverage of one case."""
    results = [one(case, seed) for seed in range(sets)]
    row: dict = {"case": asdict(case), "sets": sets}
    for what in ("K", "e", "other"):
        held = [np.concatenate([r[what][i] for r in results]) for i in range(len(LEVELS))]
        row[what] = {f"{level:.0%}": float(np.mean(h)) for level, h in zip(LEVELS, held, strict=True)}
        row[what]["intervals"] = len(held[0])
    values = np.array([r["value"][0] for r in results])
    row["K_mean"], row["K_spread"] = float(values.mean()), float(values.std(ddof=1))
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--out", default=None)
    args = parser.parse_args()
    rows = []
    print(f"{args.sets} sets each; one percentage of K is uncertain by about {47 / np.sqrt(args.sets):.1f} (68 %)")
    print(f"{'case':36} {'K: 68 %':>8} {'95 %':>6} {'e: 68 %':>9} {'95 %':>6} {'other: 68 %':>12} {'95 %':>6}")
    for case in CASES:
        row = measure(case, args.sets)
        rows.append(row)
        cover = [100 * row[what][level] for what in ("K", "e", "other") for level in ("68%", "95%")]
        print("{:36} {:8.1f} {:6.1f} {:9.1f} {:6.1f} {:12.1f} {:6.1f}".format(case.name, *cover), flush=True)
    if args.out:
        Path(args.out).write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
