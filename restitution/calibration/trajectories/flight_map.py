r"""A bouncing trajectory as a smooth function of its parameters: quadratic near a centre, flight by flight.

At a fixed time the gap has a kink in every parameter, where a contact passes. The times of the contacts have none,
nor has the shape of a flight over its own duration. With s = (t - T_k)/(T_{k+1} - T_k) these are expanded to
second order in the parameters x, from integrations at the centre c, c +- a step of each, c + steps of each pair:

    q(x) = q(c) + sum_i g_i d_i + 1/2 sum_ij H_ij d_i d_j,    d_i = (x_i - c_i)/step_i,

q being the contact times, the speeds of the impacts, and gap and its slope in s at points that lie close near the
contacts; between them the gap is a cubic. An integration takes milliseconds, the map some ten microseconds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import Trajectory

POINTS = 41
_X = np.linspace(0, np.pi, POINTS)
NODES = 0.5 * (1 - np.cos(_X))
"""Where in s a flight is kept; half of them within a sixth of it from a contact."""


@dataclass(frozen=True)
class FlightMap:
    """``coefficients`` of 1, d_i and d_i d_j (i <= j), for T, impact speed, gap and d gap/ds of all flights."""

    centre: NDArray
    steps: NDArray
    coefficients: NDArray
    flights: int
    before: float
    """Velocity in m/s before the release: of a sphere that was falling, or 0."""

    @cached_property
    def _pairs(self) -> tuple[NDArray, NDArray]:
        return np.triu_indices(len(self.centre))

    def expand(self, x: NDArray) -> Flights:
        """The flights at the parameters ``x``."""
        return self._flights(self._terms(x) @ self.coefficients)

    def expand_each(self, points: NDArray) -> list[Flights]:
        """The flights at each of several points, which costs little more than one of them."""
        return [self._flights(q) for q in np.array([self._terms(x) for x in points]) @ self.coefficients]

    def _terms(self, x: NDArray) -> NDArray:
        d = (x - self.centre) / self.steps
        i, j = self._pairs
        return np.concatenate([[1.0], d, d[i] * d[j]])

    def _flights(self, q: NDArray) -> Flights:
        n = self.flights
        gap, slope = q[2 * n :].reshape(2, n, POINTS)
        return Flights(np.concatenate([[0.0], q[:n]]), q[n : 2 * n], gap, slope, self.before)


@dataclass(frozen=True)
class Flights:
    """Contact times in s after the release, itself the first; by flight impact speed (m/s), gap (m), d gap/ds."""

    contacts: NDArray
    impact_speed: NDArray
    gap: NDArray
    slope: NDArray
    before: float

    def __call__(self, time: NDArray) -> tuple[NDArray, NDArray]:
        """Gap in m and velocity in m/s at ``time`` (s after the release); after the last flight at rest."""
        last = len(self.gap) - 1
        k = np.clip(np.searchsorted(self.contacts, time, side="right") - 1, 0, last)
        duration = (self.contacts[1:] - self.contacts[:-1])[k]
        s = np.clip((time - self.contacts[k]) / duration, 0.0, 1.0)
        i = np.minimum((np.arccos(1 - 2 * s) / _X[1]).astype(int), POINTS - 2)
        width = NODES[i + 1] - NODES[i]
        x = (s - NODES[i]) / width
        y = 1 - x
        g0, g1 = self.gap[k, i], self.gap[k, i + 1]
        m0, m1 = self.slope[k, i] * width, self.slope[k, i + 1] * width
        h = y * y * ((1 + 2 * x) * g0 + x * m0) + x * x * ((1 + 2 * y) * g1 - y * m1)
        v = (6 * x * y * (g1 - g0) + y * (1 - 3 * x) * m0 + x * (3 * x - 2) * m1) / (width * duration)
        early, late = time < 0, time > self.contacts[-1]
        if early.any():
            h = np.where(early, self.gap[0, 0] + self.before * time, h)
            v = np.where(early, self.before, v)
        if late.any():
            h, v = np.where(late, 0.0, h), np.where(late, 0.0, v)
        return h, v


def flights_of(path: Trajectory, count: int) -> NDArray:
    """The first ``count`` flights of a trajectory as one row: contact times, impact speeds, gaps, slopes."""
    contacts = np.array([0.0, *(i.time_s for i in path.impacts[:count])])
    duration = np.diff(contacts)[:, None]
    # Not at the contacts themselves: the velocity jumps there.
    time = contacts[:-1, None] + duration * np.clip(NODES, 1e-9, 1 - 1e-9)
    gap = path.gap(time)
    gap[:, -1] = 0.0 if path.impacts else gap[:, -1]
    speeds = [i.v_in for i in path.impacts[:count]]
    return np.concatenate([contacts[1:], speeds, gap.ravel(), (path.velocity(time) * duration).ravel()])


def expand_about(
    integrate: Callable[[NDArray], Trajectory],
    centre: NDArray,
    steps: NDArray,
    flights: int,
    before: float,
    pairs: bool = True,
) -> FlightMap:
    """The map of the first ``flights`` flights about ``centre``; ``integrate`` gives the trajectory at a point.

    Without ``pairs`` the terms of two different parameters are left out, which most integrations are for.
    """
    p = len(centre)
    first = integrate(centre)
    unit = np.diag(steps)
    above = [integrate(centre + unit[i]) for i in range(p)]
    below = [integrate(centre - unit[i]) for i in range(p)]
    both = {
        (i, j): integrate(centre + unit[i] + unit[j]) for i in range(p if pairs else 0) for j in range(i + 1, p)
    }
    n = min(flights, *(len(path.impacts) for path in (first, *above, *below, *both.values())))
    q0 = flights_of(first, n)
    up, down = ([flights_of(path, n) for path in paths] for paths in (above, below))
    rows = [q0, *((u - d) / 2 for u, d in zip(up, down, strict=True))]
    for i in range(p):
        rows.append(0.5 * (up[i] + down[i]) - q0)
        rows += [
            flights_of(both[i, j], n) - up[i] - up[j] + q0 if pairs else np.zeros_like(q0) for j in range(i + 1, p)
        ]
    return FlightMap(centre, steps, np.array(rows), n, before)
