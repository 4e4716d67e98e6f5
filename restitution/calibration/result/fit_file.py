"""A fit in a file: used where its parts belong together, bounds and values, covariance, names, ranges, draws."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from restitution.calibration.estimation.likelihood import OFFSET, SCATTER
from restitution.calibration.estimation.maximum import LEVELS
from restitution.calibration.result.fit_result import FitResult
from restitution.conditions import LARGEST
from restitution.errors import ConventionError, Defect, InputError
from restitution.stokes import CONVENTIONS, Speed, StokesNumber
from restitution.tables.schema import read_record

_ROUND_OFF = 1e-6
"""How far below zero an eigenvalue of a correlation matrix may lie that was written with all its digits."""
_AT_A_BOUND = 1e-4
"""Of the width of the bounds: an estimate nearer than that is at one."""
_LEAST_FREEDOM = 0.1
"""Below, an interval of Student's t has no end that can be written."""
_LARGEST_VARIANCE = LARGEST**2
_LEVELS = {f"{level:.0%}" for level in LEVELS}

Finding = tuple[str, object, str]


def read_fit(path: str | Path) -> FitResult:
    """The fit in a JSON file; raises :class:`InputError` naming all that is wrong with it."""
    result = read_record(path, FitResult)
    found = [finding for rule in (_law, _parameters, _ranges, _points) for finding in rule(result)]
    found = found or [*_model(result)]
    found = found or [*_names(result), *_covariance(result), *_chain(result), *_draws(result)]
    if found:
        raise InputError(
            *(
                Defect(rule, file=str(path), field=field, value=None if value is None else f"{value}")
                for field, value, rule in found
            )
        )
    return result


def _law(result: FitResult) -> Iterator[Finding]:
    for field, key in (("law.convention", result.law.convention), ("stokes_convention", result.stokes_convention)):
        if key not in CONVENTIONS:
            yield field, key, f"must be one of {', '.join(CONVENTIONS)}"
    if result.speed_definition not in list(Speed):
        yield "speed_definition", result.speed_definition, f"must be one of {', '.join(Speed)}"
    for name, (low, high) in result.law.bounds.items():
        if not low < high:
            yield f"law.bounds.{name}", f"{low:g} to {high:g}", "must rise"


def _parameters(result: FitResult) -> Iterator[Finding]:
    seen: set[str] = set()
    for k, p in enumerate(result.parameters):
        where, (low, high) = f"parameters.{k}", p.bounds
        if p.name in seen:
            yield f"{where}.name", p.name, "is there twice"
        seen.add(p.name)
        if not (low < high and abs(low) <= LARGEST and abs(high) <= LARGEST):
            yield f"{where}.bounds", f"{low:g} to {high:g}", f"must rise, within {LARGEST:g}"
        elif not low <= p.value <= high:
            yield f"{where}.value", f"{p.value:g}", f"lies outside its bounds [{low:g}, {high:g}]"
        if p.sigma is not None and (p.sigma < 0 or (not p.mean and p.sigma < _ROUND_OFF * p.value)):
            yield f"{where}.sigma", f"{p.sigma:g}", "is too small for the error of anything that is estimated"
        if p.degrees_of_freedom is not None and p.degrees_of_freedom < _LEAST_FREEDOM:
            yield f"{where}.degrees_of_freedom", f"{p.degrees_of_freedom:g}", f"must be at least {_LEAST_FREEDOM}"
        for name, ends in (("intervals", p.intervals), ("open_ends", p.open_ends)):
            if set(ends) != _LEVELS:
                yield f"{where}.{name}", ", ".join(ends), f"must be those of {', '.join(sorted(_LEVELS))}"
        for level, (a, b) in p.intervals.items():
            if a > b:
                yield f"{where}.intervals.{level}", f"{a:g} to {b:g}", "must rise"
    for name, (_, sigma) in result.offsets.items():
        if sigma < 0:
            yield f"offsets.{name}", f"{sigma:g}", "has a negative standard deviation"


def _ranges(result: FitResult) -> Iterator[Finding]:
    for field in ("stokes_range", "law_stokes_ratio", "e_dry_range"):
        low, high = getattr(result, field)
        least = 0.0 if field == "e_dry_range" else None
        if low > high or (low <= 0 if least is None else not 0 <= low <= high <= 1):
            rule = "must rise from a positive number" if least is None else "must rise and lie within 0 to 1"
            yield field, f"{low:g} to {high:g}", rule


def _points(result: FitResult) -> Iterator[Finding]:
    if not any(p.e_eff is not None for p in result.points):
        yield "points", None, "has no measured impact"
    for k, p in enumerate(result.points):
        if p.e_eff is None and p.e_eff_upper is None:
            yield f"points.{k}.e_eff", None, "is missing, and so is e_eff_upper"
        for name in ("stokes", "stokes_sigma", "e_eff_sigma", "sigma"):
            value = getattr(p, name)
            if value < 0 or (name == "stokes" and value == 0):
                yield f"points.{k}.{name}", f"{value:g}", "must not be negative, St not zero"


