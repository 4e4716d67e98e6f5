"""The maximum of a likelihood and the intervals of its profile, by MINUIT (iminuit).

Nothing here knows of restitution: a negative log-likelihood as a function of values, and the parameters with
bounds and priors. The search runs in the internal coordinates of :mod:`.parameters`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtr

from restitution.calibration.estimation.parameters import Normal, Parameter, log_prior
from restitution.errors import Defect, InputError

LEVELS = (0.68, 0.95)
HUGE = 1e12
"""Stands for an infinite -ln L in the search, which needs numbers."""
_SILENT = -1
"""Level of MINUIT's own messages; at 0 it writes of matrices that it mends."""
Function = Callable[[NDArray], float]


@dataclass(frozen=True)
class Maximum:
    """The estimate. ``intervals[level]`` has shape (parameters, 2); ``covariance`` is of the values, not of x."""

    parameters: tuple[Parameter, ...]
    values: NDArray
    covariance: NDArray
    negative_log: float
    """-ln L with the normal priors, at the maximum."""
    calls: int
    intervals: Mapping[float, NDArray] = field(default_factory=dict)
    open_ends: Mapping[float, NDArray] = field(default_factory=dict)
    """True where an interval ends at a bound of the parameter, not because the likelihood has fallen."""
    condition: float | None = None
    """Of the curvature scaled to a unit diagonal, greatest over least eigenvalue; None where it is not exact."""
    unsettled: float = 0.0
    """The step that Newton's method would still make, in standard errors, where it leads no lower any more."""

    @property
    def sigma(self) -> NDArray:
        """Standard errors."""
        return np.sqrt(np.diag(self.covariance))

    def at_bound(self, j: int) -> str | None:
        """``lower`` or ``upper`` if parameter j was found there."""
        p, value = self.parameters[j], self.values[j]
        low, high = p.bounds
        reach = 1e-4 * min(high - low, max(abs(value), 1e-12) if p.scale == "log" else high - low)
        if value - low < reach and p.scale != "even":
            return "lower"
        return "upper" if high - value < reach else None


@dataclass(frozen=True)
class Thresholds:
    """By how much -2 ln L rises to the ends of an interval: by level, one number a parameter; None: do without."""

    rise: Mapping[float, Sequence[float | None]]


def maximise(
    negative_log: Function,
    parameters: Sequence[Parameter],
    start: NDArray | None = None,
    thresholds: Thresholds | None = None,
    covariance: bool = True,
    steps: NDArray | None = None,
) -> Maximum:
    """The maximum within the bounds; with ``thresholds`` also the intervals of the profile.

    ``steps`` are first steps of the search in the values, as the standard errors of a similar fit. Raises
    :class:`InputError` where the likelihood is infinite at the start, or no maximum is found.
    """
    from iminuit import Minuit

    parameters = tuple(parameters)
    start = np.array([p.start for p in parameters]) if start is None else np.asarray(start, float)
    outward = [p.outward for p in parameters]
    measured = any(isinstance(p.prior, Normal) for p in parameters)

    def function(x: NDArray) -> float:
        given = x.tolist()
        if not all(map(math.isfinite, given)):
            return HUGE
        values = np.array([out(v) for out, v in zip(outward, given, strict=True)])
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            total = negative_log(values) - (log_prior(parameters, values, every=False) if measured else 0.0)
        return total if total < HUGE else HUGE

    first = np.array([p.inward(v) for p, v in zip(parameters, start, strict=True)])
    if not parameters:
        return Maximum((), np.zeros(0), np.zeros((0, 0)), function(first), 1)
    if function(first) >= HUGE:
        at = ", ".join(f"{p.name} = {v:g}" for p, v in zip(parameters, start, strict=True))
        raise InputError(f"the likelihood is not finite at the start ({at}): give starts or bounds where it is")
    minuit = Minuit(function, first, name=[p.name for p in parameters])
    minuit.errordef = Minuit.LIKELIHOOD
    minuit.print_level = _SILENT
    for j, (p, x) in enumerate(zip(parameters, first, strict=True)):
        minuit.limits[p.name] = p.limits
        known = steps is not None and np.isfinite(steps[j]) and steps[j] > 0
        minuit.errors[p.name] = steps[j] / abs(p.slope(x)) if known else _step(p, x)
    minuit.migrad()
    if not minuit.valid:
        minuit.simplex()
        minuit.strategy = 2
        minuit.migrad()
    if not minuit.valid and not minuit.fmin.edm < 1e-2:
        raise InputError(_no_maximum(minuit, parameters))
    values = np.array([p.outward(x) for p, x in zip(parameters, minuit.values, strict=True)])
    lowest = float(minuit.fval)
    if not covariance:
        return Maximum(parameters, values, np.full((len(values),) * 2, np.nan), lowest, minuit.nfcn)
    minuit.hesse()
    slope = np.array([p.slope(x) for p, x in zip(parameters, minuit.values, strict=True)])
    if minuit.covariance is None:
        raise InputError(_no_maximum(minuit, parameters))
    C = np.asarray(minuit.covariance) * np.outer(slope, slope)
    intervals, ends = {}, {}
    for level, rise in (thresholds.rise if thresholds else {}).items():
        sides = [_interval(minuit, p, r) for p, r in zip(parameters, rise, strict=True)]
        intervals[level] = np.array([interval for interval, _ in sides])
        ends[level] = np.array([open_end for _, open_end in sides])
    return Maximum(parameters, values, C, lowest, minuit.nfcn, intervals, ends)


