"""The draws that a fit keeps in its file, as arrays, and the noise of one more impact by each of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincinv, ndtri

from restitution.calibration.estimation.draws import Draws, lattice
from restitution.calibration.estimation.likelihood import OFFSET, SCATTER, STUDENT
from restitution.calibration.result.fit_result import FitResult, sources
from restitution.errors import Defect, InputError

_STAND_IN = 1024
"""Normal draws of a fit that keeps none."""


class OneMore(NamedTuple):
    """What one more impact has besides the law, an entry a draw: its offset, its noise's standard deviation."""

    offset: NDArray
    noise: NDArray


def kept(result: FitResult) -> Draws:
    """The draws of a fit; of one that keeps none, since an earlier version wrote it, normal ones."""
    names = tuple(p.name for p in result.parameters)
    if (own := result.draws) is not None:
        rows = np.array(own.rows).reshape(len(own.rows), len(names) + len(own.sources))
        weights = np.array(own.weights)
        return Draws(names, rows[:, : len(names)], weights / weights.sum(), own.sources, rows[:, len(names) :])
    if result.posterior is not None and result.posterior.draws:
        values = np.array(result.posterior.draws)
    else:
        values = _normal(result)
    return Draws(names, values, np.full(len(values), 1 / len(values)), (), np.zeros((len(values), 0)))


def _normal(result: FitResult) -> NDArray:
    """Draws from the covariance, within the bounds; standard deviations folded at zero."""
    C = np.array([[0.0 if x is None else x for x in row] for row in result.covariance])
    n = len(result.parameters)
    if not n:
        return np.zeros((_STAND_IN, 0))
    size, directions = np.linalg.eigh(C.reshape(n, n))
    root = directions * np.sqrt(np.maximum(size, 0.0))
    values = np.array([p.value for p in result.parameters]) + ndtri(lattice(_STAND_IN, n)) @ root.T
    low, high = np.array([p.bounds for p in result.parameters]).T
    deviation = np.array([not p.mean for p in result.parameters])
    return np.clip(np.where(deviation, np.abs(values), values), low, high)


def one_more(draws: Draws, result: FitResult, source: str | None) -> OneMore:
    """Of a new source, or of one that was fitted; raises :class:`InputError` for one that was not."""
    tau, omega = (_column(draws, name) for name in (SCATTER, OFFSET))
    if result.robust:  # Student's t is normal with a variance of its own in each draw
        tau = tau * np.sqrt(0.5 * STUDENT / gammaincinv(0.5 * STUDENT, lattice(len(tau), 1)[:, 0]))
    if source is None:
        return OneMore(np.zeros(len(tau)), np.hypot(tau, omega))
    known: Sequence[str] = sources(result)
    if source not in known:
        rule = f"is no source of this fit; there are: {', '.join(known)}"
        raise InputError(Defect(rule, field="--source", value=source))
    if source in draws.sources:
        return OneMore(draws.offsets[:, draws.sources.index(source)], tau)
    if omega.any():
        rule = "the fit keeps no offsets of its sources: an earlier version wrote it, or they are too many"
        raise InputError(Defect(rule, field="--source", value=source))
    return OneMore(np.zeros(len(tau)), tau)


def _column(draws: Draws, name: str) -> NDArray:
    return draws.values[:, draws.names.index(name)] if name in draws.names else np.zeros(len(draws.values))
