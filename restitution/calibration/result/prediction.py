"""e_eff at given conditions, with its interval: that of the law, and that of one more impact.

Both are central intervals of the posterior, over the draws that a fit keeps (:mod:`..estimation.draws`, or a
chain). One more impact has the scatter of the draw on top, and of a new source its offset as well; of a source
that was fitted, the offset that its impacts leave open. Many Stokes numbers share the intervals of some of them:
how far an end lies from the value, in standard errors by the linear propagation J C J^T, changes slowly with St
and is interpolated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.bounce.edges import passage
from restitution.calibration.estimation.likelihood import OFFSET
from restitution.calibration.estimation.maximum import LEVELS
from restitution.calibration.estimation.plan import TYPICAL_OFFSET
from restitution.calibration.result.bands import noisy_quantiles, quantiles
from restitution.calibration.result.fit_result import FitResult, parameter_values, sources
from restitution.calibration.result.kept_draws import kept, one_more
from restitution.calibration.showing import Showing, Table
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.stokes import Speed, StokesNumber, film_edge

FEW = 3
"""Sources below which the prior decides how much a new one differs."""
KNOTS = 256
"""Stokes numbers whose intervals are computed; of more they are interpolated."""
_PARTS = tuple(0.5 * (1 + sign * level) for level in LEVELS for sign in (-1, 1))


@dataclass(frozen=True, repr=False)
class Prediction(Showing):
    """Arrays over the Stokes numbers; ``law`` and ``impact`` are intervals (n, 2) by level in percent."""

    stokes: NDArray
    value: NDArray
    sigma: NDArray
    law: Mapping[str, NDArray]
    impact: Mapping[str, NDArray]
    warnings: tuple[str, ...]

    def shown(self) -> Table:
        """e_eff at each Stokes number, where the law lies, and where one more impact would."""
        intervals = {f"law, {level}": ends for level, ends in self.law.items()}
        intervals |= {f"one impact, {level}": ends for level, ends in self.impact.items()}
        rows = [
            (
                f"{St:.4g}",
                f"{value:.3f}",
                *(f"{ends[i][0]:.3f} to {ends[i][1]:.3f}" for ends in intervals.values()),
            )
            for i, (St, value) in enumerate(zip(self.stokes, self.value, strict=True))
        ]
        title = "\n".join(["e_eff by the fitted law", *(f"warning: {text}" for text in self.warnings)])
        return Table(title, ("St", "e_eff", *intervals), rows)


def predict(
    result: FitResult,
    St: NDArray | Sequence[float] | float,
    e_dry: float | None = None,
    conditions: Conditions | None = None,
    levels: Mapping[str, str] | None = None,
    source: str | None = None,
) -> Prediction:
    """e_eff of the fitted law, with intervals for the mean and for one more impact.

    Parameters
    ----------
    result : of a fit.
    St : Stokes numbers in the convention and of the speed of the data it was fitted to; a number or 1-D.
    e_dry : where it was not estimated; else taken from ``conditions``.
    conditions : fluid and sphere.
    levels : which level of separate parameters, as ``{"material": "steel"}``.
    source : the fitted source (laboratory, record) of the one more impact; None: a new one.

    Returns
    -------
    Values and intervals, an entry a St, and warnings where St lies outside the data.

    Raises
    ------
    InputError : where e_dry, a level or the source is missing or unknown.
    """
    law = Evaluation(result, e_dry, conditions, levels)
    St = np.atleast_1d(np.asarray(St, float))
    value = law(St, law.values)
    J = law.jacobian(St)
    sigma = np.sqrt(np.einsum("ij,jk,ik->i", J, law.covariance, J))
    draws = kept(result)
    more, weights = one_more(draws, result, source), draws.weights
    rows = draws.values[:, [draws.names.index(name) for name in law.full_names]]
    knots = np.unique(St)
    if len(knots) > KNOTS:
        knots = knots[np.linspace(0, len(knots) - 1, KNOTS).astype(int)]
    f = np.stack([law(knots, row) for row in rows], axis=1)
    whole = np.sqrt(sigma**2 + weights @ more.noise**2 + weights @ (more.offset - weights @ more.offset) ** 2)
    tables = (
        (quantiles(f, weights, _PARTS), sigma),
        (noisy_quantiles(f + more.offset, weights, more.noise, _PARTS), whole),
    )
    at_knots = law(knots, law.values)
    intervals, one = (_by_level(_spread_out(knots, ends, at_knots, St, value, scale)) for ends, scale in tables)
    return Prediction(St, value, sigma, intervals, one, _warnings(result, St, law.e_dry, source))


def predict_at(
    result: FitResult,
    speed: NDArray,
    edge: float,
    conditions: Conditions,
    e_dry: float | None = None,
    levels: Mapping[str, str] | None = None,
    source: str | None = None,
) -> Prediction:
    """:func:`predict` for impact speeds in m/s at another ``edge`` of the film (diameters) than the fit's.

    Each speed is carried to the fit's own edge, and value and ends of the intervals back from it
    (:mod:`restitution.bounce.edges`); ``sigma`` is half the law's 68 % interval. ``stokes`` is that of the speeds.

    Raises
    ------
    InputError : as :func:`predict`, and for a fit to speeds that know no edge.
    """
    edge = film_edge(edge, "--edge")
    own = result.edge_d
    if result.speed_definition != Speed.FAR or own is None:
        rule = (
            f"is a convention of the speed far; the fit is of the speed {result.speed_definition}: fit it by far"
        )
        raise InputError(Defect(rule, field="--edge", value=f"{edge:g}"))
    passages = [passage(conditions, float(v), edge, own) for v in np.atleast_1d(speed)]
    wider = own < edge
    there = predict(
        result,
        stokes_of(result, np.array([p.v_narrow if wider else p.v_wide for p in passages]), conditions),
        e_dry, conditions, levels, source,
    )  # fmt: skip

    def here(e: NDArray) -> NDArray:
        ends = np.clip(e, 0.0, 1.0)
        return np.array([p.widened(x) if wider else p.narrowed(x) for p, x in zip(passages, ends, strict=True)])

    def both(table: Mapping[str, NDArray]) -> dict[str, NDArray]:
        return {level: np.stack([here(ends[:, 0]), here(ends[:, 1])], axis=1) for level, ends in table.items()}

    law, St = both(there.law), stokes_of(result, np.atleast_1d(speed), conditions)
    sigma = np.diff(law["68%"], axis=1)[:, 0] / 2
    return Prediction(St, here(there.value), sigma, law, both(there.impact), there.warnings)


def stokes_of(result: FitResult, speed: NDArray, conditions: Conditions) -> NDArray:
    """St in the convention of the fit's data, of impact speeds in m/s by the fit's definition of speed."""
    number = StokesNumber.from_speed(speed, conditions, result.stokes_convention, Speed(result.speed_definition))
    return np.atleast_1d(number.value)


class Evaluation:
    """A fitted law that can be evaluated at other values of its parameters: what prediction and design share."""

    def __init__(
        self,
        result: FitResult,
        e_dry: float | None = None,
        conditions: Conditions | None = None,
        levels: Mapping[str, str] | None = None,
    ):
        self.model = result.model()
        chosen = parameter_values(result, levels)
        missing = [p.name for p in self.model.parameters if p.name not in chosen]
        if "e_dry" in result.separate and "e_dry" not in chosen:
            missing.append("e_dry")
        if missing:
            label = result.separate[missing[0]]
            known = [p.name.partition("[")[2].removesuffix("]") for p in result.parameters if "[" in p.name]
            rule = f"differs by {label}: --level {label}=NAME, one of {', '.join(dict.fromkeys(known))}"
            raise InputError(Defect(rule, field=missing[0]))
        if e_dry is None and "e_dry" not in chosen and conditions is not None:
            e_dry = conditions.sphere.e_dry
        if "e_dry" not in chosen and e_dry is None:
            raise InputError(
                Defect("is needed: it was not estimated (--e-dry 0.97, or --sphere ...,e_dry=0.97)", field="e_dry")
            )
        if e_dry is not None and not 0 < e_dry <= 1:
            raise InputError(Defect("must lie above 0 and be at most 1", field="e_dry", value=f"{e_dry:g}"))
        self.e_dry = chosen.get("e_dry", e_dry)
        self.fixed = {"e_dry": self.e_dry} | chosen
        plain = {p.name: p.name.partition("[")[0] for p in result.parameters if p.mean}
        used = [p for p in result.parameters if p.mean and chosen.get(plain[p.name]) == p.value]
        self.names = [plain[p.name] for p in used]
        self.full_names = [p.name for p in used]
        self.bounds = [p.bounds for p in used]
        self.values = np.array([p.value for p in used])
        index = [[q.name for q in result.parameters].index(p.name) for p in used]
        whole = np.array([[np.nan if x is None else x for x in row] for row in result.covariance])
        self.covariance = whole[np.ix_(index, index)] if index else np.zeros((0, 0))
        self.ratio = _ratio(result, self.model.convention, conditions)

    def __call__(self, St: NDArray, values: NDArray) -> NDArray:
        """F at St of the data's convention."""
        given = self.fixed | dict(zip(self.names, map(float, values), strict=True))
        e_dry = given.pop("e_dry")
        given = {p.name: given[p.name] for p in self.model.parameters}
        return self.model(St * self.ratio, e_dry, given)[0]

    def slope(self, St: NDArray) -> NDArray:
        """Df/dSt in the data's St."""
        given = dict(self.fixed)
        e_dry = given.pop("e_dry")
        given = {p.name: given[p.name] for p in self.model.parameters}
        return self.model(St * self.ratio, e_dry, given)[1] * self.ratio

    def jacobian(self, St: NDArray) -> NDArray:
        """Df/d parameter by central differences, (n, parameters)."""
        J = np.zeros((len(St), len(self.names)))
        for j, (low, high) in enumerate(self.bounds):
            step = 1e-6 * max(abs(self.values[j]), 1e-3 * min(1.0, high - low))
            above, below = self.values.copy(), self.values.copy()
            above[j], below[j] = min(above[j] + step, high), max(below[j] - step, low)
            J[:, j] = (self(St, above) - self(St, below)) / (above[j] - below[j])
        return J


