"""A whole bouncing trajectory: flights outside the film, passages of the film, impacts by event, rest.

Every stretch ends where the sphere reaches the edge of the film, the wall, or the end of the time, so no force
changes its form within a step. At the wall the sphere is reversed at once,

    v_out = e v_in,

sphere and added mass alike: the wall, not the sphere, pays the impulse that turns the fluid round. The lagged
velocities of the history force stay as they are, so that the jump acts on from there.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.bounce.closures import Closures, Release
from restitution.bounce.forces import GREATEST_RE, expected_reynolds, forces
from restitution.bounce.kernel import END, FELL, FULL, ROSE, Forces, fly
from restitution.bounce.tables import look
from restitution.bounce.wake import NONE, OwnWake, Wake, left_behind
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.laws.drag import terminal_speed
from restitution.stokes import StokesNumber

if TYPE_CHECKING:
    import pandas as pd

TOLERANCE = 1e-6
"""Relative error of a step; the trajectory of Gondret's sphere is then within 1e-5 d of the converged one."""
_ROWS = 20_000
_MOST_IMPACTS = 1000


class IntegrationError(RuntimeError):
    """The equation of motion could not be integrated to the end."""


@dataclass(frozen=True)
class Impact:
    """One contact: time in s, speeds in m/s, both positive. The sphere rests where v_out is 0."""

    time_s: float
    v_in: float
    v_out: float

    @property
    def e(self) -> float:
        """Rebound speed over impact speed."""
        return self.v_out / self.v_in if self.v_in > 0 else 0.0


@dataclass(frozen=True)
class Trajectory:
    """Gap in m and velocity in m/s (away from the wall) at the steps of the integration; impacts; energies in J.

    At an impact there are two rows of the same time, before and after it.
    """

    time_s: NDArray
    gap_m: NDArray
    velocity_m_s: NDArray
    impacts: list[Impact]
    conditions: Conditions
    closures: Closures
    energy: NDArray = field(repr=False)
    """Kinetic energy of sphere and added mass, and gravity less buoyancy times gap."""
    lost: NDArray = field(repr=False)
    """Columns: to drag, to the wall's resistance, to history, in impacts; each from the start to that row."""

    @property
    def imbalance(self) -> float:
        """Largest |energy + losses - initial energy| over the initial energy: the error of the integration."""
        total = self.energy + self.lost.sum(axis=1)
        return float(np.max(np.abs(total - total[0])) / abs(total[0]))

    def gap(self, time: NDArray | float) -> NDArray:
        """Gap in m at ``time`` (s), cubic between steps; the start before the start, the end after the end."""
        i, x, dt = self._place(time)
        h, v = self.gap_m, self.velocity_m_s
        y = 1 - x
        return y**2 * ((1 + 2 * x) * h[i] + x * dt * v[i]) + x**2 * ((1 + 2 * y) * h[i + 1] - y * dt * v[i + 1])

    def velocity(self, time: NDArray | float) -> NDArray:
        """Velocity in m/s at ``time`` (s), the derivative of :meth:`gap`."""
        i, x, dt = self._place(time)
        h, v = self.gap_m, self.velocity_m_s
        slope = (h[i + 1] - h[i]) / dt
        return 6 * x * (1 - x) * slope + (1 - x) * (1 - 3 * x) * v[i] + x * (3 * x - 2) * v[i + 1]

    def _place(self, time: NDArray | float) -> tuple[NDArray, NDArray, NDArray]:
        t = self.time_s
        time = np.clip(np.asarray(time, float), t[0], t[-1])
        i = np.clip(np.searchsorted(t, time, side="right") - 1, 0, len(t) - 2)
        dt = t[i + 1] - t[i]
        dt = np.where(dt > 0, dt, 1.0)
        return i, (time - t[i]) / dt, dt

    def apexes(self) -> NDArray:
        """Greatest gap in m of each flight after an impact, in order; of the last one only if it got there."""
        v = self.velocity_m_s
        turning = np.flatnonzero((v[:-1] > 0) & (v[1:] <= 0) & (np.diff(self.time_s) > 0))
        dt = np.diff(self.time_s)[turning]
        v0, v1, slope = v[turning], v[turning + 1], np.diff(self.gap_m)[turning] / dt
        a, b = 3 * (v0 + v1) - 6 * slope, 6 * slope - 4 * v0 - 2 * v1
        x = 2 * v0 / (-b + np.sqrt(np.maximum(b**2 - 4 * a * v0, 0)))  # where the velocity between the steps is 0
        first = self.impacts[0].time_s if self.impacts else math.inf
        return self.gap(self.time_s[turning] + x * dt)[self.time_s[turning] >= first]

    def table(self, time: NDArray | None = None) -> pd.DataFrame:
        """Columns ``time_s``, ``gap_m``, ``velocity_m_s``, at ``time`` or at the steps."""
        import pandas as pd

        if time is None:
            columns = {"time_s": self.time_s, "gap_m": self.gap_m, "velocity_m_s": self.velocity_m_s}
        else:
            columns = {"time_s": time, "gap_m": self.gap(time), "velocity_m_s": self.velocity(time)}
        return pd.DataFrame(columns)

    def impact_table(self, stokes: str = "st") -> pd.DataFrame:
        """One row an impact: time, speeds, restitution, Stokes number in the convention ``stokes``."""
        import pandas as pd

        rows = [
            {
                "impact": k + 1, "time_s": i.time_s, "impact_speed_m_s": i.v_in, "rebound_speed_m_s": i.v_out,
                "e_eff": i.e, "stokes_convention": stokes,
                "stokes": float(StokesNumber.from_speed(i.v_in, self.conditions, stokes).value),
            }
            for k, i in enumerate(self.impacts)
        ]  # fmt: skip
        return pd.DataFrame(rows)


