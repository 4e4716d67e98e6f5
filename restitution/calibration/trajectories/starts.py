"""How a record starts: what is open there, and what is known of it before the fit.

- ``height``: released from rest, from a height that is stated or that the approach tells: the fall, under all
  forces of the model, that is nearest to its frames;
- ``speed``: it falls steadily, or is driven at a constant speed; open within 5 % of the mean of the approach;
- ``impact``: the approach was not filmed; the speed of the impact is open, near a quoted one, or near that from
  which Eq. (4), its K known within a factor of two, gives the first rebound.

What the frames tell is a guess with an honest width: they are used again in the fit. Of a height that is the error
of the frames and what the history force does to it, which no law of it is sure about.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import Closures, IntegrationError, Release, bounce, terminal_speed
from restitution.bounce.agreement import release_reaching
from restitution.calibration.estimation.parameters import Normal
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.laws.source_abstract_eq4 import Eq4Exponential
from restitution.stokes import H_FILM, StokesNumber

STEADY = 0.05
"""Relative standard deviation of the speed of a steady fall about its mean over the approach."""
STILL_FALLING = 0.7
"""Slower than this part of the terminal speed at its first frames a sphere was released at rest, if they allow."""
BETTER = 25.0
"""Difference of chi^2 by which frames are said to be of one kind of approach and not of another."""
STATED = 0.01
"""Relative standard deviation of a height of release that somebody states."""
K = (6.0, 11.0, 18.0)
"""Of Eq. (4): low, middle and high, to guess an impact from its rebound."""
UNSEEN = 0.15
"""Least relative standard deviation of such a guess."""
_LEAST_WIDTH_D = 0.02
"""Least standard deviation of a height told by the frames, in diameters."""
_MODEL_D = 0.002
"""What a model of the approach may be wrong by, in diameters, where kinds of approach are told apart."""
_MOST_FRAMES = 40
"""Of an approach that tell its kind and height."""
_RUN_UP_D = 5.0
"""Gap, in diameters, at which the model starts where the approach was not filmed."""
_MOVED = 10.0
"""Errors of a frame by which a sphere must have moved to tell its speed."""


@dataclass(frozen=True)
class Start:
    """What is open at the start, with its prior: m/s or m. ``gap`` is that of the release where it is known."""

    kind: Literal["speed", "height", "impact"]
    prior: Normal
    gap: float = 0.0
    release_speeds: tuple[float, ...] = ()
    """Of ``impact``: quadratic in the impact speed over its mean less 1, the release speed at ``gap``."""

    @property
    def name(self) -> str:
        """In words, with its unit."""
        return {"speed": "release_speed_m_s", "height": "release_gap_m", "impact": "impact_speed_m_s"}[self.kind]

    def release(self, value: float) -> Release:
        """The release at a value of what is open."""
        if self.kind == "height":
            return Release(value, 0.0)
        if self.kind == "speed":
            return Release(self.gap, value, developed=True)
        speed = float(np.polyval(self.release_speeds, value / self.prior.mean - 1))
        return Release(self.gap, speed, developed=True)


@dataclass(frozen=True)
class Approach:
    """Frames before the first contact, outside the film: time in s, gap in m, error of a frame in m."""

    time: NDArray
    gap: NDArray
    sigma: float
    conditions: Conditions

    @classmethod
    def of(cls, time: NDArray, gap: NDArray, sigma: float, frames: NDArray, conditions: Conditions) -> Approach:
        """Those of ``frames``, of many a part."""
        frames = frames[gap[frames] > H_FILM * conditions.sphere.diameter]
        if len(frames) > _MOST_FRAMES:
            frames = frames[np.unique(np.linspace(0, len(frames) - 1, _MOST_FRAMES).astype(int))]
        return cls(time[frames], gap[frames], sigma, conditions)

    @property
    def slope(self) -> float:
        """Mean speed towards the wall in m/s."""
        return -float(np.polyfit(self.time - self.time[0], self.gap, 1)[0])

    @property
    def first(self) -> float:
        """Speed towards the wall at the first frames."""
        return -rate(self.time, self.gap, self.sigma, max(2, min(4, len(self.time) // 2)))

    def fallen(self, closures: Closures) -> tuple[NDArray, NDArray, float]:
        """Height of a release from rest in m and time from there to the first frame in s; covariance; chi^2.

        The time is negative where the sphere is held over the first frames.
        """
        c, v, since = self.conditions, max(self.first, 0.0), self.time - self.time[0]
        begin = np.array([self.gap[0] + v**2 / (2 * c.free_fall), v / c.free_fall])
        moved = np.flatnonzero(self.gap[0] - self.gap > _MOVED * self.sigma)
        if (
            len(moved)
            and (held := since[moved[0]] - math.sqrt(2 * (self.gap[0] - self.gap[moved[0]]) / c.free_fall)) > 0
        ):
            begin = np.array([self.gap[0], -held])
        highest = self.gap[0] + 5 * terminal_speed(c) ** 2 / c.free_fall

        def shown(x: NDArray) -> NDArray:
            end = float(x[1] + since[-1] + 1e-6)
            return bounce(c, Release(float(x[0])), closures, end, 1e-5).gap(np.maximum(since + x[1], 0.0))

        low = [self.gap[0] - 3 * self.error, -0.9 * since[-1]]
        high = [highest, 10 * math.sqrt(highest / c.free_fall)]
        return self._nearest(shown, begin, low, high, [0.1 * c.sphere.diameter, 1e-3])

    def steady(self, closures: Closures) -> tuple[NDArray, NDArray, float]:
        """Speed of a steady fall at the first frame in m/s, and its gap in m; covariance; chi^2."""
        c, u = self.conditions, self.slope
        end = float(np.ptp(self.time) + 1e-6)

        def shown(x: NDArray) -> NDArray:
            release = Release(float(x[1]), float(x[0]), developed=True)
            return bounce(c, release, closures, end, 1e-5).gap(self.time - self.time[0])

        d = c.sphere.diameter
        return self._nearest(
            shown, np.array([u, self.gap[0]]), [0.3 * u, 0.5 * self.gap[0]], [3 * u, self.gap[0] + d], [0.1 * u, d]
        )

    def straight(self) -> float:
        """Chi^2 of a straight line: a sphere that is driven."""
        line = np.polyval(np.polyfit(self.time - self.time[0], self.gap, 1), self.time - self.time[0])
        return float(np.sum(((line - self.gap) / self.error) ** 2))

    @property
    def error(self) -> float:
        """Of a frame about a model of the approach, in m."""
        return math.hypot(self.sigma, _MODEL_D * self.conditions.sphere.diameter)

    def _nearest(
        self, shown: Callable[[NDArray], NDArray], begin: NDArray, low: list, high: list, scale: list
    ) -> tuple[NDArray, NDArray, float]:
        from scipy.optimize import least_squares

        begin = np.clip(begin, np.array(low) + 1e-9, np.array(high) - 1e-9)
        fit = least_squares(
            lambda x: (shown(x) - self.gap) / self.error, begin, bounds=(low, high), x_scale=scale, diff_step=1e-3
        )
        return fit.x, np.linalg.pinv(fit.jac.T @ fit.jac), float(2 * fit.cost)


def start_of(
    name: str, time: NDArray, gap: NDArray, sigma: float, frames: NDArray, conditions: Conditions,
    stated: Normal | None, zero: float, notes: list[str],
) -> Start:  # fmt: skip
    """What is open at the start of a record whose approach are ``frames``; says in ``notes`` what it took.

    ``stated`` is a height of release that is known, ``zero`` the standard deviation of the wall's level in m.
    """
    if stated is not None:
        return Start("height", stated)
    approach = Approach.of(time, gap, sigma, frames, conditions)
    if len(approach.time) < 2:
        after = slice(frames[-1] + 2 if len(frames) else 0, None)  # the frame between may be of either side
        return _unseen(name, time[after], gap[after], sigma, conditions, notes)
    try:
        return _seen(name, approach, zero, notes)
    except IntegrationError:
        return Start("speed", Normal(approach.slope, STEADY * approach.slope), float(approach.gap[0]))


def _seen(name: str, approach: Approach, zero: float, notes: list[str]) -> Start:
    """Of an approach that was filmed: the kind whose model is nearest; where frames leave it open the likelier."""
    c, forces = approach.conditions, Closures(measured=())
    (height, _), covariance, by_fall = approach.fallen(forces)
    _, _, by_steady = approach.steady(forces)
    by_line = approach.straight()
    slow = approach.first < STILL_FALLING * terminal_speed(c)
    if by_line < min(by_fall, by_steady) - BETTER:
        notes.append(f"{name}: taken to be driven at {approach.slope:.3g} m/s until the film")
        return Start("speed", Normal(approach.slope, STEADY * approach.slope), float(approach.gap[-1]))
    if by_steady < by_fall - BETTER or not (slow or by_fall < by_steady - BETTER):
        return Start("speed", Normal(approach.slope, STEADY * approach.slope), float(approach.gap[0]))
    without_history = approach.fallen(Closures(measured=(), history=None))[0][0]
    width = math.hypot(
        math.sqrt(covariance[0, 0]), 0.5 * (height - without_history), zero, _LEAST_WIDTH_D * c.sphere.diameter
    )
    notes.append(
        f"{name}: taken to start from rest, at a gap of {1e3 * height:.3g} +- {1e3 * width:.2g} mm (--release "
        "states it)"
    )
    return Start("height", Normal(float(height), width))


def _unseen(
    name: str, time: NDArray, gap: NDArray, sigma: float, conditions: Conditions, notes: list[str]
) -> Start:
    """Of an approach that was not filmed: near the quoted speed of its impact, or told by the rebound's frames."""
    if conditions.impact is not None:
        quoted = conditions.impact
        impact = Normal(quoted.speed, max(quoted.speed_sigma, 1e-3 * quoted.speed))
        reach = 0.04
    else:
        low, middle, high = (_coming(rate(time, gap, sigma), conditions, k) for k in K)
        impact = Normal(middle, max(0.5 * (high - low), UNSEEN * middle))
        reach = 2 * impact.sigma / impact.mean
        words = f"{name}: the first impact was not filmed; by the rebound it was at {middle:.2g} m/s"
        if middle < STILL_FALLING * terminal_speed(conditions):
            slow, height, fast = (_height(impact.mean + x * impact.sigma, conditions) for x in (-1, 0, 1))
            width = 0.5 * (fast - slow)
            notes.append(
                f"{words}, after a fall from rest from {1e3 * height:.3g} +- {1e3 * width:.2g} mm (--release)"
            )
            return Start("height", Normal(height, width))
        notes.append(f"{words} +- {impact.sigma:.2g}, after a steady fall (--release states one from rest)")
    # A sphere that is released above the wall falls faster than from rest.
    least = 1.02 * _met(_run_up(conditions), conditions) / impact.mean - 1
    about = np.array([max(-reach, least), 0.0, reach])
    about[1] = 0.5 * (about[0] + reach) if about[0] > -0.1 * reach else 0.0
    speeds = [release_reaching(impact.mean * (1 + x), conditions, gap=_run_up(conditions)).speed for x in about]
    return Start("impact", impact, _run_up(conditions), tuple(map(float, np.polyfit(about, speeds, 2))))


