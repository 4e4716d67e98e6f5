"""What a posterior says of each parameter, and of what the solver lacks beside each record; what is doubtful."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.maximum import LEVELS
from restitution.calibration.estimation.parameters import Parameter
from restitution.doubts import Doubt
from restitution.emulation.emulated import Emulated
from restitution.emulation.held_out import Predicted
from restitution.emulation.runs_table import Runs

SAYS_NOTHING = 0.85
"""Width of the 68 % interval over that of the prior from which on the records say nothing about a parameter."""
EDGE = 0.05
"""Part of the prior's width at each end that is looked at for a best point beyond the runs."""
PRESSED = 2.5
"""Times as much probability there as in the prior from which on it is taken to lie beyond."""
_LARGE = 3.0
"""Discrepancy over the error of a reading from which on the solver does not meet a record."""
_AT_END = 0.9
"""Of the greatest discrepancy allowed, from which on it may be greater."""


@dataclass(frozen=True)
class Told:
    """What the records say of one parameter; intervals by level; ``share``: width of its 68 % over the prior's."""

    name: str
    prior: tuple[float, float]
    logarithmic: bool
    median: float
    intervals: Mapping[float, tuple[float, float]]
    share: float
    pressed: str | None
    """``low`` or ``high`` where the best values lie at that end of the runs, or beyond it."""

    @property
    def says_nothing(self) -> bool:
        """Whether the posterior is as wide as the prior."""
        return self.share > SAYS_NOTHING


@dataclass(frozen=True)
class Discrepancy:
    """Of one record: what the solver lacks, sigma_u in diameters, correlation time in ms; each median and 68 %.

    ``prior_d`` are the ends of the prior of sigma_u, uniform in the logarithm; ``runs_d`` is how far the runs lie
    apart at the frames, the root mean square of the standard deviation of their gaps.
    """

    record: str
    sigma_d: tuple[float, float, float]
    tau_ms: tuple[float, float, float]
    reading_d: float
    prior_d: tuple[float, float]
    runs_d: float

    @property
    def missed(self) -> bool:
        """Whether the solver does not meet the record at any values of its parameters."""
        return self.sigma_d[0] > _LARGE * self.reading_d

    @property
    def elsewhere(self) -> bool:
        """Whether the solver lacks more than all its parameters move it: what is wrong is none of them."""
        return self.missed and self.sigma_d[0] > self.runs_d

    @property
    def bounded(self) -> bool:
        """Whether it lies at the upper end of its prior, and may be greater."""
        return self.sigma_d[2] > _AT_END * self.prior_d[1]


def told_of(p: Parameter, draws: NDArray) -> Told:
    """What draws of a parameter say of it."""
    intervals = {
        level: tuple(map(float, np.quantile(draws, [0.5 * (1 - level), 0.5 * (1 + level)]))) for level in LEVELS
    }
    low, high = map(p.inward, p.bounds)
    inner = [p.inward(v) for v in intervals[LEVELS[0]]]
    place = (np.array([p.inward(v) for v in draws]) - low) / (high - low)
    ends = {"low": np.mean(place < EDGE), "high": np.mean(place > 1 - EDGE)}
    worst = max(ends, key=ends.__getitem__)
    return Told(
        p.name, p.bounds, p.scale == "log", float(np.median(draws)), intervals,
        float((inner[1] - inner[0]) / (LEVELS[0] * (high - low))),
        worst if ends[worst] > PRESSED * EDGE else None,
    )  # fmt: skip


def discrepancy_of(e: Emulated, unknowns: NDArray) -> Discrepancy:
    """What draws of t_1, sigma_u and tau say of a record, (n, 3)."""
    d = e.registration.d
    at = [0.5, 0.16, 0.84]
    sigma, tau = np.quantile(unknowns[:, 1] / d, at), np.quantile(1e3 * unknowns[:, 2], at)
    low, high = e.frames.nuisances[1].bounds
    gaps = e.frames.predicted(e.q, np.full(len(e.q), e.frames.touch.mean))
    apart = float(np.sqrt(np.mean(gaps.var(axis=0)))) / d
    return Discrepancy(
        e.name, tuple(map(float, sigma)), tuple(map(float, tau)), e.frames.reading / d, (low / d, high / d), apart
    )


def doubts_of(
    group: Runs, told: Sequence[Told], discrepancies: Sequence[Discrepancy], predictions: Sequence[Predicted]
) -> list[Doubt]:
    """About parameters at an end of what was run, and records that the solver does not meet."""
    doubts = []
    for t in told:
        if t.pressed:
            end, value = ("lower", t.prior[0]) if t.pressed == "low" else ("upper", t.prior[1])
            rule = (
                f"{t.name}: the best values lie at the {end} end of what was run or allowed, {value:g}, or "
                "beyond: intervals end there for want of runs; widen the design"
            )
            doubts.append(Doubt("edge", rule, group.file))
    for x in discrepancies:
        after = next(p.rms_after_d for p in predictions if p.record == x.record)
        if x.missed:
            rule = (
                f"no parameters make the solver meet the record: at the medians it is {after:.2g} d off, rms; "
                f"a reading has {x.reading_d:.2g} d; the intervals take that for noise of {x.sigma_d[0]:.2g} d "
                f"(68 %: {x.sigma_d[1]:.2g} to {x.sigma_d[2]:.2g}) and do not say what else is wrong with it"
            )
            if x.elsewhere:
                rule += f"; that is more than all the runs differ by, {x.runs_d:.2g} d: their values are no remedy"
            doubts.append(Doubt("discrepancy", rule, x.record))
        if x.bounded:
            rule = (
                f"its discrepancy lies at the greatest that is allowed, {x.prior_d[1]:.2g} d, all of a flight's "
                "height: the intervals of the parameters are too narrow; do the runs simulate this record?"
            )
            doubts.append(Doubt("bound", rule, x.record))
    return doubts
