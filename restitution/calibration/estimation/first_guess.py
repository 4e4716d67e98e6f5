"""Where the search for the maximum begins: least squares of the measured impacts.

It is tried from the parameters' own starts, from places along the diagonal of their bounds and from a lattice that
fills them, the most promising first, until the least of all sums of squares has been reached twice: a likelihood
that is flat in the middle of the bounds has its valley elsewhere. Where starts end in w different valleys, n
searches leave a share w (w + 1)/(n (n - 1)) of the starts to valleys not yet seen (Boender & Rinnooy Kan 1987,
Math. Program. 37, 59); more starts are then tried until it is small. A start that the caller gives is taken alone.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.draws import lattice
from restitution.calibration.estimation.likelihood import SCATTER, Likelihood
from restitution.calibration.estimation.parameters import Normal
from restitution.errors import Defect, InputError

_DIAGONAL = (0.02, 0.1, 0.3, 0.6)
_A_PARAMETER = 64
"""Places of the lattice for each parameter."""
_MOST_REFINED = 16
UNSEEN = 0.05
"""Share of starts, expected to lead to valleys not yet seen, from which on the least of the seen is in doubt."""
_THE_SAME = 1e-4
"""Relative difference below which two sums of squares are one."""
_BAD = 1e6
"""Stands for a residual without a finite value."""


class Guess(NamedTuple):
    """Values to search from; ``tried`` starts whose least may not be the least of all, or 0."""

    values: NDArray
    tried: int


def first_guess(likelihood: Likelihood, given: Collection[str] = ()) -> Guess:
    """Least squares of the measured impacts, and the scatter left; ``given`` names the caller's starts."""
    from scipy.optimize import least_squares

    parameters, o = likelihood.parameters, likelihood.observations
    values = np.array([p.start for p in parameters], float)
    mean = np.flatnonzero([p.mean for p in parameters])
    seen = ~o.censored
    weight = 1 / np.hypot(o.e_sigma, 0.02)[seen]
    if not len(mean):
        return Guess(values, 0)
    size, directions = np.linalg.eigh(likelihood.jointly.precision)
    root = np.sqrt(np.maximum(size, 0.0))[:, None] * directions.T

    def at(x: NDArray) -> NDArray:
        trial = values.copy()
        trial[mean] = [parameters[j].outward(v) for j, v in zip(mean, x, strict=True)]
        return trial

    def misfit(x: NDArray) -> NDArray:
        trial = at(x)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            r = (o.e - likelihood.moments(trial)[0])[seen] * weight
        priors = [
            (trial[j] - q.mean) / q.sigma if isinstance(q := parameters[j].prior, Normal) else 0.0 for j in mean
        ]
        jointly = root @ likelihood.jointly.away(trial)
        return np.nan_to_num(np.concatenate([r, priors, jointly]), nan=_BAD, posinf=_BAD, neginf=-_BAD)

    low = np.array([-np.inf if (a := parameters[j].limits[0]) is None else a for j in mean])
    high = np.array([np.inf if (b := parameters[j].limits[1]) is None else b for j in mean])
    own = np.clip([parameters[j].inward(values[j]) for j in mean], low, high)
    starts = [own]
    if np.isfinite(low).all() and np.isfinite(high).all():
        inside = low + (1e-9 + (1 - 2e-9) * lattice(_A_PARAMETER * len(mean), len(mean))) * (high - low)
        starts += [low + part * (high - low) for part in _DIAGONAL] + list(inside)
    fixed = np.array([parameters[j].name.partition("[")[0] in given for j in mean], bool)
    starts = [np.where(fixed, own, x) for x in (starts if not fixed.all() else [own])]
    starts = [np.clip(x, low + 1e-9, high - 1e-9) for x in starts]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        starts = [x for x in starts if np.isfinite(likelihood(at(x)))]
    if not starts:
        raise InputError(_nowhere(likelihood, values))
    starts.sort(key=lambda x: float(np.sum(misfit(x) ** 2)))
    starts, best, sure = starts[:_MOST_REFINED], None, len(starts) == 1
    valleys: list[list[float]] = []  # costs of the searches that ended in each
    for n, x in enumerate(starts, 1):
        fit = least_squares(misfit, x, bounds=(low, high), x_scale="jac")
        best = fit if best is None or fit.cost < best.cost else best
        place = next((v for v in valleys if abs(fit.cost - v[0]) <= _THE_SAME * v[0] + 1e-300), None)
        if place:
            place.append(fit.cost)
        else:
            valleys.append([fit.cost])
        w, reached = len(valleys), len(min(valleys)) > 1
        sure = sure or (reached and (w == 1 or w * (w + 1) <= UNSEEN * n * (n - 1)))
        if sure:
            break
    values = at(best.x)
    left = float(np.sqrt(np.mean((o.e - likelihood.moments(values)[0])[seen] ** 2)))
    for j, p in enumerate(parameters):
        if not p.mean:
            values[j] = min(max(left if p.name == SCATTER else 0.5 * left, 1e-12), 0.5)
    return Guess(values, 0 if sure else len(starts))


def _nowhere(likelihood: Likelihood, values: NDArray) -> Defect:
    """The law has no finite value at any start."""
    o, names = (
        likelihood.observations,
        ", ".join(f"{p.name} = {p.start:g}" for p in likelihood.parameters if p.mean),
    )
    row = int(np.argmin(np.isfinite(likelihood.moments(values)[0])))
    rule = (
        f"the law has no finite value here at the start ({names}), nor elsewhere within the bounds: give a start "
        "(--start NAME=VALUE) or bounds where it has (--bounds NAME=LOW:HIGH)"
    )
    return Defect(rule, **o.place(row), field="stokes", value=f"{o.St[row]:g}")
