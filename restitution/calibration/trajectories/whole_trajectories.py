r"""Impacts from whole trajectories: every frame takes part, through the equation of motion of a bouncing sphere.

The restitution of each bounce of a record is estimated with the start, the clock, the scale and the noise of the
record (:mod:`.likelihood`), under gravity, drag, added mass, wall, history force and, if wanted, the
wake of the approach; no rebound law takes part. Impact speed and e are those of the motion outside the film,
carried to the wall: the ``far`` definition. A law is then fitted to them, with their errors, as to any impacts
(:mod:`.estimation.fitting`), those of different bounces of a record with their correlations. What a record says of
its e being nearly normal, that is the likelihood of the frames,

    p(frames | theta, scatter) = int p(frames | e) p(e | law, theta, scatter) de.

The trajectories are those of quadratic maps (:mod:`.flight_map`), moved until the estimate lies within them; what
they differ by from a direct integration stands in the result.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import Closures, Trajectory
from restitution.bounce.agreement import agreement
from restitution.calibration.trajectories.flight_map import expand_about
from restitution.calibration.trajectories.flights import Bounces, Films, flight, forces_of, restitution_name
from restitution.calibration.trajectories.likelihood import Marginal, Noise, RecordLikelihood
from restitution.calibration.trajectories.recordings import Recording
from restitution.doubts import refuse
from restitution.errors import Defect, InputError
from restitution.impacts.find import find_impacts
from restitution.stokes import H_FILM, Speed, convention

_ROUNDS = 10
"""Maps about better and better centres before the estimate is given up."""
_ANOTHER_FLIGHT = 0.2
"""Distance of the frames from the model, rms in d, beyond which it follows another flight."""
_FEW = 9
"""Unknowns up to which every map has the terms of their pairs; of more, those about a known centre alone."""


@dataclass(frozen=True)
class WholeTrajectory:
    """What one record says under the model.

    ``mean`` and ``covariance`` of the unknowns ``names``; ``sigma_u`` and ``tau`` of the correlated noise, each as
    median and standard deviation of its logarithm; ``log_evidence`` is ln of the density of all frames, everything
    unknown integrated out. ``path`` is integrated at the estimate, ``map_error`` what the map differs from it by,
    at most, in standard deviations of a reading. ``rms_d``: residuals from the first contact on, in diameters.
    """

    recording: Recording
    wake: bool
    edge: float
    """Of the film, in diameters: outside it the speeds of the impacts are those of the motion."""
    likelihood: RecordLikelihood
    names: tuple[str, ...]
    mean: NDArray
    covariance: NDArray
    sigma_u: tuple[float, float]
    tau: tuple[float, float]
    log_evidence: float
    path: Trajectory
    map_error: float
    rms_d: float
    settled: bool = True
    """Whether the maps came to stand still about the estimate."""

    @property
    def sigma(self) -> NDArray:
        """Standard deviations of the unknowns."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def unknowns(self) -> dict[str, tuple[float, float]]:
        """Mean and standard deviation of each unknown, by its name with its unit."""
        return {n: (float(m), float(s)) for n, m, s in zip(self.names, self.mean, self.sigma, strict=True)}

    @property
    def restitutions(self) -> list[tuple[float, float]]:
        """Mean and standard deviation of the e of each bounce, where they are unknowns of their own."""
        names = (restitution_name(n) for n in range(1, self.bounces + 1))
        return [self.unknowns[name] for name in names if name in self.unknowns]

    @property
    def forces(self) -> dict[str, Any]:
        """Drag, history and wake as they are estimated, for :class:`restitution.bounce.Closures`."""
        return forces_of({name: mean for name, (mean, _) in self.unknowns.items()})

    @property
    def bounces(self) -> int:
        """How many rebounds were seen."""
        return self.likelihood.bounces

    def impact_moments(self) -> tuple[NDArray, NDArray, NDArray]:
        """Impact speeds in m/s and restitutions, (bounces,) each, and their covariance, (2 bounces, 2 bounces).

        Of a model in which the restitution of each bounce is unknown.
        """
        n, steps = self.bounces, self.likelihood.flights.steps
        here = self.likelihood.named(self.mean)
        x, at = here.flight, here.flight_places
        J = np.zeros((2 * n, len(x)))
        for j, step in enumerate(0.1 * steps):
            more, less = x.copy(), x.copy()
            more[j], less[j] = more[j] + step, less[j] - step
            speeds = [self.likelihood.flights.expand(v).impact_speed[:n] for v in (more, less)]
            J[:n, j] = (speeds[0] - speeds[1]) / (2 * step)
        J[n:, -n:] = np.eye(n)
        speeds = self.likelihood.flights.expand(x).impact_speed[:n]
        return speeds, x[-n:], J @ self.covariance[at, at] @ J.T

    def rows(self, stokes: str = "st") -> list[dict]:
        """Its impacts in the schema of the impact table; without a rebound as :mod:`restitution.impacts` has it.

        Bounces whose flights before or after stay within the film are left out: the far speed does not see them.
        """
        r, per_speed = self.recording, convention(stokes).per_speed(self.recording.conditions)
        v, e, C = self.impact_moments()
        outside = self.outside()
        about: dict[str, Any] = {
            "record": r.name, "kind": "measured", "outcome": "rebound", "speed_definition": str(Speed.FAR),
            "film_edge_d": self.edge,
            "stokes_convention": stokes, "e_dry": r.conditions.sphere.e_dry,
            "note": "from the whole trajectory" + (", wake of the approach" if self.wake else ""),
        }  # fmt: skip
        rebounds = []
        for n in np.flatnonzero(outside):
            v_sigma, e_sigma = np.sqrt(C[n, n]), np.sqrt(C[n + self.bounces, n + self.bounces])
            rebounds.append(
                about | {
                    "impact": int(n) + 1, "time_s": self.contact_times()[n],
                    "impact_speed_m_s": v[n], "impact_speed_sigma_m_s": v_sigma,
                    "stokes": v[n] * per_speed, "stokes_sigma": v_sigma * per_speed,
                    "rebound_speed_m_s": e[n] * v[n], "e_eff": e[n], "e_eff_sigma": e_sigma,
                    "e_stokes_correlation": C[n, n + self.bounces] / (v_sigma * e_sigma),
                }
            )  # fmt: skip
        slopes = find_impacts(r.track, r.conditions, Speed.FAR, stokes, r.name, h_film=self.edge).rows
        last = max((row["impact"] for row in rebounds), default=0)
        return rebounds + [row for row in slopes if row["outcome"] == "not_resolved" and row["impact"] > last]

    def outside(self) -> NDArray:
        """Of each bounce, whether the flights before and after it leave the film."""
        flights = self.likelihood.model(self.mean)
        leaves = flights.gap.max(axis=1) > self.edge * self.recording.conditions.sphere.diameter
        return leaves[: self.bounces] & leaves[1 : self.bounces + 1]

    def contact_times(self) -> NDArray:
        """Recorded times of the bounces, in s."""
        flights, u = self.likelihood.model(self.mean), self.likelihood.named(self.mean)
        zero = flights.contacts[1] if self.recording.clock_of == "contact" else 0.0
        return (flights.contacts[1 : self.bounces + 1] - zero) / (1 + u.rate) + u.time


