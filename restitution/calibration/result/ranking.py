"""Which law do the data support: information criteria, predictive scores by refitting, a predictive check.

- AIC and BIC from the maximum of the true likelihood, scatter and offsets counted as parameters;
- leave-one-out and leave-one-source-out: every impact, or every source, is predicted by a fit to the others, and
  its log predictive density summed (elpd). The density is normal with the errors, scatter and offset of the impact
  and the covariance of the parameters; an impact without a rebound has the probability of its limit. Of many, the
  fits are replaced by weights of draws where their diagnostic allows it (:mod:`.leaving_out`);
- a posterior-predictive check: the sum of products of neighbouring pulls in the order of St, against data drawn
  from the fitted law. Estimated scatter makes every law fit in the mean; a wrong shape leaves neighbours alike.

Two laws are called separated where their elpd differ by more than 4 and by more than twice the standard error of
the difference (Sivula, Magnusson & Vehtari, arXiv:2008.10296), by single impacts, and by sources wherever there
are three or more.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from restitution.calibration.estimation.fitting import Fit, estimate
from restitution.calibration.estimation.identifiability import ExactImpactsError
from restitution.calibration.estimation.likelihood import Likelihood
from restitution.calibration.estimation.plan import Plan
from restitution.calibration.reading.observations import Observations
from restitution.calibration.result.influence import fit_without
from restitution.calibration.result.leaving_out import LeavingOut, LeftOut
from restitution.calibration.showing import Showing, Table, counted
from restitution.errors import ConventionError, InputError

LEAST_DIFFERENCE = 4.0
"""Difference in elpd below which two laws are not separated, whatever its error."""
STANDARD_ERRORS = 2.0
"""In standard errors of the difference, the same."""
REPLICATES = 1000
"""Data drawn for the predictive check."""


@dataclass(frozen=True)
class Score:
    """One law's scores; ``loo`` has one elpd an impact, ``loso`` one a source (empty with a single source).

    ``left_out`` says which impacts were left out by a fit, and how far the weights of the others may be off.
    """

    label: str
    fit: Fit
    parameters: int
    log_likelihood: float
    aic: float
    bic: float
    loo: NDArray
    loso: NDArray
    left_out: LeftOut
    check: float
    """P-value of the predictive check: small where neighbours in St deviate alike."""

    @property
    def refitted(self) -> int:
        """How many impacts were left out by a fit, the others by weights of draws."""
        return int(self.left_out.refitted.sum())

    @property
    def elpd_loo(self) -> float:
        return float(self.loo.sum())

    @property
    def elpd_loso(self) -> float | None:
        return float(self.loso.sum()) if len(self.loso) else None


@dataclass(frozen=True)
class Row:
    """A law in its place: how far its elpd is behind the best law's, with the standard error of that."""

    score: Score
    best: bool
    behind: float
    behind_error: float
    separated: bool
    """Whether the data tell it from the best one."""

    @property
    def law(self) -> str:
        """Its label."""
        return self.score.label


@dataclass(frozen=True, repr=False)
class Ranking(Showing):
    """Scores, best first by leave-one-out, and laws that could not be fitted with the reason."""

    scores: tuple[Score, ...]
    failed: dict[str, str] = field(default_factory=dict)

    def difference(self, better: Score, worse: Score) -> tuple[float, float]:
        """Difference of the leave-one-out elpd and its standard error."""
        d = better.loo - worse.loo
        return float(d.sum()), float(np.sqrt(len(d) * np.var(d, ddof=1))) if len(d) > 1 else np.inf

    def separated(self, better: Score, worse: Score) -> bool:
        """Whether the data tell the two laws apart."""
        gap, error = self.difference(better, worse)
        if gap < LEAST_DIFFERENCE or gap < STANDARD_ERRORS * error:
            return False
        return len(better.loso) < 3 or better.elpd_loso > worse.elpd_loso

    def rows(self) -> list[Row]:
        """Every law in its place, best first."""
        best = self.scores[0]
        return [
            Row(s, s is best, *self.difference(best, s), s is not best and self.separated(best, s))
            for s in self.scores
        ]

    def shown(self) -> Table:
        """The laws, best first, and how far each is behind."""
        rows = [
            (row.law, f"{row.score.elpd_loo:.1f}",
             "" if row.best else f"{row.behind:.1f} +- {row.behind_error:.1f}",
             "yes" if row.separated else "", f"{row.score.aic:.1f}", f"{row.score.check:.2f}")
            for row in self.rows()
        ]  # fmt: skip
        left_out = f"; left out: {', '.join(self.failed)}" if self.failed else ""
        title = f"{counted(len(self.scores), 'law')} by predicting each impact from the others{left_out}"
        return Table(title, ("law", "elpd", "behind the best", "separated", "AIC", "check p"), rows)

    @property
    def contenders(self) -> list[Score]:
        """The best law and those that the data do not separate from it."""
        return [row.score for row in self.rows() if not row.separated]


