"""What is kept of a fit: a record that is JSON and nothing else, and its plain text."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field

from restitution.calibration.fitting import Fit
from restitution.calibration.likelihood import OFFSET, SCATTER
from restitution.calibration.maximum import LEVELS
from restitution.calibration.posterior import Posterior
from restitution.calibration.rebound_model import LawModel, ReboundModel, model_of
from restitution.conditions import Record
from restitution.table_schema import read_record

FORMAT = "restitution-fit/1"
_LIBRARIES = ("restitution", "numpy", "scipy", "iminuit", "emcee")


class LawRecord(Record):
    """The law: its name in the registry, or the text of a formula of the user's own."""

    name: str | None
    text: str
    title: str
    convention: str
    bounds: dict[str, tuple[float, float]] = Field(default_factory=dict)
    """Of the parameters of a formula."""


class Estimated(Record):
    """One parameter. ``intervals`` by level in percent; ``open_ends`` marks ends that are bounds."""

    name: str
    value: float
    sigma: float | None
    unit: str
    bounds: tuple[float, float]
    prior: str
    mean: bool
    intervals: dict[str, tuple[float, float]]
    open_ends: dict[str, tuple[bool, bool]]
    degrees_of_freedom: float | None
    """Of Student's t; None: many."""


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


class Chain(Record):
    """The posterior: medians, central intervals, and what was needed to get them."""

    names: tuple[str, ...]
    median: tuple[float, ...]
    intervals: dict[str, tuple[tuple[float, float], ...]]
    walkers: int
    steps: int
    autocorrelation_time: tuple[float, ...]
    acceptance: float
    seed: int
    priors: dict[str, str]
    draws: tuple[tuple[float, ...], ...]


class TrajectoryRecord(Record):
    """One record of a fit to whole trajectories: its unknowns as value and standard deviation, noise, distances.

    ``rms_d`` is with the restitutions that the record has itself, ``rms_law_d`` with those of the fitted law, its
    clock known from the approach alone. Noise: median, and standard deviation of the logarithm.
    """

    record: str
    wake: bool
    frames: int
    frames_at_rest: int
    reading_sigma_m: float
    unknowns: dict[str, tuple[float, float]]
    correlated_sigma_m: tuple[float, float]
    correlation_time_s: tuple[float, float]
    log_evidence: float
    log_evidence_other_wake: float | None
    rms_d: float
    rms_law_d: float
    apex_1_law_m: float
    impacts_law: int
    map_error: float
    """Of the interpolated trajectory, at most, in standard deviations of a reading."""


class FitResult(Record):
    """Everything that a prediction, a report or another program needs of a fit."""

    format: Literal["restitution-fit/1"] = FORMAT
    law: LawRecord
    stokes_convention: str
    speed_definition: str
    fixed: dict[str, float]
    separate: dict[str, str]
    parameters: tuple[Estimated, ...]
    covariance: tuple[tuple[float | None, ...], ...]
    offsets: dict[str, tuple[float, float]]
    """Of each source: mean and standard deviation."""
    goodness: Goodness
    stokes_range: tuple[float, float]
    law_stokes_ratio: tuple[float, float]
    """Least and greatest ratio of the law's Stokes number to that of the data."""
    e_dry_range: tuple[float, float]
    robust: bool
    points: tuple[Point, ...]
    posterior: Chain | None = None
    trajectories: tuple[TrajectoryRecord, ...] = ()
    """Of a fit to whole trajectories."""
    files: dict[str, str]
    versions: dict[str, str]
    notes: tuple[str, ...]

    @property
    def values(self) -> dict[str, float]:
        """Estimates by name."""
        return {p.name: p.value for p in self.parameters}

    def deviation(self, name: str) -> float:
        """The scatter or the source offset; 0 where it was not estimated."""
        return self.values.get(name, 0.0)

    def model(self) -> ReboundModel:
        """The law as a model."""
        return model_of(self.law.name or self.law.text, self.law.bounds, self.law.convention)

    def to_json(self) -> str:
        """JSON text of standard numbers only: no NaN, no infinity."""
        return json.dumps(self.model_dump(mode="json"), indent=1, allow_nan=False) + "\n"


