"""A law of the user's own as a formula: parsed against a whitelist, evaluated here, never run as Python.

The grammar: numbers, names, + - * / **, unary signs, and the functions exp, log, sqrt, tanh, sin, cos, atan, erf,
gamma, abs, min, max. ``St``
and ``e_dry`` are what the law is of; every other name is a parameter. Python's parser makes the tree, each node of
which must be of a known kind; everything else is refused with its place in the text. The tree is evaluated with
value and slope in St together, so that the slope is exact (forward differentiation).
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import digamma, erf, gamma

from restitution.calibration.estimation.parameters import Parameter, scale_of
from restitution.errors import Defect, InputError
from restitution.stokes import Speed, convention

LONGEST = 500
"""Characters of a formula."""
DEEPEST = 30
"""Brackets and operations within one another."""
MOST_NODES = 200
"""Numbers, names and operations."""
LARGEST_EXPONENT = 50.0
"""Beyond it a power of St leaves the range of numbers."""
_TWO_OVER_ROOT_PI = 2 / math.sqrt(math.pi)
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,29}")
Pair = tuple[Any, Any]
"""A value and its slope in St."""
Node = Callable[[Mapping[str, Pair]], Pair]


@dataclass(frozen=True)
class FormulaModel:
    """E_eff by a formula, a :class:`~.rebound_model.ReboundModel`. Its parameters need bounds."""

    text: str
    convention: str
    parameters: tuple[Parameter, ...]
    evaluate: Node
    speed: Speed = Speed.UNSTATED
    chosen: frozenset[str] = frozenset()

    @property
    def name(self) -> str:
        return self.text

    @property
    def title(self) -> str:
        return "formula of the user's own"

    @classmethod
    def parse(cls, text: str, bounds: Mapping[str, tuple[float, float]], stokes: str = "st") -> FormulaModel:
        """The model of a formula; raises :class:`InputError` for anything outside the grammar."""
        convention(stokes)
        evaluate, names = parse(text)
        if "St" not in names:
            raise InputError(Defect("does not contain St, the Stokes number", field="formula", value=text))
        unknown = [n for n in names if n not in ("St", "e_dry") and n not in bounds]
        if unknown:
            options = " ".join(f"--bounds {n}=LOW:HIGH" for n in unknown)
            rule = f"its parameter{'s' * (len(unknown) > 1)} {', '.join(unknown)} must have bounds: {options}"
            raise InputError(Defect(rule, field="formula", value=text))
        parameters = tuple(
            Parameter(n, _middle(bounds[n]), bounds[n], "1", scale_of(bounds[n]))
            for n in names
            if n not in ("St", "e_dry")
        )
        return cls(text, stokes, parameters, evaluate)

    def __call__(self, St: NDArray, e_dry: Any, values: Mapping[str, Any]) -> tuple[NDArray, NDArray]:
        """The value and its exact slope in St; NaN or infinite where the formula has no value."""
        given = {name: (np.asarray(v, float), 0.0) for name, v in values.items()}
        given |= {"St": (St, 1.0), "e_dry": (np.asarray(e_dry, float), 0.0)}
        with np.errstate(all="ignore"):
            value, slope = self.evaluate(given)
        return np.broadcast_to(value, St.shape), np.broadcast_to(slope, St.shape)


def _middle(bounds: tuple[float, float]) -> float:
    low, high = bounds
    return math.sqrt(low * high) if scale_of(bounds) == "log" else 0.5 * (low + high)


def parse(text: str) -> tuple[Node, list[str]]:
    """The evaluator of a formula and the names in it, in order of appearance."""
    if len(text) > LONGEST:
        raise InputError(Defect(f"is longer than {LONGEST} characters", field="formula", value=text[:40] + "..."))
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        where = f" at character {error.offset}" if isinstance(error, SyntaxError) and error.offset else ""
        raise InputError(Defect(f"is not a formula{where}", field="formula", value=text)) from None
    reader = _Reader(text)
    evaluate = reader.node(tree.body, 0)
    return evaluate, list(reader.names)


class _Reader:
    """Turns a tree into nested functions; knows the nodes of the grammar and refuses all others."""

    def __init__(self, text: str):
        self.text, self.names, self.count = text, dict[str, None](), 0

    def refuse(self, node: ast.AST, rule: str) -> InputError:
        part = ast.get_source_segment(self.text.strip(), node) if hasattr(node, "lineno") else None
        return InputError(Defect(rule, field="formula", value=part[:60] if part else self.text[:60]))

    def node(self, node: ast.AST, depth: int) -> Node:
        self.count += 1
        if depth > DEEPEST:
            raise self.refuse(node, f"is nested deeper than {DEEPEST} levels")
        if self.count > MOST_NODES:
            raise self.refuse(node, f"has more than {MOST_NODES} parts")
        match node:
            case ast.Constant(value=value) if type(value) in (int, float):
                return self.number(node, value)
            case ast.Name(id=name):
                return self.name(node, name)
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=inner):
                inside = self.node(inner, depth + 1)
                return inside if isinstance(sign, ast.UAdd) else lambda known: _negative(inside(known))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                a, b = self.node(left, depth + 1), self.node(right, depth + 1)
                if isinstance(op, ast.Pow):
                    self.exponent(right)
                combine = _BINARY[type(op)]
                return lambda known: combine(a(known), b(known))
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in _FUNCTIONS:
                least, most, function = _FUNCTIONS[name]
                if not least <= len(arguments) <= most:
                    raise self.refuse(
                        node, f"{name} takes {least}{f' to {most}' if most > least else ''} arguments"
                    )
                parts = [self.node(argument, depth + 1) for argument in arguments]
                return lambda known: function(*(part(known) for part in parts))
        allowed = f"numbers, names, + - * / **, {', '.join(_FUNCTIONS)}"
        raise self.refuse(node, f"is not part of the grammar of a formula: {allowed}")

    def number(self, node: ast.AST, value: float) -> Node:
        if isinstance(value, int) and abs(value) > 10**15:
            raise self.refuse(node, "is too large a number; write it with a decimal point")
        if not math.isfinite(value):
            raise self.refuse(node, "is not a finite number")
        constant = (float(value), 0.0)
        return lambda known: constant

    def name(self, node: ast.AST, name: str) -> Node:
        if not _NAME.fullmatch(name) or "__" in name:
            raise self.refuse(node, "is not a name for a parameter: a letter, then letters, digits, single _")
        if name in _FUNCTIONS:
            raise self.refuse(node, "is a function: it needs its argument in brackets")
        self.names[name] = None
        return lambda known: known[name]

    def exponent(self, node: ast.AST) -> None:
        """Refuse an exponent that is a huge number, also where it is written as a computation."""
        try:
            size = max(abs(float(x.value)) for x in ast.walk(node) if isinstance(x, ast.Constant))
        except ValueError:
            return  # made of names alone
        towers = any(isinstance(x, ast.BinOp) and isinstance(x.op, ast.Pow) for x in ast.walk(node))
        if size > LARGEST_EXPONENT or towers:
            raise self.refuse(node, f"is too large an exponent: at most {LARGEST_EXPONENT:g}, and no powers in it")


def _negative(a: Pair) -> Pair:
    return -a[0], -a[1]


def _divide(a: Pair, b: Pair) -> Pair:
    value = np.divide(a[0], b[0])
    return value, np.divide(a[1] - value * b[1], b[0])


def _power(a: Pair, b: Pair) -> Pair:
    value = np.power(np.asarray(a[0], float), b[0])
    slope = b[0] * np.power(np.asarray(a[0], float), np.asarray(b[0], float) - 1) * a[1]
    if np.any(b[1]):
        slope = slope + value * np.log(a[0]) * b[1]
    return value, slope


def _choose(which: Callable, *pairs: Pair) -> Pair:
    value, slope = pairs[0]
    for other, other_slope in pairs[1:]:
        keep = which(value, other)
        value, slope = np.where(keep, value, other), np.where(keep, slope, other_slope)
    return value, slope


def _through(function: Callable, derivative: Callable) -> Callable[[Pair], Pair]:
    def apply(a: Pair) -> Pair:
        value = function(a[0])
        return value, derivative(a[0], value) * a[1]

    return apply


def symbolic(text: str, symbols: Mapping[str, Any]) -> Any:
    """A formula that has passed the grammar, or that of a law, as a sympy expression in ``symbols``.

    Raises :class:`InputError` for one with a part that is infinite or undefined whatever the symbols are.
    """
    import sympy

    # Every name in it is bound here: none means a sympy object.
    known = {name: getattr(sympy, own) for name, own in SYMPY.items()}
    try:
        expression = sympy.sympify(text, locals=known | dict(symbols))
        finite = not expression.has(sympy.zoo, sympy.nan, sympy.oo, -sympy.oo)
    except (ValueError, TypeError):  # of what is compared with such a part
        finite = False
    if not finite:
        rule = "has a part that is infinite or undefined for all St, such as a division by zero"
        raise InputError(Defect(rule, field="formula", value=text))
    return expression


SYMPY = {
    "exp": "exp", "log": "log", "sqrt": "sqrt", "tanh": "tanh", "sin": "sin", "cos": "cos", "atan": "atan",
    "erf": "erf", "gamma": "gamma", "abs": "Abs", "min": "Min", "max": "Max",
}  # fmt: skip
"""Names of the functions of a formula as sympy knows them."""
_BINARY: dict[type, Callable[[Pair, Pair], Pair]] = {
    ast.Add: lambda a, b: (a[0] + b[0], a[1] + b[1]),
    ast.Sub: lambda a, b: (a[0] - b[0], a[1] - b[1]),
    ast.Mult: lambda a, b: (a[0] * b[0], a[1] * b[0] + a[0] * b[1]),
    ast.Div: _divide,
    ast.Pow: _power,
}
_FUNCTIONS: dict[str, tuple[int, int, Callable[..., Pair]]] = {
    "exp": (1, 1, _through(np.exp, lambda x, y: y)),
    "log": (1, 1, _through(np.log, lambda x, y: np.divide(1.0, x))),
    "sqrt": (1, 1, _through(np.sqrt, lambda x, y: np.divide(0.5, y))),
    "tanh": (1, 1, _through(np.tanh, lambda x, y: 1 - y**2)),
    "sin": (1, 1, _through(np.sin, lambda x, y: np.cos(x))),
    "cos": (1, 1, _through(np.cos, lambda x, y: -np.sin(x))),
    "atan": (1, 1, _through(np.arctan, lambda x, y: 1 / (1 + np.square(x)))),
    "erf": (1, 1, _through(erf, lambda x, y: _TWO_OVER_ROOT_PI * np.exp(-np.square(x)))),
    "gamma": (1, 1, _through(gamma, lambda x, y: y * digamma(x))),
    "abs": (1, 1, _through(np.abs, lambda x, y: np.sign(x))),
    "min": (2, 5, lambda *pairs: _choose(np.less_equal, *pairs)),
    "max": (2, 5, lambda *pairs: _choose(np.greater_equal, *pairs)),
}
