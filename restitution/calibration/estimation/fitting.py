"""One fit: the estimate under a plan, its intervals, and what a reader must know of them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.curvature import Curvature
from restitution.calibration.estimation.first_guess import Guess, first_guess
from restitution.calibration.estimation.identifiability import (
    check_bounds,
    check_exact,
    check_flat,
    of_estimate,
    of_search,
)
from restitution.calibration.estimation.likelihood import OFFSET, Likelihood
from restitution.calibration.estimation.maximum import LEVELS, Maximum, Thresholds, maximise
from restitution.calibration.estimation.plan import Plan
from restitution.calibration.estimation.profile import NARROW, nearby, profiled, settled
from restitution.calibration.estimation.small_sample import Restriction, threshold
from restitution.calibration.reading.impact_checks import doubts_about
from restitution.calibration.reading.observations import Observations
from restitution.calibration.showing import Showing, Table, counted
from restitution.doubts import Doubt

_LOWER = 1e-6
"""By how much -ln L must be lower for another maximum to be one."""


@dataclass(frozen=True, repr=False)
class Fit(Showing):
    """An estimate with what it came from; ``freedom`` are Satterthwaite's degrees of freedom, by parameter."""

    plan: Plan
    likelihood: Likelihood
    maximum: Maximum
    freedom: NDArray
    restricted: bool
    notes: tuple[str, ...]
    tried: int = 0
    """Starts of the search, where they leave a higher maximum likely; else 0."""

    @property
    def doubts(self) -> tuple[Doubt, ...]:
        """What is doubtful about the impacts, and about the estimate itself."""
        about = doubts_about(self.likelihood.observations, self.plan.known_e_dry)
        earlier = self.plan.earlier
        twice = () if earlier is None else tuple(earlier.doubts(self.likelihood.observations))
        return (*about, *twice, *self.own_doubts)

    @property
    def own_doubts(self) -> tuple[Doubt, ...]:
        """What is doubtful about the estimate itself."""
        search = of_search(self.likelihood, self.maximum.values, self.tried)
        return (*search, *of_estimate(self.maximum, self.freedom))

    def shown(self) -> Table:
        """The estimates with their standard errors; intervals and all else are in its result."""
        m = self.maximum
        cells = zip(m.parameters, m.values, m.sigma, strict=True)
        rows = [
            (p.name, f"{value:.4g}", f"{sigma:.2g}", "" if p.unit == "1" else p.unit) for p, value, sigma in cells
        ]
        title = f"fit of {self.likelihood.model.name} to {counted(len(self.likelihood.observations), 'impact')}"
        return Table(title, ("parameter", "value", "sigma", "unit"), rows)


def estimate(
    plan: Plan,
    observations: Observations,
    intervals: bool | Collection[str] = True,
    restricted: bool = True,
    near: Maximum | None = None,
    covariance: bool = True,
) -> Fit:
    """The maximum of the (restricted) likelihood of :mod:`.likelihood`, and intervals of its profile.

    Parameters
    ----------
    plan : model and what is free.
    observations : impacts, as :func:`restitution.calibration.read` gives them.
    intervals : whether parameters get intervals, or the names of those that do.
    restricted : False for the plain maximum, whose value ranks laws.
    near : estimate of a similar fit with the same parameters, to start from; Newton's steps from there do where
        they come to rest.
    covariance : whether the covariance is wanted.

    Raises
    ------
    InputError : where the data cannot determine what is free.
    """
    likelihood = plan.likelihood(observations)
    parameters = likelihood.parameters
    warm = near is not None
    guess = Guess(near.values, 0) if near is not None else first_guess(likelihood, plan.starts)
    start, steps = guess.values, near.sigma if near is not None else None
    if not warm:
        check_flat(likelihood, start)
        check_exact(likelihood, start)
    restriction = None
    if restricted and any(not p.mean for p in parameters):
        if not warm:
            start = maximise(likelihood, parameters, start, covariance=False).values
        restriction = Restriction.at(likelihood, start)
        # Zero is a stationary point of a standard deviation: the search must not begin there.
        start = np.where([p.mean for p in parameters], start, np.maximum(start, 1e-3))

    def function(values: NDArray) -> float:
        return likelihood(values) + (restriction(values) if restriction else 0.0)

    curvature = Curvature.of(likelihood, restriction) if covariance or intervals else None
    freedom = np.full(len(parameters), np.inf)
    if not intervals:
        best = nearby(near, parameters, function, curvature) if near is not None and covariance else None
        if best is None:
            best = maximise(function, parameters, start, covariance=covariance, steps=steps)
            best = settled(best, function, curvature) if covariance else best
        return Fit(plan, likelihood, best, freedom, restriction is not None, ())
    best = settled(maximise(function, parameters, start), function, curvature)
    mean = np.array([p.mean for p in parameters], bool)
    check_bounds(best)
    if restriction is not None:
        freedom[mean] = restriction.degrees_of_freedom(best.values)
    wanted = [intervals is True or p.name in intervals for p in parameters]
    rises = {
        level: [threshold(level, nu) if want else None for nu, want in zip(freedom, wanted, strict=True)]
        for level in LEVELS
    }
    if curvature is not None and best.condition is not None and best.condition > NARROW:
        best = profiled(best, function, curvature, rises)
    else:
        ended = maximise(function, parameters, best.values, Thresholds(rises), steps=best.sigma)
        if ended.negative_log < best.negative_log - _LOWER:  # a better maximum on the way along the profile
            best = settled(ended, function, curvature)
        else:
            best = replace(best, intervals=ended.intervals, open_ends=ended.open_ends, calls=ended.calls)
    return Fit(plan, likelihood, best, freedom, restriction is not None, _notes(likelihood, best), guess.tried)


def _notes(likelihood: Likelihood, best: Maximum) -> tuple[str, ...]:
    """What a reader must know of this estimate."""
    o, notes = likelihood.observations, list(likelihood.observations.notes)
    if o.speed != likelihood.model.speed and likelihood.model.speed != "unstated":
        notes.append(
            f"{likelihood.model.name} is meant for the {likelihood.model.speed} impact speed; the data have the "
            f"{o.speed} speed: the parameters hold for that one"
        )
    for j, p in enumerate(best.parameters):
        if p.mean and (side := best.at_bound(j)):
            notes.append(f"{p.name} lies on its {side} bound: its interval is one-sided")
        if p.name == OFFSET and len(likelihood.source_names) < 5:
            few = len(likelihood.source_names)
            notes.append(f"{few} sources say little of how sources differ: intervals are wide for it")
    if likelihood.earlier is not None:
        notes.append(f"prior of {', '.join(likelihood.earlier.names)}: the fit {likelihood.earlier.origin}")
    if not likelihood.log_variance:
        notes.append("without ln of the variances, as York's line: a steeper law buys misfit where St has errors")
    if likelihood.robust:
        notes.append("robust: Student's t with 4 degrees of freedom, no correction for small samples")
    return tuple(notes)
