r"""The likelihood of a set of impacts under a law, written as the statistics are.

Impact i has the Stokes number St_i and the restitution e_i, in error by sigma_St and sigma_e with correlation rho;
the particles differ from one another by the scatter tau; all impacts of a source (a laboratory, a record) share an
offset b_s. With the law f, its exact slope f' and the shrinkage b_s ~ N(0, omega^2),

    e_i = f(St_i) + b_s + error,    var_i = sigma_e^2 + f'^2 sigma_St^2 - 2 rho f' sigma_e sigma_St + tau^2,

    -2 ln L = sum_i [ (e_i - f_i - b_s)^2 / var_i + ln(2 pi var_i) ]        given the offsets.

The term ln var_i belongs to it: var_i depends on the parameters through f' and tau, and without it any misfit
could be bought with a steeper law. The offsets are integrated out, exactly: with w_i = 1/var_i, W = sum w_i over
the source and r_i = e_i - f_i,

    -2 ln L_s = sum w_i r_i^2 - omega^2 (sum w_i r_i)^2/(1 + omega^2 W) + sum ln(2 pi var_i) + ln(1 + omega^2 W).

An impact without a rebound is censored, not a zero: all that is known is e_i <= u_i, with the probability
Phi[(u_i - f_i - b_s)/sqrt(var_i)], averaged over what the other impacts of its source leave open of b_s.

Robust: Student's t with 4 degrees of freedom and scale sqrt(var_i) in place of the normal, so that an outlier
weighs little; the offset then is integrated by quadrature.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, log_ndtr, stdtr

from restitution.calibration.estimation.parameters import Earlier, Normal, Parameter, Placed
from restitution.calibration.estimation.rebound_model import ReboundModel
from restitution.calibration.reading.observations import Observations
from restitution.calibration.reading.shared_errors import Sums, off_diagonal, residual_variance, sums

SCATTER = "scatter"
"""Name of tau among the parameters."""
OFFSET = "source_offset"
"""Name of omega."""
STUDENT = 4.0
"""Degrees of freedom of the robust option."""
_LEAST_VARIANCE = 1e-24
"""Of an impact without any error, so that its weight stays finite."""
_NODES = np.linspace(-8.0, 8.0, 65)
"""Of the trapezoidal rule over an offset, in standard deviations; exact to rounding for smooth integrands."""
_LOG_2PI = math.log(2 * math.pi)
_LOG_T = gammaln((STUDENT + 1) / 2) - gammaln(STUDENT / 2) - 0.5 * np.log(STUDENT * np.pi)


class _Sources(NamedTuple):
    """Of which source each impact is, those with a rebound and the censored ones apart."""

    seen: NDArray
    censored: NDArray
    alone: NDArray
    """Places of the censored ones that are the only one of their source."""
    together: tuple[int, ...]
    """Sources with several censored ones."""


class _AtLaw(NamedTuple):
    """What follows from the law, whatever scatter and offsets are: of all impacts, and of both kinds apart."""

    f: NDArray
    slope: NDArray
    of_errors: NDArray
    """Variance by the errors alone."""
    r: NDArray
    r_variance: NDArray
    z: NDArray
    """Limit less f, of the censored ones."""
    z_variance: NDArray
    g: NDArray | None
    """Loadings of the measured ones' residuals on the errors of their record, (measured, m)."""
    finite: bool