def whole_trajectories(
    records: Sequence[Recording], wake: bool, edge: float = H_FILM, say: Callable[[str], None] | None = None
) -> list[WholeTrajectory]:
    """All records under the model; raises :class:`InputError` naming the record where that cannot be done.

    ``say`` is told how far the work has come.
    """
    found = []
    for number, r in enumerate(records, 1):
        if say is not None:
            say(f"{r.name}: record {number} of {len(records)}, {'with' if wake else 'without'} wake")
        found.append(whole_trajectory(r, wake, edge))
    return found


def whole_trajectory(r: Recording, wake: bool, edge: float = H_FILM) -> WholeTrajectory:
    """One record, the restitution of each bounce unknown; the film is a black box within ``edge`` diameters."""
    return settle(Bounces(r, wake, edge))


def settle(model: Bounces | Films) -> WholeTrajectory:
    """What a record says of the unknowns of a model of its flight."""
    r = model.recording
    centre, steps = model.guess(), np.array([x.step for x in model.open])
    noise, eta, narrow = Noise.typical(r), None, False
    for _ in range(_ROUNDS):
        low, high = np.array([(x.low, x.high) for x in model.open]).T
        low, high = low + steps, high - steps
        centre = np.clip(centre, low, high)
        pairs = narrow or len(centre) <= _FEW
        flights = expand_about(model, centre, steps, model.bounces + 1, model.before(centre[0]), pairs)
        if flights.flights < model.bounces + 1:
            # A last bounce so low that the model has none, or not in all of the map.
            if flights.flights < 2:
                raise InputError(Defect("the model does not bounce where the record does", file=r.name))
            model = model.fewer(flights.flights - 1)
            kept = len(model.open)
            centre, steps, eta = centre[:kept], steps[:kept], None
            continue
        likelihood = RecordLikelihood(r, model.open, flights, noise, np.zeros(0))
        mean, sigma = likelihood.prior
        if eta is None:
            values = mean.copy()
            likelihood.named(values).flight[:] = centre
            eta = (values - mean) / sigma
        likelihood = RecordLikelihood(r, model.open, flights, noise, eta).settled()
        noise, eta = likelihood.noise, likelihood.eta
        m = likelihood.marginal()
        new = likelihood.named(likelihood.values(m.moments()[0])).flight
        moved = np.max(np.abs(np.clip(new, low, high) - centre) / steps)
        centre = new
        if narrow and moved < 1.5:
            break
        if moved < 1.5:
            own = likelihood.prior[1] * np.sqrt(np.diag(m.moments()[1]))
            steps, narrow = np.clip(likelihood.named(own).flight, 0.02 * steps, steps), True
    else:
        return _followed(replace(_summary(model, likelihood, m), settled=False))
    return _followed(_summary(model, likelihood, m))