def _by_level(ends: NDArray) -> dict[str, NDArray]:
    """Low and high ends (n, 2) by level, of ends in the order of the parts."""
    return {f"{level:.0%}": ends[:, 2 * k : 2 * k + 2] for k, level in enumerate(LEVELS)}


def _spread_out(
    knots: NDArray, ends: NDArray, at_knots: NDArray, St: NDArray, value: NDArray, scale: NDArray
) -> NDArray:
    """Ends at all St from those at the knots; ``scale`` is the standard error of each St."""
    at_least = 1e-12 + 1e-6 * float(np.max(scale, initial=0.0))
    scale = np.maximum(scale, at_least)
    own = np.interp(knots, *_rising(St, scale))
    away = (ends - at_knots[:, None]) / own[:, None]
    found = value[:, None] + scale[:, None] * np.stack([np.interp(St, knots, x) for x in away.T], axis=1)
    # An estimate on a bound has all draws on one side: the interval then begins at it.
    lower = np.array(_PARTS) < 0.5
    return np.where(lower, np.minimum(found, value[:, None]), np.maximum(found, value[:, None]))


def _rising(x: NDArray, y: NDArray) -> tuple[NDArray, NDArray]:
    order = np.argsort(x)
    return x[order], y[order]


def _ratio(result: FitResult, convention: str, conditions: Conditions | None) -> float:
    """The law's Stokes number over that of the data: by the conditions, or as it was for all fitted impacts."""
    low, high = result.law_stokes_ratio
    if conditions is None and high - low < 1e-9 * high:
        return low
    return StokesNumber(1.0, result.stokes_convention).to(convention, conditions).value


