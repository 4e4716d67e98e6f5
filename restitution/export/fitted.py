"""A fit as a closure: its parameters with intervals, the range of its data, and where it comes from.

A fit file carries no signature, but it holds what its parameters make of every impact. Where these numbers do not
agree any more the file was edited by hand, and nothing is exported from it. That can be told only where all
impacts have one ratio of Stokes numbers, not of fits to whole trajectories.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.formula import SYMPY
from restitution.calibration.result.fit_file import read_fit
from restitution.calibration.result.fit_result import FORMAT, FitResult, parameter_values
from restitution.calibration.result.prediction import predict, stokes_of
from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.export.closure import Closure, Constant
from restitution.inputs import read_json
from restitution.laws import REGISTRY
from restitution.stokes import Speed

_AGREEMENT = 1e-6
"""Of kept predictions with the law at the kept parameters; text and platforms differ by less than 1e-12."""


def read_unedited(path: str | Path) -> FitResult:
    """The fit in a file; raises :class:`InputError` for one of a newer version or edited by hand."""
    _check_version(path)
    result = read_fit(path)
    for p in result.parameters:
        low, high = p.bounds
        if not low <= p.value <= high or any(not a <= p.value <= b for a, b in p.intervals.values()):
            rule = "lies outside its own bounds or interval: the file was edited by hand; run the fit again"
            raise InputError(Defect(rule, file=str(path), field=p.name, value=f"{p.value:g}"))
    _check_points(result, path)
    return result


def _check_version(path: str | Path) -> None:
    try:
        content = read_json(path)
    except InputError:
        return  # read_fit says what is wrong
    given = content.get("format") if isinstance(content, dict) else None
    kind, _, version = FORMAT.partition("/")
    number = given.removeprefix(f"{kind}/") if isinstance(given, str) else ""
    if number.isdigit() and int(number) > int(version):
        rule = f"is of a newer version of this package; this one reads {FORMAT}"
        raise InputError(Defect(rule, file=str(path), field="format", value=given))


def _check_points(result: FitResult, path: str | Path) -> None:
    """Compare what the file says of each impact with the law at the file's parameters."""
    low, high = result.law_stokes_ratio
    if high - low > 1e-9 * high or result.trajectories:
        return  # each impact's own ratio of Stokes numbers is not kept
    model = result.model()
    for point in result.points:
        values = parameter_values(result, point.levels)
        e_dry = values.pop("e_dry", point.e_dry)
        if e_dry is None:
            continue
        e = model(np.array([low * point.stokes]), e_dry, values)[0][0]
        expected = float(e) + result.offsets.get(point.source, (0.0, 0.0))[0]
        if abs(expected - point.predicted) > _AGREEMENT:
            rule = (
                f"predicts {point.predicted:.6g} at St = {point.stokes:.4g}, its parameters give {expected:.6g}: "
                "the file was edited by hand; run the fit again"
            )
            raise InputError(Defect(rule, file=str(path)))


def fit_closure(path: str | Path, levels: Mapping[str, str] | None = None) -> Closure:
    """The fitted law of a JSON file.

    Parameters
    ----------
    path : what ``restitution fit --out`` wrote.
    levels : which level of separate parameters, as ``{"material": "steel"}``.
    """
    result = read_unedited(path)
    model, values = result.model(), parameter_values(result, levels)
    missing = [p.name for p in model.parameters if p.name not in values]
    if "e_dry" in result.separate and "e_dry" not in values:
        missing.append("e_dry")
    if missing:
        label = result.separate[missing[0]]
        known = [p.name.partition("[")[2].removesuffix("]") for p in result.parameters if "[" in p.name]
        rule = f"differs by {label}: --of {label}=NAME, one of {', '.join(dict.fromkeys(known))}"
        raise InputError(Defect(rule, field=missing[0]))
    names = [p.name for p in model.parameters]
    if "e_dry" in values:
        names.append("e_dry")
    constants = tuple(_constant(result, name, values[name]) for name in names)
    law = {name: values[name] for name in names if name != "e_dry"}
    variables = ("St",) if "e_dry" in values else ("St", "e_dry")
    low, high = result.law_stokes_ratio

    def computed(which: int, St: NDArray, dry: NDArray) -> NDArray:
        return model(np.asarray(St, float), dry, law)[which]

    def interval(speed: NDArray, conditions: Conditions) -> NDArray:
        St = stokes_of(result, np.asarray(speed, float), conditions)
        return predict(result, St, values.get("e_dry"), conditions, levels).law["95%"]

    record = REGISTRY.get(result.law.name) if result.law.name else None
    hashes = tuple(f"data: {Path(name).name} {digest}" for name, digest in result.files.items())
    digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()
    fixed_dry = values.get("e_dry")
    return Closure(
        name=f"{result.law.name or 'own_formula'}_fit",
        title=f"{result.law.title}, fitted to {result.goodness.measured} impacts",
        family="rebound",
        text=model.text,
        meaning=f"e_eff = {model.text}",
        variables=variables,
        constants=constants,
        convention=model.convention,
        speed=Speed(result.speed_definition),
        edge=result.edge_d if result.speed_definition == Speed.FAR else None,
        validity=(result.stokes_range[0] * low, result.stokes_range[1] * high),
        validity_source="range of the fitted data",
        reference=record.reference if record else "a formula of the user's own",
        status=(f"form {record.status}: {record.evidence}" if record else "form the user's own")
        + "; parameters fitted",
        evaluate=lambda St, dry=fixed_dry: computed(0, St, dry),
        slope=lambda St, dry=fixed_dry: computed(1, St, dry),
        closed=record is None or record.formula is not None,
        upper={"e_dry": 1.0},
        functions={} if record else SYMPY,
        identity=(
            f"fit: {Path(path).name} sha256 {digest}",
            *hashes,
            *(() if "e_dry" in values else (f"data: {_dry_range(result)}",)),
            *(f"note: {n}" for n in result.notes),
            *(f"doubt: {d}" for d in result.doubts),
        ),
        interval=interval,
    )


def _dry_range(result: FitResult) -> str:
    """Dry restitutions of the data: beyond them e_eff rests on the law's form alone."""
    low, high = result.e_dry_range
    span = f"{low:g} to {high:g}" if high > low else f"{low:g} alone"
    return f"measured with e_dry {span}; of another e_dry by the form of the law only"


def _constant(result: FitResult, name: str, value: float) -> Constant:
    """A parameter with its 95 % interval, or as it was set."""
    for p in result.parameters:
        if p.name.partition("[")[0] == name and p.value == value:
            return Constant(name, value, p.unit, "fitted", f"95 %: {p.interval_in_words('95%')}")
    return Constant(name, value, "1", "held fixed in the fit" if name in result.fixed else "set by the user")
