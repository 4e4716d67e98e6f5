"""The equation of motion of one flight and its integration, compiled.

State: gap h, velocity v = dh/dt (away from the wall), and the lagged fluid velocities Z_j of the history force
(:mod:`restitution.bounce.history`). With M(h) = m + C_M(h) m_f

    M dv/dt = -1/2 M'(h) v^2 - (m - m_f) g - D(v) - W(h) v - S sum_j w_j G_j (v - Z_j),
    dh/dt = v,    dZ_j/dt = lambda_j (v - Z_j),

which is Lagrange's equation of sphere and potential flow with dissipative forces. The lagged velocities are
stiff (rates up to 1e8 per s) and so is the film, hence an L-stable, stiffly accurate singly diagonal implicit
Runge-Kutta method of order 4 with an embedded one of order 3 for the step (Hairer & Wanner, Solving Ordinary
Differential Equations II, table IV.6.5). In each stage all Z_j follow from v, so there is one equation in one
unknown, whatever the number of terms. The works of drag, wall and history are integrated along.

Everything compiled stands in this one file: Numba's cache looks at the file of the function it caches, so an edit
of anything inlined here compiles anew.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from restitution.bounce.tables import Table


class Forces(NamedTuple):
    """What the flight depends on, in SI; forces that are off have zero factors or constant tables."""

    mass: float
    tail: float
    """Added mass of the history terms faster than the fastest."""
    fluid_mass: float
    weight: float
    """Gravity less buoyancy."""
    radius: float
    stokes: float
    """6 pi mu r."""
    history: float
    """6 pi mu r, or 0."""
    reynolds_per_speed: float
    floor: float
    """Gap below which the resistance of the wall stays constant."""
    drag: Table
    """C_D Re/24 against Re."""
    wall: Table
    """eps (lambda - 1) against eps."""
    tear: float
    """eta^2/v of the film that cavitates on rebound: 3 mu/(p_c r); 0 where it holds any tension."""
    added_mass: Table
    """C_M against eps."""
    memory: NDArray
    """What of each history term is left at a Reynolds number: (grid of ln(Re), terms)."""
    memory_slope: NDArray
    """Its derivative in ln(Re)."""
    memory_start: float
    memory_per_step: float
    rates: NDArray
    weights: NDArray


FELL, ROSE, END, FULL, STUCK = 0, 1, 2, 3, 4
"""Why a stretch ended: gap ``low``, gap ``high``, end time, no room for more steps, an unsolvable step."""

_ITERATIONS = 30
_SHORTEST = 1e-18
_GAMMA = 0.25
_AT = np.array([1 / 4, 3 / 4, 11 / 20, 1 / 2, 1])
_A = np.array(
    [
        [1 / 4, 0, 0, 0, 0],
        [1 / 2, 1 / 4, 0, 0, 0],
        [17 / 50, -1 / 25, 1 / 4, 0, 0],
        [371 / 1360, -137 / 2720, 15 / 544, 1 / 4, 0],
        [25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4],
    ]
)
_ERROR = _A[4] - np.array([59 / 48, -17 / 96, 225 / 32, -85 / 12, 0])


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _look(table, ln_x):
    """y and dy/d ln(x) of a table."""
    at = (ln_x - table.start) * table.per_step
    last = len(table.y) - 1
    if not at > 0:
        return table.y[0], 0.0
    if at >= last:
        return table.y[last], 0.0
    i = int(at)
    t = at - i
    h = 1 / table.per_step
    y0, y1, d0, d1 = table.y[i], table.y[i + 1], h * table.slope[i], h * table.slope[i + 1]
    c2 = 3 * (y1 - y0) - 2 * d0 - d1
    c3 = 2 * (y0 - y1) + d0 + d1
    return y0 + t * (d0 + t * (c2 + t * c3)), (d0 + t * (2 * c2 + t * 3 * c3)) * table.per_step


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _mass(f, h):
    """M(h) and M'(h)."""
    eps = max(h / f.radius, 1e-12)
    C, slope = _look(f.added_mass, math.log(eps))
    return f.mass + f.tail + C * f.fluid_mass, slope / eps / f.radius * f.fluid_mass


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _share(f, ln_Re, share):
    """What is left of each history term at ln(Re), the same interpolation as in _look for all at once."""
    at = (ln_Re - f.memory_start) * f.memory_per_step
    at = min(max(at, 0.0), len(f.memory) - 1.000001)
    i = int(at)
    t = at - i
    s = 1 - t
    h = 1 / f.memory_per_step
    a, b, c, d = s * s * (1 + 2 * t), t * t * (3 - 2 * t), h * s * s * t, -h * t * t * s
    for j in range(len(share)):
        share[j] = (
            a * f.memory[i, j] + b * f.memory[i + 1, j] + c * f.memory_slope[i, j] + d * f.memory_slope[i + 1, j]
        )


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _wake(wake, radius, t, h):
    """Velocity of the fluid that the approach has set moving (restitution.bounce.wake)."""
    if h <= 0 or wake.speed == 0.0:
        return 0.0
    return wake.speed * math.exp(-wake.rate * (t - wake.time)) * (1 - math.exp(-h / radius))


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _wall(f, h, v):
    """lambda - 1 at a gap and velocity, and the slope of (lambda - 1) v in v.

    Below eta = sqrt(tear v) a sphere that leaves has the cavitating film's (2 - eps/eta)/eta in place of 1/eps
    (restitution.laws.cavitation): less by (1 - eps/eta)^2/eps, and that times v has the slope (1 - eps/eta)/eps.
    """
    eps = max(h, f.floor) / f.radius
    held = _look(f.wall, math.log(eps))[0] / eps
    if v <= 0 or eps * eps >= f.tear * v:
        return held, held
    torn = 1 - eps / math.sqrt(f.tear * v)
    return held - torn * torn / eps, held - torn / eps


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _forces(f, wake, inviscid, t, h, v, Z_explicit, g, Z, share):
    """Drag, force of the wall, history force (all against the motion), and the slope in v of their sum.

    In that slope Z follows v as it does within a stage of length g.
    """
    relative = v - _wake(wake, f.radius, t, h)
    Re = max(abs(relative) * f.reynolds_per_speed, 1e-12)
    factor, d_factor = _look(f.drag, math.log(Re))
    drag = f.stokes * factor * relative
    slope = f.stokes * (factor + d_factor)
    wall, wall_slope = _wall(f, h, v)
    memory, memory_slope = 0.0, 0.0
    if f.history > 0:
        _share(f, math.log(max(abs(v) * f.reynolds_per_speed, 1e-12)), share)
        for j in range(len(Z)):
            left = 1 / (1 + g * f.rates[j])
            Z[j] = (Z_explicit[j] + g * f.rates[j] * v) * left
            memory += f.weights[j] * share[j] * (v - Z[j])
            memory_slope += f.weights[j] * share[j] * left
    if inviscid:
        return 0.0, 0.0, 0.0, 0.0
    slope += f.stokes * wall_slope + f.history * memory_slope
    return drag, f.stokes * wall * v, f.history * memory, slope