def _warnings(result: FitResult, St: NDArray, e_dry: float, source: str | None) -> tuple[str, ...]:
    warnings = []
    low, high = result.stokes_range
    outside = St[(St < low) | (St > high)]
    if len(outside):
        shown = f"{outside.min():.4g}" + (f" to {outside.max():.4g}" if len(outside) > 1 else "")
        warnings.append(
            f"St {shown} lies outside the calibrated range {low:.4g} to {high:.4g}: the interval does not say how "
            "wrong the law may be there"
        )
    least, most = result.e_dry_range
    estimated = any(p.name.startswith("e_dry") for p in result.parameters)
    if not estimated and not least - 0.02 <= e_dry <= most + 0.02:
        warnings.append(f"e_dry {e_dry:g} lies outside that of the calibration, {least:g} to {most:g}")
    if source is None and len(known := sources(result)) < FEW:
        if OFFSET in result.values:
            rule = (
                f"the fit has {len(known)} sources, which say little of how sources differ: the interval of one "
                f"impact of a new one is mostly the prior of that, some {TYPICAL_OFFSET:g}; --source NAME for one "
                "of the fit's"
            )
        else:
            rule = (
                "how much sources (laboratories, records) differ is not in the fit: one impact of a new one "
                "may lie outside its interval more often than that says"
            )
        warnings.append(rule)
    return tuple(warnings)
