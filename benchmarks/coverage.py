"""Do the intervals of ``restitution fit`` hold what they promise? Coverage on synthetic impacts with known truth.

Impacts of e_dry exp[-K (1 + e_dry)/St], K = 18, e_dry = 0.9, St log-uniform from 15 to 500, errors of e_eff 0.01
and quoted; both parameters are fitted. Scatter is estimated in every case but the first, since nobody knows that
there is none, and an offset wherever there are several sources. Printed are the fraction of sets whose 68 % and
95 % intervals contain the truth, and the bias over the standard deviation of the estimates; below it the fraction
of predictions that hold: of the law at a St, of one more impact of the first source, and of one of a new source.
Each set predicts four of each, at St of its own drawn like the others, free of errors of measurement.

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

from restitution.calibration import Fit, Plan, estimate, model_of, predict, result_of
from restitution.calibration.estimation.maximum import LEVELS
from restitution.calibration.estimation.plan import TYPICAL_OFFSET
from restitution.calibration.reading.observations import Observations
from restitution.calibration.result.fit_result import sources
from restitution.errors import InputError
from restitution.files import write_whole
from restitution.stokes import Speed

K, E_DRY, E_SIGMA = 18.0, 0.9, 0.01
SIZES = (10, 40)
AHEAD = 4
"""Predictions of each kind a set."""
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
    sources: int = 2
    """Where they are offset."""
    offset_drawn: bool = False
    """Each set has an ``offset`` of its own, drawn from the half-normal of this width."""


CASES = (
    Case("errors alone, known to be all", fit_scatter=False),
    Case("errors alone"),
    Case("scatter 0.03", 0.03),
    Case("errors of St 5 %", 0.0, 0.05),
    Case("scatter, errors of St", 0.03, 0.05),
    Case("scatter, no rebound seen below 0.2", 0.03, 0.0, 0.2),
    Case("scatter, two sources offset by 0.03", 0.03, 0.0, 0.0, 0.03),
    Case("all of these", 0.03, 0.05, 0.2, 0.03),
    Case("scatter, five sources offset by 0.03", 0.03, 0.0, 0.0, 0.03, sources=5),
    Case("scatter, two sources offset by 0.01", 0.03, 0.0, 0.0, 0.01),
    Case("scatter, two sources offset by 0.08", 0.03, 0.0, 0.0, 0.08),
    Case("scatter, two sources offset as known", 0.03, offset=TYPICAL_OFFSET, offset_drawn=True),
)
"""The last has offsets from the prior of the fit: an interval of the posterior that is computed rightly then holds
as often as it says, which no single offset can test."""
PREDICTED = ("law", "known source", "new source")


def law(St: np.ndarray) -> np.ndarray:
    """The truth, without scatter and offset."""
    return E_DRY * np.exp(-K * (1 + E_DRY) / St)


def draw(case: Case, n: int, seed: int) -> Observations:
    """One set of impacts."""
    return drawn(case, n, seed)[0]


def drawn(case: Case, n: int, seed: int) -> tuple[Observations, float, float]:
    """One set of impacts, the offset of its first source, and the standard deviation that it was drawn with."""
    stream = CASES.index(case) if case in CASES else len(CASES)
    rng = np.random.default_rng([stream, n, seed])
    St = np.exp(rng.uniform(np.log(15), np.log(500), n))
    source = np.arange(n) % case.sources if case.offset else np.zeros(n, int)
    e = law(St) + np.hypot(E_SIGMA, case.scatter) * rng.standard_normal(n)
    between = case.offset * abs(rng.standard_normal()) if case.offset_drawn else case.offset
    offsets = between * rng.standard_normal(case.sources)
    e += offsets[source]
    seen = St * (1 + case.St_error * rng.standard_normal(n))
    none, unknown = e < case.limit, np.full(n, np.nan)
    observations = Observations(
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
    return observations, float(offsets[0]), between


def predicted(case: Case, fit: Fit, offset: float, between: float, seed: int) -> list[list[list[int]]]:
    """How many predictions hold by what is predicted and level.

    The first source is off by ``offset``, a new one by an offset of the standard deviation ``between``.
    """
    rng = np.random.default_rng([CASES.index(case), len(fit.likelihood.observations), seed, 1])
    St = np.exp(rng.uniform(np.log(15), np.log(500), AHEAD))
    scatter = case.scatter * rng.standard_normal((2, AHEAD))
    truths = (
        law(St),
        law(St) + scatter[0] + offset,
        law(St) + scatter[1] + between * rng.standard_normal(AHEAD),
    )
    result = result_of(fit)
    known, new = (predict(result, St, source=source) for source in (sources(result)[0], None))
    bands = (new.law, known.impact, new.impact)
    return [
        [int(np.sum((ends[:, 0] <= t) & (t <= ends[:, 1]))) for ends in band.values()]
        for t, band in zip(truths, bands, strict=True)
    ]


def one(task: tuple[Case, int, int]) -> list | None:
    """Whether each interval contains the truth, by level, the estimates, and how many predictions hold; None where
    no fit was possible.
    """
    case, n, seed = task
    plan = Plan(model_of("eq4_exponential"), e_dry="free", scatter=case.fit_scatter)
    observations, offset, between = drawn(case, n, seed)
    try:
        fit = estimate(plan, observations, intervals=("K", "e_dry"))
    except InputError as error:
        print(f"{case.name}, n = {n}, set {seed}: {error}", file=sys.stderr)
        return None
    found, truths = fit.maximum, np.array([K, E_DRY])
    held = [(found.intervals[x][:2, 0] <= truths) & (truths <= found.intervals[x][:2, 1]) for x in LEVELS]
    ahead = predicted(case, fit, offset, between, seed)
    return [*(h.astype(float).tolist() for h in held), found.values[:2].tolist(), ahead]


@dataclass
class Cell:
    """Sums over the first ``sets`` sets of one case: intervals that held, errors of the estimates (K, e_dry), and
    predictions that held, by what is predicted.
    """

    case: str
    n: int
    sets: int = 0
    failed: int = 0
    held_68: tuple[int, int] = (0, 0)
    held_95: tuple[int, int] = (0, 0)
    error: tuple[float, float] = (0.0, 0.0)
    error_squared: tuple[float, float] = (0.0, 0.0)
    ahead_68: tuple[int, int, int] = (0, 0, 0)
    ahead_95: tuple[int, int, int] = (0, 0, 0)

    def add(self, results: list) -> None:
        """Take in further sets, in their order."""
        self.sets += len(results)
        self.failed += sum(r is None for r in results)
        for in_68, in_95, values, ahead in (r for r in results if r is not None):
            error = (values[0] - K, values[1] - E_DRY)
            self.held_68 = tuple(int(a + b) for a, b in zip(self.held_68, in_68, strict=True))
            self.held_95 = tuple(int(a + b) for a, b in zip(self.held_95, in_95, strict=True))
            self.error = tuple(a + b for a, b in zip(self.error, error, strict=True))
            self.error_squared = tuple(a + b**2 for a, b in zip(self.error_squared, error, strict=True))
            self.ahead_68 = tuple(a + b[0] for a, b in zip(self.ahead_68, ahead, strict=True))
            self.ahead_95 = tuple(a + b[1] for a, b in zip(self.ahead_95, ahead, strict=True))

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
        m *= AHEAD
        ahead = "; ".join(
            f"{what} {100 * a / m:.1f} / {100 * b / m:.1f}"
            for what, a, b in zip(PREDICTED, self.ahead_68, self.ahead_95, strict=True)
        )
        return (
            f"{self.case:36} {self.n:3} {self.sets:5}  {numbers}  {self.bias[0]:11.2f} {self.bias[1]:6.2f}{failed}"
            f"\n    predictions: {ahead}"
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
