"""By exact derivatives: the maximum from one nearby, and ends of intervals of parameters nearly exchangeable.

For an interval the others follow the parameter that is moved by Newton's method on -ln L with its exact gradient
and curvature, damped (Levenberg, Marquardt) where it does not lead down. The search of :mod:`.maximum` learns the
curvature as it goes and loses its way in a valley whose walls are a thousand times steeper than its floor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from restitution.calibration.estimation.curvature import Curvature
from restitution.calibration.estimation.maximum import Function, Maximum
from restitution.calibration.estimation.parameters import Parameter, log_prior

NARROW = 100.0
"""Condition of the scaled curvature from which on intervals are made here."""
SHORT = 1e-6
"""Step to the maximum, in standard errors, that is still to be made where a search has stopped short of it."""
_STEPS = 30
"""Steps of Newton's method at most."""
_FOUND = 1e-9
"""Step in standard errors below which a maximum is found."""
_ROUNDED = 1e-9
"""Of -ln L, relative: what rounding may make of a step that is one towards the maximum."""
_AT_REST = 1e-6
"""The same of a maximum that no search has looked for."""
_ROUNDS = 20
"""Of damped and exact steps by turns: a valley that bends takes several."""
_NEWTON = 200
_SETTLED = 1e-6
"""Newton's decrement, in units of -ln L, below which the others have followed."""
_MOST_DAMPED = 1e6
"""Of Levenberg and Marquardt, relative to the scaled curvature, where no step leads down any more."""
_GROWTH = 1.3
"""Of the way from the estimate, until the profile has risen enough."""
_FARTHEST = 40


def profiled(
    best: Maximum, negative_log: Function, curvature: Curvature, rises: Mapping[float, Sequence[float | None]]
) -> Maximum:
    """The estimate with intervals; ``rises`` as in :class:`.maximum.Thresholds`."""
    profile = _Profile(best, negative_log, curvature)
    intervals, open_ends = {}, {}
    for level, rise in rises.items():
        sides = [
            [(np.nan, False)] * 2 if r is None else [profile.end(j, r, side) for side in (-1, 1)]
            for j, r in enumerate(rise)
        ]
        intervals[level] = np.array([[end for end, _ in pair] for pair in sides])
        open_ends[level] = np.array([[is_open for _, is_open in pair] for pair in sides])
    return replace(best, intervals=intervals, open_ends=open_ends)


def settled(best: Maximum, negative_log: Function, curvature: Curvature | None) -> Maximum:
    """The maximum of a search that stopped short of it in a narrow valley, by damped steps and then exact ones."""
    best = sharpened(best, negative_log, curvature)
    for _ in range(_ROUNDS):
        if curvature is None or best.unsettled < SHORT:
            break
        profile = _Profile(best, negative_log, curvature)
        values = profile.follow(best.values, None)
        # Exact steps leave this as it is where the curvature is not one of a maximum yet: that is further too.
        followed = replace(best, values=values, negative_log=profile.total(values))
        further = sharpened(followed, negative_log, curvature)
        gain, best = best.negative_log - further.negative_log, further
        if not gain > 0:
            break
    return best


def sharpened(best: Maximum, negative_log: Function, curvature: Curvature | None) -> Maximum:
    """The maximum by Newton's method from one nearby, with the covariance of the exact curvature.

    Where rounding hides whether a step leads down, the gradient decides, which is exact: across a narrow valley
    that bends it must be nought to many digits, or it adds to the curvature along the valley.
    Parameters at their bounds stay there, and keep with all others the covariance of the search.
    """
    inside = np.array([best.at_bound(j) is None for j in range(len(best.values))], bool)
    if curvature is None or not inside.any():
        return best

    def total(values: NDArray) -> float:
        return negative_log(values) - log_prior(best.parameters, values, every=False)

    values, lowest, condition, C, left = best.values.copy(), total(best.values), None, None, 0.0
    before, unsure = np.inf, False
    low, high = np.array([p.bounds for p in best.parameters]).T
    even = np.array([p.scale == "even" for p in best.parameters], bool)
    for _ in range(_STEPS):
        d = curvature(values)
        if d is None:
            return best
        diagonal = np.diag(d.hessian)[inside]
        if not (diagonal > 0).all():
            return best
        scale = 1 / np.sqrt(diagonal)
        size, directions = np.linalg.eigh(d.hessian[np.ix_(inside, inside)] * np.outer(scale, scale))
        if not size[0] > np.finfo(float).eps * size[-1]:
            return best
        push = float(np.linalg.norm(scale * d.gradient[inside]))
        if unsure and push > 0.5 * before:
            break  # rounding hides the gradient too
        before = push
        condition = float(size[-1] / size[0])
        inverse = (directions / size) @ directions.T
        C = inverse * np.outer(scale, scale)
        step = np.zeros(len(values))
        step[inside] = -scale * (inverse @ (scale * d.gradient[inside]))
        left = float(np.max(np.abs(step[inside]) / np.sqrt(np.diag(C))))
        if left < _FOUND:
            break
        for part in (1.0, 0.5, 0.25, 0.125):
            new = np.clip(np.where(even, np.abs(values + part * step), values + part * step), low, high)
            if (value := total(new)) <= lowest:
                values, lowest, unsure = new, value, False
                break
        else:
            new = np.clip(np.where(even, np.abs(values + step), values + step), low, high)
            if not (value := total(new)) - lowest <= _ROUNDED * max(1.0, abs(lowest)):
                break
            values, lowest, unsure = new, value, True
    if not inside.all() or C is None:
        C = best.covariance
    return replace(best, values=values, negative_log=lowest, covariance=C, condition=condition, unsettled=left)


