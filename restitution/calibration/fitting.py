"""One fit: which parameters are free, whether the data can determine them, the estimate and its intervals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.likelihood import OFFSET, SCATTER, Likelihood
from restitution.calibration.maximum import LEVELS, Maximum, Thresholds, maximise
from restitution.calibration.observations import Observations
from restitution.calibration.parameters import Flat, HalfNormal, Normal, Parameter
from restitution.calibration.rebound_model import ReboundModel
from restitution.calibration.small_sample import Restriction, threshold
from restitution.errors import Defect, InputError

TYPICAL_DEVIATION = 0.1
"""Width of the half-normal priors of scatter and offset in the posterior; e_eff itself lies between 0 and 1."""


@dataclass(frozen=True)
class Plan:
    """What to estimate. Parameters of the law are free unless fixed, but for those that are a choice.

    ``e_dry`` is ``None`` (as the data state it), ``"free"``, a number, or a :class:`Normal`. ``separate`` maps a
    parameter to the label it is separate by. ``offsets`` None: if there is more than one source.
    """

    model: ReboundModel
    fixed: Mapping[str, float] = field(default_factory=dict)
    free: frozenset[str] = frozenset()
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    priors: Mapping[str, Normal] = field(default_factory=dict)
    e_dry: str | float | Normal | None = None
    separate: Mapping[str, str] = field(default_factory=dict)
    scatter: bool = True
    offsets: bool | None = None
    robust: bool = False

    def likelihood(self, observations: Observations) -> Likelihood:
        """The likelihood of the observations under this plan; refuses what cannot be fitted."""
        self._known_names()
        fixed: dict[str, float | NDArray] = {}
        parameters: list[Parameter] = []
        separate = dict(self.separate)
        for p in self.model.parameters:
            wanted = p.name in self.free or p.name in self.separate or p.name in self.priors
            if p.name in self.fixed or (p.name in self.model.chosen and not wanted):
                fixed[p.name] = self.fixed.get(p.name, p.start)
            else:
                parameters += _by_level(self._own(p), separate.get(p.name), observations)
        e_dry, value = self._e_dry(observations, separate)
        if e_dry is None:
            fixed["e_dry"] = value
        else:
            parameters += _by_level(
                self._own(e_dry), separate.get("e_dry"), observations, observations.e_dry_sigma
            )
        sources = len(observations.groups("source")[0])
        deviation = HalfNormal(TYPICAL_DEVIATION)
        if self.scatter:
            parameters.append(Parameter(SCATTER, 0.03, (0.0, 1.0), "1", "even", deviation, False))
        if self.offsets if self.offsets is not None else sources > 1:
            parameters.append(Parameter(OFFSET, 0.03, (0.0, 1.0), "1", "even", deviation, False))
        found = Likelihood(self.model, observations, tuple(parameters), fixed, separate, self.robust)
        _check(found)
        return found

    def _known_names(self) -> None:
        names = [p.name for p in self.model.parameters]
        for given in (*self.fixed, *self.free, *self.bounds, *self.priors, *self.separate):
            if given not in (*names, "e_dry"):
                rule = f"is not a parameter of {self.model.name}; it has: {', '.join([*names, 'e_dry'])}"
                raise InputError(Defect(rule, field=given))

    def _own(self, p: Parameter) -> Parameter:
        """A parameter with the caller's bounds and prior."""
        bounds = self.bounds.get(p.name, p.bounds)
        prior = self.priors.get(p.name, p.prior)
        start = prior.mean if isinstance(prior, Normal) else p.start
        if not bounds[0] <= start <= bounds[1]:
            start = 0.5 * (bounds[0] + bounds[1])
        return replace(
            p, bounds=bounds, prior=prior if p.scale != "log" or prior != Flat() else Flat(True), start=start
        )

    def _e_dry(self, o: Observations, separate: dict[str, str]) -> tuple[Parameter | None, float | NDArray | None]:
        """The parameter e_dry, or its fixed value; finds what it is separate by where priors differ."""
        given = self.fixed.get("e_dry", self.priors.get("e_dry", self.e_dry))
        stated = np.isfinite(o.e_dry)
        unknown = Parameter("e_dry", 0.95, (0.01, 1.0))
        if given == "free" or (given is None and "e_dry" in self.free):
            start = float(np.median(o.e_dry[stated])) if stated.any() else 0.95
            return replace(unknown, start=start), None
        if isinstance(given, Normal):
            return replace(unknown, start=min(given.mean, 1.0), prior=given), None
        if given is not None:
            if not 0 < float(given) <= 1:
                raise InputError(Defect("must lie above 0 and be at most 1", field="e_dry", value=f"{given:g}"))
            return None, float(given)
        if not stated.all():
            where = o.places[int(np.argmin(stated))] if o.places else (None, None)
            rule = "is not stated: fill the column e_dry, or give --e-dry VALUE, VALUE+-SIGMA or free"
            raise InputError(Defect(rule, *where, "e_dry"))
        uncertain = np.isfinite(o.e_dry_sigma)
        if not uncertain.any():
            return None, o.e_dry
        if not uncertain.all():
            where = o.places[int(np.argmin(uncertain))] if o.places else (None, None)
            raise InputError(
                Defect("is empty here and given in other rows: give it in all", *where, "e_dry_sigma")
            )
        levels = np.unique(np.stack([o.e_dry, o.e_dry_sigma], axis=1), axis=0)
        if len(levels) == 1:
            return replace(unknown, start=levels[0, 0], prior=Normal(*map(float, levels[0]))), None
        separate.setdefault("e_dry", "material" if "material" in o.labels else "source")
        return unknown, None


