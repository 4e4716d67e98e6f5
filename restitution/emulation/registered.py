r"""Flights as vectors that change smoothly with the parameters of a run, and back.

Gaps at fixed times have kinks that move with the moments of contact, which no few components describe. So a flight
is taken apart at its contacts (landmark registration, Ramsay & Silverman, Functional Data Analysis, 2005, ch. 7):

    q = [ h(t)/d before the first contact;  for each flight n: its duration D_n/sqrt(d/g), its gap h/d at equal
          parts s = (t - T_n)/D_n of it, its e_eff ],        T_n = D_1 + ... + D_n-1,

all counted from the first contact. Going back, h(t) = h_n((t - T_n)/D_n). Durations weigh in the components as
much as what they move, v_n dD = 4 H_n/D_n dD at all places of a flight; e_eff follows from the others, with an
error of its own, for it is read off short stretches of a trajectory.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions
from restitution.emulation.flown import Flown

PLACES = 81
"""Of a flight: between them a straight line is within a 1/25600 of a parabola's height."""
APPROACH = 17
"""Of the approach."""
FOLLOWS = 1e-6
"""Weight of what takes no part in the choice of the components."""


@dataclass(frozen=True)
class Registration:
    """What all vectors of a set of flights have in common.

    ``flights`` is N; ``approach_s`` how much of the approach, ``bounces`` whose e_eff is told; ``weight`` that of
    each entry among the components; ``d`` and ``unit`` (sqrt(d/g)) make lengths and times pure numbers.
    """

    flights: int
    approach_s: float
    bounces: tuple[int, ...]
    weight: NDArray
    d: float
    unit: float

    @classmethod
    def of(cls, flown: Sequence[Flown], conditions: Conditions, approach_s: float) -> Registration:
        """Of the flights that all have; of up to ``approach_s`` of their approach."""
        d, unit = conditions.sphere.diameter, math.sqrt(conditions.sphere.diameter / conditions.gravity)
        n = min(f.flights for f in flown)
        e = np.array([f.e[: n + 1] for f in flown])
        told = tuple(int(k) for k in np.flatnonzero(np.isfinite(e).all(axis=0)))
        before = min(approach_s, *(float(-f.time_s[0]) for f in flown))
        plain = cls(n, max(before, 0.0), told, np.ones(0), d, unit)
        q = np.array([plain.vector(f) for f in flown])
        weight = np.ones(q.shape[1])
        D, heights = plain.durations(q).mean(axis=0), plain.shapes(q).max(axis=-1).mean(axis=0)
        weight[APPROACH : APPROACH + n] = math.sqrt(PLACES) * 4 * heights / D
        weight[APPROACH + n : APPROACH + n + len(told)] = FOLLOWS
        return cls(n, plain.approach_s, told, weight, d, unit)

    @property
    def fixed(self) -> int:
        """Entries before the shapes."""
        return APPROACH + self.flights + len(self.bounces)

    def vector(self, f: Flown) -> NDArray:
        """A flight as a vector q."""
        T = f.contacts_s
        before = np.linspace(-self.approach_s, 0.0, APPROACH)
        parts = [np.interp(before, np.r_[f.time_s[f.time_s < 0], 0.0], np.r_[f.gap_m[f.time_s < 0], 0.0]) / self.d]
        parts += [np.diff(T)[: self.flights] / self.unit, f.e[list(self.bounces)]]
        for n in range(self.flights):
            inside = (f.time_s > T[n]) & (f.time_s < T[n + 1])
            t = np.r_[T[n], f.time_s[inside], T[n + 1]]
            h = np.r_[0.0, f.gap_m[inside], 0.0] / self.d
            parts.append(np.interp(np.linspace(T[n], T[n + 1], PLACES), t, h))
        return np.concatenate(parts)

    def durations(self, q: NDArray) -> NDArray:
        """Of each flight in sqrt(d/g), (..., N)."""
        return q[..., APPROACH : APPROACH + self.flights]

    def restitutions(self, q: NDArray) -> NDArray:
        """e_eff of the bounces that are told, (..., bounces)."""
        return q[..., APPROACH + self.flights : self.fixed]

    def shapes(self, q: NDArray) -> NDArray:
        """Gaps in d at the places of each flight, (..., N, places)."""
        return q[..., self.fixed :].reshape(*q.shape[:-1], self.flights, PLACES)

    def ends_s(self, q: NDArray) -> NDArray:
        """The last contact in s after the first, (...)."""
        return self.durations(q).sum(axis=-1) * self.unit

    def gaps(self, q: NDArray, time_s: NDArray) -> NDArray:
        """Gap in m at times in s after the first contact, both (B, n), for q (B, p); nought after the last one."""
        D = np.maximum(self.durations(q), 1e-9) * self.unit
        T = np.concatenate([np.zeros((len(q), 1)), np.cumsum(D, axis=1)], axis=1)
        flight = np.minimum((time_s[:, :, None] >= T[:, None, 1:]).sum(axis=2), self.flights - 1)
        begin, lasts = np.take_along_axis(T, flight, axis=1), np.take_along_axis(D, flight, axis=1)
        place = np.clip((time_s - begin) / lasts, 0.0, 1.0) * (PLACES - 1)
        left = np.minimum(place.astype(int), PLACES - 2)
        first = self.fixed + flight * PLACES + left
        h = _between(q, first, place - left)
        if self.approach_s > 0:
            back = np.clip(1 + time_s / self.approach_s, 0.0, 1.0) * (APPROACH - 1)
            left = np.minimum(back.astype(int), APPROACH - 2)
            h = np.where(time_s < 0, _between(q, left, back - left), h)
        return h * self.d

    def quantities(self, q: NDArray) -> dict[str, NDArray]:
        """What a flight is told by: heights in mm, durations in ms, e_eff, by label; each (...)."""
        heights = 1e3 * self.d * self.shapes(q).max(axis=-1)
        lasts = 1e3 * self.unit * self.durations(q)
        found = {f"apex {n + 1}, mm": heights[..., n] for n in range(self.flights)}
        found |= {f"flight {n + 1}, ms": lasts[..., n] for n in range(self.flights)}
        e = self.restitutions(q)
        return found | {f"e {k + 1}": e[..., place] for place, k in enumerate(self.bounces)}


def _between(q: NDArray, left: NDArray, share: NDArray) -> NDArray:
    """Straight lines between neighbouring entries of q."""
    at = left + q.shape[1] * np.arange(len(q))[:, None]
    flat = q.ravel()
    return (1 - share) * flat[at] + share * flat[at + 1]