def read_fit(path: str | Path) -> FitResult:
    """The fit in a JSON file; raises :class:`InputError` naming what is wrong with it."""
    return read_record(path, FitResult)


MOST_DRAWS = 1000
"""Draws that are kept in a record."""


def chain_of(posterior: Posterior) -> Chain:
    """The record of a posterior, with some of its draws, evenly spaced."""
    draws = posterior.draws
    kept = draws[np.linspace(0, len(draws) - 1, min(len(draws), MOST_DRAWS)).astype(int)]
    return Chain(
        names=tuple(p.name for p in posterior.parameters),
        median=tuple(map(float, posterior.median)),
        intervals={
            f"{level:.0%}": tuple((float(a), float(b)) for a, b in posterior.interval(level)) for level in LEVELS
        },
        walkers=posterior.walkers,
        steps=posterior.steps,
        autocorrelation_time=tuple(map(float, posterior.autocorrelation_time)),
        acceptance=posterior.acceptance,
        seed=posterior.seed,
        priors={p.name: str(p.prior) for p in posterior.parameters},
        draws=tuple(tuple(float(f"{x:.6g}") for x in row) for row in kept),
    )


def result_of(fit: Fit, posterior: Chain | None = None) -> FitResult:
    """The record of a fit."""
    likelihood, found, o = fit.likelihood, fit.maximum, fit.likelihood.observations
    model = likelihood.model
    named = isinstance(model, LawModel)
    sigma = found.sigma
    estimated = tuple(
        Estimated(
            name=p.name,
            value=float(found.values[j]),
            sigma=_number(sigma[j]),
            unit=p.unit,
            bounds=p.bounds,
            prior=str(p.prior),
            mean=p.mean,
            intervals={f"{level:.0%}": tuple(map(float, found.intervals[level][j])) for level in LEVELS},
            open_ends={f"{level:.0%}": tuple(map(bool, found.open_ends[level][j])) for level in LEVELS},
            degrees_of_freedom=_number(fit.freedom[j]),
        )
        for j, p in enumerate(found.parameters)
    )
    fixed = {name: float(v) for name, v in likelihood.fixed.items() if np.ndim(v) == 0}
    e_dry, ratio = o.e_dry[np.isfinite(o.e_dry)], o.ratio_to(model.convention)
    # A limit above the dry restitution tells nothing, so it calibrates nothing.
    told = ~o.censored | (o.upper < np.where(np.isfinite(o.e_dry), o.e_dry, 1.0))
    return FitResult(
        law=LawRecord(
            name=model.name if named else None,
            text=model.text,
            title=model.title,
            convention=model.convention,
            bounds={} if named else {p.name: p.bounds for p in model.parameters},
        ),
        stokes_convention=o.convention,
        speed_definition=str(o.speed),
        fixed=fixed,
        separate=dict(likelihood.separate),
        parameters=estimated,
        covariance=tuple(tuple(_number(x) for x in row) for row in found.covariance),
        offsets=likelihood.offsets(found.values) if OFFSET in [p.name for p in found.parameters] else {},
        goodness=_goodness(fit),
        stokes_range=(float(o.St[told].min()), float(o.St[told].max())),
        law_stokes_ratio=(float(ratio.min()), float(ratio.max())),
        e_dry_range=(float(e_dry.min()), float(e_dry.max())) if len(e_dry) else (0.0, 1.0),
        robust=likelihood.robust,
        points=_points(fit),
        posterior=posterior,
        files=dict(o.files),
        versions={name: metadata.version(name) for name in _LIBRARIES},
        notes=fit.notes,
    )


def _points(fit: Fit) -> tuple[Point, ...]:
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
                e_dry=_number(o.e_dry[i]),
                e_eff=float(o.e[i]) if seen else None,
                e_eff_sigma=float(o.e_sigma[i]),
                e_eff_upper=None if seen else float(o.upper[i]),
                predicted=predicted,
                residual=residual,
                sigma=math.sqrt(variance[i]),
                pull=residual / math.sqrt(variance[i]) if seen else None,
            )
        )
    return tuple(points)