def _model(result: FitResult) -> Iterator[Finding]:
    """What the file says of its law is what the law is: a text of its own would be believed, and evaluated."""
    try:
        model = result.model()
    except InputError as error:
        yield "law", result.law.name or result.law.text, str(error)
        return
    said = "the file was edited by hand or is of another version; run the fit again"
    if result.law.name not in (None, model.name):
        yield "law.name", result.law.name, f"is no law; {said}"
    for field in ("text", "convention"):
        own = getattr(model, field)
        if getattr(result.law, field) != own:
            yield f"law.{field}", getattr(result.law, field), f"is {own} of {model.name}: {said}"
    try:
        ratio = StokesNumber(1.0, result.stokes_convention).to(model.convention).value
    except ConventionError:
        return  # it differs from impact to impact, by fluid and sphere
    low, high = result.law_stokes_ratio
    if not np.allclose((low, high), ratio, rtol=_ROUND_OFF, atol=0):
        rule = f"is {ratio:g} of {result.stokes_convention} to {model.convention}: {said}"
        yield "law_stokes_ratio", f"{low:g} to {high:g}", rule


def _names(result: FitResult) -> Iterator[Finding]:
    """Every parameter of the law is there once: free, fixed, or with a value for each level."""
    law = {p.name for p in result.model().parameters}
    there = {p.name.partition("[")[0] for p in result.parameters} | result.fixed.keys()
    for name in sorted(law - there):
        yield "parameters", None, f"has no {name}, which the law needs"
    for name in sorted(there - law - {"e_dry", SCATTER, OFFSET}):
        yield "parameters", name, f"is no parameter of the law; it has: {', '.join(sorted(law)) or 'none'}"
    for p in result.parameters:
        name, bracket, _ = p.name.partition("[")
        if bool(bracket) != (name in result.separate):
            yield "separate", p.name, "a parameter has levels where it is separate, and only there"
        if p.mean == (name in (SCATTER, OFFSET)):
            yield "parameters", p.name, "says of itself that it is of the law where it is not, or the other way"


def _covariance(result: FitResult) -> Iterator[Finding]:
    n, rows = len(result.parameters), result.covariance
    if len(rows) != n or any(len(row) != n for row in rows):
        shape = " x ".join(str(k) for k in (len(rows), len(rows[0]) if rows else 0))
        yield "covariance", shape, f"must be {n} x {n}, a row and a column a parameter"
        return
    whole = np.array([[np.nan if x is None else x for x in row] for row in rows]).reshape(n, n)
    known = np.flatnonzero(np.isfinite(np.diag(whole)))
    C = whole[np.ix_(known, known)]
    if not np.isfinite(C).all():
        yield "covariance", None, "has empty places between parameters that have a variance"
    elif (np.diag(C) < 0).any():
        yield "covariance", f"{np.diag(C).min():g}", "has a negative variance"
    elif len(C) and np.abs(C).max() > _LARGEST_VARIANCE:
        yield "covariance", f"{np.abs(C).max():g}", "is larger than of anything that is fitted"
    else:
        scale = np.sqrt(np.diag(C))
        scale[scale == 0] = 1.0
        R = C / np.outer(scale, scale)
        if not np.allclose(R, R.T, atol=_ROUND_OFF):
            yield "covariance", None, "is not symmetric"
        elif len(R) and np.linalg.eigvalsh(R).min() < -_ROUND_OFF:
            yield "covariance", None, "is negative for some combination of the parameters"


def _chain(result: FitResult) -> Iterator[Finding]:
    chain = result.posterior
    if chain is None:
        return
    n = len(chain.names)
    if list(chain.names) != [p.name for p in result.parameters]:
        yield "posterior.names", ", ".join(chain.names), "must be those of the parameters, in their order"
    for field in ("median", "autocorrelation_time"):
        if len(getattr(chain, field)) != n:
            yield f"posterior.{field}", len(getattr(chain, field)), f"must have {n} numbers"
    if any(len(row) != n for row in chain.draws) or not (chain.draws or result.draws):
        yield "posterior.draws", len(chain.draws), f"must be rows of {n} numbers, at least one"


def _at_a_bound(value: float, bounds: tuple[float, float]) -> bool:
    low, high = bounds
    return min(value - low, high - value) <= _AT_A_BOUND * (high - low)


def _draws(result: FitResult) -> Iterator[Finding]:
    own = result.draws
    if own is None:
        return
    n = len(result.parameters) + len(own.sources)
    if not own.rows or any(len(row) != n for row in own.rows):
        yield "draws.rows", len(own.rows), f"must be rows of {n} numbers, at least one"
        return
    if len(own.weights) != len(own.rows) or min(own.weights) < 0 or not 0 < sum(own.weights) < 2:
        yield "draws.weights", len(own.weights), "must be one a row, none negative, with the sum 1"
    for k, p in enumerate(result.parameters):
        low, high = min(row[k] for row in own.rows), max(row[k] for row in own.rows)
        slack = _ROUND_OFF * 10 * max(abs(low), abs(high))
        if low < p.bounds[0] - slack or high > p.bounds[1] + slack:
            yield f"draws.{p.name}", f"{low:g} to {high:g}", f"leave the bounds {p.bounds[0]:g} to {p.bounds[1]:g}"
        # An estimate at a bound, which the search comes near to only, has all its draws on one side.
        elif p.mean and not low - slack <= p.value <= high + slack and not _at_a_bound(p.value, p.bounds):
            yield f"draws.{p.name}", f"{low:g} to {high:g}", f"are not about the estimate {p.value:g}"
    if any(abs(x) > LARGEST for row in own.rows for x in row):
        yield "draws.rows", None, f"must lie within {LARGEST:g}"
