r"""Weighted draws from the posterior near a maximum: what a prediction is made of, without a chain.

Law and conditions make the impacts nearly normal given the standard deviations phi = (scatter, offset), which are
few and far from normal: their density may be highest at zero. So the proposal has two parts. phi comes from a grid
of cells with the mass

    q(phi) ~ p(phi) L(theta(phi), phi) |C(phi)|^1/2,     C = (J^T V^-1 J + Lambda)^-1,
    theta(phi) = theta* + C J^T V(phi)^-1 r*             (one Gauss-Newton step from the maximum theta*),

and theta given its cell from Student's t about theta(phi) with the shape C(phi). Each draw is then weighted by
likelihood times priors (those of :mod:`.posterior`, all of them) over its density, so that bounds, limits and the
bend of the law are in the draws though they are not in the proposal. Points are those of a Kronecker lattice, not
of a generator of random numbers: the same data give the same draws, and data that change a little move them a
little.
The effective number (sum w)^2/sum w^2 says what they are worth; where it is small, a second proposal takes its
spread from the first draws.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincinv, gammaln, log_ndtr, ndtri

from restitution.calibration.estimation.likelihood import OFFSET, SCATTER, Likelihood
from restitution.calibration.estimation.maximum import Maximum
from restitution.calibration.estimation.parameters import Normal, Parameter, log_prior, prior_precision
from restitution.calibration.estimation.small_sample import Restriction

COUNT = 2048
"""Draws: the ends of an interval are then uncertain by some 2 % of its width."""
ENOUGH = 0.2
"""Effective part of the draws below which a proposal is tried anew."""
FREEDOM = 8.0
"""Of Student's t of the proposal: its tails must not be thinner than those of what it stands for."""
_CELLS = {0: 1, 1: 48, 2: 16}
"""Cells of the grid along each standard deviation, by how many there are."""
_FALL = 12.0
"""The grid ends where ln of the density has fallen by this much."""
_ACROSS = 12
"""Places tried along a standard deviation to find where its grid begins."""
_ROUNDS = 4
_MOST_TIMES = 4.0
"""By how much the number of draws is raised where each is worth less than half of one."""
MOST_SOURCES = 100
"""Whose offsets are drawn."""
_LEAST_WEIGHT = 1e-9
"""Of the greatest; lighter draws are left out."""


@dataclass(frozen=True)
class Draws:
    """Values of shape (draws, parameters), weights that sum to one, and an offset drawn for each source."""

    names: tuple[str, ...]
    values: NDArray
    weights: NDArray
    sources: tuple[str, ...]
    offsets: NDArray

    @property
    def effective(self) -> float:
        """How many independent draws they are worth."""
        return float(1 / np.sum(self.weights**2))


def lattice(count: int, dimensions: int) -> NDArray:
    """Points in the unit cube, (count, dimensions): multiples of powers of the generalised golden ratio."""
    ratio = 2.0
    for _ in range(60):  # of x^(d + 1) = x + 1
        ratio = (1 + ratio) ** (1 / (dimensions + 1))
    return (0.5 + np.arange(1, count + 1)[:, None] * ratio ** -np.arange(1.0, dimensions + 1)) % 1.0


def draw(likelihood: Likelihood, best: Maximum, count: int = COUNT) -> Draws:
    """Weighted draws about a maximum."""
    return finished(likelihood, *weighted(likelihood, best, count))


def weighted(likelihood: Likelihood, best: Maximum, count: int = COUNT) -> tuple[NDArray, NDArray]:
    """Values of the parameters, (draws, parameters), and their weights, without offsets of the sources."""
    proposal = _Proposal(likelihood, best)
    values, log_weight = proposal.draw(count)
    for _ in range(_ROUNDS):
        weight = _normalised(log_weight)
        if 1 / np.sum(weight**2) > ENOUGH * count or not proposal.adapt(values, weight):
            break
        again, log_again = proposal.draw(count)
        if np.sum(_normalised(log_again) ** 2) < np.sum(weight**2):
            values, log_weight = again, log_again
    worth = 1 / np.sum(_normalised(log_weight) ** 2)
    if worth < 0.5 * count:  # more of them for what each lacks
        values, log_weight = proposal.draw(int(min(0.5 * count / worth, _MOST_TIMES) * count))
    weight = _normalised(log_weight)
    kept = weight > _LEAST_WEIGHT * weight.max()
    return values[kept], weight[kept]


