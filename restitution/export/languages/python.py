"""Python without dependencies: one module of functions of floats."""

from __future__ import annotations

from typing import Any

from restitution.export.languages.language import Language, Source
from restitution.export.self_check import TOLERANCE

_HELPERS = '''

def _exp(x):
    """exp, infinite where it overflows."""
    try:
        return math.exp(x)
    except OverflowError:
        return math.inf


def _power(x, y):
    """x to the y, infinite where it overflows; for positive x."""
    try:
        return x**y
    except OverflowError:
        return math.inf
'''


def _number(x: float | str) -> str:
    return "math.nan" if x == "nan" else repr(float(x))


def _expression(expression: Any) -> str:
    from sympy.printing.pycode import PythonCodePrinter

    class Printer(PythonCodePrinter):
        """Python raises where the other languages give infinity: the printed functions do not."""

        def _print_exp(self, expr: Any) -> str:
            return f"_exp({self._print(expr.args[0])})"

        def _print_Pow(self, expr: Any, rational: bool = False) -> str:
            if expr.exp == -1 or abs(expr.exp) == 0.5:
                return super()._print_Pow(expr, rational=rational)
            return f"_power({self._print(expr.base)}, {self._print(expr.exp)})"

    return Printer({"precision": 17}).doprint(expression)


def _file(language: Language, source: Source) -> str:
    name, table = source.name, source.table
    checked = [(name, "values")] + [(f"{name}_slope", "slopes")] * source.derivative
    text = "" if source.part else language.comments(source.heading) + f"# Self-check: python3 {name}.py\n\n"
    text += f"import math\n{_HELPERS}"
    for f in source.functions:
        text += f'\n\ndef {f.name}({", ".join(f.arguments)}):\n    """{f.says}."""\n{language.body(f)}'
    rows = "".join(f"    {row},\n" for row in language.rows(table, "(", ",)", ", "))
    text += f"\n\n_INPUTS = (\n{rows})\n"
    for _, what in checked:
        values = "".join(f"    {_number(x)},\n" for x in getattr(table, what))
        text += f"_{what.upper()} = (\n{values})\n"
    text += '\n\ndef self_check():\n    """The number of wrong values; 0 where the file is as it was written."""\n'
    text += "    wrong = 0\n"
    for function, what in checked:
        text += f"    for given, expected in zip(_INPUTS, _{what.upper()}):\n"
        text += f"        wrong += not abs({function}(*given) - expected) <= {TOLERANCE!r} * abs(expected)\n"
    text += "    return wrong\n"
    if source.part:
        return text
    text += '\n\nif __name__ == "__main__":\n    wrong = self_check()\n'
    return text + f'    print("{name}:", wrong, "wrong")\n    raise SystemExit(wrong != 0)\n'


PYTHON = Language(
    key="python",
    title="Python",
    version="Python 3 without packages",
    suffix=".py",
    comment="#",
    conjunction=" and ",
    negation="not ({})",
    number=_number,
    expression=_expression,
    let=lambda name, value: f"{name} = {value}",
    end=lambda condition, value: (f"if {condition}:", f"    return {value}"),
    give=lambda value: f"return {value}",
    lacks=("polygamma",),
    file=_file,
)
