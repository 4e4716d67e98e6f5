"""What is exported: a law of the registry or a fitted one, at values of its parameters, and what goes with it.

Whatever the target, its numbers come from here: ``expression`` is the law's single formula, ``value`` what this
package computes by it, held to what e_eff can be:

    0 <= e_eff <= e_dry,     e_eff = 0 for St <= 0,     no value (NaN) for an e_dry outside (0, 1] or a St of NaN.

Outside its validity range a law is continued by its formula and ``in_range`` says so.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.laws import Law, ReboundLaw
from restitution.laws.formula import parse
from restitution.stokes import Speed


@dataclass(frozen=True)
class Constant:
    """A parameter at its value; ``interval`` in words, of a fit."""

    name: str
    value: float
    unit: str
    origin: str
    interval: str = ""


@dataclass(frozen=True)
class Closure:
    """A law at values of its parameters.

    ``evaluate`` and ``slope`` are the law as this package computes it, without limits, of arrays in the order of
    ``variables``. ``identity`` says which file and data a fitted law comes from. ``upper`` is the largest value of
    a variable, where it has one.
    """

    name: str
    title: str
    family: str
    text: str
    meaning: str
    variables: tuple[str, ...]
    constants: tuple[Constant, ...]
    convention: str | None
    speed: Speed
    validity: tuple[float, float]
    validity_source: str
    reference: str
    status: str
    evaluate: Callable[..., NDArray]
    slope: Callable[..., NDArray]
    closed: bool = True
    upper: Mapping[str, float] = field(default_factory=dict)
    functions: Mapping[str, str] = field(default_factory=dict)
    """Of the formula's text, names of functions as sympy knows them."""
    typical: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Two values of each variable but the first that mean something: of the law's own check values."""
    edge: float | None = None
    """Edge of the film in diameters that the constants belong to, where one is known."""
    identity: tuple[str, ...] = ()
    interval: Callable[[NDArray, Conditions], NDArray] | None = None
    """Of a fit: low and high end of the law's 95 % interval, (n, 2), at impact speeds in m/s."""

    @property
    def rebound(self) -> bool:
        """Whether it gives e_eff, which is held between 0 and e_dry."""
        return self.family == "rebound"

    @property
    def symbols(self) -> tuple[str, ...]:
        """Names in the formula: variables, then parameters."""
        return (*self.variables, *(c.name for c in self.constants))

    @cached_property
    def expression(self) -> Any:
        """The formula in positive sympy symbols; raises :class:`InputError` where the law has none."""
        if not self.closed:
            rule = f"{self.name} has no closed formula ({self.text}): --to csv exports its table for one pair"
            raise InputError(rule)
        import sympy

        if not self.functions:
            return parse(self.text, self.symbols)
        known = {name: getattr(sympy, function) for name, function in self.functions.items()}
        # The text has passed the grammar of fitted formulas: every name in it is bound here.
        return sympy.sympify(self.text, locals=known | {s: sympy.Symbol(s, positive=True) for s in self.symbols})

    @property
    def e_dry(self) -> float | None:
        """The dry restitution, where it is a parameter of the fit rather than a variable."""
        return next((c.value for c in self.constants if c.name == "e_dry"), None)

    def value(self, *arguments: Any) -> NDArray:
        """What every target must give at these arguments, in the order of ``variables``."""
        return self._limited(self.evaluate, arguments, of_value=True)

    def derivative(self, *arguments: Any) -> NDArray:
        """The slope of :meth:`value` in the first variable: 0 where the value is held at a limit."""
        return self._limited(self.slope, arguments, of_value=False)

    def in_range(self, x: Any) -> NDArray:
        """Whether the first variable lies in the validity range."""
        low, high = self.validity
        return (np.asarray(x) >= low) & (np.asarray(x) <= high)

    def _limited(self, function: Callable, arguments: tuple, of_value: bool) -> NDArray:
        arrays = np.broadcast_arrays(*(np.asarray(a, float) for a in arguments))
        admissible = np.ones(arrays[0].shape, bool)
        for name, x in zip(self.variables, arrays, strict=True):
            positive = ~np.isnan(x) if self.rebound and name == "St" else x > 0
            admissible &= positive & (x <= self.upper.get(name, np.inf))
        computed = admissible & (arrays[0] > 0)
        inside = [np.where(computed, x, 1.0) for x in arrays]
        value = function(*inside)
        if self.rebound:
            e, most = (value if of_value else self.evaluate(*inside)), self._most(inside)
            if of_value:
                value = np.where(e < 0, 0.0, np.where(e > most, most, e))
            else:
                value = np.where((e <= 0) | (e > most), 0.0, value)
            value = np.where(computed, value, 0.0)
        return np.where(admissible, value, np.nan)

    def _most(self, arrays: list[NDArray]) -> NDArray | float:
        return arrays[self.variables.index("e_dry")] if "e_dry" in self.variables else self.e_dry


def law_closure(law: Law) -> Closure:
    """A law of the registry at its parameters."""
    constants = tuple(
        Constant(
            f.name,
            getattr(law, f.name),
            f.metadata["unit"],
            f.metadata["source"] if getattr(law, f.name) == f.default else "set by the user",
        )
        for f in law.parameter_fields()
    )
    return Closure(
        name=law.name,
        title=law.title,
        family=law.family,
        text=law.formula or law.formula_note,
        meaning=(law.__doc__ or "").strip().splitlines()[0],
        variables=law.variables,
        constants=constants,
        convention=law.convention if isinstance(law, ReboundLaw) else None,
        speed=law.speed if isinstance(law, ReboundLaw) else Speed.UNSTATED,
        validity=law.validity,
        validity_source=law.validity_source,
        reference=law.reference,
        status=f"{law.status}: {law.evidence}" if law.evidence else str(law.status),
        evaluate=lambda *arrays: law._value(*map(np.asarray, arrays)),
        slope=lambda *arrays: law._derivative(*map(np.asarray, arrays)),
        closed=law.formula is not None,
        upper=law.upper,
        typical={name: _typical(law, name) for name in law.variables[1:]},
    )


def _typical(law: Law, name: str) -> tuple[float, float]:
    """The least and the greatest value of a variable in the law's checks; the first doubled where they are one."""
    values = sorted({check.inputs[name] for check in law.checks})
    return values[0], values[-1] if len(values) > 1 else min(2 * values[0], law.upper.get(name, np.inf))


def require_rebound(closure: Closure, target: str) -> None:
    """Raise :class:`InputError` for a law of another family where a target takes e_eff."""
    if not closure.rebound:
        rule = f"{closure.name} is a {closure.family} law; {target} takes a rebound law"
        raise InputError(Defect(rule, field="--to", value=target))
