"""A user's formula: what it gives against sympy, and that nothing outside the grammar passes."""

import numpy as np
import pytest
import sympy

from restitution.calibration.estimation.formula import FormulaModel, parse
from restitution.errors import InputError

St = np.geomspace(5, 500, 7)
VALUES = {"a": 1.7, "b": 0.6, "n": 1.2}
BOUNDS = {"a": (0.1, 10.0), "b": (0.01, 3.0), "n": (0.2, 4.0)}


def value(text):
    evaluate, names = parse(text)
    given = {n: (np.asarray(VALUES.get(n, 0.9)), 0.0) for n in names} | {"St": (St, 1.0)}
    with np.errstate(all="ignore"):
        return evaluate(given)


def random_formula(rng, depth):
    """A random valid formula, all of whose parts are positive and smooth."""
    if depth == 0 or rng.random() < 0.15:
        return str(rng.choice(["St", "a", "b", "n", "e_dry", "2", "0.5", "1e1"]))
    a, b = random_formula(rng, depth - 1), random_formula(rng, depth - 1)
    forms = [
        f"({a} + {b})",
        f"({a} * {b})",
        f"({a} / {b})",
        f"({a})**n",
        f"exp(-{a}/(1 + {b}))",
        f"log(1 + {a})",
        f"sqrt({a})",
        f"tanh({a})",
        f"abs(-({a}))",
        f"min({a}, {b} + 0.1234)",
        f"max({a}, {b} + 0.1234)",
    ]
    return str(rng.choice(forms))


def test_value_and_slope_against_sympy():
    rng = np.random.default_rng(0)
    symbols = {name: sympy.Symbol(name, positive=True) for name in ("St", "a", "b", "n", "e_dry")}
    for _ in range(60):
        text = random_formula(rng, 3)
        theirs = sympy.sympify(text, locals=symbols | {"min": sympy.Min, "max": sympy.Max, "abs": sympy.Abs})
        theirs = theirs.subs({symbols[k]: VALUES.get(k, 0.9) for k in ("a", "b", "n", "e_dry")})
        ours, slope = (np.broadcast_to(x, St.shape) for x in value(text))
        derivative = theirs.diff(symbols["St"])
        for i, x in enumerate(St):
            assert ours[i] == pytest.approx(float(theirs.subs(symbols["St"], x)), rel=1e-9), text
            assert slope[i] == pytest.approx(float(derivative.subs(symbols["St"], x)), rel=1e-7, abs=1e-12), text


REFUSED = {
    "attribute": "St.real",
    "dunder": "__import__",
    "name with two underscores": "a__b*St",
    "call of anything else": "eval(St)",
    "call of an attribute": "os.system(St)",
    "import": "__import__('os').system('true')*St",
    "subscript": "St[0]",
    "lambda": "(lambda: St)()",
    "comprehension": "[St for St in (1, 2)]",
    "text": "'a' * 10**9",
    "boolean": "True * St",
    "complex": "1j * St",
    "comparison": "St < 3",
    "condition": "a if St else b",
    "assignment": "(a := St)",
    "statement": "import os",
    "two statements": "St; a",
    "keyword": "exp(x=St)",
    "starred": "max(*St)",
    "modulo": "St % 3",
    "floor": "St // 3",
    "bits": "St | 1",
    "huge exponent": "St**1000000",
    "tower": "St**9**9**9",
    "huge integer": "St + " + "9" * 40,
    "infinity": "St + 1e999",
    "function as a name": "exp + St",
    "too few arguments": "min(St)",
    "too many arguments": "exp(St, a)",
    "deep": "(" * 60 + "St" + ")" * 60 + "+ exp(" * 40 + "St" + ")" * 40,
    "nested": "exp(" * 40 + "St" + ")" * 40,
    "long": "St" + "+1" * 300,
    "many parts": "St" + "+a" * 120,
    "empty": "",
    "unclosed": "exp(St",
    "nul": "St\0",
    "f-string": "f'{St}'",
    "no St": "a*2",
}


@pytest.mark.parametrize("kind", REFUSED)
def test_outside_the_grammar_is_refused(kind):
    with pytest.raises(InputError, match="formula"):
        FormulaModel.parse(REFUSED[kind], BOUNDS)


def test_fuzz():
    """Random strings of Python's tokens: each is either refused, or is a formula that gives numbers."""
    rng = np.random.default_rng(1)
    good = [*"+-*/(),", "St", "e_dry", "a", "n", "1", "2.5", "**", "exp", "log", "min", "max"]
    bad = (
        ". [ ] { } : = == ' \" lambda if else for in not __class__ import eval exec open getattr os \\ @ % // ~ ;"
    )
    bad = [*bad.split(), "\n", "0x1F", "1_0", "é"]
    accepted = 0
    for i in range(6000):
        tokens = rng.choice(good + (bad if i % 2 else []), rng.integers(1, 9))
        text = ("" if i % 3 else " ").join(tokens)
        try:
            model = FormulaModel.parse(text, BOUNDS)
        except InputError:
            continue
        accepted += 1
        f, slope = model(St, 0.9, {p.name: VALUES[p.name] for p in model.parameters})
        assert f.shape == slope.shape == St.shape
        assert f.dtype == slope.dtype == float
        assert not any(token in text for token in ("__", "import", "eval", "[", ".real", "lambda"))
    assert accepted > 20


def test_parameters_without_bounds_are_asked_for():
    with pytest.raises(InputError, match="--bounds q=LOW:HIGH"):
        FormulaModel.parse("q/St", {})


def test_same_as_the_law_of_the_registry():
    from restitution.calibration import model_of

    own = model_of("e_dry*exp(-K*(1 + e_dry)/St)", {"K": (1.0, 100.0)})
    law = model_of("eq4_exponential")
    for ours, theirs in zip(own(St, 0.97, {"K": 18.0}), law(St, 0.97, {"K": 18.0}), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-13)
