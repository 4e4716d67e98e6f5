r"""What LIGGGHTS' `viscous on` delivers, and the inputs with which it comes nearest to a law.

Its hooke contact takes the damping of Legendre's law, but by the Stokes number of the *instantaneous* speed
u = v/v_0, positive on approach:

    x'' + 2 zeta(u) x' + x = 0,   zeta = L/sqrt(pi^2 + L^2),   L = |St_c/(St u) - ln(e_max)|

in units of the undamped frequency, St being that of the impact. Damping grows as the sphere slows, so the law
typed in is not the law delivered. With `limitForce on` the contact ends where the force does. Keywords:
`CriticalStokes` St_c > 0 and `MaximumRestitution` e_max, St = m* v/(6 pi mu r*^2).

That u enters with its sign, so that e_max counts the other way on the rebound, was not read but found: with it the
runs of version 3.8.0 are met within 0.001, without it they are missed by 0.03.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

_STEP, _LONGEST = 0.01, 12.0
"""Of the integration, in units of the inverse frequency; the free half period is pi."""
_SLOWEST = 1e-9
"""Least |u| that the damping is evaluated at."""
_POINTS = 24
"""Stokes numbers across the range that the inputs are fitted to."""


def delivered(St: NDArray, critical: float, most: float, cut: bool = True) -> NDArray:
    """e of impacts at Stokes numbers ``St`` (st_b); ``cut``: with `limitForce on`."""
    St = np.atleast_1d(np.asarray(St, float))

    def damped(u: NDArray) -> NDArray:
        approach = np.where(np.abs(u) < _SLOWEST, _SLOWEST, u)
        L = np.abs(critical / (St * approach) - np.log(most))
        return 2 * L / np.hypot(np.pi, L) * u

    def push(x: NDArray, u: NDArray) -> NDArray:
        return x + damped(u)

    x, u = np.zeros_like(St), np.ones_like(St)
    e, going = np.zeros_like(St), np.ones(St.shape, bool)
    before = push(x, u) if cut else x
    for step in range(int(_LONGEST / _STEP)):
        k1x, k1u = u, -push(x, u)
        k2x, k2u = u + _STEP / 2 * k1u, -push(x + _STEP / 2 * k1x, u + _STEP / 2 * k1u)
        k3x, k3u = u + _STEP / 2 * k2u, -push(x + _STEP / 2 * k2x, u + _STEP / 2 * k2u)
        k4x, k4u = u + _STEP * k3u, -push(x + _STEP * k3x, u + _STEP * k3u)
        new_x = x + _STEP / 6 * (k1x + 2 * k2x + 2 * k3x + k4x)
        new_u = u + _STEP / 6 * (k1u + 2 * k2u + 2 * k3u + k4u)
        now = push(new_x, new_u) if cut else new_x
        over = going & (now <= 0) & (step > 0)
        share = np.where(over, before / np.where(over, before - now, 1.0), 0.0)
        e = np.where(over, np.maximum(-(u + share * (new_u - u)), 0.0), e)
        going &= ~over
        if not going.any():
            break
        x, u, before = new_x, new_u, now
    return e


@dataclass(frozen=True)
class Refit:
    """Inputs of `viscous on` with `limitForce on`, and the greatest deviation of e that remains."""

    critical: float
    most: float
    deviation: float
    worst: float
    """The Stokes number where that is."""


def refit(St: NDArray, e: NDArray) -> Refit:
    """The inputs whose e delivered has the least greatest deviation from ``e`` at Stokes numbers ``St`` (st_b)."""

    def inputs(p: NDArray) -> tuple[float, float]:
        return float(np.exp(p[0])), float(np.clip(p[1], 0.051, 1.0))

    def worst(p: NDArray) -> float:
        return float(np.abs(delivered(St, *inputs(p)) - e).max())

    start = [np.log(25.0), min(0.98 * float(e.max()) + 0.01, 0.99)]
    best = minimize(worst, start, method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-5, "maxiter": 200})
    critical, most = inputs(best.x)
    error = np.abs(delivered(St, critical, most) - e)
    return Refit(critical, most, float(error.max()), float(St[error.argmax()]))


def refit_points(low: float, high: float) -> NDArray:
    """The Stokes numbers that a refit is made at."""
    return np.geomspace(low, high, _POINTS)
