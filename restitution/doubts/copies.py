r"""Impacts that stand in a table more than once: each copy counts as a measurement, and errors come out too small.

Repeated impacts of one release may well have one nominal Stokes number, and an e_eff that is rounded to the same
digits. Two independent readings with the error sigma, written in steps of delta, agree with the probability

    p = delta/(2 sqrt(pi) sigma)    for delta below sigma.

n impacts at one Stokes number have n - k different e_eff in S(n, n - k) ways (Stirling's numbers of partitions),
each with a probability of at most p^k. So k excess ones in all, over all Stokes numbers, have a probability of at
most

    min_z z^-k prod_n sum_j S(n, n - j) (p z)^j    (Chernoff's bound).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from restitution.doubts.doubt import Doubt

_UNLIKELY = 1e-4
"""Probability below which equal rows are copies."""
_TYPICAL_ERROR = 0.01
"""Of an e_eff without a stated one: that of careful measurements."""
_FINEST = 1e-3
"""Step of e_eff that speeds of three digits make, however many digits their ratio is written with."""
_MOST = 200
"""Impacts at one Stokes number of which copies are looked for: among more, rounding makes many equal."""
_NAMED = 3


def of_copies(
    St: NDArray, e: NDArray, e_sigma: NDArray, places: Sequence[tuple[str, int]] = (), where: Sequence[str] = ()
) -> list[Doubt]:
    """A doubt where impacts agree with one another more than errors allow; ``e`` is NaN without a rebound."""
    seen = np.flatnonzero(np.isfinite(e) & np.isfinite(St))
    _, at, size = np.unique(St[seen], return_inverse=True, return_counts=True)
    seen = seen[(size[at] > 1) & (size[at] <= _MOST)]
    if not len(seen):
        return []
    pairs, group, count = np.unique(
        np.stack([St[seen], e[seen]], axis=1), axis=0, return_inverse=True, return_counts=True
    )
    copies = int(len(seen) - len(pairs))
    stated = e_sigma[seen][e_sigma[seen] > 0]
    error = float(np.median(stated)) if len(stated) else _TYPICAL_ERROR
    alike = min(1.0, max(_step(e[np.isfinite(e)]), _FINEST) / (2 * math.sqrt(math.pi) * error))
    if not copies or _log_chance(size[(size > 1) & (size <= _MOST)], copies, alike) > math.log(_UNLIKELY):
        return []
    largest = int(np.argmax(count))
    number = int(count[largest])
    rows = [":".join(map(str, places[i])) for i in seen[group.ravel() == largest][:_NAMED]] if places else []
    named = f" ({', '.join(rows)}{', ...' if number > len(rows) else ''})" if rows else ""
    message = (
        f"{copies} impacts are equal to another one in Stokes number and e_eff, as {number} with St "
        f"{pairs[largest, 0]:g} and e_eff {pairs[largest, 1]:g}{named}, where errors let measured ones differ: "
        "are they copies? Each counts as a measurement, so that errors come out too small; give each impact once"
    )
    return [Doubt("copies", message, ", ".join(dict.fromkeys(where)))]


def _log_chance(sizes: NDArray, copies: int, alike: float) -> float:
    """Ln of the bound on the probability of so many copies at Stokes numbers with ``sizes`` impacts."""
    table = _partitions(int(sizes.max()))
    kinds, number = np.unique(sizes, return_counts=True)
    log_z = np.linspace(0.0, 40.0, 161)
    total = -copies * log_z
    for n, m in zip(kinds.tolist(), number.tolist(), strict=True):
        j = np.arange(n)
        total = total + m * np.logaddexp.reduce(table[n, n - j] + j * (math.log(alike) + log_z[:, None]), axis=1)
    return float(total.min())


def _partitions(most: int) -> NDArray:
    """Ln of Stirling's numbers of the second kind, S(n, k) = k S(n - 1, k) + S(n - 1, k - 1), by n and k."""
    table = np.full((most + 1, most + 1), -np.inf)
    table[0, 0] = 0.0
    log_k = np.log(np.arange(1, most + 1))
    for n in range(1, most + 1):
        table[n, 1:] = np.logaddexp(log_k + table[n - 1, 1:], table[n - 1, :-1])
    return table


def _step(values: NDArray) -> float:
    """The place of the last digit that any of the values is written with."""
    digits = (len(f"{x:.12f}".rstrip("0").partition(".")[2]) for x in values[:1000].tolist())
    return 10.0 ** -max(digits)
