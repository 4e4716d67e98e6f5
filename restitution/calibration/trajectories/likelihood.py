r"""The likelihood of one recorded trajectory under the model of a bouncing sphere, written as the statistics are.

Frame i of a record shows the gap y_i at the time t_i. With the gap h(t'; x) of the model, x its unknowns
(:mod:`.flights`): what is open at the start (:mod:`.recordings`), the strength of the wake where there is one, and
the effective restitution of each bounce, or the film,

    y_i = b + s h(t'_i; x) + u(t_i) + w_i,        t' = T_1 + (t - t_1)(1 + r)   or   (t - t_0)(1 + r):

b the zero of the gap, s the scale of the digitisation, t_1 the recorded time of the first contact (of a release
from rest at a known height, t_0 of the release), r a relative error of the clock where one is stated. w is the
error of a reading, u an Ornstein-Uhlenbeck process: what the model lacks, and the drift of the camera
(:mod:`.correlated_noise`). Frames at rest enter as their mean, b + w/sqrt(n).

The unknowns eta = (b, s, t_1, r, x) in units of their priors (:mod:`.unknowns`) have normal priors N(0, 1);
that of each e is wide. They are integrated over, the model being linear about the most probable eta
(Gauss-Newton), as it is in b and s:

    ln L(sigma_u, tau) = -1/2 [z^T K^-1 z - g^T M^-1 g + ln|K| + ln|M| + n ln(2 pi)],
    z = y - f(eta*) + X eta*,  X = df/deta,  M = 1 + X^T K^-1 X,  g = X^T K^-1 z,  <eta> = M^-1 g.

sigma_u and tau are integrated out over a grid, priors uniform in ln(sigma_u) from 0.1 sigma_w to 0.3 d and in
ln(tau) from one frame interval to the length of the record. The fewer correlated deviations a record has, the
wider is what it tells; a record that the model meets badly tells little.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from restitution.calibration.trajectories.correlated_noise import gram_matrices
from restitution.calibration.trajectories.flight_map import FlightMap, Flights
from restitution.calibration.trajectories.recordings import Recording
from restitution.calibration.trajectories.unknowns import Open, Unknowns, priors

SIGMA_U = (0.1, 0.3)
"""Range of the prior of sigma_u: from this part of the reading error to this part of a diameter."""
_COARSE = (12, 7)
"""Nodes of the first grid over the noise, in ln(sigma_u) and ln(tau)."""
_FINE = (11, 9)
"""Nodes of those about the most probable part of it."""
_MOST_STEPS = 25
"""Of the search for the most probable unknowns."""
_SETTLED = 1e-3
"""A step of the search that is this part of a standard deviation ends it."""
_NEGLIGIBLE = 1e-4
"""Density over the greatest below which a node of the noise is left out of the next grid."""


@dataclass(frozen=True)
class Noise:
    """Grid of sigma_u (m) and tau (s) with the logarithm of prior times cell; ``at`` is the most probable one."""

    sigma_u: NDArray
    tau: NDArray
    log_weight: NDArray
    at: int = 0

    @classmethod
    def grid(cls, prior: NDArray, box: NDArray, shape: tuple[int, int]) -> Noise:
        """Trapezoidal rule over ``box`` within ``prior``, both [[low, high] of ln sigma_u, of ln tau]."""
        axes = [np.linspace(low, high, n) for (low, high), n in zip(box, shape, strict=True)]
        weights = [np.full(len(a), a[1] - a[0]) for a in axes]
        for w in weights:
            w[[0, -1]] /= 2
        s, t = np.meshgrid(*axes, indexing="ij")
        cell = np.log(np.multiply.outer(*weights)) - np.log(np.ptp(prior, axis=1)).sum()
        return cls(np.exp(s.ravel()), np.exp(t.ravel()), cell.ravel())

    @classmethod
    def typical(cls, r: Recording) -> Noise:
        """Where the search begins: a hundredth of a diameter, a quarter of sqrt(d/g)."""
        low, high = noise_prior(r).T
        at = np.clip(np.log([0.01 * r.conditions.sphere.diameter, 0.25 * r.fall_time]), low, high)
        sigma, tau = np.exp(at)[:, None]
        return cls(sigma, tau, np.zeros(1))


def noise_prior(r: Recording) -> NDArray:
    """Ranges of ln sigma_u and ln tau."""
    low, high = SIGMA_U[0] * r.sigma, SIGMA_U[1] * r.conditions.sphere.diameter
    dt, span = np.median(np.diff(r.time_s)), np.ptp(r.time_s)
    return np.log([[low, max(high, 10 * low)], [dt, span]])


@dataclass(frozen=True)
class Marginal:
    """Integrated over the unknowns: ln L, the eta of the linear model; ln L, <eta>, covariance at every node."""

    log: float
    eta: NDArray
    nodes: NDArray
    means: NDArray
    covariances: NDArray

    @property
    def weights(self) -> NDArray:
        """Posterior probability of each node of the noise."""
        return np.exp(self.nodes - self.log)

    def moments(self) -> tuple[NDArray, NDArray]:
        """Mean and covariance of eta, the noise integrated out."""
        w = self.weights
        mean = w @ self.means
        away = self.means - mean
        return mean, np.einsum("n,nij->ij", w, self.covariances) + np.einsum("n,ni,nj->ij", w, away, away)


@dataclass(frozen=True)
class RecordLikelihood:
    """One record; ``flights`` maps the unknowns ``open`` to a trajectory, ``eta`` is where the search begins."""

    recording: Recording
    open: tuple[Open, ...]
    flights: FlightMap
    noise: Noise
    eta: NDArray

    @property
    def bounces(self) -> int:
        """N, one less than the flights that are told."""
        return self.flights.flights - 1

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the unknowns, with their units."""
        return tuple(priors(self.recording, self.open))

    @cached_property
    def prior(self) -> tuple[NDArray, NDArray]:
        """Mean and standard deviation of each unknown."""
        mean, sigma = np.array(list(priors(self.recording, self.open).values())).T
        return mean, sigma

    def named(self, array: NDArray) -> Unknowns:
        """The unknowns on the last axis of ``array`` by name."""
        return Unknowns.of(self.recording, array)

    def values(self, eta: NDArray) -> NDArray:
        """The unknowns in their units."""
        mean, sigma = self.prior
        return mean + sigma * eta

    def model(self, values: NDArray) -> Flights:
        """The trajectory at given values of the unknowns."""
        return self.flights.expand(self.named(values).flight)

    def own_time(self, values: NDArray, flights: Flights, time: NDArray | None = None) -> NDArray:
        """The model's time of recorded ``time``, by default of the frames."""
        u = self.named(values)
        own = ((self.recording.time_s if time is None else time) - u.time) * (1 + u.rate)
        return own + (flights.contacts[1] if self.recording.clock_of == "contact" else 0.0)

    def predict(self, values: NDArray, time: NDArray | None = None) -> NDArray:
        """What the camera would show at ``time`` (by default its own frames), but for the noise."""
        u, flights = self.named(values), self.model(values)
        return u.zero + u.scale * flights(self.own_time(values, flights, time))[0]

    def columns(self, values: NDArray) -> tuple[NDArray, NDArray]:
        """What the model leaves of the frames, and d f/d unknown; shapes (n,) and (n, unknowns)."""
        u, flights = self.named(values), self.model(values)
        h, v = flights(self.own_time(values, flights))
        X = self.named(np.empty((len(h), len(values))))
        X.zero[:], X.scale[:], X.time[:] = 1.0, h, -u.scale * v * (1 + u.rate)
        if X.has_rate:
            X.rate[:] = u.scale * v * (self.recording.time_s - u.time)
        steps = 1e-3 * self.flights.steps
        others = self.flights.expand_each(u.flight + np.diag(steps))
        for j, (step, other) in enumerate(zip(steps, others, strict=True)):
            X.flight[:, j] = u.scale * (other(self.own_time(values, other))[0] - h) / step
        return self.recording.gap_m - u.zero - u.scale * h, X.array

    def marginal(self) -> Marginal:
        """The unknowns integrated over."""
        r, sigma = self.recording, self.prior[1]
        eta, columns = self._most_probable()
        k = len(sigma)
        z = columns[:, :1] + columns[:, 1:] @ eta[:, None]
        gram, log_det = gram_matrices(
            r.time_s, np.hstack([z, columns[:, 1:]]), r.sigma, self.noise.sigma_u, self.noise.tau
        )
        n = len(r.time_s) + self._add_rest(gram, 0.0)
        log_det = log_det + (np.log(r.sigma**2 / r.rest_frames) if r.rest_frames else 0.0)
        M = gram[:, 1:, 1:] + np.eye(k)
        g = gram[:, 1:, :1]
        C = np.linalg.inv(M)
        means = (C @ g)[:, :, 0]
        square = gram[:, 0, 0] - np.einsum("ni,ni->n", g[:, :, 0], means)
        nodes = -0.5 * (square + log_det + np.linalg.slogdet(M)[1] + n * np.log(2 * np.pi))
        nodes = nodes + self.noise.log_weight
        return Marginal(float(logsumexp(nodes)), eta, nodes, means, C)

    def _add_rest(self, gram: NDArray, level: float) -> int:
        """The mean of the frames at rest, of which the zero of the gap alone is a part; how many data that is.

        ``level`` is what is taken off already.
        """
        r = self.recording
        if not r.rest_frames:
            return 0
        row = np.zeros(gram.shape[1])
        row[0] = r.rest_gap - level
        self.named(row[1:]).zero[...] = self.named(self.prior[1]).zero
        gram += np.outer(row, row) * r.rest_frames / r.sigma**2
        return 1

    def _most_probable(self) -> tuple[NDArray, NDArray]:
        """Eta of greatest probability at the most probable noise; residual and d f/d eta there."""
        r, node, sigma = self.recording, [self.noise.at], self.prior[1]
        su, tau = self.noise.sigma_u[node], self.noise.tau[node]
        best, probable, step = np.inf, (self.eta, np.empty(0)), np.zeros_like(self.eta)
        eta = self.eta
        for _ in range(_MOST_STEPS):
            values = self.values(eta)
            residual, X = self.columns(values)
            columns = np.hstack([residual[:, None], X * sigma])
            gram, _ = gram_matrices(r.time_s, columns, r.sigma, su, tau)
            self._add_rest(gram, self.named(values).zero)
            away = gram[0, 0, 0] + eta @ eta
            if away < best:
                best, probable = away, (eta, columns)
                M = gram[0, 1:, 1:] + np.eye(len(eta))
                step = np.linalg.solve(M, gram[0, 1:, 0] - eta)
            else:  # past a contact the linear model overshoots
                step = 0.5 * step
            if step @ M @ step < _SETTLED**2:
                break
            eta = probable[0] + step
        return probable

    def settled(self) -> RecordLikelihood:
        """The same about the noise and the unknowns that are most probable."""
        prior = noise_prior(self.recording)
        current, box = self, prior
        for shape in (_COARSE, _FINE, _FINE):
            noise = Noise.grid(prior, box, shape)
            was = current.noise.sigma_u[current.noise.at], current.noise.tau[current.noise.at]
            away = np.abs(np.log(noise.sigma_u / was[0])) + np.abs(np.log(noise.tau / was[1]))
            current = replace(current, noise=replace(noise, at=int(np.argmin(away))))
            m = current.marginal()
            current = replace(
                current, noise=replace(noise, at=int(np.argmax(m.nodes - noise.log_weight))), eta=m.eta
            )
            box = _around(noise, m.nodes, prior)
        return replace(current, eta=current.marginal().eta)


def _around(noise: Noise, nodes: NDArray, prior: NDArray) -> NDArray:
    """The part of a grid that has all but a negligible part of the probability, one cell wider."""
    use = nodes > np.max(nodes) + np.log(_NEGLIGIBLE)
    box = []
    for values, (low, high) in zip((np.log(noise.sigma_u), np.log(noise.tau)), prior, strict=True):
        axis = np.unique(np.round(values, 9))
        cell = axis[1] - axis[0]
        box.append((max(values[use].min() - cell, low), min(values[use].max() + cell, high)))
    return np.array(box)
