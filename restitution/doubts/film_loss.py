"""Impacts against all measured ones: how much the film takes at a Stokes number.

    e_eff = e_dry exp[-K (1 + e_dry)/St]    gives    K = St ln(e_dry/e_eff)/(1 + e_dry)    impact by impact,

and the measured records of spheres of steel, glass and nylon under liquids have K of 8 to 18, by their reading
(:mod:`restitution.laws.source_abstract_eq4`: 10 to 12; Legendre et al. 2005: 35/(1 + e_dry)). Another
definition of the Stokes number than the stated one moves K by its factor.

Of few impacts, or of such that lose little, K has an error: by least squares in

    ln(e_eff/e_dry) = -K (1 + e_dry)/St + ln(e_dry'/e_dry),

e_dry' being the true e_dry, that is known to 0.02.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from restitution.doubts.doubt import Doubt

USUAL_K = 11.0
"""Of the measured records."""
FARTHEST = 4.0
"""Factor from it beyond which no measured record is."""
LEAST_K = 4.0
"""Half of the least of the measured records, for a K that is known with its error: a film always takes something,
where rough walls and other spheres may take more."""
_TELLING = (0.1, 0.9)
"""Between which parts of e_dry an e_eff tells K."""
_SURE = 3.0
"""Errors by which an e is beyond what can be."""
_LEAST = 3
"""Impacts that are needed for a doubt."""
_MISTAKES = (
    (9.0, "is St without its 9 (--stokes st_d)?"),
    (1 / 9.0, "is St already divided by the 9 (--stokes st)?"),
    (1000.0, "is the viscosity in mPa s?"),
    (1e-3, "is the viscosity in mPa s (cP) where Pa s are meant?"),
)
"""Factors of K that a mistake makes, and what to ask."""
_NEAR = 1.6
"""Factor about such a factor within which it is recognised: the spread of K among records."""


def of_gain(
    impact: Sequence[int], e: ArrayLike, sigma: ArrayLike, e_dry: float | None, where: str = ""
) -> list[Doubt]:
    """Doubts about impacts of one record, by their number, after which the sphere is faster than it can be.

    That is above the speed before, or above e_dry times that, by more than three errors; NaN where not known.
    """
    e, sigma = np.asarray(e, float), np.nan_to_num(np.asarray(sigma, float))
    with np.errstate(all="ignore"):
        faster = np.flatnonzero(e - _SURE * sigma > 1)
        above = np.flatnonzero(e - _SURE * sigma > e_dry) if e_dry is not None else []
    if len(faster):
        i = faster[0]
        message = (
            f"the sphere leaves impact {impact[i]} with {e[i]:.3g} of the speed it came with: does time run "
            "backwards, or the frame rate change there, or was the sphere lost about the contact?"
        )
        return [Doubt("gain", message, where)]
    if len(above):
        i = above[0]
        message = (
            f"e_eff {e[i]:.3g} of impact {impact[i]} is above the e_dry of {e_dry:.3g} that is stated: is it that "
            "of this sphere and wall, or are frames missing about the contact?"
        )
        return [Doubt("gain", message, where)]
    return []


def of_impacts(
    St: ArrayLike,
    e: ArrayLike,
    e_dry: ArrayLike,
    where: Sequence[str] = (),
    computed: bool = False,
    sigma: ArrayLike | None = None,
) -> list[Doubt]:
    """Doubts about impacts; ``St`` under the convention ``st``, NaN in ``e`` or ``e_dry`` where it is not known.

    ``computed``: St is that of the stated conditions, so that these are asked about. ``sigma``: errors of e, of
    one record; with them one impact may suffice.
    """
    St, e, e_dry = (np.asarray(x, float) for x in np.broadcast_arrays(St, e, e_dry))
    with np.errstate(all="ignore"):
        ratio = e / e_dry
        telling = (ratio > _TELLING[0]) & (ratio < _TELLING[1])
        K = (-np.log(ratio) * St / (1 + e_dry))[telling]
    typical = float(np.median(K)) if len(K) >= _LEAST else USUAL_K
    if 1 / FARTHEST <= typical / USUAL_K <= FARTHEST:
        far = None if sigma is None else _surely_far(St, ratio, e_dry, np.asarray(sigma, float) / e)
        if far is None:
            return []
        typical = far
    times = typical / USUAL_K
    asked = [question for factor, question in _MISTAKES if 1 / _NEAR < times / factor < _NEAR]
    words = f"{times:.2g} times" if times >= 1 else f"1/{1 / times:.2g} of" if times > 0 else "nothing of"
    question = asked[0] if asked else "is it this Stokes number, in these units, and this e_dry?"
    if computed:
        question = "are viscosity, density and diameter those of this fluid and sphere, and e_dry?"
    message = (
        f"the film takes {words} what it takes in all measured records (K = {typical:.3g} of Eq. (4), "
        f"where they have 10 to 12): {question}"
    )
    return [Doubt("stokes", message, ", ".join(dict.fromkeys(where)))]


def _surely_far(St: np.ndarray, ratio: np.ndarray, e_dry: np.ndarray, error: np.ndarray) -> float | None:
    """K by least squares where it is beyond that of all records by more than its errors; ``error``: of ln e.

    None else, and where single impacts do not agree on which side it is.
    """
    use = np.isfinite(ratio) & (ratio > _TELLING[0]) & np.isfinite(error) & (St > 0)
    if not use.any():
        return None
    y, x = -np.log(ratio[use]), (1 + e_dry[use]) / St[use]
    variance = error[use] ** 2 + _SCATTER**2
    inverse = np.linalg.inv(np.diag(variance) + (_E_DRY / np.mean(e_dry[use])) ** 2)
    K = float(x @ inverse @ y / (x @ inverse @ x))
    away = _SURE * float(x @ inverse @ x) ** -0.5
    alone, alone_away = y / x, _SURE * np.sqrt(variance + _E_DRY**2) / x
    if K + away < LEAST_K and np.all(alone - alone_away < LEAST_K):
        return K
    if K - away > FARTHEST * USUAL_K and np.all(alone + alone_away > FARTHEST * USUAL_K):
        return K
    return None


_E_DRY = 0.02
"""Error of a stated e_dry: that of the quoted ones."""
_SCATTER = 0.02
"""Relative scatter of e from impact to impact of one record: no more is seen in the shipped ones."""