@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
def _step(f, wake, inviscid, t, dt, h, v, Z, top, scratch):
    """One step: whether it could be solved, gap and velocity after it, and the errors of both.

    Leaves Z after the step in ``Z_stage`` and the powers of drag, wall and history at the stages in ``power``.
    """
    k_h, k_v, k_Z, Z_explicit, Z_stage, power, share = scratch
    n = len(Z)
    g = _GAMMA * dt
    x = v
    for i in range(5):
        h_explicit, v_explicit = h, v
        for j in range(n):
            Z_explicit[j] = Z[j]
        for s in range(i):
            c = dt * _A[i, s]
            h_explicit += c * k_h[s]
            v_explicit += c * k_v[s]
            for j in range(n):
                Z_explicit[j] += c * k_Z[s, j]
        # The stage's velocity x by Newton's method with the slope of the viscous forces, then by secants.
        before, residual_before, slope_of_residual, drag, wall, memory = x, 0.0, 1.0, 0.0, 0.0, 0.0
        for iteration in range(_ITERATIONS):
            gap = h_explicit + g * x
            M, M_slope = _mass(f, gap)
            drag, wall, memory, slope = _forces(
                f, wake, inviscid, t + _AT[i] * dt, gap, x, Z_explicit, g, Z_stage, share
            )
            residual = x - v_explicit - g * (-0.5 * M_slope * x * x - f.weight - drag - wall - memory) / M
            if iteration == 0:
                slope_of_residual = 1 + g * slope / M
            elif x != before and residual != residual_before:
                slope_of_residual = (residual - residual_before) / (x - before)
            before, residual_before = x, residual
            x -= residual / slope_of_residual
            if abs(x - before) <= 1e-13 * top or abs(residual) <= 1e-15 * top:
                break
        else:
            return False, h, v, 0.0, 0.0
        if not math.isfinite(x):
            return False, h, v, 0.0, 0.0
        k_h[i], k_v[i] = x, (x - v_explicit) / g
        for j in range(n):
            k_Z[i, j] = (Z_stage[j] - Z_explicit[j]) / g
        power[i, 0], power[i, 1], power[i, 2] = drag * x, wall * x, memory * x
    error_h, error_v = 0.0, 0.0
    for i in range(5):
        error_h += dt * _ERROR[i] * k_h[i]
        error_v += dt * _ERROR[i] * k_v[i]
    return True, h_explicit + g * x, x, abs(error_h), abs(error_v)