def bounce(
    conditions: Conditions,
    release: Release,
    closures: Closures | None = None,
    end: float = 1.0,
    tolerance: float = TOLERANCE,
) -> Trajectory:
    """The trajectory of a sphere released over a wall; the equation of motion is in :mod:`restitution.bounce`.

    Parameters
    ----------
    conditions : fluid and sphere in SI.
    release : gap, speed, and what the fluid remembers of the way there.
    closures : which forces act, and what happens at contact.
    end : time in s at which it ends.
    tolerance : relative error of a step of the integration.

    Returns
    -------
    Gap (m), velocity (m/s, away from the wall) and energy in time, impacts, ``gap(t)``, ``apexes()``. The sphere
    comes to rest where the free flight of a rebound would rise by less than the film limit.

    Raises
    ------
    InputError : for input that cannot be used.
    IntegrationError : where the integration fails.
    """
    run = Run(conditions, release, closures or Closures(), end, tolerance)
    while run.fly_to_wall():
        run.rebound()
    return run.trajectory()


class Run:
    """State of one integration and what it has recorded."""

    def __init__(self, conditions: Conditions, release: Release, closures: Closures, end: float, tolerance: float):
        touch = closures.contact_gap(conditions)
        _check(conditions, release, touch, end)
        self.conditions, self.closures, self.touch = conditions, closures, touch
        self.end, self.tolerance = end, tolerance
        self.forces: Forces = forces(conditions, closures, end)
        self.edge = closures.film * conditions.sphere.diameter
        self.t, self.h, self.v = 0.0, float(release.gap), -float(release.speed)
        self.Z = release.lagged(self.forces.rates)
        if not release.developed:
            self.v = self._shared(self.v, 0.0, self.h)
        self.inside = self.h < self.edge
        self.scale = conditions.sphere.radius / math.sqrt(conditions.gravity * conditions.sphere.diameter)
        self.dt = 1e-4 * self.scale
        self.wake, self.steady = NONE, release.developed and release.drive is None
        self.driven = 0.0 if release.drive is None else release.drive.way
        self.impacts: list[Impact] = []
        self.rows: list[NDArray] = []
        self.lost: list[NDArray] = []
        self.so_far = np.zeros(4)
        self.lowest_apex = closures.film_limit(conditions)

    def branch(self, closures: Closures) -> Run:
        """The same state, from which another run goes on with what ``closures`` say of contacts to come."""
        other = copy.copy(self)
        other.closures, other.Z, other.so_far = closures, self.Z.copy(), self.so_far.copy()
        other.impacts, other.rows, other.lost = [*self.impacts], [*self.rows], [*self.lost]
        return other

    def fly_to_wall(self) -> bool:
        """Fly on to the next contact; False where the end comes first."""
        while self.t < self.end:
            if self._stretch():
                return True
        return False

    def _stretch(self) -> bool:
        """Fly on to the next edge of the film, contact or end; whether it is a contact."""
        low, high = (self.touch, self.edge) if self.inside else (self.edge, math.inf)
        if self.edge <= self.touch:
            low, high = self.touch, math.inf
        out, works = np.empty((_ROWS, 3)), np.zeros((_ROWS, 3))
        black_box = self.inside and self.closures.black_box
        n, why = fly(
            self.forces, self.wake, black_box, self.t, self.end, self.h, self.v, self.Z, low, high,
            self.dt, 3.0, self.tolerance, out, works,
        )  # fmt: skip
        self.rows.append(out[:n].copy())
        self.lost.append(self.so_far + np.hstack([works[:n], np.zeros((n, 1))]))
        self.so_far = self.lost[-1][-1].copy()
        self.t, self.h, self.v = out[n - 1]
        self.dt = 1e-4 * self.scale
        if why == FELL and low == self.touch:
            return True
        if why == ROSE:
            self.inside = False
        elif why == FELL:
            self.inside, self.touch = True, self.closures.contact_gap(self.conditions, -self.v)
        elif why != END:
            what = f"took more than {_ROWS} steps" if why == FULL else "could not solve a step"
            raise IntegrationError(f"the flight {what} near t = {self.t:.6g} s, gap {self.h:.3g} m")
        return False

    def rebound(self) -> None:
        """Reverse the sphere at the wall, or let it rest there."""
        v_in, whole = -self.v, self._mass(self.touch)
        M, tail = whole - self.forces.tail, self.forces.tail
        v_out = self._restitution(v_in) * v_in
        # Sphere and added mass rise as in free flight, at most; what stays within the film limit rests.
        if M * v_out**2 / (2 * self.forces.weight) < self.lowest_apex or len(self.impacts) >= _MOST_IMPACTS:
            v_out = 0.0
        self.impacts.append(Impact(self.t, v_in, v_out))
        self.v, self.inside, self.dt = v_out, self.edge > self.touch, 1e-8 * self.scale
        self.so_far[3] += M / 2 * (v_in**2 - v_out**2)
        if v_out == 0:
            self.so_far[3] += tail / 2 * v_in**2
            self.rows.append(np.array([[self.t, self.h, 0.0], [self.end, self.h, 0.0]]))
            self.lost.append(np.array([self.so_far, self.so_far]))
            self.t = self.end
            return
        if self.closures.wake is not None:
            self.wake = self._left_behind(self.closures.wake, v_in)
        self.v = self._shared(v_out, -v_in, self.touch)
        self.so_far[2] += M / 2 * v_out**2 + tail / 2 * v_in**2 - whole / 2 * self.v**2

    def _left_behind(self, law: OwnWake, speed: float) -> Wake:
        """The wake of the approach that has just ended: of the way since the sphere last began to fall."""
        h, v = np.concatenate(self.rows)[:, 1:].T
        turned = np.flatnonzero(v >= 0)
        way = float(h[turned[-1]]) if len(turned) else float(h[0] + self.driven)
        way = math.inf if self.steady and not len(turned) else way
        fluid = self.conditions.fluid
        nu = fluid.viscosity / fluid.density
        return left_behind(law, self.t, speed, way, self.conditions.sphere.diameter, nu)

    def _shared(self, v: float, before: float, gap: float) -> float:
        """The velocity after a jump to ``v``, once the fastest history terms, at ``before``, have followed."""
        share = self.forces.tail / self._mass(gap)
        return float(v - share * (v - before))

    def _restitution(self, v_in: float) -> float:
        law, measured, count = self.closures.rebound, self.closures.measured, len(self.impacts)
        if measured is not None:
            return measured[count] if count < len(measured) else 0.0
        e_dry = self.closures.dry(self.conditions)
        if law is None:
            return e_dry
        St = StokesNumber.from_speed(v_in, self.conditions).read_as(law.speed)
        return float(law(St, e_dry, self.conditions, out_of_range="ignore")) if v_in > 0 else 0.0

    def _mass(self, gap: NDArray | float) -> NDArray:
        C = look(self.forces.added_mass, np.maximum(np.asarray(gap) / self.forces.radius, 1e-12))
        return self.forces.mass + self.forces.tail + C * self.forces.fluid_mass

    def trajectory(self) -> Trajectory:
        """What was recorded."""
        t, h, v = np.concatenate(self.rows).T
        energy = self._mass(h) / 2 * v**2 + self.forces.weight * h
        return Trajectory(t, h, v, self.impacts, self.conditions, self.closures, energy, np.concatenate(self.lost))


def _check(conditions: Conditions, release: Release, touch: float, end: float) -> None:
    Re = expected_reynolds(conditions, release.speed)  # refuses a sphere that does not sink
    if release.gap <= touch:
        raise InputError(
            Defect(f"must be above the contact gap {touch:g} m: the sphere starts in the wall",
                   field="release.gap", value=f"{release.gap:g}")
        )  # fmt: skip
    if not (math.isfinite(end) and end > 0):
        raise InputError(Defect("must be a positive number of seconds", field="end", value=f"{end:g}"))
    if Re > GREATEST_RE:
        d, fast = conditions.sphere.diameter, abs(release.speed) > terminal_speed(conditions)
        raise InputError(
            Defect(f"gives Re = {Re:.2g}, beyond any drag law here: in millimetres where metres are meant?",
                   field="release.speed" if fast else "sphere.diameter", value=f"{release.speed if fast else d:g}")
        )  # fmt: skip
