"""What a law is: a small record with one formula, from which value, derivative and LaTeX follow.

A law is a frozen dataclass. Its fields are its parameters, made by :func:`parameter` with default, bounds,
unit and the source of the default; its class attributes say what it is: name, formula, convention, validity,
reference, status and a check value from outside this package. Subclassing with a ``name`` registers it.

The formula is one sympy expression in the law's variables and parameters. Laws that no closed expression
gives (a series, a table of a numerical solution) override ``_value`` and ``_derivative`` instead and say so
in ``formula_note``. Sympy is imported when a law is first evaluated, not when it is named.
"""

from __future__ import annotations

import dataclasses
import warnings
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from restitution.errors import Defect, InputError, OutOfRangeError, OutOfRangeWarning
from restitution.laws.formula import compiled_formula, latex_name, parse

OutOfRange = Literal["warn", "raise", "clip", "ignore"]
REGISTRY: dict[str, type[Law]] = {}
"""All laws by name; a law enters it by being defined."""


class Status(StrEnum):
    """How far a law's formula has been checked against its source."""

    VERIFIED = "verified"
    """Read in the source, or equal to the values it prints."""
    IN_CODE = "read in code"
    """Read in public code that implements it and names the source; the source was not opened."""
    DERIVED = "derived"
    """Derived or computed from stated equations; the derivation is in the docstring or the reference."""
    RECONSTRUCTED = "reconstructed"
    """The source survives only in part; the formula is a reading of what is left."""
    UNVERIFIED = "unverified"
    """Widely quoted; the source itself was not opened."""


@dataclass(frozen=True)
class CheckValue:
    """A value from outside this package: ``law(**inputs, **parameters)`` is ``value`` within ``tolerance``."""

    inputs: dict[str, float]
    value: float
    tolerance: float
    source: str
    parameters: dict[str, float] = dataclasses.field(default_factory=dict)


def parameter(
    default: float, bounds: tuple[float, float], unit: str, meaning: str, source: str, chosen: bool = False
) -> Any:
    """A law's parameter: a dataclass field that carries its bounds, unit, meaning and source.

    ``chosen`` marks one that is set by choice and that data cannot tell from another: a fit leaves it as it is.
    """
    metadata = {"bounds": bounds, "unit": unit, "meaning": meaning, "source": source, "chosen": chosen}
    return dataclasses.field(default=default, metadata=metadata)


