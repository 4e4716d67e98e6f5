"""What is estimated: which parameters of a law are free, e_dry, scatter and offsets, as a likelihood."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.identifiability import check_data
from restitution.calibration.estimation.likelihood import OFFSET, SCATTER, Likelihood
from restitution.calibration.estimation.parameters import Earlier, Flat, HalfNormal, Normal, Parameter
from restitution.calibration.estimation.rebound_model import ReboundModel
from restitution.calibration.reading.impact_checks import NO_E_DRY
from restitution.calibration.reading.observations import Observations
from restitution.errors import Defect, InputError

TYPICAL_SCATTER = 0.1
"""Width of the half-normal prior of the scatter: it stays below 0.2, what another definition of the impact speed
does to e_eff at most, with 95 %. Ten impacts tell it anyway."""
TYPICAL_OFFSET = 0.05
"""Width of the half-normal prior of the offsets: constants of the measured records from K = 8 to 18
(:mod:`restitution.doubts.film_loss`) spread e_eff by 0.2 at St 60, taken as four standard deviations. Two or three
sources leave so much open that this decides how wide a prediction for a new one is."""


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
    starts: Mapping[str, float] = field(default_factory=dict)
    """Where the search begins; of the others it finds its own."""
    e_dry: str | float | Normal | None = None
    separate: Mapping[str, str] = field(default_factory=dict)
    scatter: bool = True
    offsets: bool | None = None
    robust: bool = False
    log_variance: bool = True
    """Off: without the term ln var_i, as York's line and ODRPACK have it; with known errors alone."""
    earlier: Earlier | None = None
    """A fit to other data as the prior of the law's parameters."""

    @property
    def known_e_dry(self) -> float | None:
        """The number that e_dry is held at or expected to be, where it is one."""
        given = self.fixed.get("e_dry", self.priors.get("e_dry", self.e_dry))
        mean = given.mean if isinstance(given, Normal) else given
        return None if isinstance(mean, str) else mean

    def likelihood(self, observations: Observations) -> Likelihood:
        """The likelihood of the observations under this plan; refuses what cannot be fitted."""
        self._known_names()
        fixed: dict[str, float | NDArray] = {}
        parameters: list[Parameter] = []
        separate = dict(self.separate)
        for p in self.model.parameters:
            wanted = p.name in self.free or p.name in self.separate or p.name in self.priors
            low, high = p.bounds
            if p.name in self.fixed and not low <= self.fixed[p.name] <= high:
                rule = f"lies outside the bounds of the law, [{low:g}, {high:g}]"
                raise InputError(Defect(rule, field=p.name, value=f"{self.fixed[p.name]:g}"))
            if p.name in self.fixed or (p.name in self.model.chosen and not wanted):
                fixed[p.name] = self.fixed.get(p.name, p.start)
            else:
                parameters += _by_level(self._own(p), separate.get(p.name), observations)
        e_dry, value = self._e_dry(observations, separate)
        self._check_separate(e_dry)
        if e_dry is None:
            fixed["e_dry"] = value
        else:
            parameters += _by_level(
                self._own(e_dry), separate.get("e_dry"), observations, observations.e_dry_sigma
            )
        sources = len(observations.groups("source")[0])
        if self.scatter:
            parameters.append(
                Parameter(SCATTER, 0.03, (0.0, 1.0), "1", "even", HalfNormal(TYPICAL_SCATTER), False)
            )
        if self.offsets if self.offsets is not None else sources > 1:
            parameters.append(Parameter(OFFSET, 0.03, (0.0, 1.0), "1", "even", HalfNormal(TYPICAL_OFFSET), False))
        earlier = self.earlier
        if earlier is not None:
            earlier.check(self.model.text, observations)
            earlier = earlier.of([p.name for p in parameters if p.mean])
            for name in self.priors.keys() & set(earlier.names):
                rule = f"has a prior of its own, and one by {earlier.origin}: leave one of them out"
                raise InputError(Defect(rule, field=name))
            parameters = earlier.without_own_priors(parameters)
        if not self.log_variance and (self.robust or any(not p.mean for p in parameters)):
            rule = (
                "without ln of the variances nothing holds scatter, offsets and robust errors down: it goes with "
                "known errors alone (--no-scatter --offsets none)"
            )
            raise InputError(Defect(rule, field="--no-log-variance"))
        likelihood = Likelihood(
            self.model, observations, tuple(parameters), fixed, separate, self.robust, self.log_variance, earlier
        )
        check_data(likelihood)
        return likelihood

    def _check_separate(self, e_dry: Parameter | None) -> None:
        """Refuse levels of what is not estimated."""
        if "e_dry" in self.separate and e_dry is None:
            rule = "is not estimated but stated by the data or the caller: --e-dry free estimates it by levels"
            raise InputError(Defect(rule, field="e_dry"))
        for name in self.starts.keys() & (self.fixed.keys() | ({"e_dry"} if e_dry is None else set())):
            raise InputError(Defect("is not estimated: it has no start", field=name))
        for name in self.separate.keys() & self.fixed.keys():
            raise InputError(Defect("is fixed: it cannot differ by levels", field=name))

    def _known_names(self) -> None:
        names = [p.name for p in self.model.parameters]
        for given in (*self.fixed, *self.free, *self.bounds, *self.priors, *self.starts, *self.separate):
            if given not in (*names, "e_dry"):
                rule = f"is not a parameter of {self.model.name}; it has: {', '.join([*names, 'e_dry'])}"
                raise InputError(Defect(rule, field=given))

    def _own(self, p: Parameter) -> Parameter:
        """A parameter with the caller's bounds and prior."""
        bounds = self.bounds.get(p.name, p.bounds)
        prior = self.priors.get(p.name, p.prior)
        start = self.starts.get(p.name, prior.mean if isinstance(prior, Normal) else p.start)
        if not bounds[0] <= start <= bounds[1]:
            if p.name in self.starts:
                rule = f"starts outside its bounds [{bounds[0]:g}, {bounds[1]:g}]"
                raise InputError(Defect(rule, field=p.name, value=f"{start:g}"))
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
            raise InputError(Defect(NO_E_DRY, **o.place(int(np.argmin(stated))), field="e_dry"))
        uncertain = np.isfinite(o.e_dry_sigma)
        if not uncertain.any():
            return None, o.e_dry
        if not uncertain.all():
            rule = "is empty here and given in other rows: give it in all"
            raise InputError(Defect(rule, **o.place(int(np.argmin(uncertain))), field="e_dry_sigma"))
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
    parameters = []
    for i, level in enumerate(levels):
        own = replace(p, name=f"{p.name}[{level}]")
        if e_dry_sigma is not None and isinstance(p.prior, Flat):
            stated = {(m, s) for m, s in zip(o.e_dry[group == i], e_dry_sigma[group == i], strict=True) if s == s}
            if len(stated) > 1:
                rule = f"has more than one value where {label} is {level!r}: it must be one a {label}"
                raise InputError(Defect(rule, field="e_dry"))
            if stated:
                own = replace(own, start=min(stated)[0], prior=Normal(*map(float, min(stated))))
        parameters.append(own)
    return parameters
