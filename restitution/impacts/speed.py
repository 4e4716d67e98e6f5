"""Which speed an impact has: the speeds before and after one contact of a track, under each definition.

The frames of the approach and of the rebound are fitted by polynomials averaged over windows and orders
(:mod:`restitution.impacts.branch`). The contact time t_c is where the two extrapolated branches meet, and the
speed is the slope of a branch at t_c; where a soft contact is resolved, each branch ends where its own gap is
zero. The definitions differ in the frames that the branches are fitted to:

- ``far``: frames at gaps above h_film = 0.1 d only (:data:`restitution.stokes.H_FILM`), one cell at ten cells a
  diameter. It is the speed with which the motion out there would meet the wall. What a film that begins at a
  larger gap h0 has taken by then, a fraction of about ln(h0/h_film)/St, stays in it;
- ``contact``: all frames. Where the sampling resolves the film this is the slowed speed at the wall;
- ``window``: the straight line through the n nearest frames on each side (default 2), no extrapolation.

Uncertainties come from draws of the averaged fits, so they follow from the position noise and from the choice
of window. Errors of d, density and viscosity are not in them. On synthetic flights, every other one with a wake
that brakes the sphere after the rebound by up to v_in/sqrt(d/g) (about three times that after the first rebound
of the 3 mm sphere of Gondret et al. 2002), the 68 % intervals of v_in, v_out and e_eff cover 72 to 78 % for gap
tracks and 69 to 80 % for velocity tracks: what decays within a frame or two cannot be seen, and is allowed for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import NDArray

from restitution.conditions import Conditions
from restitution.impacts.branch import Branch, Points, Prior, average, line, points, speed_of
from restitution.stokes import Speed
from restitution.tracks import DETECTION, Contact, Track

DRAWS = 4000


class UnresolvedError(Exception):
    """The sampling does not resolve one ``branch``, approach or rebound, of a contact."""

    def __init__(self, branch: str, reason: str):
        self.branch = branch
        super().__init__(f"{reason} the {branch}" if reason.endswith("resolve") else f"the {branch} {reason}")


@dataclass(frozen=True)
class Speeds:
    """Draws of contact time, impact speed and rebound speed.

    Without a resolved rebound ``v_out`` is None and ``v_out_upper`` the speed of a free flight to the greatest
    height that was seen or would have been missed. ``early_s``: draws of the time by which the rebound leaves the
    wall before the approach reaches it, both extrapolated; None where the frames do not tell it.
    """

    time_s: NDArray
    v_in: NDArray
    v_out: NDArray | None
    v_out_upper: float | None
    note: str
    early_s: NDArray | None = None


@dataclass(frozen=True)
class ReadBranch:
    """What one branch was read as: the mean of its fits in (t - ``origin``), from ``begin`` to ``end`` in s."""

    begin: float
    end: float
    origin: float
    coefficients: NDArray
    rebound: bool

    def value(self, time: NDArray, quantity: str) -> NDArray:
        """Gap in m or velocity in m/s at ``time``."""
        c = self.coefficients if quantity == "gap" else polynomial.polyder(self.coefficients)
        return polynomial.polyval(time - self.origin, c)


@dataclass(frozen=True)
class SpeedMeasure:
    """Measures the contacts of a track under one definition of speed.

    ``film_m`` serves ``far`` only; ``level`` is the gap at which the sphere touches the wall, as recorded.
    """

    track: Track
    conditions: Conditions
    speed: Speed
    window_frames: int
    film_m: float
    level: float = 0.0

    def __call__(self, contact: Contact, rng: np.random.Generator) -> Speeds:
        """The speeds at one contact; raises :class:`UnresolvedError` where the sampling does not give them."""
        if not contact.approach:
            return self._quoted(contact, rng)
        if not contact.rebound:
            return self._limited(contact, "the sphere stays at the wall", rng)
        before, after = list(contact.approach)[::-1], list(contact.rebound)
        try:
            if contact.nearest is not None:
                side = before if self._precedes(contact.nearest, before, after, rng) else after
                side.insert(0, contact.nearest)
            t_c, v_in, v_out, early = self._meet(before, after, rng)
            v_in, v_out = _moving(v_in, "approach"), _moving(v_out, "rebound")
        except UnresolvedError as reason:
            # Of a flight that was not seen to come down nothing can be excluded.
            if reason.branch == "approach" or np.argmax(self.track.value[contact.rebound]) + 1 == len(after):
                raise
            return self._limited(contact, str(reason), rng)
        scale, note = self._scale(rng), ""
        if self.track.quantity == "velocity" and _lasts(before[0], after[0]):
            between = self.track.time_s[after[0]] - self.track.time_s[before[0]]
            note = f"contact lasts {1e3 * between:.2g} ms: its {after[0] - before[0] - 1} frames left out"
        return Speeds(t_c, scale * v_in, scale * v_out, None, note, early)

    def branches(self, contact: Contact) -> list[ReadBranch]:
        """What approach and rebound were read as, where the sampling resolves them, without the open frame."""
        found = []
        for frames, rebound in ((list(contact.approach)[::-1], False), (list(contact.rebound), True)):
            try:
                use = self._usable(frames, "rebound" if rebound else "approach")
            except UnresolvedError:
                continue
            origin = float(self.track.time_s[use[0]])
            branch = self._fit(use, origin, self._before(contact) if rebound else None)
            begin, end = (origin, origin + branch.reach) if rebound else (origin - branch.reach, origin)
            found.append(ReadBranch(begin, end, origin, branch.mean(), rebound))
        return found

    def _precedes(self, frame: int, before: list[int], after: list[int], rng: np.random.Generator) -> bool:
        """On which side of the contact the nearest frame lies, by the contact time of the others."""
        t_c, *_ = self._meet(before, after, rng)
        return self.track.time_s[frame] < np.nanmedian(t_c) if np.isfinite(t_c).any() else False

    def _meet(
        self, before: list[int], after: list[int], rng: np.random.Generator
    ) -> tuple[NDArray, NDArray, NDArray, NDArray | None]:
        """Draws of the contact time, the speeds of approach and rebound, and by what one is before the other."""
        low, high = self.track.time_s[before[0]], self.track.time_s[after[0]]
        lasts = _lasts(before[0], after[0])
        overlap = self.track.quantity == "gap" and self._touching([*before[:2], *after[:2]]).any()
        before, after = self._usable(before, "approach"), self._usable(after, "rebound")
        origin = 0.5 * (low + high)
        incoming, outgoing = (
            self._fit(before, origin).draw(DRAWS, rng),
            self._fit(after, origin, self._seen_speed(before)).draw(DRAWS, rng),
        )
        if self.track.quantity == "velocity":
            tau = left = rng.uniform(
                low - origin, high - origin, DRAWS
            )  # velocities do not say where between frames
            if lasts:
                beside = 2 * float(np.median(np.diff(self.track.time_s)))
                tau = low - origin + rng.uniform(0, beside, DRAWS)
                left = high - origin - rng.uniform(0, beside, DRAWS)
            return origin + tau, -_slope(incoming, tau), _slope(outgoing, left), None
        if overlap:  # a contact that lasts: each branch ends where its own gap does
            incoming[:, 0] -= self.level
            outgoing[:, 0] -= self.level
            tau, left = _root(incoming, np.zeros(DRAWS)), _root(outgoing, np.zeros(DRAWS))
            return origin + tau, -_slope(incoming, tau), _slope(outgoing, left), None
        tau = _root(incoming - outgoing, np.zeros(DRAWS))
        # Far from the frames that were fitted on both sides the branches do not meet.
        tau[np.abs(tau) > self.track.time_s[after[0]] - self.track.time_s[before[0]]] = np.nan
        early = None
        if self.speed is not Speed.WINDOW:
            at_wall = (branch - self.level * np.eye(1, branch.shape[1]) for branch in (incoming, outgoing))
            reaches, leaves = (_root(branch, np.zeros(DRAWS)) for branch in at_wall)
            early = reaches - leaves
        return origin + tau, -_slope(incoming, tau), _slope(outgoing, tau), early

    def _usable(self, frames: list[int], branch: str) -> NDArray:
        """The frames of a branch, nearest to the contact first, that the definition of speed admits."""
        use = np.asarray(frames, int)
        gap = self._gaps(use)
        if self.track.quantity == "gap":
            touching = self._touching(use)
            use, gap = use[~touching], gap[~touching]
        if self.speed is Speed.FAR:
            if np.max(gap, initial=0.0) < self.film_m:
                raise UnresolvedError(branch, f"stays below the film of {self.film_m * 1e3:.3g} mm")
            use = use[gap >= self.film_m]
        if self.speed is Speed.WINDOW:
            use = use[: self.window_frames]
        if len(use) < (self.window_frames if self.speed is Speed.WINDOW else 2):
            raise UnresolvedError(branch, f"only {len(use)} frame{'s' * (len(use) != 1)} resolve")
        return use

    def _touching(self, frames: NDArray | list[int]) -> NDArray:
        """Frames in the overlap of a soft contact, which belong to neither branch."""
        return self.track.value[frames] < self.level - 3 * self.track.sigma

    def _gaps(self, frames: NDArray) -> NDArray:
        """Gaps of the frames; of a velocity track by integration away from a contact half a frame before."""
        from scipy.integrate import cumulative_trapezoid

        value, time = self.track.value[frames], self.track.time_s[frames]
        if self.track.quantity == "gap" or not len(frames):
            return value - self.level
        first = 0.5 * abs(value[0]) * float(np.median(np.diff(self.track.time_s)))
        return first + cumulative_trapezoid(value, time, initial=0.0)

    def _fit(self, frames: NDArray, origin: float, impact_speed: float | None = None) -> Branch:
        """The fits of an approach, or of the rebound from an impact."""
        branch = self._points(frames, origin, impact_speed is not None)
        if self.speed is Speed.WINDOW:
            return line(branch, self.track.quantity)
        return average(branch, self.track.quantity, Prior.of(self.conditions), impact_speed)

    def _points(self, frames: NDArray, origin: float, rebound: bool) -> Points:
        return points(self.track.time_s[frames] - origin, self.track.value[frames], self.track.sigma, rebound)

    def _seen_speed(self, approach: NDArray) -> float:
        """How fast the frames of an approach are, as a scale."""
        return speed_of(self._points(approach, float(self.track.time_s[approach[0]]), False), self.track.quantity)

    def _before(self, contact: Contact) -> float:
        """The scale of the speed before a rebound; 0 where neither frames nor the source tell it."""
        try:
            return self._seen_speed(self._usable(list(contact.approach)[::-1], "approach"))
        except UnresolvedError:
            return self.conditions.impact.speed if self.conditions.impact is not None else 0.0

    def _alone(
        self, frames: list[int], branch: str, rng: np.random.Generator, impact_speed: float | None = None
    ) -> tuple[NDArray, float]:
        """Draws of a branch whose other side is missing, and the time of its nearest frame, their origin."""
        use = self._usable(frames, branch)
        origin = float(self.track.time_s[use[0]])
        return self._fit(use, origin, impact_speed).draw(DRAWS, rng), origin

    def _scale(self, rng: np.random.Generator) -> NDArray:
        """Draws of the factor that the track's scale error puts on its speeds; it cancels in their ratio."""
        return rng.normal(1.0, self.track.scale_sigma, DRAWS)

    def _quoted(self, contact: Contact, rng: np.random.Generator) -> Speeds:
        """A record that begins on the rebound: the impact speed is the quoted one."""
        quoted = self.conditions.impact
        outgoing, origin = self._alone(list(contact.rebound), "rebound", rng, quoted.speed)
        tau = _root(outgoing, np.zeros(DRAWS))
        v_in = rng.normal(quoted.speed, quoted.speed_sigma, DRAWS)
        v_out = self._scale(rng) * _moving(_slope(outgoing, tau), "rebound")
        note = f"impact speed ({quoted.speed_definition}) quoted by the source, not in the record"
        return Speeds(origin + tau, v_in, v_out, None, note)

    def _limited(self, contact: Contact, reason: str, rng: np.random.Generator) -> Speeds:
        """A contact whose rebound is not resolved: the approach, and a limit of the rebound speed."""
        incoming, origin = self._alone(list(contact.approach)[::-1], "approach", rng)
        seen = self.track.value[contact.rebound.start : contact.rebound.stop]
        highest = np.max(seen - self.level, initial=0.0) + DETECTION * self.track.sigma
        frame = float(np.median(np.diff(self.track.time_s)))
        if self.track.quantity == "gap":
            incoming[:, 0] -= self.level
            tau = _root(incoming, np.zeros(DRAWS))
            fall = abs(self.conditions.free_fall)
            highest = max(np.sqrt(2 * fall * highest), fall * frame)  # shorter flights go unseen as well
        else:
            tau = np.full(DRAWS, self.track.time_s[contact.approach[-1]] + 0.5 * frame - origin)
        v_in = self._scale(rng) * _moving(-_slope(incoming, tau), "approach")
        return Speeds(origin + tau, v_in, None, float(highest), f"rebound not resolved: {reason}")


