"""Flights without drag: each leaves the wall as fast as it comes back.

    v = g_eff T/2 = sqrt(2 g_eff h),    g_eff = g (rho_p - rho_f)/(rho_p + rho_f/2),

T being the time between two contacts and h the apex, so that of two flights in a row

    e = T_(n+1)/T_n = sqrt(h_(n+1)/h_n)

whatever g_eff is: buoyancy and added mass change the speeds, not the ratio. A fall from rest arrives with g_eff T.
Drag takes from a flight on both its ways, so that in a liquid this is not the restitution of the impact: the
flight before arrives slower than it left. Bernstein, Am. J. Phys. 45, 41 (1977) has it for balls in air.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.flights.table import Kind


def speeds(kind: Kind, numbers: NDArray, values: NDArray, g_eff: float) -> tuple[NDArray, NDArray]:
    """Speeds in m/s before and after each contact of a run of bounces, NaN where no flight tells them.

    ``numbers`` follow each other, from 0 where the first value is the release; ``values`` are times of contact in
    s or apexes in m.
    """
    released = numbers[0] == 0
    if kind == "times":
        flight = g_eff * np.diff(values) / 2
        contacts = len(numbers) - released
        before, after = np.full(contacts, np.nan), np.full(contacts, np.nan)
        if released:
            before[:], after[:-1] = flight, flight[1:]
            before[0] *= 2
        else:
            before[1:], after[:-1] = flight, flight
        return before, after
    flight = np.sqrt(2 * g_eff * values)
    if released:
        return flight[:-1], flight[1:]
    return np.concatenate([[np.nan], flight[:-1]]), flight
