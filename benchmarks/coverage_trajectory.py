"""Do the intervals of ``restitution fit --trajectory`` hold what they promise? Synthetic records with known truth.

The records are those of :mod:`restitution.calibration.trajectories.synthetic`, under four sorts of noise. The
model that makes them fits them, drag, history and wake as far off as they are known; what another model does is in
:mod:`benchmarks.independent_tracks`. Printed are the fractions of sets whose 68 %
and 95 % intervals contain the truth: of K, of all restitutions together, and of scale, start and clock together.

    python -m benchmarks.coverage_trajectory [--sets 100] [--out benchmarks/coverage_trajectory.json]
"""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import asdict
from pathlib import Path

import numpy as np

from restitution.calibration import Plan, model_of
from restitution.calibration.estimation.maximum import LEVELS
from restitution.calibration.reading.reading import Reading
from restitution.calibration.trajectories.fit import law_fit, observations
from restitution.calibration.trajectories.synthetic import Filming, K, draw, filmed
from restitution.calibration.trajectories.whole_trajectories import whole_trajectory

CASES = (
    Filming("errors of reading alone", forces=True),
    Filming("correlated noise", 0.01, forces=True),
    Filming("correlated noise, slow, wake", 0.02, 0.06, 0.0, True, True),
    Filming("correlated noise, scatter of e", 0.01, 0.02, 0.03, forces=True),
)


def one(case: Filming, seed: int) -> dict[str, list]:
    """Whether each interval contains the truth, by level: of K, of each e, of scale, start and clock."""
    track, truth = draw(case, np.random.default_rng([CASES.index(case), seed]))
    found = whole_trajectory(filmed(track), case.wake)
    plan = Plan(model_of("eq4_exponential"), scatter=case.scatter > 0)
    fit = law_fit(plan, observations([found], Reading()))
    e = [(mean - true) / sigma for (mean, sigma), true in zip(found.restitutions, truth.e, strict=False)]
    known = {"scale": truth.scale, "contact_time_s": truth.contact_s, "release_speed_m_s": truth.speed}
    other = [(mean - known[n]) / sigma for n, (mean, sigma) in found.unknowns.items() if n in known]
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


def measure(case: Filming, sets: int) -> dict:
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