def _lasts(last: int, first: int) -> bool:
    """Whether more than a frame lies between the last one of an approach and the first one of its rebound."""
    return first - last > 3


def _moving(speed: NDArray, branch: str) -> NDArray:
    """The draws in which the sphere moves as it was seen to: towards the wall before, away from it after.

    Draws whose branches do not meet are left out too; if both are more than a tenth, the speed is not resolved.
    """
    moves = speed > 0
    if np.mean(moves) < 0.9:
        if np.mean(np.isnan(speed)) > np.mean(speed <= 0):
            raise UnresolvedError(branch, _APART)
        raise UnresolvedError(branch, "has a speed that cannot be told from zero")
    return np.where(moves, speed, np.nan)


_APART = "meets the other side nowhere near the contact, by the frames that are taken (--speed contact takes all)"


def _value(coefficients: NDArray, tau: NDArray) -> NDArray:
    return polynomial.polyval(tau, coefficients.T, tensor=False)


def _slope(coefficients: NDArray, tau: NDArray) -> NDArray:
    return polynomial.polyval(tau, polynomial.polyder(coefficients, axis=1).T, tensor=False)


def _root(coefficients: NDArray, start: NDArray) -> NDArray:
    """Root of each polynomial nearest to its start by Newton's method; NaN where it does not settle."""
    tau = start.copy()
    step = np.zeros_like(tau)
    with np.errstate(all="ignore"):
        for _ in range(10):
            step = _value(coefficients, tau) / _slope(coefficients, tau)
            tau = tau - step
        tau[~(np.abs(step) < 1e-9 + 1e-6 * np.abs(tau))] = np.nan
    return tau