def finished(likelihood: Likelihood, values: NDArray, weights: NDArray) -> Draws:
    """Draws of the parameters with an offset of each source drawn from what its impacts leave open.

    Of more than :data:`MOST_SOURCES` none is drawn: a file of all of them would be larger than is read.
    """
    names = tuple(p.name for p in likelihood.parameters)
    if OFFSET not in names or len(likelihood.source_names) > MOST_SOURCES:
        return Draws(names, values, weights / weights.sum(), (), np.zeros((len(values), 0)))
    known = np.array([list(likelihood.offsets(row).values()) for row in values])  # (draws, sources, 2)
    z = np.random.default_rng(0).standard_normal(known.shape[:2])
    offsets = known[..., 0] + z * known[..., 1]
    return Draws(names, values, weights / weights.sum(), tuple(likelihood.source_names), offsets)


def _normalised(log_weight: NDArray) -> NDArray:
    weight = np.exp(log_weight - log_weight.max())
    return weight / weight.sum()


class _Proposal:
    """Where draws are proposed: cells of the standard deviations, and a t of the law's parameters for each."""

    def __init__(self, likelihood: Likelihood, best: Maximum):
        self.likelihood, self.parameters = likelihood, likelihood.parameters
        names = [p.name for p in self.parameters]
        self.deviations = [names.index(n) for n in (SCATTER, OFFSET) if n in names]
        self.law = [j for j, p in enumerate(self.parameters) if p.mean]
        own: Sequence[Parameter] = [self.parameters[j] for j in self.law]
        self.best = np.array(best.values, float)
        self.x = np.array([p.inward(self.best[j]) for j, p in zip(self.law, own, strict=True)])
        slope = np.array([p.slope(x) for p, x in zip(own, self.x, strict=True)])
        f, variance, _ = likelihood.moments(self.best)
        tau = self.best[names.index(SCATTER)] if SCATTER in names else likelihood.fixed.get(SCATTER, 0.0)
        o, seen = likelihood.observations, ~likelihood.observations.censored
        J = likelihood.jacobian(self.best)[:, self.law] * slope
        known = np.maximum(variance - tau**2, 0.0)
        self.r, self.z, self.J_z, self.v_z = (o.e - f)[seen], (o.upper - f)[~seen], J[~seen], known[~seen]
        earlier = likelihood.jointly.precision[np.ix_(self.law, self.law)]
        precision = (np.diag(prior_precision(own)) + earlier) * np.outer(slope, slope)
        places = tuple(names.index(n) if n in names else None for n in (SCATTER, OFFSET))
        self.measured = Restriction(J[seen], known[seen], likelihood.sources[seen], precision, places)
        self.pull_of_priors = np.array(
            [
                (p.prior.mean - self.best[j]) / p.prior.sigma**2 * s if isinstance(p.prior, Normal) else 0.0
                for j, p, s in zip(self.law, own, slope, strict=True)
            ]
        ) - slope * (earlier @ likelihood.jointly.away(self.best)[self.law])
        self.shift, self.spread = np.zeros(len(self.law)), np.eye(len(self.law))
        self._near: dict[tuple[float, ...], tuple[NDArray, NDArray]] = {}
        ends = [self._reach(j) for j in self.deviations]
        self.edges = [np.linspace(self._begin(k, ends), end, _CELLS[len(ends)] + 1) for k, end in enumerate(ends)]
        self.mass = self._masses()

    def near(self, phi: tuple[float, ...]) -> tuple[NDArray, NDArray]:
        """Centre and root of the shape of the law's parameters at these standard deviations."""
        if phi not in self._near:
            values = self.best.copy()
            values[self.deviations] = phi
            information, score = self.measured.information(values), self.measured.score(values, self.r)
            if len(self.z):
                tau, omega = self.measured.deviations(values)
                v = self.v_z + tau**2 + omega**2 + 1e-24
                u = self.z / np.sqrt(v)
                hazard = np.exp(-0.5 * u**2 - 0.5 * math.log(2 * math.pi) - log_ndtr(u))
                information = information + self.J_z.T @ ((hazard * (u + hazard) / v)[:, None] * self.J_z)
                score = score - self.J_z.T @ (hazard / np.sqrt(v))
            C = np.linalg.pinv(information, hermitian=True) if len(self.x) else np.zeros((0, 0))
            step = C @ (score + self.pull_of_priors)
            scale = np.sqrt(np.maximum(np.diag(C), 1e-300))
            root = np.linalg.cholesky(C / np.outer(scale, scale) + 1e-9 * np.eye(len(C))) * scale[:, None]
            self._near[phi] = self.x + np.clip(step, -3 * scale, 3 * scale), root
        return self._near[phi]

    def log_target(self, x: NDArray, phi: NDArray) -> float:
        """Ln of likelihood and priors as a density in x of the law and the values of the standard deviations."""
        values = self.best.copy()
        values[self.deviations] = phi
        jacobian = 0.0
        for j, at in zip(self.law, x, strict=True):
            p = self.parameters[j]
            low, high = p.limits
            if (low is not None and at < low) or (high is not None and at > high):
                return -np.inf
            values[j] = p.outward(float(at))
            jacobian += float(at) if p.scale == "log" else 0.0
        total = log_prior(self.parameters, values, every=True) + jacobian - self.likelihood(values)
        return total if math.isfinite(total) else -np.inf

    def log_mass(self, phi: tuple[float, ...]) -> float:
        """Ln q of the standard deviations, the law's parameters integrated out as if they were normal."""
        x, root = self.near(phi)
        inside = [np.clip(v, p.limits[0], p.limits[1]) for v, p in zip(x, self._own, strict=True)]
        return self.log_target(np.array(inside), np.array(phi)) + float(np.sum(np.log(np.diag(root))))

    @property
    def _own(self) -> list[Parameter]:
        return [self.parameters[j] for j in self.law]

    def _reach(self, j: int) -> float:
        """Where the density of one standard deviation ends, the others at their estimates."""
        k, most = self.deviations.index(j), self.parameters[j].bounds[1]
        typical = float(np.sqrt(np.mean(self.r**2)))

        def at(value: float) -> float:
            phi = [self.best[i] for i in self.deviations]
            # Both at zero, errors that are too small would make everything else look likely.
            phi = [max(x, 0.1 * typical) if i != k else value for i, x in enumerate(phi)]
            return self.log_mass(tuple(phi))

        top = end = min(max(self.best[j], 0.3 * typical, 1e-9), most)
        highest = max(at(0.5 * top), at(top))
        while end < most and highest - (here := at(end)) < _FALL:
            end, highest = min(1.3 * end, most), max(highest, here)
        while end > 1e-9 and highest - at(end / 1.3) > _FALL:
            end /= 1.3
        return end

    def _begin(self, k: int, ends: Sequence[float]) -> float:
        """Where the grid of one standard deviation begins: at nought unless half of it would be empty cells.

        What many impacts know within one of the cells from nought on, weights of draws from them do not tell. The
        other deviation may make up for this one, so it is tried over all of its range.
        """
        others = [np.linspace(0.0, end, _ACROSS) if i != k else [0.0] for i, end in enumerate(ends)]

        def highest(value: float) -> float:
            places = np.stack(np.meshgrid(*others, indexing="ij"), axis=-1).reshape(-1, len(ends))
            places[:, k] = value
            return max(self.log_mass(tuple(row)) for row in places.tolist())

        begin, step = 0.5 * ends[k], 0.5 * ends[k] / _ACROSS
        top = max(highest(begin + i * step) for i in range(_ACROSS))
        if top - highest(begin) < _FALL:
            return 0.0
        while top - highest(begin + step) > _FALL:
            begin += step
        return begin

    def _masses(self) -> NDArray:
        """Of the cells, by the middle of each, shape (cells,) or (cells, cells)."""
        if not self.deviations:
            return np.ones(())
        middles = [0.5 * (e[1:] + e[:-1]) for e in self.edges]
        grid = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1)
        log = np.array([self.log_mass(tuple(row)) for row in grid.reshape(-1, len(middles)).tolist()])
        mass = np.exp(log - log.max()).reshape(grid.shape[:-1])
        # No cell without a draw: what the middle of a cell does not see, its draws may.
        return mass / mass.sum() + 1e-5 / mass.size

    def _pick(self, u: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Standard deviations, the middles of their cells, and ln of their density; one row of ``u`` a draw."""
        n, mass = len(u), np.broadcast_to(self.mass / self.mass.sum(), self.mass.shape)
        phi, middle, log_q = np.zeros((n, len(self.edges))), np.zeros((n, len(self.edges))), np.zeros(n)
        conditional = np.broadcast_to(mass, (n, *mass.shape))
        for k, edges in enumerate(self.edges):
            marginal = conditional.reshape(n, len(edges) - 1, -1).sum(axis=2)
            marginal = marginal / marginal.sum(axis=1, keepdims=True)
            upto = np.cumsum(marginal, axis=1)
            cell = np.minimum((upto < u[:, k : k + 1]).sum(axis=1), len(edges) - 2)
            own = marginal[np.arange(n), cell]
            part = np.clip((u[:, k] - (upto[np.arange(n), cell] - own)) / own, 0.0, 1.0)
            width = edges[1] - edges[0]
            phi[:, k], middle[:, k] = edges[cell] + part * width, edges[cell] + 0.5 * width
            log_q += np.log(own / width)
            conditional = conditional[np.arange(n), cell]
        return phi, middle, log_q

    def draw(self, count: int) -> tuple[NDArray, NDArray]:
        """Values of all parameters, (count, parameters), and ln of their weights."""
        p, q = len(self.law), len(self.deviations)
        u = lattice(count, p + q + 1)
        phi, middle, log_q = self._pick(u)
        t = ndtri(u[:, q : q + p]) * np.sqrt(0.5 * FREEDOM / gammaincinv(0.5 * FREEDOM, u[:, -1]))[:, None]
        z = self.shift + t @ self.spread.T
        values = np.tile(self.best, (count, 1))
        values[:, self.deviations] = phi
        log_w = np.empty(count)
        log_t = _log_t(t) - np.linalg.slogdet(self.spread)[1]
        for i in range(count):
            centre, root = self.near(tuple(middle[i].tolist()))
            x = centre + root @ z[i]
            log_w[i] = self.log_target(x, phi[i]) - log_q[i] - log_t[i] + np.sum(np.log(np.diag(root)))
            values[i, self.law] = [o.outward(float(v)) for o, v in zip(self._own, x, strict=True)]
        self._z = z
        return values, log_w

    def adapt(self, values: NDArray, weight: NDArray) -> bool:
        """Take centre and spread of the law's parameters from weighted draws; False where they tell none."""
        if not self.law:
            return False
        # As many effective draws as parameters tell no spread: towards the old one then.
        own = min(1.0, 1 / np.sum(weight**2) / (10 * len(self.law)))
        mean = weight @ self._z
        C = (weight[:, None] * (self._z - mean)).T @ (self._z - mean)
        old = self.spread @ self.spread.T
        self.shift = (1 - own) * self.shift + own * mean
        self.spread = np.linalg.cholesky(own * 1.1 * C + (1 - own) * old + 1e-6 * np.eye(len(self.law)))
        return True


def _log_t(t: NDArray) -> NDArray:
    """Ln of the density of Student's t in so many dimensions, of unit shape."""
    p, nu = t.shape[1], FREEDOM
    constant = gammaln(0.5 * (nu + p)) - gammaln(0.5 * nu) - 0.5 * p * math.log(nu * math.pi)
    return constant - 0.5 * (nu + p) * np.log1p(np.sum(t**2, axis=1) / nu)