def _step(p: Parameter, x: float) -> float:
    """A first step of the search: a tenth of the value, at most of the range."""
    low, high = p.bounds
    if p.scale == "log":
        return 0.3
    reach = 0.1 * (high - low) if np.isfinite(high - low) else np.inf
    return min(0.1 * abs(x) if x else reach, reach) or 0.1


def _interval(minuit, p: Parameter, rise: float | None) -> tuple[tuple[float, float], tuple[bool, bool]]:
    """Where the profile of -2 ln L has risen by ``rise`` on both sides of the maximum, or the bounds."""
    if rise is None:
        return (np.nan, np.nan), (False, False)
    # MINUIT takes a confidence level; this is the one whose chi^2 quantile is the rise.
    best = minuit.values[p.name]
    ends, open_ends = [], []
    try:
        minuit.minos(p.name, cl=float(chdtr(1, rise)))
        minos = minuit.merrors[p.name]
        found = (
            (0, minos.lower_valid, minos.at_lower_limit, minos.lower),
            (1, minos.upper_valid, minos.at_upper_limit, minos.upper),
        )
    except RuntimeError:  # not sure enough of its maximum
        found = ((0, False, False, 0.0), (1, False, False, 0.0))
    for side, valid, limit, error in found:
        x = best + error if valid and not limit else _search(minuit, p, rise, side)
        ends.append(np.nan if x is None else x)
        open_ends.append(x is None)
    bounds = p.bounds
    values = [bounds[s] if open_ends[s] else p.outward(x) for s, x in enumerate(ends)]
    if p.scale == "even":  # x and -x are one value: an interval across zero begins there
        across = not open_ends[0] and not open_ends[1] and ends[0] * ends[1] < 0
        low, high = (0.0, max(values)) if across else (min(values), max(values))
        return (low, high), (False, open_ends[0] or open_ends[1])
    return (values[0], values[1]), (open_ends[0], open_ends[1])


def _search(minuit, p: Parameter, rise: float, side: int) -> float | None:
    """The end of an interval where MINOS did not give it, by bisection of the profile.

    None where the profile has not risen enough at the bound.
    """
    from iminuit import Minuit
    from scipy.optimize import brentq

    lowest, best = minuit.fval, minuit.values[p.name]
    profile = Minuit(minuit.fcn, np.array(minuit.values), name=minuit.parameters)
    profile.errordef = Minuit.LIKELIHOOD
    profile.print_level = _SILENT
    profile.limits = minuit.limits
    profile.fixed[p.name] = True

    known = {best: -rise}

    def excess(x: float) -> float:
        # A profile is a search of its own and repeats itself to rounding only: a bracket must keep its signs.
        if x not in known:
            known[x] = at(x)
        return known[x]

    def at(x: float) -> float:
        for name in minuit.parameters:
            profile.values[name] = minuit.values[name]
            profile.errors[name] = minuit.errors[name]
        profile.values[p.name] = x
        if profile.nfit:
            profile.migrad()
        value = profile.fcn(np.array(profile.values)) if not profile.nfit else profile.fval
        return 2 * (value - lowest) - rise

    low, high = p.limits
    limit = (low, high)[side]
    step, sign, inner = minuit.errors[p.name] or _step(p, best), (-1, 1)[side], best
    for _ in range(40):
        x = inner + sign * step
        if limit is not None and sign * (x - limit) >= 0:
            x = limit
        if excess(x) > 0:
            return brentq(excess, inner, x, xtol=1e-4 * abs(x - inner) + 1e-12)
        if x == limit:
            return None
        inner, step = x, 2 * step
    return None


def _no_maximum(minuit, parameters: Sequence[Parameter]) -> Defect:
    """Why no maximum was found, in words that say what to do."""
    at = ", ".join(f"{p.name} = {p.outward(x):.4g}" for p, x in zip(parameters, minuit.values, strict=True))
    rule = (
        f"no maximum of the likelihood was found (last at {at}): the data may not determine all parameters; "
        "fix one, narrow its bounds, or give it a prior"
    )
    return Defect(rule)
