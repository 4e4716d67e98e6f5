"""The functions that a file of source code gets, before any language: names, arguments and what they do in order.

    NAME(St, e_dry)          e_eff, held within 0 and e_dry          NAME_slope      its derivative in St
    NAME_in_range(St)        1 in the validity range, else 0
    NAME_stokes(v, d, ...)   the law's Stokes number of an impact at a wall; NAME_stokes_pair of two spheres

Laws of other families have value, slope and in_range alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from restitution.export.closure import Closure
from restitution.stokes import convention

Comparison = tuple[str, str, "str | float"]
"""Left side, operator and right side: a name or a number."""
_TAKEN = frozenset(
    [
        "e",
        "y",
        "i",
        "n",
        "s",
        "dp",
        "pi",
        "nan",
        "inf",
        "int",
        "if",
        "do",
        "for",
        "in",
        "is",
        "or",
        "and",
        "not",
        "else",
        "end",
        "real",
        "double",
        "float",
        "return",
        "function",
        "module",
        "class",
        "def",
        "del",
        "from",
        "import",
        "lambda",
        "let",
        "const",
        "var",
        "new",
        "this",
        "with",
        "while",
        "until",
        "repeat",
        "break",
        "case",
        "switch",
        "default",
        "static",
        "inline",
        "void",
        "char",
        "short",
        "long",
        "signed",
        "unsigned",
        "struct",
        "union",
        "enum",
        "auto",
        "register",
        "goto",
        "extern",
        "volatile",
        "restrict",
        "program",
        "use",
        "only",
        "result",
        "contains",
        "call",
        "merge",
        "sign",
        "max",
        "min",
        "abs",
        "exp",
        "log",
        "sqrt",
        "tanh",
        "pow",
        "fmax",
        "fmin",
        "math",
        "local",
        "global",
        "begin",
        "true",
        "false",
        "nothing",
        "none",
        "try",
        "catch",
        "except",
        "raise",
        "pass",
        "yield",
        "async",
        "await",
        "elif",
        "as",
        "assert",
        "wrong",
        "expected",
        "inputs",
        "values",
        "slopes",
        "self",
        "check",
        "row",
    ]
)


@dataclass(frozen=True)
class Let:
    """A local name for a number, an expression of sympy, or text that is the same in every language."""

    name: str
    value: Any


@dataclass(frozen=True)
class Unless:
    """Ends with ``value`` unless all comparisons hold; a comparison with NaN does not."""

    comparisons: tuple[Comparison, ...]
    value: str | float


@dataclass(frozen=True)
class When:
    """Ends with ``value`` where the comparison holds."""

    comparison: Comparison
    value: str | float


@dataclass(frozen=True)
class Give:
    """Ends with an expression, or text."""

    value: Any


@dataclass(frozen=True)
class Function:
    """One function of numbers. ``flag``: it gives 1 or 0."""

    name: str
    arguments: tuple[str, ...]
    says: str
    body: tuple[Let | Unless | When | Give, ...]
    flag: bool = False


def functions_of(closure: Closure, derivative: bool = False) -> list[Function]:
    """The functions of a closure's file; raises :class:`InputError` for a law without a closed formula."""
    expression, constants = _with_safe_names(closure)
    functions = [_value(closure, expression, constants)]
    if derivative:
        functions.append(_slope(closure, expression, constants))
    functions.append(_in_range(closure))
    if closure.rebound:
        functions += _stokes(closure)
    return functions


def _with_safe_names(closure: Closure) -> tuple[Any, list[Let]]:
    """The formula and its constants under names that are free in every language, in capitals or not."""
    import sympy

    # As a number: some languages would declare pi in the middle of an expression.
    expression = closure.expression.xreplace({sympy.pi: sympy.pi.evalf(17)})
    used, constants = {v.lower() for v in closure.variables}, []
    for constant in closure.constants:
        name = constant.name
        while name.lower() in _TAKEN or name.lower() in used:
            name = f"{name}_p"
        used.add(name.lower())
        symbol = sympy.Symbol(constant.name, positive=True)
        expression = expression.xreplace({symbol: sympy.Symbol(name, positive=True)})
        constants.append(Let(name, constant.value))
    return expression, constants


def _guards(closure: Closure) -> list[Unless]:
    """What comes before the formula: arguments without a meaning, and no impact at all."""
    wanted: list[Comparison] = []
    for name in closure.variables:
        if closure.rebound and name == "St":
            wanted.append(("St", "==", "St"))
            continue
        wanted.append((name, ">", 0.0))
        if name in closure.upper:
            wanted.append((name, "<=", closure.upper[name]))
    guards = [Unless(tuple(wanted), "nan")]
    return [*guards, Unless((("St", ">", 0.0),), 0.0)] if closure.rebound else guards


