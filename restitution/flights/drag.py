"""Flights of the point particle: the restitution of each contact from which the next flight lasts, or rises, so.

The equation of motion is that of :mod:`restitution.bounce`, e_eff standing for the film, so speeds are ``far``.
The contacts are solved for one after the other, so that each flight meets the history of all before it. Where
neither a release nor a quoted speed tells the approach to the first contact, its speed is taken to be what the
first rebound comes from with the restitution e_1 = e_2 + ``first`` (1 - e_2), e_2 being that of the second
contact; whether it was steady or a fall from rest is then open too (``fallen``).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import Closures, Release, terminal_speed
from restitution.bounce.model import TOLERANCE, Run
from restitution.conditions import Conditions
from restitution.flights.table import Kind

_CLOSE = 1e-9
"""Of an e that is solved for."""
_ROUNDS = 4
"""In which an unknown approach and the first two restitutions settle."""
_FAR = 5.0
"""Height of a fall that is all but steady, in v_terminal^2/g_eff."""
_TOUCHING_D = 1e-6
"""Gap in diameters at which a sphere starts that comes with a known speed."""


def speeds(
    kind: Kind,
    numbers: NDArray,
    values: NDArray,
    conditions: Conditions,
    quoted: float | None = None,
    first: float = 0.0,
    fallen: bool = False,
    closures: Closures | None = None,
) -> tuple[NDArray, NDArray]:
    """Speeds in m/s before and after each contact of a run of bounces, NaN where no flight tells them.

    Parameters
    ----------
    kind, numbers, values : as in :func:`restitution.flights.free.speeds`.
    conditions : fluid and sphere, heavier than the fluid.
    quoted : impact speed of the first contact in m/s, where it is known.
    first : (e_1 - e_2)/(1 - e_2) of the first two contacts, where nothing tells the first approach.
    fallen : whether an approach that is not known was a fall from rest, if one is as fast; else it was steady.
    closures : the forces; by default those of :class:`~restitution.bounce.Closures`.

    Where no restitution up to 1 gives a flight, it is 1: it leaves as fast as it comes.
    """
    chain = _Chain(kind, numbers, values, conditions, closures or Closures(measured=()))
    if chain.released:
        return chain.solve(chain.fall(), known=True)
    if quoted is not None:
        return chain.solve(chain.coming(quoted, fallen), known=True)
    coming = 2 * chain.free_speed(chain.targets[0])
    for _ in range(_ROUNDS):
        before, after = chain.solve(chain.coming(coming, fallen), known=False)
        if after[0] >= coming:  # too slow
            coming *= 2
            continue
        e_second = after[1] / before[1] if chain.contacts > 1 else np.nan
        if np.isnan(e_second):
            break
        coming = after[0] / (e_second + first * (1 - e_second))
    return before, after


class _Chain:
    """One run of bounces: ``targets`` are durations in s or apexes in m of the flights after each contact."""

    def __init__(self, kind: Kind, numbers: NDArray, values: NDArray, conditions: Conditions, closures: Closures):
        self.kind, self.conditions, self.closures = kind, conditions, replace(closures, measured=())
        self.released = bool(numbers[0] == 0)
        flights = np.diff(values) if kind == "times" else np.asarray(values)
        self.start, self.targets = (flights[0], flights[1:]) if self.released else (None, flights)
        self.contacts = len(self.targets) + (kind == "times")
        g = conditions.free_fall
        lasting = flights if kind == "times" else 2 * np.sqrt(2 * flights / g)
        self.end = float(f"{10 * (np.sum(lasting) + np.max(lasting)):.1g}")  # the same for values next to these

    def free_speed(self, target: float) -> float:
        """The launch speed of a flight without drag."""
        g = self.conditions.free_fall
        return g * target / 2 if self.kind == "times" else float(np.sqrt(2 * g * target))

    def coming(self, speed: float, fallen: bool) -> Run:
        """At the wall with this speed, by a fall from rest or with a developed wake."""
        if fallen and (run := self._fallen_to(speed)) is not None:
            return run
        gap = _TOUCHING_D * self.conditions.sphere.diameter
        run = Run(self.conditions, Release(gap, speed, developed=True), self.closures, self.end, TOLERANCE)
        run.fly_to_wall()
        return run

    def fall(self) -> Run:
        """At the wall after the fall from rest."""
        from scipy.optimize import brentq

        if self.kind == "apexes":
            return self._fallen(self.start)
        g, T = self.conditions.free_fall, self.start
        highest = g * T**2 / 2
        if self._fallen(1.5 * highest).t < T:  # history and drag only make a fall longer
            highest *= 1.5
        height = brentq(lambda h: self._fallen(h).t - T, 1e-4 * highest, 1.5 * highest, rtol=1e-10)
        return self._fallen(height)

    def _fallen_to(self, speed: float) -> Run | None:
        """At the wall with this speed after a fall from rest; None where no fall is as fast."""
        from scipy.optimize import brentq

        c = self.conditions
        high = _FAR * terminal_speed(c) ** 2 / c.free_fall
        if not -self._fallen(high).v > speed:
            return None
        height = brentq(lambda h: -self._fallen(h).v - speed, 1e-4 * high, high, rtol=1e-9)
        return self._fallen(height)

    def _fallen(self, height: float) -> Run:
        run = Run(self.conditions, Release(height), self.closures, self.end, TOLERANCE)
        run.fly_to_wall()
        return run

    def solve(self, run: Run, known: bool) -> tuple[NDArray, NDArray]:
        """Go from contact to contact; ``known``: the speed of the first approach is to be told."""
        from scipy.optimize import brentq

        before, after = np.full((2, self.contacts), np.nan)
        before[0] = -run.v if known else np.nan
        found: tuple[float, ...] = ()
        for k, target in enumerate(self.targets):

            def excess(
                e: float, target: float = target, run: Run = run, found: tuple[float, ...] = found
            ) -> float:
                return self._flown(run, (*found, e))[0] - target

            e = brentq(excess, 1e-6, 1.0, xtol=_CLOSE) if excess(1.0) > 0 else 1.0
            found = (*found, e)
            after[k] = e * -run.v
            run = self._flown(run, found)[1]
            if k + 1 < self.contacts:
                before[k + 1] = -run.v
        return before, after

    def _flown(self, run: Run, measured: tuple[float, ...]) -> tuple[float, Run]:
        """How long or how high the flight after this contact is, and the run at its end."""
        other = run.branch(replace(self.closures, measured=measured))
        begin, rows = other.t, len(other.rows)
        other.rebound()
        if not other.fly_to_wall():
            return 0.0, other
        if self.kind == "times":
            return other.t - begin, other
        return _apex(np.concatenate(other.rows[rows:])), other


def _apex(rows: NDArray) -> float:
    """The greatest gap of a flight given at steps (time, gap, velocity), cubic between them."""
    t, h, v = rows.T
    turning = np.flatnonzero((v[:-1] > 0) & (v[1:] <= 0))
    if not len(turning):
        return float(np.max(h))
    i = turning[0]
    dt = t[i + 1] - t[i]
    slope = (h[i + 1] - h[i]) / dt
    a, b = 3 * (v[i] + v[i + 1]) - 6 * slope, 6 * slope - 4 * v[i] - 2 * v[i + 1]
    x = 2 * v[i] / (-b + np.sqrt(max(b**2 - 4 * a * v[i], 0.0)))
    return float(h[i] + dt * x * (v[i] + x * (b / 2 + x * a / 3)))