def _kept(function):
    """Compile, and keep the result beside this file or in the user's cache folder, where either can be written."""
    try:
        return njit(function, cache=True, error_model="numpy")
    except RuntimeError:  # numba found no folder to write to: compiled anew in every process
        return njit(function, error_model="numpy")


@_kept
def fly(f, wake, inviscid, t, end, h, v, Z, low, high, dt, growth, tolerance, out, works):
    """Integrate from (t, h, v, Z) until the gap falls to ``low`` or rises to ``high``, or until ``end``.

    ``inviscid``: no viscous force acts (the film of a rebound law), while the memory goes on. Steps begin with
    ``dt`` and grow by at most ``growth``; ``tolerance`` is the relative error allowed in each. ``out`` takes
    t, h, v of every step, row 0 being the start, ``works`` the work done against drag, wall and history since
    then. Z is changed in place to its value at the end. Returns the number of rows and why it ended.
    """
    n = len(Z)
    power, Z_after = np.zeros((5, 3)), np.zeros(n)
    scratch = (np.zeros(5), np.zeros(5), np.zeros((5, n)), np.zeros(n), Z_after, power, np.zeros(n))
    top = max(abs(v), 1e-3 * math.sqrt(f.radius * f.weight / f.mass))
    out[0, 0], out[0, 1], out[0, 2] = t, h, v
    rows = 1
    # While the crossing of low or high is sought within a step: the bracket in dt, by how much each end misses.
    searching, target, why, side = False, low, FELL, 0
    before, before_miss, after, after_miss = 0.0, 0.0, 0.0, 0.0
    while t < end:
        if rows == len(out):
            return rows, FULL
        last = not searching and t + dt >= end
        if last:
            dt = end - t
        solved, new_h, new_v, error_h, error_v = _step(f, wake, inviscid, t, dt, h, v, Z, top, scratch)
        if not solved:
            if dt < _SHORTEST:
                return rows, STUCK
            dt *= 0.25
            searching = False
            continue
        scale_h = max(min(max(h, f.floor), 2 * f.radius), 1e-6 * f.radius)
        error = max(error_h / scale_h, error_v / top) / tolerance
        if error > 1 and not searching:
            dt *= max(0.2, 0.9 * error**-0.25)
            continue
        if searching or new_h < low or new_h > high:
            # Shrink the step until it ends at the crossing, by the Illinois form of the regula falsi.
            if not searching:
                target, why = (low, FELL) if new_h < low else (high, ROSE)
                before, before_miss, after, after_miss = 0.0, h - target, dt, new_h - target
                searching, side = True, 0
            elif (new_h - target) * after_miss < 0:
                before, before_miss = dt, new_h - target
                if side == 1:
                    after_miss *= 0.5
                side = 1
            else:
                after, after_miss = dt, new_h - target
                if side == -1:
                    before_miss *= 0.5
                side = -1
            if abs(new_h - target) > 1e-13 * f.radius and after - before > 1e-15 * (t + after):
                dt = (before * after_miss - after * before_miss) / (after_miss - before_miss)
                continue
            new_h = target
        for s in range(3):
            gain = 0.0
            for i in range(5):
                gain += _A[4, i] * power[i, s]
            works[rows, s] = works[rows - 1, s] + dt * gain
        t = end if last and not searching else t + dt
        h, v = new_h, new_v
        Z[:] = Z_after
        out[rows, 0], out[rows, 1], out[rows, 2] = t, h, v
        rows += 1
        if searching:
            return rows, why
        dt *= min(growth, max(0.3, 0.9 * (error + 1e-12) ** -0.25))
    return rows, END
