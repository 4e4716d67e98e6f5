"""What each impact does to the estimate: how far it moves when a fit is made without it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.fitting import Fit, estimate
from restitution.calibration.estimation.likelihood import OFFSET
from restitution.errors import InputError

MOST = 300
"""Impacts up to which each is left out in turn; of more, one does little."""


def fit_without(whole: Fit, out: NDArray) -> Fit:
    """The plan of a fit on its impacts without those ``out``, searched from its estimate."""
    plan, rest = whole.plan, whole.likelihood.observations.take(~out)
    # Whether sources are offset is a property of the model, not of what is left out.
    names = [p.name for p in whole.maximum.parameters]
    plan = replace(plan, offsets=OFFSET in names)
    # A level of a separate parameter may be gone with what is left out.
    near = whole.maximum if not plan.separate or len(plan.likelihood(rest).parameters) == len(names) else None
    held = not any(p.mean for p in whole.maximum.parameters)  # nothing of the law is open: no covariance needed
    return estimate(plan, rest, intervals=False, near=near, covariance=not held)


def influences(fit: Fit) -> list[dict[str, float]]:
    """For each impact its moves of the law's parameters in standard errors; empty where that cannot be told."""
    n = len(fit.likelihood.observations)
    if n > MOST:
        return [{}] * n
    whole = {p.name: (v, s) for p, v, s in zip(fit.maximum.parameters, fit.maximum.values, fit.maximum.sigma,
                                               strict=True) if p.mean and s > 0}  # fmt: skip
    result = []
    for i in range(n):
        try:
            rest = fit_without(fit, np.arange(n) == i).maximum
        except InputError:
            result.append({})
            continue
        without = {p.name: v for p, v in zip(rest.parameters, rest.values, strict=True)}
        result.append({name: float((v - without[name]) / s) for name, (v, s) in whole.items() if name in without})
    return result