def rank(
    plans: Sequence[tuple[str, Plan]],
    observations: Observations,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
    intervals: bool | Collection[str] = True,
) -> Ranking:
    """Fit and score plans on the same impacts: AIC, BIC, predicting each impact and each source from the others.

    Parameters
    ----------
    plans : name and plan of each candidate.
    observations : the impacts.
    seed : of the draws.
    progress : called with the name of each plan as it is begun, and how far it has come.
    intervals : whether parameters get intervals, or the names of those that do; half of the time goes into them.

    Returns
    -------
    The candidates from best to worst; a law that cannot be fitted is set aside with its reason.
    """
    scores, failed = [], {}
    for label, plan in plans:
        if progress:
            progress(label)
        say = (lambda text, label=label: progress(f"{label}: {text}")) if progress else None
        try:
            scores.append(score(label, plan, observations, seed, intervals, say))
        except ConventionError:
            failed[label] = (
                f"its Stokes number is {plan.model.convention}, that of the data {observations.convention}: fluid "
                "and sphere are needed (their columns, or --conditions FILE)"
            )
        except ExactImpactsError:
            raise  # what one law meets exactly, none of the others is the best of
        except InputError as error:
            failed[label] = str(error.defects[0])
    if not scores:
        raise InputError(*(f"{label}: {reason}" for label, reason in failed.items()))
    return Ranking(tuple(sorted(scores, key=lambda s: -s.elpd_loo)), failed)


def score(
    label: str,
    plan: Plan,
    observations: Observations,
    seed: int = 0,
    intervals: bool | Collection[str] = True,
    say: Callable[[str], None] | None = None,
) -> Score:
    """One law's scores."""
    fit = estimate(plan, observations, intervals)
    plain = estimate(plan, observations, False, False, fit.maximum, covariance=False)
    k, n = len(fit.maximum.parameters), len(observations)
    log_likelihood = -plain.maximum.negative_log
    leaving = LeavingOut(fit, lambda out: _left_out(fit, out), say)
    one = leaving.impacts()
    loso = leaving.sources().elpd if len(fit.likelihood.source_names) > 1 else np.zeros(0)
    aic, bic = 2 * k - 2 * log_likelihood, k * np.log(n) - 2 * log_likelihood
    return Score(label, fit, k, log_likelihood, aic, bic, one.elpd, loso, one, _neighbours(fit, seed))


def _left_out(whole: Fit, out: NDArray) -> float:
    """Log predictive density of the impacts ``out`` by a fit to the others."""
    return predictive(fit_without(whole, out), whole.likelihood, out)


