"""A constant in place of a law: in which impacts it holds, and which constant is best over a range of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from restitution.errors import Defect, InputError
from restitution.export.impacts import Impacts

_FARTHEST = 1e3
"""Ratio of Stokes numbers up to which the end of the range is sought."""


@dataclass(frozen=True)
class Constant:
    """``e`` and the Stokes numbers of the law between which it is ``within`` of it."""

    e: float
    within: float
    stokes: tuple[float, float]


def constant_at(impacts: Impacts, speed: float, within: float) -> Constant:
    """The law's e at an impact speed in m/s, and the St in which it holds within an absolute error."""
    St = float(impacts.stokes(speed))
    e = float(impacts.restitution(St))
    if e <= 0:
        raise InputError(Defect(f"gives no rebound (St = {St:.4g}): no contact force does that", field="--speed"))

    def excess(log_St: float) -> float:
        return abs(float(impacts.restitution(np.exp(log_St))) - e) - within

    def end(far: float) -> float:
        here = np.log(St)
        return (
            St * far
            if excess(here + np.log(far)) <= 0
            else float(np.exp(brentq(excess, here, here + np.log(far))))
        )

    return Constant(e, within, (end(1 / _FARTHEST), end(_FARTHEST)))


def best_constant(impacts: Impacts, low: float, high: float) -> Constant:
    """The constant whose greatest deviation between two Stokes numbers is least: half way between the extremes."""
    e = impacts.restitution(np.geomspace(low, high, 400))
    least, most = float(e.min()), float(e.max())
    return Constant((least + most) / 2, (most - least) / 2, (low, high))
