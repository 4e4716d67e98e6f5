"""The closure laws against values from outside: exact resistances, published check values, measured drag."""

from __future__ import annotations

import numpy as np

from restitution import datasets, laws
from restitution.bounce.unbounded import drag_errors
from restitution.laws.rebound import ReboundLaw
from restitution.stokes import Speed, StokesNumber
from restitution.validation.row import Kind, Row, Values, at_most


def check_values() -> Values:
    """Of each family of laws the worst deviation from a published check value, over its tolerance."""
    found: dict[str, float] = {}
    for name in laws.names():
        law = laws.get(name)
        for check in law.checks:
            tolerance = max(check.tolerance, _DIGITS * max(1.0, abs(check.value)))
            off = abs(_value(law.replace(**check.parameters), check.inputs) - check.value) / tolerance
            found[law.family] = max(found.get(law.family, 0.0), off)
    return found


def _value(law, inputs: dict[str, float]) -> float:
    if not isinstance(law, ReboundLaw):
        return float(law(**inputs, out_of_range="ignore"))
    speed = law.speed if law.speed is not Speed.UNSTATED else Speed.FAR
    St = StokesNumber(inputs["St"], law.convention, speed)
    return float(law(St, inputs["e_dry"], out_of_range="ignore"))


def resistance() -> Values:
    """Worst relative error of each exact resistance over its table."""
    found = {}
    for name, record, function, law in (
        ("normal to a wall", "brenner1961", "F_n", "brenner_1961"),
        ("along a wall, near", "goldman1967", "F_t", "chaoui_feuillebois_2003"),
    ):
        table = datasets.load(record)
        rows = table[(table.function == function) & (table.gap_over_radius < 0.2)]
        value = laws.get(law)(rows.gap_over_radius.to_numpy(), out_of_range="ignore")
        found[name] = float(np.abs(value / rows.value.to_numpy() - 1).max())
    return found


def drag() -> Values:
    """Rms deviation of drag laws from the measured points between Re 20 and 800."""
    return {e.law: e.rms for e in drag_errors(20.0, 800.0) if e.law in _DRAG}


_DIGITS = 1e-14
"""Where a check value is exact: round-off, over the value or 1."""
_FAMILIES = ("rebound", "resistance", "drag", "history", "film", "dry")
_DRAG = ("schiller_naumann_1935", "clift_grace_weber_1978")

ROWS = (
    Row(
        "law-check-values", "worst deviation from a published check value, over its tolerance, by family of laws",
        Kind.PUBLISHED, "the check value of every law, from outside this package",
        tuple(at_most(family, 1.0) for family in _FAMILIES), "the tolerance that each check value states",
        check_values,
    ),
    Row(
        "exact-resistance", "worst relative error of the resistance at a wall", Kind.ANALYTICAL,
        "Brenner 1961; Goldman, Cox & Brenner 1967",
        (at_most("normal to a wall", 6e-6), at_most("along a wall, near", 5e-4)),
        "the digits printed; the law's own stated error, 0.03 %", resistance,
    ),
    Row(
        "drag-law", "rms deviation of drag laws from measured drag, Re 20 to 800", Kind.MEASURED,
        "Roos & Willmarth, AIAA J. 9 (1971) 285",
        tuple(at_most(name, 0.08) for name in _DRAG),
        "twice the scatter of the points about the standard curve, 3 to 4 %", drag,
    ),
)  # fmt: skip