def predictive(fit: Fit, whole: Likelihood, out: NDArray) -> float:
    """Log density of impacts that are not in ``fit``, given those of their sources that are.

    Normal: mean f + the offset known from the source, covariance of errors, scatter, what is open of the offset,
    and J C J^T of the parameters. Limits enter one by one, given the measured ones.
    """
    values, o = fit.maximum.values, whole.observations
    f = whole.moments(values)[0]
    of_law = np.array([p.mean for p in fit.maximum.parameters], bool)
    J, C = whole.jacobian(values)[:, of_law], fit.maximum.covariance[np.ix_(of_law, of_law)]
    inside = ~out & ~o.censored & np.isin(whole.sources, whole.sources[out])  # other sources tell nothing else
    known = _known_of_offset(whole, values, inside, out)
    mean = f[out] + known.gain((o.e - f)[inside, None])[:, 0]
    J_out = J[out] - known.gain(J[inside])
    cov_out = known.covariance + J_out @ C @ J_out.T
    e, upper = o.e[out], o.upper[out]
    seen = ~np.isnan(e)
    total = 0.0
    if seen.any():
        r, K = (e - mean)[seen], cov_out[np.ix_(seen, seen)]
        total -= 0.5 * (r @ np.linalg.solve(K, r) + np.linalg.slogdet(2 * np.pi * K)[1])
    for i in np.flatnonzero(~seen):
        m, v = mean[i], cov_out[i, i]
        if seen.any():
            weight = np.linalg.solve(K, cov_out[seen, i])
            m, v = m + weight @ r, v - weight @ cov_out[seen, i]
        total += float(log_ndtr((upper[i] - m) / np.sqrt(max(v, 1e-24))))
    return float(total)


class _Known(NamedTuple):
    """Of impacts left out, given those of their sources: the gain on their residuals, and what stays open."""

    gain: Callable[[NDArray], NDArray]
    covariance: NDArray


def _known_of_offset(whole: Likelihood, values: NDArray, inside: NDArray, out: NDArray) -> _Known:
    """With the offset alone the gain is w omega^2/(1 + omega^2 W); shared errors need the sources' matrix."""
    _, variance, omega = whole.moments(values)
    own, s_in, s_out = variance[out], whole.sources[inside], whole.sources[out]
    between = whole.between(values)
    if between is None:
        n, w = len(whole.source_names), 1 / variance[inside]
        shrink = omega**2 / (1 + omega**2 * np.bincount(s_in, w, n))

        def gain(x: NDArray) -> NDArray:
            sums = np.array([np.bincount(s_in, w * column, n) for column in x.T])
            return (shrink[:, None] * sums.reshape(-1, n).T)[s_out]  # a law may have no free parameter

        return _Known(gain, np.diag(own) + shrink[s_out, None] * (s_out[:, None] == s_out))
    places = np.concatenate([np.flatnonzero(inside), np.flatnonzero(out)])
    s = whole.sources[places]
    cov = np.diag(variance[places]) + omega**2 * (s[:, None] == s)
    seen = ~whole.observations.censored
    at = (np.cumsum(seen) - 1)[places]  # among the measured ones
    both = seen[places]
    cov[np.ix_(both, both)] += between[np.ix_(at[both], at[both])]
    m = int(inside.sum())
    G = np.linalg.solve(cov[:m, :m], cov[:m, m:]).T
    return _Known(lambda x: G @ x, cov[m:, m:] - G @ cov[:m, m:])


def _neighbours(fit: Fit, seed: int) -> float:
    """Posterior-predictive p-value of the products of neighbouring pulls in the order of St.

    Parameters are drawn from the normal approximation of their posterior; for each draw the statistic of the data
    is set against that of data drawn from the law.
    """
    likelihood, o = fit.likelihood, fit.likelihood.observations
    seen = np.flatnonzero(~o.censored)
    order = seen[np.argsort(o.St[seen], kind="stable")]
    if len(order) < 3:
        return 1.0
    values = fit.maximum.values
    f, variance, omega = likelihood.moments(values)
    sigma = np.sqrt(variance)[order]
    rng = np.random.default_rng(seed)
    mean = [j for j, p in enumerate(fit.maximum.parameters) if p.mean]
    C = fit.maximum.covariance[np.ix_(mean, mean)]
    away = rng.multivariate_normal(np.zeros(len(mean)), C, REPLICATES) if mean else np.zeros((REPLICATES, 0))
    observed = ((o.e - f)[order] - away @ likelihood.jacobian(values)[order][:, mean].T) / sigma
    sources = likelihood.sources[order]
    offsets = omega * rng.standard_normal((REPLICATES, len(likelihood.source_names)))[:, sources] / sigma
    drawn = rng.standard_normal((REPLICATES, len(order))) + offsets

    def statistic(z: NDArray) -> NDArray:
        return np.sum(z[:, 1:] * z[:, :-1], axis=1) / np.sum(z**2, axis=1)

    return float((1 + np.sum(statistic(drawn) >= statistic(observed))) / (1 + REPLICATES))
