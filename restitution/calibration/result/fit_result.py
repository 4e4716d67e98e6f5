"""What is kept of a fit: a record that is JSON and nothing else."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import metadata
from typing import Literal

import numpy as np
from pydantic import Field

from restitution.calibration.estimation.draws import draw, finished
from restitution.calibration.estimation.fitting import Fit
from restitution.calibration.estimation.likelihood import OFFSET
from restitution.calibration.estimation.maximum import LEVELS
from restitution.calibration.estimation.posterior import Posterior
from restitution.calibration.estimation.rebound_model import LawModel, ReboundModel, model_of
from restitution.calibration.result.influence import influences
from restitution.calibration.result.residuals import Goodness, Point, goodness_of, number_or_none, points_of
from restitution.calibration.showing import Showing, Table, counted
from restitution.conditions import Record
from restitution.stokes import H_FILM

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

    @property
    def shown_value(self) -> float:
        """The value; 0 for a standard deviation that is zero but for rounding."""
        return 0.0 if not self.mean and self.value < 1e-3 * self.intervals["95%"][1] else self.value

    def interval_in_words(self, level: str) -> str:
        """Its ends, those marked that are bounds of the parameter."""
        low, high = self.intervals[level]
        marks = [" (bound)" if open_end else "" for open_end in self.open_ends[level]]
        return f"{low:.5g}{marks[0]} to {high:.5g}{marks[1]}"


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
    draws: tuple[tuple[float, ...], ...] = ()
    """Of files of earlier versions; now the fit has them."""


class DrawsRecord(Record):
    """Weighted draws from the posterior: a row has a value for each parameter, then an offset for each source.

    ``effective``: how many independent draws they are worth.
    """

    sources: tuple[str, ...]
    rows: tuple[tuple[float, ...], ...]
    weights: tuple[float, ...]
    effective: float


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


class FitResult(Showing, Record):
    """Everything that a prediction, a report or another program needs of a fit."""

    format: Literal["restitution-fit/1"] = FORMAT
    law: LawRecord
    stokes_convention: str
    speed_definition: str
    edge_d: float | None = H_FILM
    """Edge of the film in diameters, to which the parameters belong; null of speeds that know none.

    A file without it was written when there was no other than this one."""
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
    draws: DrawsRecord | None = None
    """What predictions are made of; a file without them was written by an earlier version."""
    trajectories: tuple[TrajectoryRecord, ...] = ()
    """Of a fit to whole trajectories."""
    files: dict[str, str]
    versions: dict[str, str]
    notes: tuple[str, ...]
    doubts: tuple[str, ...] = ()
    """What contradicts what such data must obey, with the likely mistake."""

    def shown(self) -> Table:
        """The parameters with their intervals; :func:`restitution.calibration.result.fit_summary.describe` says
        all.
        """
        rows = [
            (p.name, f"{p.shown_value:.4g}", *(p.interval_in_words(level) for level in p.intervals))
            for p in self.parameters
        ]
        levels = next((p.intervals for p in self.parameters), {})
        impacts = counted(self.goodness.measured + self.goodness.censored, "impact")
        title = f"{self.law.name or 'own formula'}: {self.law.text}, fitted to {impacts}"
        return Table(title, ("parameter", "value", *levels), rows)

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


MOST_DRAWS = 4000
"""Draws of a chain that are kept in a record."""


def chain_of(posterior: Posterior) -> Chain:
    """The record of a posterior, without its draws."""
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
    )


def draws_of(fit: Fit, posterior: Posterior | None) -> DrawsRecord:
    """Draws about the maximum, or some of those of a chain, evenly spaced."""
    if posterior is None:
        own = draw(fit.likelihood, fit.maximum)
    else:
        values = posterior.draws[
            np.linspace(0, len(posterior.draws) - 1, min(len(posterior.draws), MOST_DRAWS)).astype(int)
        ]
        own = finished(fit.likelihood, values, np.ones(len(values)))
    rows = np.concatenate([own.values, own.offsets], axis=1)
    return DrawsRecord(
        sources=own.sources,
        rows=tuple(tuple(float(f"{x:.6g}") for x in row) for row in rows),
        weights=tuple(float(f"{w:.6g}") for w in own.weights),
        effective=own.effective,
    )


def result_of(fit: Fit, posterior: Posterior | None = None, influence: bool = False) -> FitResult:
    """The record of a fit: what ``fit.json`` holds, and what :func:`~restitution.calibration.predict` takes.

    Parameters
    ----------
    fit : of :func:`~restitution.calibration.estimate`.
    posterior : of :func:`~restitution.calibration.estimation.posterior.sample`, whose draws then are those of
        predictions; else draws weighted about the maximum, from the same posterior.
    influence : whether each impact is left out in turn, to tell what it does to the estimate.
    """
    likelihood, maximum, o = fit.likelihood, fit.maximum, fit.likelihood.observations
    model = likelihood.model
    named = isinstance(model, LawModel)
    sigma = maximum.sigma
    estimated = tuple(
        Estimated(
            name=p.name,
            value=float(maximum.values[j]),
            sigma=number_or_none(sigma[j]),
            unit=p.unit,
            bounds=p.bounds,
            prior=str(p.prior),
            mean=p.mean,
            intervals={f"{level:.0%}": tuple(map(float, maximum.intervals[level][j])) for level in LEVELS},
            open_ends={f"{level:.0%}": tuple(map(bool, maximum.open_ends[level][j])) for level in LEVELS},
            degrees_of_freedom=number_or_none(fit.freedom[j]),
        )
        for j, p in enumerate(maximum.parameters)
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
        edge_d=o.edge,
        fixed=fixed,
        separate=dict(likelihood.separate),
        parameters=estimated,
        covariance=tuple(tuple(number_or_none(x) for x in row) for row in maximum.covariance),
        offsets=likelihood.offsets(maximum.values) if OFFSET in [p.name for p in maximum.parameters] else {},
        goodness=goodness_of(fit),
        stokes_range=(float(o.St[told].min()), float(o.St[told].max())),
        law_stokes_ratio=(float(ratio.min()), float(ratio.max())),
        e_dry_range=(float(e_dry.min()), float(e_dry.max())) if len(e_dry) else (0.0, 1.0),
        robust=likelihood.robust,
        points=points_of(fit, influences(fit) if influence else ()),
        posterior=None if posterior is None else chain_of(posterior),
        draws=draws_of(fit, posterior),
        files=dict(o.files),
        versions={name: metadata.version(name) for name in _LIBRARIES},
        notes=fit.notes,
        doubts=tuple(map(str, fit.doubts)),
    )


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
