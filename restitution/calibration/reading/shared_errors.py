r"""Errors that the impacts of one record share: its scale, its clock, the noise of frames between bounces.

Impact i has errors of St and e_eff that are sums over independent ones z_k of its record, of unit variance,

    dSt_i = sum_k a_ik z_k,    de_i = sum_k b_ik z_k,

so that its residual e_i - f(St_i) has the loadings g_ik = b_ik - f' a_ik, and two impacts of a record have the
covariance sum_k g_ik g_jk. The whole variances of the errors stand apart; what is here adds what lies off the
diagonal.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


def residual_variance(slope: NDArray, e_sigma: NDArray, St_sigma: NDArray, correlation: NDArray) -> NDArray:
    """Of e - f(St) by the errors of e and St: sigma_e^2 + f'^2 sigma_St^2 - 2 rho f' sigma_e sigma_St."""
    from_St = slope * St_sigma
    return e_sigma**2 + from_St**2 - 2 * correlation * from_St * e_sigma


def loadings(covariance: NDArray) -> NDArray:
    """A root L of a covariance (m, m), L L^T: row i has the loadings of quantity i."""
    size, directions = np.linalg.eigh(covariance)
    return directions * np.sqrt(np.maximum(size, 0.0))


def joined(parts: Sequence[tuple[int, NDArray | None]]) -> NDArray | None:
    """Loadings (n, 2, m) of several data sets, of ``n`` impacts each; None where none has any."""
    known = [shared for _, shared in parts if shared is not None]
    if not known:
        return None
    m = max(shared.shape[2] for shared in known)
    blocks = [np.zeros((n, 2, m)) for n, _ in parts]
    for block, (_, shared) in zip(blocks, parts, strict=True):
        if shared is not None:
            block[:, :, : shared.shape[2]] = shared
    return np.concatenate(blocks)


_ROUND_OFF = 1e-10
"""By which variances are raised: as many common causes as impacts leave them nothing of their own."""


class Sums(NamedTuple):
    """Of each source with the covariance V_s of its residuals: r^T V^-1 r, ln |V|, 1^T V^-1 1, 1^T V^-1 r."""

    Q: NDArray
    log_det: NDArray
    W: NDArray
    S: NDArray


def sums(g: NDArray, v: NDArray, r: NDArray, sources: NDArray, count: int) -> Sums:
    """For loadings ``g`` (n, m), whole variances ``v`` and residuals ``r`` of impacts of ``count`` sources."""
    result = Sums(*np.zeros((4, count)))
    for s in np.unique(sources):
        here = sources == s
        V = g[here] @ g[here].T
        np.fill_diagonal(V, (1 + _ROUND_OFF) * v[here])
        root = np.linalg.cholesky(V)
        y = np.linalg.solve(root, np.stack([r[here], np.ones(here.sum())], axis=1))
        result.Q[s], result.log_det[s] = y[:, 0] @ y[:, 0], 2 * np.log(np.diag(root)).sum()
        result.W[s], result.S[s] = y[:, 1] @ y[:, 1], y[:, 1] @ y[:, 0]
    return result


def off_diagonal(g: NDArray, sources: NDArray) -> NDArray:
    """Covariances between different impacts of a source, (n, n), zero on the diagonal."""
    V = (g @ g.T) * (sources[:, None] == sources)
    np.fill_diagonal(V, 0.0)
    return V