def _by_level(
    p: Parameter, label: str | None, o: Observations, e_dry_sigma: NDArray | None = None
) -> list[Parameter]:
    """One parameter, or one for each level of a label; e_dry then takes the prior that its level states."""
    if label is None:
        return [p]
    levels, group = o.groups(label)
    found = []
    for i, level in enumerate(levels):
        own = replace(p, name=f"{p.name}[{level}]")
        if e_dry_sigma is not None and isinstance(p.prior, Flat):
            stated = {(m, s) for m, s in zip(o.e_dry[group == i], e_dry_sigma[group == i], strict=True) if s == s}
            if len(stated) > 1:
                rule = f"has more than one value where {label} is {level!r}: it must be one a {label}"
                raise InputError(Defect(rule, field="e_dry"))
            if stated:
                own = replace(own, start=min(stated)[0], prior=Normal(*map(float, min(stated))))
        found.append(own)
    return found


def _check(likelihood: Likelihood) -> None:
    """Refuse what no estimate can come from, saying what to do."""
    o = likelihood.observations
    measured = o.take(~o.censored)
    mean = [p for p in likelihood.parameters if p.mean]
    free = sum(isinstance(p.prior, Flat) for p in mean)
    named = ", ".join(p.name for p in mean)
    file = next(iter(o.files), None)
    if not len(o):
        raise InputError(Defect("has no impacts", file))
    if not len(measured):
        rule = "no impact has a rebound: limits alone do not determine a law; add impacts with a measured e_eff"
        raise InputError(Defect(rule, file))
    needed = free + (SCATTER in [p.name for p in likelihood.parameters])
    if len(measured) < needed:
        rule = f"{len(measured)} measured impacts are fewer than the {needed} parameters ({named}"
        scatter = ", scatter" * (needed > free)
        raise InputError(Defect(f"{rule}{scatter}): add impacts, fix a parameter, or give it a prior", file))
    distinct = len(np.unique(measured.St))
    if distinct == 1 and len(measured) > 1:
        rule = "all measured impacts have the same Stokes number, which tells nothing of a law in it: vary St"
        raise InputError(Defect(rule, file, None, "stokes", f"{measured.St[0]:g}"))
    if distinct < free:
        rule = f"{distinct} Stokes numbers cannot determine {free} parameters ({named}): vary St, or fix one"
        raise InputError(Defect(rule, file))
    if SCATTER not in [p.name for p in likelihood.parameters] and (measured.e_sigma <= 0).any():
        rule = "some impacts have no error, and no scatter is estimated: give e_eff_sigma, or let the scatter be"
        raise InputError(Defect(rule, file))


