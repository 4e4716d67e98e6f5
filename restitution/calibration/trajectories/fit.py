"""A rebound law fitted to whole trajectories: records to impacts by the equation of motion, impacts to the law.

The first step (:mod:`.whole_trajectories`) knows no law, so one pass over the records serves every law; the second
is the fit of :mod:`.estimation.fitting`, scatter from impact to impact and an offset of each record included. With
every fit stands what a slope-based one makes of the same records, and how far the model with the fitted law is
from them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import Closures
from restitution.calibration.estimation.fitting import Fit, estimate
from restitution.calibration.estimation.plan import Plan
from restitution.calibration.estimation.posterior import Posterior
from restitution.calibration.reading.impact_checks import check_physical
from restitution.calibration.reading.observations import Observations, join
from restitution.calibration.reading.reading import Reading
from restitution.calibration.reading.shared_errors import joined, loadings
from restitution.calibration.reading.track_impacts import from_track
from restitution.calibration.result.fit_result import FitResult, TrajectoryRecord, result_of
from restitution.calibration.result.fitted_law import FittedLaw
from restitution.calibration.trajectories.doubts import of_parameters, of_records, within_the_film
from restitution.calibration.trajectories.recordings import Recording
from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory, distance_d, whole_trajectories
from restitution.doubts import Doubt
from restitution.errors import Defect, InputError
from restitution.stokes import H_FILM, Speed, convention, film_edge

FEW = 2
"""Rebounds up to which laws are not ranked: without one of them nothing is left that tells their scatter."""
CLEAR = 5.0
"""Ln of the evidence by which records are said to prefer the model with or without wake; odds of 150."""


@dataclass(frozen=True)
class Measured:
    """Records turned into impacts, with the wake of the approach and without."""

    records: tuple[Recording, ...]
    trajectories: dict[bool, list[WholeTrajectory]] = field(default_factory=dict)
    edge: float = H_FILM
    """Of the film in diameters, within which e_eff stands for every viscous force: K of a law belongs to it."""

    @classmethod
    def of(
        cls,
        records: Sequence[Recording],
        wakes: Sequence[bool] = (False, True),
        edge: float = H_FILM,
        say: Callable[[str], None] | None = None,
    ) -> Measured:
        """All records under each kind of model; raises :class:`InputError` for an edge out of range.

        ``say`` is told how far the work has come.
        """
        edge = film_edge(edge)
        return cls(tuple(records), {wake: whole_trajectories(records, wake, edge, say) for wake in wakes}, edge)

    def rebounds_outside(self) -> int:
        """How many rebounds leave the film, of all records."""
        return sum(int(t.outside().sum()) for t in self.trajectories[self.preferred])

    @property
    def gains(self) -> dict[str, float]:
        """Ln of the evidence with wake over that without, by record; none where one of them was not asked for."""
        if len(self.trajectories) < 2:
            return {}
        pairs = zip(self.trajectories[True], self.trajectories[False], strict=True)
        return {a.recording.name: a.log_evidence - b.log_evidence for a, b in pairs}

    def preference(self, left_out: Collection[str] = ()) -> float:
        """The sum of :attr:`gains` over all records but those ``left_out``; 0 where there are none."""
        return sum(gain for name, gain in self.gains.items() if name not in left_out)

    @property
    def borne_out(self) -> float:
        """The least of :meth:`preference` with one record left out, or of all where there is but one."""
        if len(self.gains) < 2:
            return self.preference()
        return min(self.preference((name,)) for name in self.gains)

    @property
    def preferred(self) -> bool:
        """Whether the frames prefer the wake, whichever record is left out; of what was asked for."""
        return self.borne_out > 0 if len(self.trajectories) == 2 else next(iter(self.trajectories))

    def without(self, left_out: Collection[str]) -> Measured:
        """The same trajectories, those of some records left out."""
        records = tuple(r for r in self.records if r.name not in left_out)
        kept = {
            w: [t for t in found if t.recording.name not in left_out] for w, found in self.trajectories.items()
        }
        return Measured(records, kept, self.edge)


def observations(trajectories: Sequence[WholeTrajectory], how: Reading) -> Observations:
    """The impacts of the records for a fit, each record a source."""
    rows = [row for t in trajectories for row in t.rows(how.stokes or "st")]
    if not any(row["outcome"] == "rebound" for row in rows):
        edge = trajectories[0].edge
        rule = f"no bounce leaves the film, {edge:g} d: nothing to fit a law to"
        raise InputError(*(Defect(rule, file=t.recording.name) for t in trajectories))
    records = {t.recording.name: t.recording for t in trajectories}
    o = Observations.from_impacts(
        rows,
        [records[row["record"]].conditions for row in rows],
        places=tuple((f"{row['record']}, impact", int(row["impact"])) for row in rows),
        files={name: r.digest for name, r in records.items()},
        notes=tuple(note for r in records.values() for note in r.notes),
    )
    return check_physical(replace(o, shared=_shared(trajectories, o)), how)


def _shared(trajectories: Sequence[WholeTrajectory], o: Observations) -> NDArray | None:
    """Loadings of the errors of St and e of all bounces of a record on its independent ones."""
    parts: list[tuple[int, NDArray | None]] = []
    for t in trajectories:
        speeds, _, C = t.impact_moments()
        n, root = len(speeds), loadings(C)
        per_speed = convention(o.convention).per_speed(t.recording.conditions)
        own = np.stack([per_speed * root[:n], root[n:]], axis=1)  # (bounces, 2, 2 bounces)
        here = [i for i, source in enumerate(o.labels["source"]) if source == t.recording.name]
        block = np.zeros((len(here), 2, 2 * n))
        for row, i in enumerate(here):
            if np.isfinite(o.e[i]):
                block[row] = own[o.places[i][1] - 1]
        parts.append((len(here), block))
    return joined(parts)


def slope_observations(records: Sequence[Recording], how: Reading) -> Observations:
    """The same records by the slopes beside each contact (:mod:`restitution.impacts`), ``far`` as well."""
    how = replace(how, speed=Speed.FAR, stokes=how.stokes or "st")
    return join([from_track(r.track, r.conditions, how, r.name, r.digest) for r in records])


def law_fit(plan: Plan, o: Observations) -> Fit:
    """The fit of a law; with as many impacts as parameters the scatter cannot be told and is left out."""
    measured = int((~o.censored).sum())
    free = [p for p in plan.model.parameters if p.name not in plan.fixed and p.name not in plan.model.chosen]
    if plan.scatter and measured <= len(free):
        fit = estimate(replace(plan, scatter=False), o)
        note = "too few impacts to tell their scatter: the intervals have the errors of this record alone"
        return replace(fit, notes=(*fit.notes, note))
    return estimate(plan, o)


def closures_of(fit: Fit, forces: Mapping[str, Any], edge: float = H_FILM, record: str | None = None) -> Closures:
    """The bouncing sphere with the fitted law, under the ``forces`` of a record, with its separate parameters."""
    values = dict(fit.likelihood.fixed) | values_of(fit, record)
    own = {p.name: values[p.name] for p in fit.likelihood.model.parameters}
    e_dry = values["e_dry"] if isinstance(values.get("e_dry"), float) else None
    law = FittedLaw(fit.likelihood.model, own, edge)
    return Closures(rebound=law, e_dry=e_dry, **forces)


def values_of(fit: Fit, record: str | None) -> dict[str, float]:
    """Estimates by plain name; separate ones by the level that the first impact of the record has."""
    o, values = fit.likelihood.observations, {}
    rows = [i for i, source in enumerate(o.labels["source"]) if source == record]
    for p, value in zip(fit.maximum.parameters, fit.maximum.values, strict=True):
        name, bracket, level = p.name.partition("[")
        if not bracket or (rows and str(o.labels[fit.likelihood.separate[name]][rows[0]]) == level[:-1]):
            values[name] = float(value)
    missing = [name for name in fit.likelihood.separate if name not in values]
    if missing:
        rule = f"has no impact that tells its {missing[0]}: leave the record out, or have one value for all"
        raise InputError(Defect(rule, file=record))
    return values


@dataclass(frozen=True)
class TrajectoryFit:
    """A law fitted to whole trajectories; ``slopes`` is the slope-based fit, or why there is none."""

    measured: Measured
    wake: bool
    fit: Fit
    slopes: Fit | str

    @property
    def trajectories(self) -> list[WholeTrajectory]:
        """The records under the model that the fit is based on."""
        return self.measured.trajectories[self.wake]

    def result(self, posterior: Posterior | None = None) -> FitResult:
        """What is kept: the fit, and beside it every record's unknowns, noise and distances."""
        base = result_of(self.fit, posterior)
        records = tuple(self._record(t) for t in self.trajectories)
        notes = (*base.notes, self.wake_in_words(), *within_the_film(self.trajectories))
        doubts = tuple(map(str, self.doubts))
        return base.model_copy(update={"trajectories": records, "notes": notes, "doubts": doubts})

    @property
    def doubts(self) -> tuple[Doubt, ...]:
        """What is doubtful about records, impacts and model."""
        return (*of_records(self.trajectories), *self.fit.doubts, *of_parameters(self.fit, self.slopes))

    def wake_in_words(self) -> str:
        """Which model the frames prefer."""
        gain, used = self.measured.preference(), "with" if self.wake else "without"
        if len(self.measured.trajectories) < 2:
            return f"model {used} the wake of the approach, as asked for"
        better = "with" if gain > 0 else "without"
        clear = "" if abs(gain) > CLEAR else " (not clearly)"
        words = (
            f"the frames prefer the model {better} the wake of the approach{clear}: ln of the evidence differs by "
            f"{abs(gain):.1f}, the strength of the wake an unknown"
        )
        if len(self.measured.gains) > 1:
            least = self.measured.borne_out
            words += f"; with it less without it, at least {least:+.1f} whichever record is left out"
        return f"{words}; the fit is {used} it"

    def _record(self, t: WholeTrajectory) -> TrajectoryRecord:
        path, rms, apex = distance_d(t, closures_of(self.fit, t.forces, self.measured.edge, t.recording.name))
        other = next(
            (x for x in self.measured.trajectories.get(not self.wake, []) if x.recording is t.recording), None
        )
        return TrajectoryRecord(
            record=t.recording.name,
            wake=self.wake,
            frames=len(t.recording.time_s),
            frames_at_rest=t.recording.rest_frames,
            reading_sigma_m=t.recording.sigma,
            unknowns=t.unknowns,
            correlated_sigma_m=t.sigma_u,
            correlation_time_s=t.tau,
            log_evidence=t.log_evidence,
            log_evidence_other_wake=None if other is None else other.log_evidence,
            rms_d=t.rms_d,
            rms_law_d=rms,
            apex_1_law_m=apex,
            impacts_law=len(path.impacts),
            map_error=t.map_error,
        )


def fit_law(measured: Measured, plan: Plan, how: Reading, wake: bool | None = None) -> TrajectoryFit:
    """A law fitted to the records under the model that they prefer, or with the wake or without as said."""
    wake = measured.preferred if wake is None else wake
    fit = law_fit(plan, observations(measured.trajectories[wake], how))
    try:
        slopes: Fit | str = law_fit(plan, slope_observations(measured.records, replace(how, edge=measured.edge)))
    except InputError as error:
        slopes = str(error.defects[0])
    return TrajectoryFit(measured, wake, fit, slopes)
