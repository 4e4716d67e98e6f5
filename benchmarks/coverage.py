"""Do the intervals of ``restitution fit`` hold what they promise? Coverage on synthetic impacts with known truth.

Impacts of e_dry exp[-K (1 + e_dry)/St], K = 18, e_dry = 0.9, St log-uniform from 15 to 500, errors of e_eff 0.01
and quoted; both parameters are fitted. Scatter is estimated in every case but the first, since nobody knows that
there is none, and an offset wherever there are two sources. Printed are the fraction of sets whose 68 % and 95 %
intervals contain the truth, and the bias over the standard deviation of the estimates.

Each set has its own stream of random numbers. What was measured is kept in ``benchmarks/coverage.json`` as sums,
and a run adds the sets that are missing there: a long run may be stopped, and a longer one goes on.

    python -m benchmarks.coverage [--sets 200] [--only TEXT] [--n 10] [--processes 1]
"""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, dataclass
from multiprocessing import Pool
from pathlib import Path

import numpy as np

from restitution.calibration import Plan, estimate, model_of
from restitution.calibration.estimation.maximum import LEVELS
from restitution.calibration.reading.observations import Observations
from restitution.errors import InputError
from restitution.files import write_whole
from restitution.stokes import Speed

K, E_DRY, E_SIGMA = 18.0, 0.9, 0.01
SIZES = (10, 40)
OUT = Path(__file__).with_name("coverage.json")


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
    """One set of impacts."""
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
    """Whether each interval contains the truth, by level, and the estimates; None where no fit was possible."""
    case, n, seed = task
    plan = Plan(model_of("eq4_exponential"), e_dry="free", scatter=case.fit_scatter)
    try:
        found = estimate(plan, draw(case, n, seed), intervals=("K", "e_dry")).maximum
    except InputError as error:
        print(f"{case.name}, n = {n}, set {seed}: {error}", file=sys.stderr)
        return None
    truths = np.array([K, E_DRY])
    held = [(found.intervals[x][:2, 0] <= truths) & (truths <= found.intervals[x][:2, 1]) for x in LEVELS]
    return [*(h.astype(float).tolist() for h in held), found.values[:2].tolist()]


@dataclass
class Cell:
    """Sums over the first ``sets`` sets of one case: intervals that held, errors of the estimates (K, e_dry)."""

    case: str
    n: int
    sets: int = 0
    failed: int = 0
    held_68: tuple[int, int] = (0, 0)
    held_95: tuple[int, int] = (0, 0)
    error: tuple[float, float] = (0.0, 0.0)
    error_squared: tuple[float, float] = (0.0, 0.0)

    def add(self, results: list) -> None:
        """Take in further sets, in their order."""
        self.sets += len(results)
        self.failed += sum(r is None for r in results)
        for in_68, in_95, values in (r for r in results if r is not None):
            error = (values[0] - K, values[1] - E_DRY)
            self.held_68 = tuple(int(a + b) for a, b in zip(self.held_68, in_68, strict=True))
            self.held_95 = tuple(int(a + b) for a, b in zip(self.held_95, in_95, strict=True))
            self.error = tuple(a + b for a, b in zip(self.error, error, strict=True))
            self.error_squared = tuple(a + b**2 for a, b in zip(self.error_squared, error, strict=True))

    @property
    def bias(self) -> list[float]:
        """Mean error over the standard deviation of the estimates."""
        m = self.sets - self.failed
        mean, square = np.array(self.error) / m, np.array(self.error_squared)
        return (mean / np.sqrt((square - m * mean**2) / (m - 1))).tolist()

    def line(self) -> str:
        """One line of the table."""
        m = self.sets - self.failed
        percent = [100 * x / m for x in (*self.held_68, *self.held_95)]
        numbers = f"{percent[0]:11.1f} {percent[1]:6.1f}  {percent[2]:11.1f} {percent[3]:6.1f}"
        failed = f"  ({self.failed} not fitted)" if self.failed else ""
        return (
            f"{self.case:36} {self.n:3} {self.sets:5}  {numbers}  {self.bias[0]:11.2f} {self.bias[1]:6.2f}{failed}"
        )


def read_cells(path: Path) -> dict[tuple[str, int], Cell]:
    """What was measured before, by case and number of impacts."""
    rows = json.loads(path.read_text()) if path.exists() else []
    cells = [Cell(**{k: tuple(v) if isinstance(v, list) else v for k, v in row.items()}) for row in rows]
    return {(cell.case, cell.n): cell for cell in cells}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sets", type=int, default=200)
    parser.add_argument("--only", default="", help="cases whose name contains this")
    parser.add_argument("--n", type=int, choices=SIZES, help="this number of impacts alone")
    parser.add_argument("--processes", type=int, default=1)
    args = parser.parse_args()
    cells = read_cells(OUT)
    heads = "  ".join(f"{head:>5} {'K':>5} {'e_dry':>6}" for head in ("68 %:", "95 %:", "bias:"))
    print(f"{'case':36} {'n':>3} {'sets':>5}  {heads}")
    with Pool(args.processes) as pool:
        for case in CASES:
            for n in SIZES if args.n is None else (args.n,):
                cell = cells.setdefault((case.name, n), Cell(case.name, n))
                if args.only in case.name and cell.sets < args.sets:
                    tasks = [(case, n, seed) for seed in range(cell.sets, args.sets)]
                    cell.add(pool.map(one, tasks, chunksize=5))
                    write_whole(OUT, json.dumps([asdict(c) for c in cells.values() if c.sets], indent=1) + "\n")
                if cell.sets:
                    print(cell.line(), flush=True)


if __name__ == "__main__":
    main()