def _value(closure: Closure, expression: Any, constants: list[Let]) -> Function:
    says = "e_eff" if closure.rebound else closure.meaning
    if not closure.rebound:
        body = (*_guards(closure), *constants, Give(expression))
        return Function(closure.name, closure.variables, says, body)
    dry = _dry(closure, constants)
    limits = (When(("e", "<", 0.0), 0.0), When(("e", ">", dry), dry))
    body = (*_guards(closure), *constants, Let("e", expression), *limits, Give("e"))
    return Function(closure.name, closure.variables, says, body)


def _slope(closure: Closure, expression: Any, constants: list[Let]) -> Function:
    import sympy

    x = sympy.Symbol(closure.variables[0], positive=True)
    steps = {h: sympy.Piecewise((0, h.args[0] < 0), (1, True)) for h in expression.diff(x).atoms(sympy.Heaviside)}
    slope = expression.diff(x).xreplace(steps)
    limits: tuple = ()
    if closure.rebound:
        limits = (
            Let("e", expression),
            When(("e", "<=", 0.0), 0.0),  # also where exp has underflowed, and St^2 with it
            When(("e", ">", _dry(closure, constants)), 0.0),
        )
    body = (*_guards(closure), *constants, *limits, Give(slope))
    return Function(f"{closure.name}_slope", closure.variables, f"d/d{x} of {closure.name}", body)


def _dry(closure: Closure, constants: list[Let]) -> str:
    """The name of the dry restitution: a variable, or a constant of the fit."""
    if "e_dry" in closure.variables:
        return "e_dry"
    return next(let.name for let, c in zip(constants, closure.constants, strict=True) if c.name == "e_dry")


def _in_range(closure: Closure) -> Function:
    x, (low, high) = closure.variables[0], closure.validity
    inside: list[Comparison] = [(x, ">=", low)] if low > 0 else [(x, ">", 0.0)]
    if high < np.inf:
        inside.append((x, "<=", high))
    source = f" ({closure.validity_source})" if closure.validity_source else ""
    says = f"1 where {closure.name} is valid: {low:.6g} <= {x} <= {high:.6g}{source}; else 0"
    return Function(f"{closure.name}_in_range", (x,), says, (Unless(tuple(inside), 0.0), Give("1")), flag=True)


_IMPACT = ("v", "d", "rho_p", "rho_f", "mu")


def _stokes(closure: Closure) -> list[Function]:
    name, definition = f"{closure.name}_stokes", convention(closure.convention).definition
    expression = wall_stokes(closure.convention)
    arguments = arguments_of_stokes(closure.convention)
    wall = Function(
        name,
        arguments,
        f"Stokes number of a sphere at a wall, {definition}: v m/s, d m, rho kg/m3, mu Pa s",
        (Give(expression),),
    )
    fluid = tuple(a for a in arguments if a in ("rho_f", "mu"))
    calls = [f"{name}(v, d_{i}, rho_{i}, {', '.join(fluid)})*d_{i}*d_{i}" for i in (1, 2)]
    pair = Function(
        f"{name}_pair",
        ("v", "d_1", "rho_1", "d_2", "rho_2", *fluid),
        "of two spheres: reduced mass over reduced radius squared; v relative, along the line of centres",
        (
            Let("s_1", calls[0]),
            Let("s_2", calls[1]),
            Let("reach", "(d_1 + d_2)/(d_1*d_2)"),
            Give("s_1*s_2/(s_1 + s_2)*reach*reach"),
        ),
    )
    return [wall, pair]


def arguments_of_stokes(key: str) -> tuple[str, ...]:
    """The names that a Stokes number is a function of, in the order of the functions' arguments."""
    used = {s.name for s in wall_stokes(key).free_symbols}
    return tuple(a for a in _IMPACT if a in used)


@cache
def wall_stokes(key: str) -> Any:
    """The Stokes number of an impact at a wall in symbols, by the definition that this package computes with."""
    import sympy

    v, d, rho_p, rho_f, mu = sympy.symbols(_IMPACT, positive=True)
    sphere = SimpleNamespace(density=rho_p, diameter=d, radius=d / 2, mass=rho_p * np.pi * d**3 / 6)
    fluid = SimpleNamespace(density=rho_f, viscosity=mu)
    per_speed = convention(key).per_speed(SimpleNamespace(sphere=sphere, fluid=fluid, partner=None))
    # Fractions such as 1/9 come back from the numbers, pi being cancelled to rounding.
    exact = sympy.nsimplify(sympy.expand(per_speed), rational=True, tolerance=1e-12)
    return sympy.factor(v * exact)
