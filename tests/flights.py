"""Synthetic bouncing tracks with known truth: an independent integration of gravity and quadratic drag."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from restitution.conditions import Conditions
from restitution.tracks import Track

STEEL_IN_OIL = Conditions.model_validate(
    {
        "fluid": {"density": 935, "viscosity": 0.01},
        "sphere": {"diameter": 3e-3, "density": 7800, "e_dry": 0.97},
    }
)


@dataclass(frozen=True)
class Truth:
    time_s: float
    v_in: float
    v_out: float


@dataclass(frozen=True)
class Flight:
    start: float
    end: float
    motion: object  # t -> (gap, velocity)


def fly(y0, v0, e, terminal, gravity=8.15, wake=0.0, decay=8e-3):
    """Flights of a sphere released at gap y0 with velocity v0, reversed with e at each contact; and truths.

    Gravity (less buoyancy, added mass), quadratic drag, and after each rebound a wake that brakes the sphere with
    wake * v_in/T * exp(-t/decay), T = sqrt(d/g): history force in a simple form.
    """
    drag = gravity / terminal**2
    T = np.sqrt(STEEL_IN_OIL.sphere.diameter / STEEL_IN_OIL.gravity)

    def hit(_, state):
        return state[0]

    hit.terminal, hit.direction = True, -1
    flights, truths, t0, brake = [], [], 0.0, 0.0
    for restitution in (*e, None):

        def motion(t, state, start=t0, brake=brake):
            return [state[1], -gravity - drag * state[1] * abs(state[1]) - brake * np.exp(-(t - start) / decay)]

        solved = solve_ivp(motion, (t0, t0 + 1), [y0, v0], events=hit, dense_output=True, rtol=1e-9, atol=1e-12)
        flights.append(Flight(t0, solved.t[-1], solved.sol))
        if restitution is not None:
            v_in = -solved.y[1, -1]
            truths.append(Truth(solved.t[-1], v_in, restitution * v_in))
            t0, y0, v0, brake = solved.t[-1], 1e-15, restitution * v_in, wake * v_in / T
    return flights, truths


def film(flights: list[Flight], times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Exact gap and velocity at the frame times."""
    gap, velocity = np.empty_like(times), np.empty_like(times)
    for flight in flights:
        during = (times >= flight.start) & (times <= flight.end)
        gap[during], velocity[during] = flight.motion(times[during])
    return gap, velocity


def random_track(rng: np.random.Generator, quantity: str = "gap"):
    """A noisy track of three bounces with frames missing at random, and its truths; every other one with a wake.

    The wake is up to three times that of the 3 mm sphere of Gondret et al. (2002), about a third of v_in/T.
    """
    e = tuple(rng.uniform(0.5, 0.85, 3))
    wake = rng.choice([0.0, 1.0]) * rng.uniform(0, 1)
    start = rng.uniform(6e-3, 12e-3), -rng.uniform(0.2, 0.5)
    flights, truths = fly(*start, e, rng.uniform(0.4, 0.8), wake=wake, decay=rng.uniform(4e-3, 20e-3))
    dt = rng.uniform(0.5e-3, 2e-3)
    times = np.arange(rng.uniform(0, dt), flights[-1].end, dt)
    times = times[rng.random(len(times)) > 0.05]
    gap, velocity = film(flights, times)
    if quantity == "gap":
        seen = gap + rng.uniform(5e-6, 20e-6) * rng.standard_normal(len(times))
    else:
        seen = velocity + rng.uniform(2e-3, 10e-3) * rng.standard_normal(len(times))
    return as_track(times, seen, quantity), truths


def as_track(times: np.ndarray, seen: np.ndarray, quantity: str = "gap", sigma: float | None = None) -> Track:
    import pandas as pd

    column = "gap_m" if quantity == "gap" else "velocity_m_s"
    return Track.from_table(pd.DataFrame({"time_s": times, column: seen}), sigma)
