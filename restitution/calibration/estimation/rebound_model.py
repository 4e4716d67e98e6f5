"""A rebound law as the fit sees it: f(St, e_dry; parameters) and its exact slope df/dSt, for arrays of impacts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from restitution import laws
from restitution.calibration.estimation.parameters import Parameter, scale_of
from restitution.errors import InputError
from restitution.laws.formula import compiled_formula
from restitution.stokes import Speed


class ReboundModel(Protocol):
    """What a fit needs of a law; ``parameters`` have defaults as their starts."""

    name: str
    title: str
    text: str
    convention: str
    speed: Speed
    parameters: tuple[Parameter, ...]
    chosen: frozenset[str]
    """Parameters that are a choice rather than something data determine: fixed unless freed."""

    def __call__(self, St: NDArray, e_dry: Any, values: Mapping[str, Any]) -> tuple[NDArray, NDArray]:
        """F and df/dSt; parameter values are numbers or arrays like St."""
        ...


@dataclass(frozen=True)
class LawModel:
    """A law of the registry."""

    law: laws.ReboundLaw

    @property
    def name(self) -> str:
        return self.law.name

    @property
    def title(self) -> str:
        return self.law.title

    @property
    def text(self) -> str:
        return self.law.formula or self.law.formula_note

    @property
    def convention(self) -> str:
        return self.law.convention

    @property
    def speed(self) -> Speed:
        return self.law.speed

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        return tuple(
            Parameter(
                f.name,
                getattr(self.law, f.name),
                f.metadata["bounds"],
                f.metadata["unit"],
                scale_of(f.metadata["bounds"]),
            )
            for f in self.law.parameter_fields()
        )

    @property
    def chosen(self) -> frozenset[str]:
        return frozenset(f.name for f in self.law.parameter_fields() if f.metadata["chosen"])

    @cached_property
    def _compiled(self) -> tuple[tuple[str, ...], Any, Any]:
        """Names of the parameters, and the compiled value and slope."""
        names = tuple(f.name for f in self.law.parameter_fields())
        symbols = (*self.law.variables, *names)
        return names, *(compiled_formula(self.law.formula, symbols, wrt) for wrt in (None, "St"))

    def __call__(self, St: NDArray, e_dry: Any, values: Mapping[str, Any]) -> tuple[NDArray, NDArray]:
        """F and df/dSt in the law's own St. Outside the parameters' bounds it is the caller's affair."""
        if self.law.formula is None:
            return self._by_level(St, e_dry, values)
        names, value_of, slope_of = self._compiled
        arguments = (St, e_dry, *(values[name] for name in names))
        with np.errstate(all="ignore"):
            value, slope = value_of(*arguments), slope_of(*arguments)
        return _shaped(value, St), _shaped(slope, St)

    def _by_level(self, St: NDArray, e_dry: Any, values: Mapping[str, Any]) -> tuple[NDArray, NDArray]:
        """Laws without a formula take one set of parameters at a time."""
        names = list(values)
        e_dry = np.broadcast_to(np.asarray(e_dry, float), St.shape)
        if all(np.ndim(values[n]) == 0 for n in names):
            law = self.law.replace(**{n: float(values[n]) for n in names})
            return law._value(St, e_dry), law._derivative(St, e_dry)
        table = np.stack([np.broadcast_to(np.asarray(values[n], float), St.shape) for n in names], axis=1)
        f, slope = np.empty(St.shape), np.empty(St.shape)
        for level in np.unique(table, axis=0):
            use = (table == level).all(axis=1)
            law = self.law.replace(**dict(zip(names, map(float, level), strict=True)))
            f[use], slope[use] = law._value(St[use], e_dry[use]), law._derivative(St[use], e_dry[use])
        return f, slope


def _shaped(value: Any, St: NDArray) -> NDArray:
    """An array like St; a formula without St gives a number."""
    return value if np.shape(value) == St.shape else np.broadcast_to(np.asarray(value, float), St.shape)


def model_of(
    text: str, bounds: Mapping[str, tuple[float, float]] | None = None, convention: str | None = None
) -> ReboundModel:
    """The model to fit: a law of the registry, or a formula of the user's own.

    Parameters
    ----------
    text : name of a rebound law, or an expression in St, e_dry and the parameters to be found, as
        "e_dry*exp(-(a/St)**n)"; the grammar is in :mod:`.formula`.
    bounds : low and high of each parameter of a formula; a law has its own.
    convention : of the St of a formula.

    Raises
    ------
    InputError : for an unknown law, a formula that breaks the grammar, parameters without bounds.
    """
    if text in laws.REGISTRY:
        law = laws.get(text)
        if not isinstance(law, laws.ReboundLaw):
            raise InputError(f"{text} is a law of the family {law.family}; a rebound law is needed")
        return LawModel(law)
    if text.isidentifier():
        laws.get(text)  # raises with the names that are near
    from restitution.calibration.estimation.formula import FormulaModel

    return FormulaModel.parse(text, bounds or {}, convention or "st")
