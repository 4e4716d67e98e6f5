"""How far laws are from impacts: residuals with their full uncertainty, and scores by record.

The residual of an impact is r = e_eff - f(St). Both e_eff = v_out/v_in and St carry the error of v_in; what that
makes of the variance of r stands in :mod:`restitution.calibration.estimation.likelihood`. Where a table does not
give the correlation of the two errors, independent errors of v_in and v_out are assumed. Impacts without a
resolved rebound have no residual.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.reading.observations import correlation_of_independent_speeds
from restitution.calibration.reading.shared_errors import residual_variance
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
    the table's: the caller has chosen the definition that all are compared by.
    """
    value, slope = np.empty(len(impacts)), np.empty(len(impacts))
    for i, row in enumerate(impacts.itertuples()):
        St = StokesNumber(row.stokes, row.stokes_convention, row.speed_definition).read_as(law.speed)
        known = conditions[row.record]
        value[i] = law(St, row.e_dry, known, out_of_range="ignore")
        slope[i] = law.derivative(St, row.e_dry, known, out_of_range="ignore")
    return value, slope


def residuals(
    law: ReboundLaw, impacts: pd.DataFrame, conditions: Mapping[str, Conditions]
) -> tuple[NDArray, NDArray]:
    """r = e_eff - f(St) and its standard deviation for the rows with a rebound; NaN for the others."""
    value, slope = predict(law, impacts, conditions)
    e, sigma_e = impacts["e_eff"].to_numpy(float), impacts["e_eff_sigma"].to_numpy(float)
    St, sigma_St = impacts["stokes"].to_numpy(float), impacts["stokes_sigma"].to_numpy(float)
    correlation = impacts["e_stokes_correlation"].to_numpy(float)
    independent = correlation_of_independent_speeds(e, sigma_e, St, sigma_St)
    correlation = np.where(np.isnan(correlation), independent, correlation)
    return e - value, np.sqrt(residual_variance(slope, sigma_e, sigma_St, correlation))


def score(laws: Iterable[ReboundLaw], impacts: pd.DataFrame, conditions: Mapping[str, Conditions]) -> pd.DataFrame:
    """Scores of each law in each record and in all of them.

    Columns: ``law``, ``record``, ``impacts`` (with a rebound), ``rms``, ``weighted_rms`` (weights 1/sigma_e^2, the
    same for all laws), ``bias`` (mean of r with those weights) and ``chi_square`` (sum of r^2/var r).
    """
    import pandas as pd

    rows = []
    for law in laws:
        r, sigma = residuals(law, impacts, conditions)
        for record in [*dict.fromkeys(impacts["record"]), "all"]:
            use = np.isfinite(r) & ((impacts["record"] == record).to_numpy() | (record == "all"))
            if not use.any():
                continue
            x, weight = r[use], impacts["e_eff_sigma"].to_numpy(float)[use] ** -2.0
            rows.append(
                {
                    "law": law.name,
                    "record": record,
                    "impacts": int(use.sum()),
                    "rms": float(np.sqrt(np.mean(x**2))),
                    "weighted_rms": float(np.sqrt(np.average(x**2, weights=weight))),
                    "bias": float(np.average(x, weights=weight)),
                    "chi_square": float(np.sum((x / sigma[use]) ** 2)),
                }
            )
    return pd.DataFrame(rows)
