r"""The parameters of a solver by its runs and measured records: posterior, what it says, what is doubtful.

    p(theta, t_1, sigma_u, tau | frames) ~ prior(theta) prod p(frames | theta, ...) prior(t_1, sigma_u, tau),

the product over the records, with the likelihood of :mod:`.likelihood` and a prior of theta that is uniform (in
the logarithm where the runs lie more evenly so) within the runs, or what narrower range is given. Where it
starts is found by the cross-entropy method (Rubinstein, Methodol. Comput. Appl. Probab. 1 (1999) 127), then
emcee walks (:mod:`restitution.calibration.estimation.posterior`); all seeds are fixed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.maximum import Maximum
from restitution.calibration.estimation.parameters import Flat, Parameter, log_prior
from restitution.calibration.estimation.posterior import Posterior, sample
from restitution.calibration.reading.reading import Reading
from restitution.doubts import Doubt
from restitution.emulation.emulated import Emulated, read_all
from restitution.emulation.held_out import Predicted, predicted
from restitution.emulation.runs_table import Runs
from restitution.emulation.told import Discrepancy, Told, discrepancy_of, doubts_of, told_of
from restitution.errors import Defect, InputError

Bounds = Mapping[str, tuple[float, float]]

_ROUNDS, _POINTS, _BEST = 25, 400, 60
"""Of the search for the start."""
MOST_STEPS = 100_000
"""Of the chain: a step of all walkers together takes some 10 ms, a ridge of floor and tension 25 000 of them."""


@dataclass(frozen=True)
class Calibration:
    """One group of runs calibrated; ``draws`` (n, parameters) of the posterior, of theta alone."""

    group: Runs
    used: tuple[Emulated, ...]
    held_out: tuple[Emulated, ...]
    told: tuple[Told, ...]
    correlation: NDArray
    draws: NDArray
    posterior: Posterior
    discrepancies: tuple[Discrepancy, ...]
    predictions: tuple[Predicted, ...]
    before: Mapping[str, float] | None
    doubts: tuple[Doubt, ...]
    seed: int

    @property
    def recommended(self) -> dict[str, float]:
        """The medians."""
        return {t.name: t.median for t in self.told}


def calibrate(
    group: Runs,
    records: Sequence[str] = (),
    held_out: Sequence[str] = (),
    prior: Bounds | None = None,
    before: Mapping[str, float] | None = None,
    how: Reading | None = None,
    seed: int = 0,
    say: Callable[[str], None] | None = None,
) -> Calibration:
    """The parameters of a group of runs.

    Parameters
    ----------
    group : of :func:`restitution.emulation.runs_table.read_runs`.
    records : those to be met; by default all that the runs simulate but those held out.
    held_out : records that are predicted, and have no say.
    prior : narrower ranges of parameters, uniform.
    before : parameters that the solver had, to compare with; by default the whole prior.
    how : what the numbers of tracks mean, and the conditions of records that are files.
    seed : of the random numbers.
    say : is told how far the work has come.

    Raises
    ------
    InputError : naming what is wrong with runs, records or ranges, or that nothing can be predicted from the runs.
    """
    say = say or (lambda _: None)
    used, out = _records(group, records, held_out)
    say(f"emulators of {len(group.runs)} runs" + (f" of {group.label}" if group.label else ""))
    known = read_all(group, [*used, *out], how or Reading())
    mine, theirs = tuple(known[name] for name in used), tuple(known[name] for name in out)
    parameters = parameters_of(group, mine, prior or {})
    before = None if before is None else _before(group, before)
    posterior = posterior_of(parameters, mine, seed, say)
    p = len(parameters)
    draws = posterior.draws[:, :p]
    told = tuple(told_of(x, draws[:, j]) for j, x in enumerate(parameters))
    x = np.stack([_inner(t, draws[:, j]) for j, t in enumerate(told)], axis=1)
    correlation = np.atleast_2d(np.corrcoef(x, rowvar=False))
    discrepancies = tuple(
        discrepancy_of(e, posterior.draws[:, p + 3 * k : p + 3 * k + 3]) for k, e in enumerate(mine)
    )
    rng = np.random.default_rng(seed + 1)
    prior_draws = np.stack([_uniform(x, rng, 400) for x in parameters], axis=1)
    start = prior_draws if before is None else np.tile([before[n] for n in group.parameters], (400, 1))
    predictions = tuple(
        predicted(e, start, draws, rng, e in theirs) for e in (*mine, *theirs)
    )  # fmt: skip
    doubts = [
        *group.doubts,
        *(d for e in (*mine, *theirs) for d in e.doubts()),
        *doubts_of(group, told, discrepancies, predictions),
    ]
    return Calibration(
        group, mine, theirs, told, correlation, draws, posterior, discrepancies, predictions, before,
        tuple(dict.fromkeys(doubts)), seed,
    )  # fmt: skip


def posterior_of(
    parameters: Sequence[Parameter],
    records: Sequence[Emulated],
    seed: int = 0,
    say: Callable[[str], None] | None = None,
) -> Posterior:
    """Draws of the parameters, and of t_1, sigma_u and tau of each record in turn."""
    likelihood = _Likelihood(records, len(parameters))
    every = (*parameters, *(x for e in records for x in e.frames.nuisances))
    return sample(likelihood, _start(likelihood, every, seed), seed, MOST_STEPS, many=True, say=say)


class _Likelihood:
    """-ln L of all records at points (n, parameters and unknowns of the records)."""

    def __init__(self, records: Sequence[Emulated], parameters: int):
        self.records, self.parameters = records, parameters

    def __call__(self, points: NDArray) -> NDArray:
        theta = points[:, : self.parameters]
        total = np.zeros(len(points))
        for k, e in enumerate(self.records):
            own = points[:, self.parameters + 3 * k : self.parameters + 3 * k + 3]
            total -= e.frames.log(theta, *np.ascontiguousarray(own.T))
        return total


def _records(group: Runs, records: Sequence[str], held_out: Sequence[str]) -> tuple[list[str], list[str]]:
    defects = []
    for option, given in (("--record", records), ("--held-out", held_out)):
        unknown = [name for name in given if name not in group.records]
        rule = f"is simulated by no run{f' of {group.label}' if group.label else ''}; those are of "
        rule += ", ".join(group.records)
        defects += [Defect(rule, field=option, value=name) for name in unknown]
    both = sorted(set(records) & set(held_out))
    defects += [Defect("is to be met and held out at once", field="--held-out", value=name) for name in both]
    used = list(dict.fromkeys(records)) or [name for name in group.records if name not in held_out]
    if not used:
        defects.append(Defect("leaves no record to be met", field="--held-out"))
    if defects:
        raise InputError(*defects)
    return used, list(dict.fromkeys(held_out))


def parameters_of(group: Runs, records: Sequence[Emulated], prior: Bounds) -> tuple[Parameter, ...]:
    """Theta within what the runs of all records range over, or the narrower prior."""
    ranges = np.array([e.emulator.ranges for e in records])
    low, high = ranges[:, :, 0].max(axis=0), ranges[:, :, 1].min(axis=0)
    defects, found = [], []
    for name in prior:
        if name not in group.parameters:
            rule = f"is no parameter of the runs: {', '.join(group.parameters)}"
            defects.append(Defect(rule, field="--prior", value=name))
    for j, name in enumerate(group.parameters):
        if not low[j] < high[j]:
            rule = f"the runs of different records have no range of {name} in common"
            defects.append(Defect(rule, file=group.file, field=name))
            continue
        a, b = prior.get(name, (low[j], high[j]))
        if not low[j] <= a < b <= high[j]:
            rule = (
                f"must rise and lie within the runs, {low[j]:g} to {high[j]:g}: an emulator does not reach beyond"
            )
            defects.append(Defect(rule, field="--prior", value=f"{name}={a:g}:{b:g}"))
            continue
        scale = records[0].emulator.scales[j]
        middle = (a * b) ** 0.5 if scale == "log" else 0.5 * (a + b)
        found.append(Parameter(name, float(middle), (float(a), float(b)), "", scale, Flat(scale == "log")))
    if defects:
        raise InputError(*defects)
    return tuple(found)


def _before(group: Runs, given: Mapping[str, float]) -> dict[str, float]:
    """The solver's own values, one each, within the runs."""
    defects = [
        Defect(f"is no parameter of the runs: {', '.join(group.parameters)}", field="--before", value=name)
        for name in given
        if name not in group.parameters
    ]
    for name, (low, high) in zip(group.parameters, group.ranges, strict=True):
        if name not in given:
            defects.append(Defect(f"has no value of {name}: all parameters or none", field="--before"))
        elif not low <= given[name] <= high:
            rule = f"must lie within the runs, {low:g} to {high:g}"
            defects.append(Defect(rule, field="--before", value=f"{name}={given[name]:g}"))
    if defects:
        raise InputError(*defects)
    return dict(given)


