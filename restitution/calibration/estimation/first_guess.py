"""Where the search for the maximum begins: least squares of the measured impacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.likelihood import SCATTER, Likelihood
from restitution.calibration.estimation.parameters import Normal
from restitution.errors import Defect, InputError


def first_guess(likelihood: Likelihood) -> NDArray:
    """Least squares of the measured impacts from the better of several starts, and the scatter that they leave."""
    from scipy.optimize import least_squares

    parameters, o = likelihood.parameters, likelihood.observations
    values = np.array([p.start for p in parameters], float)
    mean = np.flatnonzero([p.mean for p in parameters])
    seen = ~o.censored
    weight = 1 / np.hypot(o.e_sigma, 0.02)[seen]
    if not np.isfinite(likelihood(values)):
        names = ", ".join(f"{p.name} = {p.start:g}" for p in parameters if p.mean)
        f = likelihood.moments(values)[0]
        row = int(np.argmin(np.isfinite(f)))
        rule = (
            f"the law has no finite value here at the start ({names}): give a start or bounds where it has "
            "(--bounds NAME=LOW:HIGH starts in the middle)"
        )
        raise InputError(Defect(rule, **o.place(row), field="stokes", value=f"{o.St[row]:g}"))
    if not len(mean):
        return values

    def misfit(x: NDArray) -> NDArray:
        trial = values.copy()
        trial[mean] = [parameters[j].outward(v) for j, v in zip(mean, x, strict=True)]
        r = (o.e - likelihood.moments(trial)[0])[seen] * weight
        priors = [
            (trial[j] - q.mean) / q.sigma if isinstance(q := parameters[j].prior, Normal) else 0.0 for j in mean
        ]
        return np.nan_to_num(np.concatenate([r, priors]), nan=1e6, posinf=1e6, neginf=-1e6)

    low = np.array([-np.inf if (a := parameters[j].limits[0]) is None else a for j in mean])
    high = np.array([np.inf if (b := parameters[j].limits[1]) is None else b for j in mean])
    first = np.clip([parameters[j].inward(values[j]) for j in mean], low, high)
    starts = [first]
    if np.isfinite(low).all() and np.isfinite(high).all():
        starts += [low + part * (high - low) for part in (0.02, 0.1, 0.3, 0.6)]
    starts = [np.clip(s, low + 1e-9, high - 1e-9) for s in starts]
    starts.sort(key=lambda s: float(np.sum(misfit(s) ** 2)))
    best = min((least_squares(misfit, s, bounds=(low, high)) for s in starts[:2]), key=lambda fit: fit.cost)
    values[mean] = [parameters[j].outward(v) for j, v in zip(mean, best.x, strict=True)]
    left = float(np.sqrt(np.mean((o.e - likelihood.moments(values)[0])[seen] ** 2)))
    for j, p in enumerate(parameters):
        if not p.mean:
            values[j] = min(max(left if p.name == SCATTER else 0.5 * left, 1e-12), 0.5)
    return values