def _goodness(fit: Fit) -> Goodness:
    from scipy.stats import chi2

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
        p_value=float(chi2.sf(chi_square, free)) if known and free > 0 else None,
        largest_pull=float(np.max(np.abs(r / np.sqrt(variance[seen])))),
        log_likelihood=-float(fit.maximum.negative_log),
        log_likelihood_of="restricted maximum" if fit.restricted else "maximum",
    )


def _number(x: float) -> float | None:
    return float(x) if math.isfinite(x) else None


def describe(result: FitResult) -> list[tuple[str, str]]:
    """The fit in words, as names and what is to be said of each."""
    g = result.goodness
    facts = [
        ("law", f"{result.law.name or 'own formula'}: {result.law.text}"),
        ("Stokes number", f"{result.stokes_convention} in the data, {result.law.convention} in the law"),
        ("impact speed", result.speed_definition),
        ("impacts", f"{g.measured} measured, {g.censored} without a rebound; sources: {len(sources(result))}"),
    ]
    facts += [(name, f"{value:g} (fixed)") for name, value in result.fixed.items()]
    for p in result.parameters:
        unit = "" if p.unit == "1" else f" {p.unit}"
        words = ", ".join(f"{level} {_interval(p, level)}" for level in p.intervals)
        prior = f"; prior {p.prior}" if p.prior.startswith("normal") else ""
        value = 0.0 if not p.mean and p.value < 1e-3 * p.intervals["95%"][1] else p.value  # zero but for rounding
        error = f" +- {_sigma(p)}" if p.mean else ""  # of a standard deviation near zero it would mislead
        facts.append((p.name, f"{value:.5g}{unit}{error} ({words}{prior})"))
    for name, (mean, sigma) in result.offsets.items():
        facts.append(("offset", f"{name}: {mean:+.3f} +- {sigma:.3f}"))
    if g.chi_square is not None:
        p_value = "" if g.p_value is None else f", p = {g.p_value:.2g}"
        facts.append(
            ("chi square", f"{g.chi_square:.1f} of {g.degrees_of_freedom} by the quoted errors alone{p_value}")
        )
    facts.append(("largest pull", f"{g.largest_pull:.1f} standard deviations, scatter included"))
    if chain := result.posterior:
        words = f"{chain.walkers} walkers, {chain.steps} steps, seed {chain.seed}, converged"
        facts.append(("posterior", f"{words} (autocorrelation time {max(chain.autocorrelation_time):.0f})"))
        for j, name in enumerate(chain.names):
            ends = ", ".join(f"{level} {x[j][0]:.5g} to {x[j][1]:.5g}" for level, x in chain.intervals.items())
            facts.append((f"  {name}", f"median {chain.median[j]:.5g} ({ends}; prior {chain.priors[name]})"))
    facts += [("note", note) for note in result.notes]
    return facts


def sources(result: FitResult) -> list[str]:
    """The names of the sources, in order."""
    return list(dict.fromkeys(p.source for p in result.points))


def parameter_values(result: FitResult, levels: Mapping[str, str] | None = None) -> dict[str, float]:
    """Values by plain name; of separate parameters those of the given levels (label -> level)."""
    values = dict(result.fixed)
    for p in result.parameters:
        name, _, level = p.name.partition("[")
        if not level or (levels or {}).get(result.separate[name]) == level.removesuffix("]"):
            values[name] = p.value
    return values


def _sigma(p: Estimated) -> str:
    return "not known" if p.sigma is None else f"{p.sigma:.2g}"


def _interval(p: Estimated, level: str) -> str:
    low, high = p.intervals[level]
    marks = [" (bound)" if open_end else "" for open_end in p.open_ends[level]]
    return f"{low:.5g}{marks[0]} to {high:.5g}{marks[1]}"
