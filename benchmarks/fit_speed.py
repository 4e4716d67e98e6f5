"""How long the fits take: maximum with intervals, leave-one-out of five laws, posterior of four parameters.

Impacts of e_dry exp[-K (1 + e_dry)/St] as in ``benchmarks.coverage``, one hundred of them, with scatter 0.03 and
errors of St of 2 %; the posterior is that of two parameters of the law, scatter and the offset of two sources.
Both the time of the processor and that on the clock are given, after imports and one fit to warm up: on a machine
that others use, the first says what the computation costs. The goals are 0.2, 10 and 20 s.

    python -m benchmarks.fit_speed
"""

from __future__ import annotations

import time
from collections.abc import Callable

from benchmarks.coverage import Case, draw
from restitution.calibration import Plan, estimate, model_of, rank
from restitution.calibration.estimation.posterior import sample

SET = Case("speed", 0.03, 0.02)
TWO_SOURCES = Case("speed, two sources", 0.03, 0.02, 0.0, 0.03)
LAWS = {
    "eq4_exponential": {},
    "eq4_exponential_over_e": {},
    "eq4_rational": {},
    "two_way_lubrication": {},
    "e_dry*exp(-(a/St)**n)": {"a": (5.0, 100.0), "n": (0.3, 3.0)},
}


def timed(what: str, goal: float, work: Callable[[], object], repeats: int = 1) -> None:
    """One line: the least of the repeats."""
    costs = []
    for _ in range(repeats):
        processor, clock = time.process_time(), time.perf_counter()
        work()
        costs.append((time.process_time() - processor, time.perf_counter() - clock))
    processor, clock = min(costs)
    print(f"{what:58} {processor:8.3f} {clock:8.3f} {goal:6.1f}", flush=True)


def main() -> None:
    one, two = (draw(case, 100, 0) for case in (SET, TWO_SOURCES))
    plan = Plan(model_of("eq4_exponential"), e_dry="free")
    plans = [(law, Plan(model_of(law, bounds, "st"), e_dry=0.9)) for law, bounds in LAWS.items()]
    estimate(plan, one)
    print(f"{'100 impacts':58} {'cpu s':>8} {'clock s':>8} {'goal':>6}")
    timed("maximum with 68 and 95 % intervals, 3 parameters", 0.2, lambda: estimate(plan, one), 5)
    timed("the same, two sources, 4 parameters", 0.2, lambda: estimate(plan, two), 5)
    timed("leave-one-out of five laws", 10.0, lambda: rank(plans, one))
    fit = estimate(plan, two)
    timed("posterior, converged, 4 parameters", 20.0, lambda: sample(fit.likelihood, fit.maximum))


if __name__ == "__main__":
    main()