@dataclass(frozen=True)
class Fit:
    """An estimate with what it came from; ``freedom`` are Satterthwaite's degrees of freedom, by parameter."""

    plan: Plan
    likelihood: Likelihood
    maximum: Maximum
    freedom: NDArray
    restricted: bool
    notes: tuple[str, ...]


def estimate(
    plan: Plan,
    observations: Observations,
    intervals: bool = True,
    restricted: bool = True,
    near: Maximum | None = None,
    covariance: bool = True,
) -> Fit:
    """Maximum (restricted) likelihood. ``restricted=False`` gives the plain maximum, whose value ranks laws.

    ``near`` is the estimate of a similar fit with the same parameters, to start from.
    """
    likelihood = plan.likelihood(observations)
    parameters = likelihood.parameters
    warm = near is not None
    start, steps = (near.values, near.sigma) if warm else (_first_guess(likelihood), None)
    if not warm:
        _check_flat(likelihood, start)
    restriction = None
    if restricted and any(not p.mean for p in parameters):
        if not warm:
            start = maximise(likelihood, parameters, start, covariance=False).values
        restriction = Restriction.at(likelihood, start)
        # Zero is a stationary point of a standard deviation: the search must not begin there.
        start = np.where([p.mean for p in parameters], start, np.maximum(start, 1e-3))

    def function(values: NDArray) -> float:
        return likelihood(values) + (restriction(values) if restriction else 0.0)

    freedom = np.full(len(parameters), np.inf)
    if not intervals:
        found = maximise(function, parameters, start, covariance=covariance, steps=steps)
        return Fit(plan, likelihood, found, freedom, restriction is not None, ())
    found = maximise(function, parameters, start)
    mean = np.array([p.mean for p in parameters], bool)
    _check_bounds(found)
    if restriction is not None:
        freedom[mean] = restriction.degrees_of_freedom(found.values)
    rises = Thresholds({level: [threshold(level, nu) for nu in freedom] for level in LEVELS})
    found = maximise(function, parameters, found.values, rises)
    return Fit(plan, likelihood, found, freedom, restriction is not None, _notes(likelihood, found))


def _first_guess(likelihood: Likelihood) -> NDArray:
    """Least squares of the measured impacts from several starts, and the scatter that they leave."""
    from scipy.optimize import least_squares

    parameters, o = likelihood.parameters, likelihood.observations
    values = np.array([p.start for p in parameters], float)
    mean = np.flatnonzero([p.mean for p in parameters])
    seen = ~o.censored
    weight = 1 / np.hypot(o.e_sigma, 0.02)[seen]
    if not np.isfinite(likelihood(values)):
        names = ", ".join(f"{p.name} = {p.start:g}" for p in parameters if p.mean)
        f = likelihood.moments(values)[0]
        row = int(np.argmin(np.isfinite(f)))
        where = o.places[row] if o.places else (None, None)
        rule = (
            f"the law has no finite value here at the start ({names}): give a start or bounds where it has "
            "(--bounds NAME=LOW:HIGH starts in the middle)"
        )
        raise InputError(Defect(rule, *where, "stokes", f"{o.St[row]:g}"))
    if not len(mean):
        return values

    def misfit(x: NDArray) -> NDArray:
        trial = values.copy()
        trial[mean] = [parameters[j].outward(v) for j, v in zip(mean, x, strict=True)]
        r = (o.e - likelihood.moments(trial)[0])[seen] * weight
        priors = [
            (trial[j] - q.mean) / q.sigma if isinstance(q := parameters[j].prior, Normal) else 0.0 for j in mean
        ]
        return np.nan_to_num(np.concatenate([r, priors]), nan=1e6, posinf=1e6, neginf=-1e6)

    low = np.array([-np.inf if (a := parameters[j].limits[0]) is None else a for j in mean])
    high = np.array([np.inf if (b := parameters[j].limits[1]) is None else b for j in mean])
    first = np.clip([parameters[j].inward(values[j]) for j in mean], low, high)
    starts = [first]
    if np.isfinite(low).all() and np.isfinite(high).all():
        starts += [low + part * (high - low) for part in (0.02, 0.1, 0.3, 0.6)]
    best = min(
        (least_squares(misfit, np.clip(s, low + 1e-9, high - 1e-9), bounds=(low, high)) for s in starts),
        key=lambda found: found.cost,
    )
    values[mean] = [parameters[j].outward(v) for j, v in zip(mean, best.x, strict=True)]
    left = float(np.sqrt(np.mean((o.e - likelihood.moments(values)[0])[seen] ** 2)))
    for j, p in enumerate(parameters):
        if not p.mean:
            values[j] = min(max(left if p.name == SCATTER else 0.5 * left, 1e-12), 0.5)
    return values