def _height(speed: float, conditions: Conditions) -> float:
    """The gap in m of a release from rest that meets the wall with the far ``speed`` in m/s."""
    from scipy.optimize import brentq

    free = speed**2 / (2 * conditions.free_fall)

    return float(brentq(lambda height: _met(height, conditions) - speed, 0.5 * free, 50 * free, rtol=1e-4))


def _met(height: float, conditions: Conditions) -> float:
    """The far speed in m/s with which a fall from rest from ``height`` in m meets the wall."""
    end = 20 * math.sqrt(2 * height / conditions.free_fall) + 20 * height / terminal_speed(conditions)
    return bounce(conditions, Release(height), Closures(measured=()), end, 1e-5).impacts[0].v_in


def _run_up(conditions: Conditions) -> float:
    return _RUN_UP_D * conditions.sphere.diameter


def _coming(out: float, conditions: Conditions, k: float) -> float:
    """The impact speed in m/s whose rebound is ``out`` by Eq. (4) with K = ``k``."""
    from scipy.optimize import brentq

    law, e_dry = Eq4Exponential(K=k), Closures().dry(conditions)
    if not out > 0:
        raise InputError(Defect("does not rise at its first frames", field="gap_m", value=f"{out:g} m/s"))

    def excess(ln_v: float) -> float:
        v = math.exp(ln_v)
        e = law(
            StokesNumber.from_speed(v, conditions).read_as(law.speed), e_dry, conditions, out_of_range="ignore"
        )
        return float(v * e - out)

    return math.exp(brentq(excess, math.log(out), math.log(1e3 * out), xtol=1e-6))


def rate(time: NDArray, gap: NDArray, sigma: float, least: int = 2) -> float:
    """Rate of the gap in m/s over the first frames, at least so many, in which the sphere moves."""
    moved = np.flatnonzero(np.abs(gap - gap[0]) > _MOVED * sigma)
    n = max(least, int(moved[0]) + 1 if len(moved) else len(gap))
    return float(np.polyfit(time[:n] - time[0], gap[:n], 1)[0])