@dataclass(frozen=True)
class Likelihood:
    """-ln L as a function of the values of ``parameters``.

    A parameter of the law, or ``e_dry``, is found by its name, or by ``name[level]`` where ``separate`` gives the
    label it is separate by. ``fixed`` are those that are not estimated; ``e_dry`` may be one number an impact.
    """

    model: ReboundModel
    observations: Observations
    parameters: tuple[Parameter, ...]
    fixed: Mapping[str, float | NDArray]
    separate: Mapping[str, str]
    robust: bool = False
    log_variance: bool = True
    """Off only to reproduce least-squares solutions that leave the term out."""
    earlier: Earlier | None = None
    """A prior of several parameters, by a fit to other data."""

    def __call__(self, values: Sequence[float] | NDArray) -> float:
        """-ln L, with the prior of an earlier fit; infinity where the law has no finite value."""
        values = np.asarray(values, float)
        return self._of_impacts(values) + (0.0 if self.earlier is None else self.jointly(values))

    @cached_property
    def jointly(self) -> Placed:
        """The prior of the earlier fit on all parameters."""
        return Placed.of(self.earlier, [p.name for p in self.parameters])

    def known_beforehand(self, p: Parameter) -> bool:
        """Whether a parameter has a prior that stands for measurements."""
        return isinstance(p.prior, Normal) or (self.earlier is not None and p.name in self.earlier.names)

    def _of_impacts(self, values: NDArray) -> float:
        law, (tau, omega) = self._at_law(values), self.deviations(values)
        if not (law.finite and math.isfinite(tau**2)):
            return np.inf
        r, v = law.r, np.maximum(law.r_variance + tau**2, _LEAST_VARIANCE)
        z, v_z = law.z, np.maximum(law.z_variance + tau**2, _LEAST_VARIANCE)
        if self.robust and omega > 0:
            return -sum(self._by_quadrature(s, r, v, z, v_z, omega) for s in range(len(self.source_names)))
        if self.robust or (law.g is None and omega == 0):
            below = self._log_below(z, v_z).sum() if len(z) else 0.0
            return -float(self._log_density(r, v).sum() + below)
        sources, own = self._kinds, self._sums(law, v)
        W, S = own.W, own.S
        result = 0.5 * float(own.Q.sum() + self.log_variance * (own.log_det.sum() + len(r) * _LOG_2PI))
        shrink = omega**2 / (1 + omega**2 * W)
        result += float((0.5 * np.log1p(omega**2 * W) - 0.5 * shrink * S**2).sum())
        if not len(z):
            return result
        # One limit in its source: the average of Phi over a normal offset is Phi again.
        alone = sources.alone
        s = sources.censored[alone]
        result -= float(log_ndtr((z[alone] - shrink[s] * S[s]) / np.sqrt(v_z[alone] + shrink[s])).sum())
        for s in sources.together:
            here = sources.censored == s
            offset = shrink[s] * S[s] + np.sqrt(shrink[s]) * _NODES[:, None]
            below = log_ndtr((z[here] - offset) / np.sqrt(v_z[here])).sum(axis=1)
            result -= _log_sum_exp(below - 0.5 * _NODES**2) - _LOG_WEIGHT
        return result

    def moments(self, values: NDArray) -> tuple[NDArray, NDArray, float]:
        """F and the variance of each impact without the offset, and the standard deviation of the offsets."""
        law, (tau, omega) = self._at_law(values), self.deviations(values)
        return law.f, np.maximum(law.of_errors + tau**2, _LEAST_VARIANCE), omega

    def law_values(self, values: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """F, its slope in the law's own St, and the variance of each impact without the offset."""
        law, (tau, _) = self._at_law(values), self.deviations(values)
        return law.f, law.slope, law.of_errors + tau**2

    def _at_law(self, values: NDArray) -> _AtLaw:
        """What follows from the law at these values; kept while a search moves scatter and offsets alone."""
        key, kept = values[self._of_law].tobytes(), self._kept
        if key not in kept:
            kept.clear()
            kept[key] = self._evaluated(values)
        return kept[key]

    def _evaluated(self, values: NDArray) -> _AtLaw:
        given, o, seen = self.by_impact(values), self.observations, self._seen
        e_dry = given.pop("e_dry")
        f, slope = self.model(self.law_St, e_dry, {n: x for n, x in given.items() if n not in (SCATTER, OFFSET)})
        variance = residual_variance(slope, o.e_sigma, self.law_St_sigma, o.correlation)
        finite = bool(np.isfinite(f).all() and np.isfinite(variance).all())
        parts = (o.e - f)[seen], variance[seen], (o.upper - f)[~seen], variance[~seen]
        return _AtLaw(f, slope, variance, *parts, self._loadings(slope), finite)

    def _loadings(self, slope: NDArray) -> NDArray | None:
        """Of the residuals of the measured impacts; None where no errors are shared."""
        shared = self.observations.shared
        if shared is None or self.robust:
            return None
        return (shared[:, 1] - (slope * self.ratio)[:, None] * shared[:, 0])[self._seen]

    def _sums(self, law: _AtLaw, v: NDArray) -> Sums:
        """Of each source without its offset; ``v`` are the variances of the measured impacts."""
        seen, n, r = self._kinds.seen, len(self.source_names), law.r
        if law.g is not None:
            return sums(law.g, v, r, seen, n)
        Q, log_det = np.bincount(seen, r**2 / v, n), np.bincount(seen, np.log(v), n)
        return Sums(Q, log_det, np.bincount(seen, 1 / v, n), np.bincount(seen, r / v, n))

    def between(self, values: NDArray) -> NDArray | None:
        """Covariances between residuals of different measured impacts, (measured, measured), no offsets."""
        g = self._at_law(np.asarray(values, float)).g
        return None if g is None else off_diagonal(g, self._kinds.seen)

    def deviations(self, values: NDArray) -> tuple[float, float]:
        """Standard deviations of the scatter and of the offsets."""
        tau, omega = (fixed if at is None else float(values[at]) for at, fixed in self._deviation_places)
        return tau, omega

    def offsets(self, values: NDArray) -> dict[str, tuple[float, float]]:
        """Offset of each source, as far as the data tell: conditional mean and standard deviation."""
        law, (tau, omega) = self._at_law(np.asarray(values, float)), self.deviations(values)
        own = self._sums(law, np.maximum(law.r_variance + tau**2, _LEAST_VARIANCE))
        shrink = omega**2 / (1 + omega**2 * own.W)
        known = zip((shrink * own.S).tolist(), np.sqrt(shrink).tolist(), strict=True)
        return dict(zip(self.source_names, known, strict=True))

    def jacobian(self, values: NDArray) -> NDArray:
        """D f_i / d parameter by central differences, shape (n, parameters); zero for standard deviations."""
        values = np.asarray(values, float)
        J = np.zeros((len(self.observations), len(values)))
        for j, p in enumerate(self.parameters):
            if not p.mean:
                continue
            step = 1e-6 * max(abs(values[j]), 1e-3 * min(1.0, p.bounds[1] - p.bounds[0]))
            above, below = values.copy(), values.copy()
            above[j], below[j] = min(values[j] + step, p.bounds[1]), max(values[j] - step, p.bounds[0])
            J[:, j] = (self.moments(above)[0] - self.moments(below)[0]) / (above[j] - below[j])
        return J

    def of(self, observations: Observations) -> Likelihood:
        """The same law and parameters for other observations, whose levels must be known here."""
        fixed = dict(self.fixed)
        if np.ndim(fixed.get("e_dry", 0.0)):
            fixed["e_dry"] = observations.e_dry
        return replace(self, observations=observations, fixed=fixed)

    @cached_property
    def source_names(self) -> list[str]:
        return self.observations.groups("source")[0]

    @cached_property
    def sources(self) -> NDArray:
        return self.observations.groups("source")[1]

    @cached_property
    def _seen(self) -> NDArray:
        return ~self.observations.censored

    @cached_property
    def _of_law(self) -> NDArray:
        """Which parameters the law depends on."""
        return np.array([p.name not in (SCATTER, OFFSET) for p in self.parameters], bool)

    @cached_property
    def _kept(self) -> dict[bytes, _AtLaw]:
        return {}

    @cached_property
    def _deviation_places(self) -> list[tuple[int | None, float]]:
        """Where scatter and offset stand among the values, and what they are where they are not estimated."""
        position = {p.name: j for j, p in enumerate(self.parameters)}
        return [(position.get(name), float(self.fixed.get(name, 0.0))) for name in (SCATTER, OFFSET)]

    @cached_property
    def _kinds(self) -> _Sources:
        seen, censored = self.sources[self._seen], self.sources[~self._seen]
        several = np.bincount(censored, minlength=len(self.source_names))[censored] > 1
        return _Sources(seen, censored, np.flatnonzero(~several), tuple(dict.fromkeys(censored[several].tolist())))

    @cached_property
    def ratio(self) -> NDArray:
        """St of the law over that of the data, impact by impact."""
        return self.observations.ratio_to(self.model.convention)

    @cached_property
    def law_St(self) -> NDArray:
        """St in the law's own convention."""
        return self.observations.St * self.ratio

    @cached_property
    def law_St_sigma(self) -> NDArray:
        """Errors of St in the law's own convention."""
        return self.observations.St_sigma * self.ratio

    @cached_property
    def places(self) -> list[tuple[str, int | NDArray]]:
        """For each quantity, where its value stands: an index, or one index an impact if it is separate."""
        position = {p.name: j for j, p in enumerate(self.parameters)}
        shared = [(name, j) for name, j in position.items() if "[" not in name]
        parted = []
        for name, label in self.separate.items():
            levels, group = self.observations.groups(label)
            parted.append((name, np.array([position[f"{name}[{level}]"] for level in levels])[group]))
        return shared + parted

    def by_impact(self, values: NDArray) -> dict[str, float | NDArray]:
        """Value of each quantity, a number or one an impact."""
        return dict(self.fixed) | {name: values[place] for name, place in self.places}

    def _log_density(self, r: NDArray, variance: NDArray) -> NDArray:
        if self.robust:
            tail = -0.5 * (STUDENT + 1) * np.log1p(r**2 / (STUDENT * variance))
            return _LOG_T + tail - 0.5 * np.log(variance)
        scale = np.log(2 * np.pi * variance) if self.log_variance else 0.0
        return -0.5 * (r**2 / variance + scale)

    def _log_below(self, distance: NDArray, variance: NDArray) -> NDArray:
        z = distance / np.sqrt(variance)
        return np.log(stdtr(STUDENT, z)) if self.robust else log_ndtr(z)

    def _by_quadrature(
        self, s: int, r: NDArray, v: NDArray, z: NDArray, v_censored: NDArray, omega: float
    ) -> float:
        """Ln of the integral over the offset of one source, nodes placed where the normal one would have it."""
        seen, censored = self.sources[self._seen] == s, self.sources[~self._seen] == s
        r, v, z, v_censored = r[seen], v[seen], z[censored], v_censored[censored]
        # Between the fold of a t likelihood's scale and that of the prior, the wider grid serves both.
        spread = omega / np.sqrt(1 + omega**2 * np.sum(1 / v) / 2)
        centre = np.median(r) * omega**2 / (omega**2 + (np.median(v) / len(v))) if len(r) else 0.0
        b = centre + spread * _NODES[:, None]
        log_p = self._log_density(r - b, v).sum(axis=1) + self._log_below(z - b, v_censored).sum(axis=1)
        log_p += -0.5 * (b[:, 0] / omega) ** 2 - np.log(omega * np.sqrt(2 * np.pi))
        return _log_sum_exp(log_p) + float(np.log(spread * (_NODES[1] - _NODES[0])))


def _log_sum_exp(x: NDArray) -> float:
    """ln sum exp x; scipy's takes any array library and ten times as long for these few nodes."""
    most = x.max()
    return float(most + np.log(np.exp(x - most).sum())) if np.isfinite(most) else float(most)


_LOG_WEIGHT = _log_sum_exp(-0.5 * _NODES**2)
