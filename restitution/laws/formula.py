"""The formula of a law, the text of one expression: parsed by sympy, compiled to value and slope, its LaTeX names.

Sympy is imported when a formula is first needed, not when a law is named.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Any

_GREEK = {
    "beta": r"\beta",
    "eps": r"\varepsilon",
    "eta": r"\eta",
    "kappa": r"\kappa",
    "mu": r"\mu",
    "rho": r"\rho",
    "sigma": r"\sigma",
    "tau": r"\tau",
}


@cache
def parse(formula: str, symbols: tuple[str, ...]) -> Any:
    """The formula as a sympy expression, all ``symbols`` positive."""
    import sympy

    # Formulas are constants of this package; every name in them is bound here, so none means a sympy object.
    return sympy.sympify(formula, locals={s: sympy.Symbol(s, positive=True) for s in symbols})


@cache
def compiled_formula(formula: str, symbols: tuple[str, ...], wrt: str | None) -> Any:
    """The formula, or its derivative to one symbol, as a function of arrays in the order of ``symbols``."""
    import sympy

    positive = [sympy.Symbol(s, positive=True) for s in symbols]
    expression = parse(formula, symbols)
    if wrt is not None:
        expression = expression.diff(sympy.Symbol(wrt, positive=True))
    return sympy.lambdify(positive, expression, modules="numpy", cse=True)


def latex_name(symbol: str) -> str:
    r"""``h_min`` -> ``h_{\mathrm{min}}``, ``h0`` -> ``h_{0}``, ``beta`` -> ``\beta``."""
    letters, digits, word = re.fullmatch(r"([A-Za-z]+)(\d*)_?(.*)", symbol).groups()
    below = digits + (rf"\mathrm{{{word}}}" if len(word) > 1 else word)
    return _GREEK.get(letters, letters) + (f"_{{{below}}}" if below else "")
