"""Whether an estimate can be believed: what its intervals, its errors and its curvature say of one another.

- An interval of 95 % contains that of 68 %, and both contain the estimate.
- The standard error is that of the curvature at the maximum, the interval that of the whole profile; where they
  differ by more than a factor, one of them is wrong or the error means little.
- The curvature, scaled to a unit diagonal, has the ratio of its greatest to its least eigenvalue: beyond some
  ten digits nothing is left of the sixteen that the likelihood is computed with.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from restitution.calibration.estimation.maximum import LEVELS, Maximum
from restitution.doubts import Doubt

APART = 2.0
"""Factor between standard error and half the interval of 68 % from which on they contradict each other."""
CONDITION = 1e10
"""Ratio of eigenvalues from which on errors and intervals are not believed."""


def of_estimate(best: Maximum, freedom: NDArray) -> Iterator[Doubt]:
    """Doubts about an estimate with intervals; ``freedom`` are the degrees of freedom of each parameter's t."""
    if best.condition is not None and best.condition > CONDITION:
        yield Doubt(
            "curvature",
            f"the parameters are nearly exchangeable (condition {best.condition:.1e} of the curvature): errors "
            "and intervals may be wrong; fix one, or give it a prior",
        )
    for j, p in enumerate(best.parameters):
        if not p.mean:
            continue
        narrow, wide = (best.intervals.get(level, np.full((j + 1, 2), np.nan))[j] for level in LEVELS)
        if np.isnan([*narrow, *wide]).any():
            continue
        slack = 1e-6 * (wide[1] - wide[0] + abs(best.values[j]) * 1e-9)
        if (
            wide[0] > narrow[0] + slack
            or wide[1] < narrow[1] - slack
            or not narrow[0] <= best.values[j] <= narrow[1]
        ):
            yield Doubt(
                "intervals",
                f"{p.name}: the intervals {narrow[0]:.6g} to {narrow[1]:.6g} (68 %) and {wide[0]:.6g} to "
                f"{wide[1]:.6g} (95 %) do not lie within one another about {best.values[j]:.6g}: the search for "
                "their ends failed; fix a parameter, narrow bounds, or take --posterior",
            )
        elif not best.open_ends[LEVELS[0]][j].any():
            half, nu = 0.5 * (narrow[1] - narrow[0]), freedom[j]
            t = stdtrit(nu if np.isfinite(nu) else 1e9, 0.5 * (1 + LEVELS[0]))
            ratio = half / best.sigma[j]
            # A bent law of few degrees of freedom has an interval between that of the normal and that of its t.
            if not 1 / APART < ratio < APART * t:
                yield Doubt(
                    "sigma",
                    f"{p.name}: its standard error {best.sigma[j]:.3g} by the curvature and half its 68 % "
                    f"interval, {half:.3g}, differ by a factor {ratio:.2g}: take the interval, not the error",
                )