def _start(likelihood: _Likelihood, parameters: Sequence[Parameter], seed: int) -> Maximum:
    """A normal distribution of points that draws in on the best of its points, round by round."""
    rng = np.random.default_rng(seed)
    low, high = np.array([p.limits for p in parameters], float).T
    mean = np.array([p.inward(p.start) for p in parameters])
    sigma = np.where(np.isfinite(high - low), 0.3 * (high - low), 1.0)
    for _ in range(_ROUNDS):
        x = np.clip(mean + sigma * rng.standard_normal((_POINTS, len(parameters))), low, high)
        values = np.array([[p.outward(v) for p, v in zip(parameters, row, strict=True)] for row in x])
        prior = np.array([log_prior(parameters, v, every=False) for v in values])
        best = x[np.argsort(likelihood(values) - prior, kind="stable")[:_BEST]]
        mean, sigma = best.mean(axis=0), best.std(axis=0) + 1e-4 * (high - low)
    values = np.array([p.outward(v) for p, v in zip(parameters, mean, strict=True)])
    slope = np.array([p.slope(v) for p, v in zip(parameters, mean, strict=True)])
    lowest = float(likelihood(values[None])[0])
    return Maximum(tuple(parameters), values, np.diag((sigma * slope) ** 2), lowest, _ROUNDS * _POINTS)


def _uniform(p: Parameter, rng: np.random.Generator, n: int) -> NDArray:
    low, high = map(p.inward, p.bounds)
    return np.array([p.outward(x) for x in rng.uniform(low, high, n)])


def _inner(t: Told, values: NDArray) -> NDArray:
    return np.log(values) if t.logarithmic else values