def _check_bounds(found: Maximum) -> None:
    """Refuse an estimate stuck on a bound; e_dry may lie at 1, and a prior may hold a parameter anywhere."""
    for j, p in enumerate(found.parameters):
        side = found.at_bound(j) if p.mean else None
        if side and not p.name.startswith("e_dry") and not isinstance(p.prior, Normal):
            low, high = p.bounds
            rule = (
                f"is stuck on its {side} bound [{low:g}, {high:g}]: the data ask for more than the law allows; "
                f"widen it (--bounds {p.name}=LOW:HIGH), fix it, or fit another law"
            )
            raise InputError(Defect(rule, None, None, p.name, f"{found.values[j]:.4g}"))


def _check_flat(likelihood: Likelihood, values: NDArray) -> None:
    """Refuse a likelihood that does not depend on a parameter, or only on a combination of several."""
    parameters = likelihood.parameters
    mean = np.flatnonzero([p.mean for p in parameters])
    J = likelihood.jacobian(values)[:, mean]
    for place, j in enumerate(mean):
        p = parameters[j]
        reach = (p.bounds[1] - p.bounds[0]) if p.scale == "linear" else values[j]
        if isinstance(p.prior, Flat) and np.max(np.abs(J[:, place])) * reach < 1e-9:
            rule = "the likelihood does not depend on it here: it is flat; fix it, or choose another start or law"
            raise InputError(Defect(rule, None, None, p.name, f"{values[j]:.4g}"))
    size = np.sqrt(np.sum(J**2, axis=0))
    free = [i for i, j in enumerate(mean) if isinstance(parameters[j].prior, Flat)]
    if len(free) > 1:
        _, singular, directions = np.linalg.svd(J[:, free] / size[free], full_matrices=False)
        if singular[-1] < 1e-5 * singular[0]:
            part = np.abs(directions[-1])
            names = " and ".join(parameters[mean[free[i]]].name for i in np.flatnonzero(part > 0.1))
            rule = "the likelihood is flat along a combination of them: only that is determined; fix one"
            raise InputError(Defect(rule, field=names))


def _notes(likelihood: Likelihood, found: Maximum) -> tuple[str, ...]:
    """What a reader must know of this estimate."""
    o, notes = likelihood.observations, list(likelihood.observations.notes)
    if o.speed != likelihood.model.speed and likelihood.model.speed != "unstated":
        notes.append(
            f"{likelihood.model.name} is meant for the {likelihood.model.speed} impact speed; the data have the "
            f"{o.speed} speed: the parameters hold for that one"
        )
    for j, p in enumerate(found.parameters):
        if p.mean and (side := found.at_bound(j)):
            notes.append(f"{p.name} lies on its {side} bound: its interval is one-sided")
        if p.name == OFFSET and len(likelihood.source_names) < 5:
            few = len(likelihood.source_names)
            notes.append(f"{few} sources say little of how sources differ: intervals are wide for it")
    if likelihood.robust:
        notes.append("robust: Student's t with 4 degrees of freedom, no correction for small samples")
    return tuple(notes)
