"""Each impact beside the fitted law, and how well the law describes them all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from pydantic import Field
from scipy.special import chdtrc

from restitution.calibration.estimation.fitting import Fit
from restitution.calibration.estimation.likelihood import SCATTER
from restitution.conditions import Record


class Point(Record):
    """One impact with what the fit makes of it. ``pull`` is the residual over its whole standard deviation."""

    file: str | None
    row: int | None
    source: str
    levels: dict[str, str]
    """Of the labels that parameters are separate by."""
    stokes: float
    stokes_sigma: float
    e_dry: float | None
    e_eff: float | None
    e_eff_sigma: float
    e_eff_upper: float | None
    predicted: float
    residual: float | None
    sigma: float
    pull: float | None
    influence: dict[str, float] = Field(default_factory=dict)
    """By how many standard errors the impact moves each parameter of the law; empty where that was not asked."""


class Goodness(Record):
    """How well the law describes the impacts. ``chi_square`` takes the quoted errors alone, without scatter."""

    measured: int
    censored: int
    chi_square: float | None
    degrees_of_freedom: int
    p_value: float | None
    largest_pull: float
    log_likelihood: float
    log_likelihood_of: Literal["maximum", "restricted maximum"]


def points_of(fit: Fit, influence: Sequence[dict[str, float]] = ()) -> tuple[Point, ...]:
    """The impacts of a fit, with their influences where these are given."""
    likelihood, o = fit.likelihood, fit.likelihood.observations
    f, variance, omega = likelihood.moments(fit.maximum.values)
    offsets = likelihood.offsets(fit.maximum.values) if omega > 0 else {}
    points = []
    for i in range(len(o)):
        file, row = o.places[i] if o.places else (None, None)
        source = str(o.labels["source"][i])
        predicted = float(f[i]) + offsets.get(source, (0.0, 0.0))[0]
        seen = not o.censored[i]
        residual = float(o.e[i]) - predicted if seen else None
        points.append(
            Point(
                file=file,
                row=row,
                source=source,
                levels={label: str(o.labels[label][i]) for label in dict.fromkeys(likelihood.separate.values())},
                stokes=float(o.St[i]),
                stokes_sigma=float(o.St_sigma[i]),
                e_dry=number_or_none(o.e_dry[i]),
                e_eff=float(o.e[i]) if seen else None,
                e_eff_sigma=float(o.e_sigma[i]),
                e_eff_upper=None if seen else float(o.upper[i]),
                predicted=predicted,
                residual=residual,
                sigma=math.sqrt(variance[i]),
                pull=residual / math.sqrt(variance[i]) if seen else None,
                influence=influence[i] if influence else {},
            )
        )
    return tuple(points)


def goodness_of(fit: Fit) -> Goodness:
    likelihood, o = fit.likelihood, fit.likelihood.observations
    values = fit.maximum.values
    names = [p.name for p in fit.maximum.parameters]
    tau = values[names.index(SCATTER)] if SCATTER in names else 0.0
    f, variance, omega = likelihood.moments(values)
    offsets = likelihood.offsets(values) if omega > 0 else {}
    shift = np.array([offsets.get(s, (0.0, 0.0))[0] for s in o.labels["source"]])
    seen = ~o.censored
    r, quoted = (o.e - f - shift)[seen], (variance - tau**2)[seen]
    free = int(seen.sum()) - sum(p.mean for p in fit.maximum.parameters)
    known = bool((o.e_sigma[seen] > 0).all() and (quoted > 0).all())
    chi_square = float(np.sum(r**2 / quoted)) if known else None
    return Goodness(
        measured=int(seen.sum()),
        censored=int((~seen).sum()),
        chi_square=chi_square,
        degrees_of_freedom=free,
        p_value=float(chdtrc(free, chi_square)) if known and free > 0 else None,
        largest_pull=float(np.max(np.abs(r / np.sqrt(variance[seen])))),
        log_likelihood=-float(fit.maximum.negative_log),
        log_likelihood_of="restricted maximum" if fit.restricted else "maximum",
    )


def number_or_none(x: float) -> float | None:
    """A finite number, or None: JSON has no other."""
    return float(x) if math.isfinite(x) else None