def _followed(found: WholeTrajectory) -> WholeTrajectory:
    """Refuse a sphere too fast for its conditions where no flight of the model is near its frames."""
    if not found.settled or found.rms_d > _ANOTHER_FLIGHT:
        refuse(doubt for doubt in found.recording.doubts if doubt.name == "speed")
    return found


def _summary(model: Bounces | Films, likelihood: RecordLikelihood, m: Marginal) -> WholeTrajectory:
    """The numbers, and a direct integration at the estimate."""
    r, (eta, C) = model.recording, m.moments()
    values, sigma = likelihood.values(eta), likelihood.prior[1]
    path = model(likelihood.named(values).flight)
    flights = likelihood.model(values)
    time = likelihood.own_time(values, flights)
    inside = (time > 0) & (time < flights.contacts[-1])
    away = np.abs(path.gap(time) - flights(time)[0])[inside]
    residual = r.gap_m - likelihood.predict(values)
    after = time >= flights.contacts[1]
    return WholeTrajectory(
        r, model.wake, model.edge, likelihood, likelihood.names, values, C * np.outer(sigma, sigma),
        _log_moments(likelihood.noise.sigma_u, m.weights), _log_moments(likelihood.noise.tau, m.weights),
        m.log, path,
        float(np.max(away, initial=0.0) / r.sigma),
        float(np.sqrt(np.mean(residual[after] ** 2)) / r.conditions.sphere.diameter),
    )  # fmt: skip


def _log_moments(values: NDArray, weights: NDArray) -> tuple[float, float]:
    """Exp of the mean of the logarithm, and its standard deviation."""
    ln = np.log(values)
    mean = float(weights @ ln)
    return float(np.exp(mean)), float(np.sqrt(max(weights @ (ln - mean) ** 2, 0.0)))


def distance_d(trajectory: WholeTrajectory, closures: Closures) -> tuple[Trajectory, float, float]:
    """The model with other closures, released as estimated: its trajectory, rms distance in d, first apex in m.

    The clocks are brought together on the approach alone (:func:`restitution.bounce.agreement.agreement`).
    """
    r = trajectory.recording
    path = flight(r, float(trajectory.likelihood.named(trajectory.mean).start), closures)
    apexes = path.apexes()
    return path, agreement(path, r.track).rms_d, float(apexes[0]) if len(apexes) else 0.0


def band(trajectory: WholeTrajectory, time: NDArray, draws: int = 200, seed: int = 0) -> NDArray:
    """Gap in m of the model at recorded ``time`` for draws from what is known of the unknowns, (draws, times)."""
    rng = np.random.default_rng(seed)
    root = np.linalg.cholesky(
        trajectory.covariance + 1e-18 * np.diag(np.maximum(np.diag(trajectory.covariance), 1e-30))
    )
    values = trajectory.mean + rng.standard_normal((draws, len(trajectory.mean))) @ root.T
    return np.array([trajectory.likelihood.predict(v, time) for v in values])
