"""Impacts against all measured ones: how much the film takes at a Stokes number.

    e_eff = e_dry exp[-K (1 + e_dry)/St]    gives    K = St ln(e_dry/e_eff)/(1 + e_dry)    impact by impact,

and the measured records of spheres of steel, glass and nylon under liquids have K of 8 to 18, by their reading
(:mod:`restitution.laws.source_abstract_eq4`: 10 to 12; Legendre et al. 2005: 35/(1 + e_dry)). Another
definition of the Stokes number than the stated one moves K by its factor.
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
            "backwards, or was the sphere lost about the contact?"
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
    St: ArrayLike, e: ArrayLike, e_dry: ArrayLike, where: Sequence[str] = (), computed: bool = False
) -> list[Doubt]:
    """Doubts about impacts; ``St`` under the convention ``st``, NaN in ``e`` or ``e_dry`` where it is not known.

    ``computed``: St is that of the stated conditions, so that these are asked about.
    """
    St, e, e_dry = (np.asarray(x, float) for x in np.broadcast_arrays(St, e, e_dry))
    with np.errstate(all="ignore"):
        ratio = e / e_dry
        telling = (ratio > _TELLING[0]) & (ratio < _TELLING[1])
        K = (-np.log(ratio) * St / (1 + e_dry))[telling]
    if len(K) < _LEAST:
        return []
    times = float(np.median(K)) / USUAL_K
    if 1 / FARTHEST <= times <= FARTHEST:
        return []
    asked = [question for factor, question in _MISTAKES if 1 / _NEAR < times / factor < _NEAR]
    words = f"{times:.2g} times" if times >= 1 else f"1/{1 / times:.2g} of"
    question = asked[0] if asked else "is it this Stokes number, in these units, and this e_dry?"
    if computed:
        question = "are viscosity, density and diameter those of this fluid and sphere, and e_dry?"
    message = (
        f"the film takes {words} what it takes in all measured records (K = {np.median(K):.3g} of Eq. (4), "
        f"where they have 10 to 12): {question}"
    )
    return [Doubt("stokes", message, ", ".join(dict.fromkeys(where)))]
