r"""Exact first and second derivatives of the likelihood: of the law by its symbols, of the statistics by hand.

A law or a formula is differentiated symbolically to its parameters, value and slope in St, once and twice. Of a
source with residuals r_i, variances v_i and the offset's omega, with w_i = 1/v_i,

    -2 ln L = Q - h S^2 + sum ln v_i + ln u,    Q = sum w_i r_i^2,  S = sum w_i r_i,  W = sum w_i,
    u = 1 + omega^2 W,    h = omega^2/u,

and Q, S, W have their derivatives through r_i, v_i. What impacts without a rebound add, and the term of
:mod:`.small_sample`, are smooth and small: second differences. Standard errors follow from the inverse; numerical
second derivatives of the whole would lose them where parameters are nearly exchangeable.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.formula import FormulaModel, symbolic
from restitution.calibration.estimation.likelihood import OFFSET, SCATTER, Likelihood
from restitution.calibration.estimation.parameters import Normal, prior_precision
from restitution.calibration.estimation.rebound_model import LawModel

_LEAST_VARIANCE = 1e-24
_STEP = 1e-3
"""Of second differences, in standard errors or of the value itself."""


@cache
def _compiled(text: str, names: tuple[str, ...], wrt: tuple[str, ...], sloped: bool) -> Callable[..., Any]:
    """First and second derivatives to ``wrt`` of the value and, if ``sloped``, of the slope in St."""
    import sympy

    symbols = {name: sympy.Symbol(name, real=True) for name in names}
    f = symbolic(text, symbols).replace(sympy.Abs, lambda x: _greatest(x, -x))
    f = f.replace(sympy.Max, _greatest).replace(sympy.Min, _least)
    outputs = []
    for expression in (f, f.diff(symbols["St"])) if sloped else (f,):
        first = [expression.diff(symbols[a]) for a in wrt]
        second = [first[i].diff(symbols[b]) for i in range(len(wrt)) for b in wrt[: i + 1]]
        outputs += first + second
    own = {"Choice": lambda d, a, b: np.where(d >= 0, a, b)}
    return sympy.lambdify(list(symbols.values()), outputs, modules=[own, "scipy", "numpy"], cse=True)


@cache
def _choice() -> Any:
    """``where(d >= 0, a, b)`` as a function that sympy differentiates; at a kink either side is as good."""
    import sympy

    class Choice(sympy.Function):
        """Of ``d``, ``a``, ``b``."""

        def _eval_derivative(self, symbol: Any) -> Any:
            d, a, b = self.args
            return Choice(d, a.diff(symbol), b.diff(symbol))

    return Choice


def _greatest(first: Any, *rest: Any) -> Any:
    other = _greatest(*rest) if rest else first
    return _choice()(first - other, first, other) if rest else first


def _least(*parts: Any) -> Any:
    return -_greatest(*(-x for x in parts))


@dataclass(frozen=True)
class Derivatives:
    """Value, gradient (parameters,) and Hessian (parameters, parameters) of -ln L with priors."""

    gradient: NDArray
    hessian: NDArray


class Curvature:
    """Derivatives of -ln L at any values; :meth:`of` gives None where there are no symbols to differentiate."""

    def __init__(self, likelihood: Likelihood, extra: Callable[[NDArray], float] | None):
        self.likelihood, self.extra = likelihood, extra
        names = [p.name for p in likelihood.parameters]
        self.position = {name: j for j, name in enumerate(names)}
        self.wrt = tuple(
            dict.fromkeys(
                name.partition("[")[0] for p, name in zip(likelihood.parameters, names, strict=True) if p.mean
            )
        )
        self.sloped = bool(np.any(likelihood.observations.St_sigma > 0))
        model = likelihood.model
        self.names = ("St", "e_dry", *(p.name for p in model.parameters))
        self.function = _compiled(model.text, self.names, self.wrt, self.sloped) if self.wrt else None

    @classmethod
    def of(cls, likelihood: Likelihood, extra: Callable[[NDArray], float] | None = None) -> Curvature | None:
        """``extra`` is a term of the standard deviations alone, added to -ln L."""
        model = likelihood.model
        symbols = isinstance(model, FormulaModel) or (
            isinstance(model, LawModel) and model.law.formula is not None
        )
        if likelihood.robust or not symbols or likelihood.observations.shared is not None:
            return None
        return cls(likelihood, extra)

    def __call__(self, values: NDArray) -> Derivatives | None:
        """None where a derivative has no finite value."""
        with np.errstate(all="ignore"):
            gradient, hessian = self._measured(np.asarray(values, float))
        precision = prior_precision(self.likelihood.parameters)
        for j, p in enumerate(self.likelihood.parameters):
            if isinstance(p.prior, Normal):
                gradient[j] += (values[j] - p.prior.mean) * precision[j]
        hessian = hessian + np.diag(precision) + self.likelihood.jointly.precision
        gradient = gradient + self.likelihood.jointly.precision @ self.likelihood.jointly.away(values)
        first, second = self._differences(values, hessian)
        gradient, hessian = gradient + first, hessian + second
        if not (np.isfinite(gradient).all() and np.isfinite(hessian).all()):
            return None
        return Derivatives(gradient, 0.5 * (hessian + hessian.T))

    def _of_law(self, values: NDArray) -> tuple[list[NDArray], list[NDArray]]:
        """Gradient (n, parameters) and second derivatives (n, parameters, parameters), of value and of slope."""
        lk, n, k = self.likelihood, len(self.likelihood.observations), len(self.wrt)
        firsts, seconds = [np.zeros((n, len(values)))] * 2, [np.zeros((n, len(values), len(values)))] * 2
        if self.function is None:
            return firsts, seconds
        given = lk.by_impact(values)
        out = [
            np.broadcast_to(np.asarray(x, float), n)
            for x in self.function(lk.law_St, *(np.broadcast_to(given[m], n) for m in self.names[1:]))
        ]
        places = dict(lk.places)
        member = [np.zeros((n, len(values))) for _ in self.wrt]
        for a, name in enumerate(self.wrt):
            member[a][np.arange(n), places[name]] = 1.0
        M = np.stack(member, axis=1)  # (n, symbols, parameters)
        size = k + k * (k + 1) // 2
        for part in range(2 if self.sloped else 1):
            own = out[part * size : (part + 1) * size]
            g, H = np.stack(own[:k], axis=1), np.zeros((n, k, k))
            rows, columns = np.tril_indices(k)
            H[:, rows, columns] = H[:, columns, rows] = np.stack(own[k:], axis=1)
            firsts[part] = np.einsum("na,naj->nj", g, M)
            seconds[part] = np.einsum("nab,nai,nbj->nij", H, M, M, optimize=True)
        return firsts, seconds

    def _measured(self, values: NDArray) -> tuple[NDArray, NDArray]:
        """Gradient and Hessian of -ln L of the impacts with a rebound."""
        lk, o = self.likelihood, self.likelihood.observations
        seen = ~o.censored
        (f_a, s_a), (f_ab, s_ab) = ([x[seen] for x in pair] for pair in self._of_law(values))
        f, slope, v = lk.law_values(values)
        r, v = (o.e - f)[seen], np.maximum(v, _LEAST_VARIANCE)[seen]
        sigma = lk.law_St_sigma[seen]
        to_slope = 2 * slope[seen] * sigma**2 - 2 * o.correlation[seen] * sigma * o.e_sigma[seen]
        v_a = to_slope[:, None] * s_a
        v_ab = to_slope[:, None, None] * s_ab + 2 * (sigma**2)[:, None, None] * s_a[:, :, None] * s_a[:, None, :]
        tau, omega = lk.deviations(values)
        if (j := self.position.get(SCATTER)) is not None:
            v_a[:, j], v_ab[:, j, j] = 2 * tau, 2.0
        r_a, r_ab, w = -f_a, -f_ab, 1 / v
        w_a = -(w**2)[:, None] * v_a
        vv = v_a[:, :, None] * v_a[:, None, :]
        w_ab = 2 * (w**3)[:, None, None] * vv - (w**2)[:, None, None] * v_ab
        rr, wr = r_a[:, :, None] * r_a[:, None, :], w_a[:, :, None] * r_a[:, None, :]
        wr = wr + wr.transpose(0, 2, 1)
        R, w1, w2 = r[:, None, None], w[:, None], w[:, None, None]
        Q_a = np.sum(w_a * r[:, None] ** 2 + 2 * w1 * r[:, None] * r_a, axis=0)
        Q_ab = np.sum(w_ab * R**2 + 2 * R * wr + 2 * w2 * rr + 2 * w2 * R * r_ab, axis=0)
        gradient, hessian = Q_a, Q_ab
        if lk.log_variance:
            gradient = gradient + np.sum(w1 * v_a, axis=0)
            hessian = hessian + np.sum(w2 * v_ab - w2**2 * vv, axis=0)
        at = self.position.get(OFFSET)
        if omega > 0 or at is not None:
            S_i, S_ai, S_abi = w * r, w_a * r[:, None] + w1 * r_a, w_ab * R + wr + w2 * r_ab
            member = (lk.sources[seen][:, None] == np.arange(lk.sources.max() + 1)).astype(float)
            S, W = S_i @ member, w @ member
            S_a, W_a = (np.einsum("na,ns->sa", x, member) for x in (S_ai, w_a))
            S_ab, W_ab = (np.einsum("nab,ns->sab", x, member) for x in (S_abi, w_ab))
            first, second = _of_offsets(S, W, omega, S_a, W_a, S_ab, W_ab, at)
            gradient, hessian = gradient + first, hessian + second
        return 0.5 * gradient, 0.5 * hessian

    def _differences(self, values: NDArray, hessian: NDArray) -> tuple[NDArray, NDArray]:
        """Of what has no symbols: the impacts without a rebound, and the term of the standard deviations."""
        lk, n = self.likelihood, len(values)
        limits = bool(lk.observations.censored.any())
        first, second = np.zeros(n), np.zeros((n, n))
        if self.extra is None and not limits:
            return first, second
        measured = lk.of(lk.observations.take(~lk.observations.censored)) if limits else None

        def rest(x: NDArray) -> float:
            x = x.copy()
            for j, p in enumerate(lk.parameters):
                x[j] = abs(x[j]) if p.scale == "even" else min(max(x[j], p.bounds[0]), p.bounds[1])
            return (self.extra(x) if self.extra else 0.0) + (lk(x) - measured(x) if measured else 0.0)

        open_ones = [j for j, p in enumerate(lk.parameters) if limits or not p.mean]
        diagonal = np.diag(hessian)
        step = np.where(
            diagonal > 0, _STEP / np.sqrt(np.maximum(diagonal, 1e-300)), _STEP * np.maximum(np.abs(values), 1e-6)
        )
        step *= 10.0 if limits else 1.0
        middle = rest(values)
        for i in open_ones:
            for j in (k for k in open_ones if k <= i):
                a, b = np.zeros(n), np.zeros(n)
                a[i], b[j] = step[i], step[j]
                if i == j:
                    up, down = rest(values + a), rest(values - a)
                    first[i] = (up - down) / (2 * step[i])
                    second[i, i] = (up - 2 * middle + down) / step[i] ** 2
                else:
                    mixed = (
                        rest(values + a + b) - rest(values + a - b) - rest(values - a + b) + rest(values - a - b)
                    )
                    second[i, j] = second[j, i] = mixed / (4 * step[i] * step[j])
        return first, second


def _of_offsets(
    S: NDArray, W: NDArray, omega: float, S_a: NDArray, W_a: NDArray, S_ab: NDArray, W_ab: NDArray, at: int | None
) -> tuple[NDArray, NDArray]:
    """Derivatives of the sum over sources of ln u - h S^2; ``at`` is the place of omega among the parameters."""
    u = 1 + omega**2 * W
    h = omega**2 / u
    g_S, g_W, g_o = -2 * h * S, h**2 * S**2 + h, -2 * omega / u**2 * S**2 + 2 * omega * W / u
    g_SS, g_SW, g_WW = -2 * h, 2 * h**2 * S, -2 * h**3 * S**2 - h**2
    g_So, g_Wo = -4 * omega * S / u**2, 4 * omega * h / u**2 * S**2 + 2 * omega / u**2
    g_oo = -(2 / u**2 - 8 * omega**2 * W / u**3) * S**2 + 2 * W / u - 4 * omega**2 * W**2 / u**2
    gradient = g_S @ S_a + g_W @ W_a
    mixed = np.einsum("s,sa,sb->ab", g_SW, S_a, W_a)
    hessian = (
        np.einsum("s,sa,sb->ab", g_SS, S_a, S_a) + np.einsum("s,sa,sb->ab", g_WW, W_a, W_a) + mixed + mixed.T
        + np.einsum("s,sab->ab", g_S, S_ab) + np.einsum("s,sab->ab", g_W, W_ab)
    )  # fmt: skip
    if at is not None:
        cross = g_So @ S_a + g_Wo @ W_a
        hessian[at] += cross
        hessian[:, at] += cross
        gradient[at] += g_o.sum()
        hessian[at, at] += g_oo.sum()
    return gradient, hessian
