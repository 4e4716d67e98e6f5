"""The posterior by affine-invariant sampling (emcee), or a refusal where it has not converged.

Like :mod:`.maximum` this knows only a negative log-likelihood and parameters, whose priors all take part here:
uniform within the bounds (in the logarithm for parameters that range over decades), half-normal for standard
deviations, normal where there is an independent measurement. Walkers move in the internal coordinates; the chain
is taken when its autocorrelation time tau is known: chain longer than 50 tau, tau changed by less than 5 % since
the last look. Without that there is no answer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.maximum import Maximum
from restitution.calibration.estimation.parameters import Parameter, log_prior
from restitution.errors import InputError

LONGER_THAN = 50
"""Autocorrelation times that a chain must have, as emcee's authors recommend."""
STEADY = 0.05
"""Relative change of the autocorrelation time since the last look below which it is known."""
_LOOK = 500
"""Steps between two looks."""


@dataclass(frozen=True)
class Posterior:
    """Draws of shape (draws, parameters) and what it took to get them."""

    parameters: tuple[Parameter, ...]
    draws: NDArray
    walkers: int
    steps: int
    autocorrelation_time: NDArray
    acceptance: float
    seed: int

    @property
    def median(self) -> NDArray:
        return np.median(self.draws, axis=0)

    def interval(self, level: float) -> NDArray:
        """Central intervals, shape (parameters, 2)."""
        return np.quantile(self.draws, [0.5 * (1 - level), 0.5 * (1 + level)], axis=0).T


def sample(
    negative_log: Callable[[NDArray], float],
    best: Maximum,
    seed: int = 0,
    most_steps: int = 20_000,
    progress: bool = False,
    many: bool = False,
    say: Callable[[str], None] | None = None,
) -> Posterior:
    """Draws from the posterior around a maximum; raises :class:`InputError` where the chain does not converge.

    With ``many`` the function takes points (n, parameters) and gives n numbers, those of all walkers that move
    together, and they move by differences of one another (ter Braak & Vrugt, Stat. Comput. 18 (2008) 435), which
    in priors with corners takes a quarter of the steps.
    ``say`` is told how far the chain has come.
    """
    import emcee

    parameters = best.parameters
    if not parameters:
        raise InputError("there is no free parameter to sample")
    rng = np.random.default_rng(seed)
    low, high = (np.array(x) for x in zip(*(_range(p) for p in parameters), strict=True))
    outward = [p.outward for p in parameters]

    def log_probability(x: NDArray) -> float:
        if (x < low).any() or (x > high).any():
            return -np.inf
        values = np.array([out(v) for out, v in zip(outward, x, strict=True)])
        prior = log_prior(parameters, values, every=True)
        # The prior is a density in the value; the walk is in x.
        jacobian = sum(v for p, v in zip(parameters, x, strict=True) if p.scale == "log")
        total = prior + jacobian - negative_log(values)
        return total if np.isfinite(total) else -np.inf

    def log_probabilities(points: NDArray) -> NDArray:
        total = np.full(len(points), -np.inf)
        inside = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
        if len(inside):
            values = np.array([[out(v) for out, v in zip(outward, x, strict=True)] for x in points[inside]])
            prior = np.array([log_prior(parameters, v, every=True) for v in values])
            found = prior + points[inside][:, logarithmic].sum(axis=1) - negative_log(values)
            total[inside] = np.where(np.isfinite(found), found, -np.inf)
        return total

    logarithmic = [j for j, p in enumerate(parameters) if p.scale == "log"]
    walkers = max(32, 4 * len(parameters) + 4)
    function = log_probabilities if many else log_probability
    moves = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)] if many else None
    sampler = emcee.EnsembleSampler(walkers, len(parameters), function, moves=moves, vectorize=many)
    sampler.random_state = np.random.RandomState(seed).get_state()
    position = _start(best, walkers, low, high, rng)
    last, time = np.full(len(parameters), np.inf), np.full(len(parameters), np.inf)
    while sampler.iteration < most_steps:
        if say is not None:
            say(f"posterior: {sampler.iteration} steps of {walkers} walkers")
        position = sampler.run_mcmc(position, _LOOK, progress=progress, skip_initial_state_check=True)
        time = sampler.get_autocorr_time(tol=0)
        long_enough = sampler.iteration > LONGER_THAN * np.max(time)
        if np.isfinite(time).all() and long_enough and (np.abs(time - last) < STEADY * time).all():
            break
        last = time
    else:
        raise InputError(
            f"the posterior has not converged in {most_steps} steps (autocorrelation time {np.nanmax(time):.0f}, "
            f"a chain of {LONGER_THAN} times that is needed): fix a parameter, give one a prior, or narrow bounds"
        )
    chain = sampler.get_chain(discard=int(3 * np.max(time)), thin=max(1, int(np.min(time) / 2)), flat=True)
    draws = np.array([[out(v) for out, v in zip(outward, x, strict=True)] for x in chain])
    return Posterior(
        parameters, draws, walkers, sampler.iteration, time, float(np.mean(sampler.acceptance_fraction)), seed
    )


def _range(p: Parameter) -> tuple[float, float]:
    """Where x may walk; a standard deviation from zero on, since its sign means nothing."""
    low, high = p.limits
    return (0.0 if p.scale == "even" else (-np.inf if low is None else low)), (np.inf if high is None else high)


def _start(best: Maximum, walkers: int, low: NDArray, high: NDArray, rng: np.random.Generator) -> NDArray:
    """Walkers around the maximum, by its standard errors, folded into the range."""
    x = np.array([p.inward(v) for p, v in zip(best.parameters, best.values, strict=True)])
    slope = np.array([p.slope(v) for p, v in zip(best.parameters, x, strict=True)])
    reach = np.where(np.isfinite(high - low), high - low, np.inf)
    spread = np.nan_to_num(best.sigma / np.abs(slope), nan=0.01, posinf=0.01)
    spread = np.clip(spread, 1e-6 * np.maximum(np.abs(x), 1e-3), 0.1 * reach)
    position = x + 0.5 * spread * rng.standard_normal((walkers, len(x)))
    position = np.where(position < low, 2 * low - position, position)
    return np.where(position > high, 2 * high - position, position)
