"""Do the intervals of ``restitution fit`` hold what they promise? Coverage on synthetic impacts with known truth.

Impacts of e_dry exp[-K (1 + e_dry)/St], K = 18, e_dry = 0.9, St log-uniform from 15 to 500, errors of e_eff 0.01
and quoted; both parameters are fitted. Scatter is estimated in every case but the first, since nobody knows that
there is none, and an offset wherever there are two sources. Printed are the fraction of sets whose 68 % and 95 %
intervals contain the truth, and the bias over the standard deviation of the estimates.

    python -m benchmarks.coverage [--sets 200] [--processes 1] [--out benchmarks/coverage.json]
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import asdict, dataclass
from multiprocessing import Pool
from pathlib import Path

import numpy as np

from restitution.calibration.fitting import estimate
from restitution.calibration.maximum import LEVELS
from restitution.calibration.observations import Observations
from restitution.calibration.plan import Plan
from restitution.calibration.rebound_model import model_of
from restitution.errors import InputError
from restitution.stokes import Speed

K, E_DRY, E_SIGMA = 18.0, 0.9, 0.01


@dataclass(frozen=True)
class Case:
    """What the impacts suffer from: ``limit`` is the e_eff below which no rebound is seen."""

    name: str
    scatter: float = 0.0
    St_error: float = 0.0
    limit: float = 0.0
    offset: float = 0.0
    fit_scatter: bool = True


CASES = (
    Case("errors alone, known to be all", fit_scatter=False),
    Case("errors alone"),
    Case("scatter 0.03", 0.03),
    Case("errors of St 5 %", 0.0, 0.05),
    Case("scatter, errors of St", 0.03, 0.05),
    Case("scatter, no rebound seen below 0.2", 0.03, 0.0, 0.2),
    Case("scatter, two sources offset by 0.03", 0.03, 0.0, 0.0, 0.03),
    Case("all of these", 0.03, 0.05, 0.2, 0.03),
)


def draw(case: Case, n: int, seed: int) -> Observations:
    """One set; every set has its own stream of random numbers."""
    stream = CASES.index(case) if case in CASES else len(CASES)
    rng = np.random.default_rng([stream, n, seed])
    St = np.exp(rng.uniform(np.log(15), np.log(500), n))
    source = np.arange(n) % 2 if case.offset else np.zeros(n, int)
    e = E_DRY * np.exp(-K * (1 + E_DRY) / St) + np.hypot(E_SIGMA, case.scatter) * rng.standard_normal(n)
    e += case.offset * rng.standard_normal(2)[source]
    seen = St * (1 + case.St_error * rng.standard_normal(n))
    none, unknown = e < case.limit, np.full(n, np.nan)
    return Observations(
        St=seen,
        St_sigma=case.St_error * seen,
        e=np.where(none, np.nan, e),
        e_sigma=np.full(n, E_SIGMA),
        correlation=np.zeros(n),
        upper=np.where(none, case.limit, np.nan),
        e_dry=unknown,
        e_dry_sigma=unknown,
        labels={"source": np.array([f"source {s}" for s in source], object)},
        convention="st",
        speed=Speed.FAR,
        conditions=(None,) * n,
    )


def one(task: tuple[Case, int, int]) -> list[list[float]] | None:
    """Estimate, and whether each interval contains the truth; None where no fit was possible."""
    case, n, seed = task
    plan = Plan(model_of("eq4_exponential"), e_dry="free", scatter=case.fit_scatter)
    try:
        found = estimate(plan, draw(case, n, seed)).maximum
    except InputError as error:
        print(f"{case.name}, n = {n}, set {seed}: {error}", file=sys.stderr)
        return None
    held = [
        [
            bool(low <= truth <= high)
            for truth, (low, high) in zip((K, E_DRY), found.intervals[level], strict=False)
        ]
        for level in LEVELS
    ]
    return [*held, found.values[:2].tolist()]


def measure(case: Case, n: int, sets: int, pool) -> dict:
    """Coverage and bias of one case."""
    results = [r for r in pool.map(one, [(case, n, seed) for seed in range(sets)], chunksize=5) if r is not None]
    held = np.array([r[:-1] for r in results], float)
    values = np.array([r[-1] for r in results])
    spread = values.std(axis=0, ddof=1)
    return {
        "case": asdict(case),
        "n": n,
        "sets": len(results),
        "failed": sets - len(results),
        "coverage": {f"{level:.0%}": held[:, i].mean(axis=0).tolist() for i, level in enumerate(LEVELS)},
        "bias_over_spread": ((values.mean(axis=0) - (K, E_DRY)) / spread).tolist(),
        "spread": spread.tolist(),
    }


def show(row: dict) -> None:
    """One line of the table."""
    (a, b), (c, d), (e, f) = *row["coverage"].values(), row["bias_over_spread"]
    cover = f"{100 * a:11.1f} {100 * b:6.1f}  {100 * c:11.1f} {100 * d:6.1f}  {e:11.2f} {f:6.2f}"
    failed = f"  ({row['failed']} not fitted)" if row["failed"] else ""
    print(f"{row['case']['name']:36} {row['n']:3}  {cover}{failed}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sets", type=int, default=200)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--out", default=None)
    args = parser.parse_args()
    start, rows = time.perf_counter(), []
    print(
        f"{args.sets} sets each; one percentage is uncertain by about {50 / np.sqrt(args.sets) * 0.93:.1f} (68 %)"
    )
    heads = "  ".join(f"{head:>5} {'K':>5} {'e_dry':>6}" for head in ("68 %:", "95 %:", "bias:"))
    print(f"{'case':36} {'n':>3}  {heads}")
    with Pool(args.processes) as pool:
        for case in CASES:
            for n in (10, 40):
                row = measure(case, n, args.sets, pool)
                rows.append(row)
                show(row)
    print(f"{time.perf_counter() - start:.0f} s")
    if args.out:
        Path(args.out).write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
