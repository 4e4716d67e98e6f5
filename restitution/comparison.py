"""How far laws are from impacts: residuals with their full uncertainty, and scores by data set.

The residual of an impact is r = e_eff - f(St). Both e_eff = v_out/v_in and St carry the error of v_in, hence

    var r = var e + f'^2 var St - 2 f' cov(e, St),      cov(e, St) = -e St (sigma_v_in / v_in)^2,

f' being the exact derivative of the law. Impacts without a resolved rebound carry an upper limit instead; they
are counted where a law predicts more than the limit, and enter no sum.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.laws import ReboundLaw
from restitution.stokes import StokesNumber

if TYPE_CHECKING:
    import pandas as pd

    from restitution.conditions import Conditions


def predict(
    law: ReboundLaw, impacts: pd.DataFrame, conditions: Mapping[str, Conditions]
) -> tuple[NDArray, NDArray]:
    """The law's e_eff and its derivative in the table's own St, at every row of an impact table.

    ``conditions`` are those of each record. A law meant for another impact speed than the table's is read with
    the table's speed: the caller has chosen the definition that all are compared by.
    """
    value, slope = np.empty(len(impacts)), np.empty(len(impacts))
    for i, row in enumerate(impacts.itertuples()):
        St = StokesNumber(row.stokes, row.stokes_convention, law.speed)
        known = conditions[row.record]
        value[i] = law(St, row.e_dry, known, out_of_range="ignore")
        slope[i] = law.derivative(St, row.e_dry, known, out_of_range="ignore")
    return value, slope


def residuals(
    law: ReboundLaw, impacts: pd.DataFrame, conditions: Mapping[str, Conditions]
) -> tuple[NDArray, NDArray]:
    """r = e_eff - f(St) and its standard deviation for the rows with a rebound; NaN for the others."""
    value, slope = predict(law, impacts, conditions)
    e, St = impacts["e_eff"].to_numpy(float), impacts["stokes"].to_numpy(float)
    relative = (impacts["stokes_sigma"] / impacts["stokes"]).to_numpy(float)
    variance = (
        impacts["e_eff_sigma"].to_numpy(float) ** 2
        + (slope * St * relative) ** 2
        + 2 * slope * e * St * relative**2
    )
    return e - value, np.sqrt(variance)


def score(
    laws: Iterable[ReboundLaw], impacts: pd.DataFrame, conditions: Mapping[str, Conditions], group: pd.Series
) -> pd.DataFrame:
    """Scores of each law in each group of impacts and in all of them.

    Columns: ``law``, ``dataset``, ``impacts`` (with a rebound), ``rms``, ``weighted_rms`` (weights 1/var r),
    ``bias`` (weighted mean of r), ``chi_square``, ``limits`` (impacts with an upper limit) and
    ``limits_exceeded`` (of these, how many the law predicts a larger rebound for).
    """
    import pandas as pd

    rows = []
    for law in laws:
        r, sigma = residuals(law, impacts, conditions)
        above = predict(law, impacts, conditions)[0] > impacts["e_eff_upper"].to_numpy(float)
        limited = impacts["e_eff_upper"].notna().to_numpy()
        for dataset in [*dict.fromkeys(group), "all"]:
            member = np.ones(len(group), bool) if dataset == "all" else (group == dataset).to_numpy()
            use = member & np.isfinite(r)
            x, weight = r[use], sigma[use] ** -2.0
            total = weight.sum()
            rows.append(
                {
                    "law": law.name,
                    "dataset": dataset,
                    "impacts": int(use.sum()),
                    "rms": float(np.sqrt(np.mean(x**2))),
                    "weighted_rms": float(np.sqrt((weight * x**2).sum() / total)),
                    "bias": float((weight * x).sum() / total),
                    "chi_square": float((weight * x**2).sum()),
                    "limits": int((member & limited).sum()),
                    "limits_exceeded": int((member & limited & above).sum()),
                }
            )
    return pd.DataFrame(rows)