@dataclass(frozen=True)
class Law:
    """Base of all laws. Call it with its variables, in order or by name; arrays broadcast."""

    name: ClassVar[str]
    family: ClassVar[str]
    title: ClassVar[str]
    symbol: ClassVar[str]
    """LaTeX of what the law gives, the left-hand side."""
    variables: ClassVar[tuple[str, ...]]
    """Names of the arguments; the first is the one that ``derivative`` and ``validity`` are about."""
    upper: ClassVar[dict[str, float]] = {}
    """Largest admissible value of a variable, where it has one; all variables are positive."""
    formula: ClassVar[str | None] = None
    formula_note: ClassVar[str] = ""
    validity: ClassVar[tuple[float, float]] = (0.0, np.inf)
    validity_source: ClassVar[str] = ""
    reference: ClassVar[str]
    status: ClassVar[Status]
    evidence: ClassVar[str] = ""
    """What the status rests on."""
    checks: ClassVar[tuple[CheckValue, ...]] = ()

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "name" in cls.__dict__:
            REGISTRY[cls.name] = cls

    def __post_init__(self) -> None:
        for f in dataclasses.fields(self):
            low, high = f.metadata["bounds"]
            value = getattr(self, f.name)
            if not low <= value <= high:  # also refuses NaN
                raise InputError(
                    Defect(
                        f"parameter of {self.name} outside its bounds [{low:g}, {high:g}]",
                        field=f.name,
                        value=f"{value:g}",
                    )
                )

    def _ordered(self, lower: str, upper: str) -> None:
        """Refuse parameters of which ``lower`` is not below ``upper``."""
        if getattr(self, lower) >= getattr(self, upper):
            raise InputError(
                Defect(
                    f"must be below {upper} = {getattr(self, upper):g} in {self.name}",
                    field=lower,
                    value=f"{getattr(self, lower):g}",
                )
            )

    @classmethod
    def parameter_fields(cls) -> tuple[dataclasses.Field, ...]:
        """The parameters as dataclass fields; ``metadata`` has bounds, unit, meaning, source."""
        return dataclasses.fields(cls)

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the parameters."""
        return dataclasses.asdict(self)

    def replace(self, **parameters: float) -> Law:
        """The same law with other parameters; raises :class:`InputError` for an unknown name."""
        known = [f.name for f in dataclasses.fields(self)]
        for name in parameters:
            if name not in known:
                raise InputError(
                    Defect(f"not a parameter of {self.name}; it has: {', '.join(known) or 'none'}", field=name)
                )
        return dataclasses.replace(self, **parameters)

    def __call__(self, *args: Any, out_of_range: OutOfRange = "warn", **kwargs: Any) -> Any:
        """The law's value; shape is that of the broadcast arguments."""
        return self._value(*self._arguments(args, kwargs, out_of_range))[()]

    def derivative(self, *args: Any, out_of_range: OutOfRange = "warn", **kwargs: Any) -> Any:
        """The exact derivative of the value with respect to the law's first variable."""
        return self._derivative(*self._arguments(args, kwargs, out_of_range))[()]

    def expression(self) -> Any:
        """The formula as a sympy expression in symbols for variables and parameters."""
        if self.formula is None:
            raise InputError(f"{self.name} has no closed formula: {self.formula_note}")
        return parse(self.formula, self._symbols)

    def latex(self) -> str:
        """The equation in LaTeX."""
        if self.formula is None:
            note = self.formula_note.replace("_", r"\_").replace("^", r"\^{}")
            return rf"{self.symbol} = \text{{{note}}}"
        import sympy

        names = {sympy.Symbol(s, positive=True): self._latex_name(s) for s in self._symbols}
        # exp(x) would be typeset as a power of e, which here is a restitution.
        shown = self.expression().replace(sympy.exp, sympy.Function(r"\exp"))
        options = {"order": "none", "ln_notation": True, "mul_symbol": r"\,"}
        return f"{self.symbol} = {sympy.latex(shown, symbol_names=names, **options)}"

    def _latex_name(self, symbol: str) -> str:
        return latex_name(symbol)

    @cached_property
    def _symbols(self) -> tuple[str, ...]:
        return (*self.variables, *(f.name for f in dataclasses.fields(self)))

    def _arguments(self, args: tuple, kwargs: dict, out_of_range: OutOfRange) -> list[np.ndarray]:
        given = dict(zip(self.variables, args, strict=False)) | kwargs
        if len(args) > len(self.variables) or set(given) != set(self.variables):
            raise TypeError(
                f"{self.name} takes {', '.join(self.variables)}; got {len(args)} values and {sorted(kwargs)}"
            )
        arrays = [np.asarray(given[v], float) for v in self.variables]
        for name, x in zip(self.variables, arrays, strict=True):
            most = self.upper.get(name, np.inf)
            wrong = ~((x > 0) & (x <= most))  # also NaN
            if wrong.any():
                rule = f"{self.name} needs a positive number" + (f", at most {most:g}" if most < np.inf else "")
                raise InputError(Defect(rule, field=name, value=f"{x[wrong][0]:g}"))
        arrays[0] = self._in_range(arrays[0], out_of_range)
        return arrays

    def _in_range(self, x: np.ndarray, out_of_range: OutOfRange) -> np.ndarray:
        low, high = self.validity
        outside = (x < low) | (x > high)
        if out_of_range == "ignore" or not outside.any():
            return x
        if out_of_range == "clip":
            return np.clip(x, low, high)
        message = (
            f"{self.name} is valid for {low:g} <= {self.variables[0]} <= {high:g}"
            f"{f' ({self.validity_source})' if self.validity_source else ''}; "
            f"got {np.min(x):g}{f' to {np.max(x):g}' if x.size > 1 else ''}"
        )
        if out_of_range == "raise":
            raise OutOfRangeError(message)
        warnings.warn(message, OutOfRangeWarning, stacklevel=4)
        return x

    def _value(self, *arrays: np.ndarray) -> np.ndarray:
        return self._compiled(None, arrays)

    def _derivative(self, *arrays: np.ndarray) -> np.ndarray:
        return self._compiled(self.variables[0], arrays)

    def _compiled(self, wrt: str | None, arrays: tuple[np.ndarray, ...]) -> np.ndarray:
        function = compiled_formula(self.formula, self._symbols, wrt)
        shape = np.broadcast_shapes(*(a.shape for a in arrays))
        # 1/St, log and Heaviside at the edges (St -> 0, inf) are meant: they give the limits.
        with np.errstate(divide="ignore", over="ignore"):
            result = function(*arrays, *self.parameters.values())
        return np.broadcast_to(np.asarray(result, float), shape)