def nearby(
    near: Maximum, parameters: Sequence[Parameter], negative_log: Function, curvature: Curvature | None
) -> Maximum | None:
    """The maximum by Newton's method alone from that of a similar fit, as without one of many impacts.

    Some three evaluations where a search takes a hundred. None where it does not come to rest, or a parameter is
    at a bound, which it might leave.
    """
    start = replace(near, parameters=tuple(parameters), calls=0, intervals={}, open_ends={}, condition=None)
    best = sharpened(start, negative_log, curvature)
    free = all(m.at_bound(j) is None for m in (start, best) for j in range(len(best.values)))
    return best if free and best.condition is not None and best.unsettled < _AT_REST else None


class _Profile:
    """-ln L with one parameter held, minimised over the others."""

    def __init__(self, best: Maximum, negative_log: Function, curvature: Curvature):
        self.best, self.function, self.curvature = best, negative_log, curvature
        self.low, self.high = np.array([p.bounds for p in best.parameters]).T
        self.even = np.array([p.scale == "even" for p in best.parameters], bool)

    def total(self, values: NDArray) -> float:
        """-ln L with priors."""
        return self.function(values) - log_prior(self.best.parameters, values, every=False)

    def end(self, j: int, rise: float, side: int) -> tuple[float, bool]:
        """Where the profile has risen by ``rise`` (of -2 ln L), and whether that is the bound instead."""
        best, sigma = self.best, self.best.sigma[j]
        limit = (self.low if side < 0 else self.high)[j]
        step = float(np.sqrt(rise)) * sigma
        if not np.isfinite(step) or step <= 0:
            return np.nan, True
        followed = {0.0: best.values}

        def excess(way: float) -> float:
            near = followed[min(followed, key=lambda known: abs(known - way))]
            values = near.copy()
            values[j] = best.values[j] + side * way
            if near is best.values:
                direction = best.covariance[:, j] / best.covariance[j, j]
                others = np.arange(len(values)) != j
                values[others] += side * way * direction[others]
            values = self.follow(np.clip(np.where(self.even, np.abs(values), values), self.low, self.high), j)
            followed[way] = values
            return 2 * (self.total(values) - best.negative_log) - rise

        inner, way, most = 0.0, step, abs(limit - best.values[j])
        for _ in range(_FARTHEST):
            way = min(way, most)
            if excess(way) > 0:
                return best.values[j] + side * brentq(excess, inner, way, xtol=1e-5 * step), False
            if way == most:
                return float(limit), not (side < 0 and bool(self.even[j]))
            inner, way = way, _GROWTH * way
        return np.nan, True

    def follow(self, values: NDArray, j: int | None) -> NDArray:
        """Where -ln L is least, parameter j held."""
        value, damping, d = self.total(values), 0.0, None
        for _ in range(_NEWTON):
            d = d or self.curvature(values)
            if d is None:
                break
            pushed = ((values <= self.low) & (d.gradient > 0)) | ((values >= self.high) & (d.gradient < 0))
            free = ~pushed
            if j is not None:
                free[j] = False
            if not free.any():
                break
            g, H = d.gradient[free], d.hessian[np.ix_(free, free)]
            scale = 1 / np.sqrt(np.maximum(np.abs(np.diag(H)), 1e-300))
            size, directions = np.linalg.eigh(H * np.outer(scale, scale))
            size = np.maximum(np.abs(size), 1e-14 * np.abs(size).max())  # downhill where it bends the other way
            along = directions.T @ (scale * g)
            if along @ (along / size) < _SETTLED:
                break
            step = np.zeros(len(values))
            step[free] = -scale * (directions @ (along / (size + damping)))
            new = values + step
            new = np.clip(np.where(self.even, np.abs(new), new), self.low, self.high)
            if (lower := self.total(new)) < value:
                values, value, damping, d = new, lower, 0.2 * damping, None
                damping = damping if damping > 1e-12 else 0.0
            elif damping > _MOST_DAMPED:
                break
            else:
                damping = max(5 * damping, float(size[0]))
        return values
