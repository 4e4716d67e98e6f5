"""MATLAB and Octave: a function file, which gives its functions as handles in a structure."""

from __future__ import annotations

from typing import Any

from restitution.export.languages.language import Language, Source
from restitution.export.self_check import TOLERANCE

PICK = "one_of"
"""A function of the file: its second or third argument, as the first is true or not."""


def _number(x: float | str) -> str:
    return "NaN" if x == "nan" else repr(float(x))


def _expression(expression: Any) -> str:
    from sympy import true
    from sympy.printing.octave import OctaveCodePrinter

    class Printer(OctaveCodePrinter):
        """Of alternatives one, not a sum of products with 0 and 1: of infinite ones that sum is NaN."""

        def _print_Piecewise(self, expr: Any) -> str:
            value, condition = expr.args[-1]
            text = (
                self._print(value)
                if condition == true
                else f"{PICK}({self._print(condition)}, {self._print(value)}, NaN)"
            )
            for value, condition in reversed(expr.args[:-1]):
                text = f"{PICK}({self._print(condition)}, {self._print(value)}, {text})"
            return text

    return Printer({"precision": 17}).doprint(expression)


def _file(language: Language, source: Source) -> str:
    name, table = source.name, source.table
    # A function file's own name is taken by the function that hands out the handles.
    inside = {f.name: f"{name}_value" if f.name == name else f.name for f in source.functions}
    text = f"function law = {name}()\n" + language.comments(source.heading)
    text += f"% Use: law = {name}(); law.value(...). Of numbers; of arrays: arrayfun(law.value, ...)\n"
    text += "% Self-check: law.self_check() gives 0\n"
    for own in inside.values():
        text += f"  law.{own.removeprefix(f'{name}_')} = @{own};\n"
    text += f"  law.self_check = @{name}_self_check;\nend\n"
    for f in source.functions:
        text += f"\n% {f.says}\nfunction y = {inside[f.name]}({', '.join(f.arguments)})\n"
        # A condition of an array is true where all of it is: limits would be passed over.
        one = " && ".join(f"isscalar({a})" for a in f.arguments)
        text += (
            f"    if ~({one})\n      error('{inside[f.name]}: takes numbers; of arrays use arrayfun')\n    end\n"
        )
        text += f"{language.body(f)}end\n"
    if f"{PICK}(" in text:
        text += f"\nfunction y = {PICK}(first, a, b)\n    y = b;\n    if first\n      y = a;\n    end\nend\n"
    text += "\n% The number of wrong values; 0 where the file is as it was written.\n"
    text += f"function wrong = {name}_self_check()\n  inputs = [ ...\n"
    text += "".join(f"    {row}; ...\n" for row in language.rows(table, "", "", ", ")) + "  ];\n"
    checked = [(f"{name}_value", "values")] + [(f"{name}_slope", "slopes")] * source.derivative
    for _, what in checked:
        text += (
            f"  {what} = [ ...\n" + "".join(f"    {_number(x)}; ...\n" for x in getattr(table, what)) + "  ];\n"
        )
    text += "  wrong = 0;\n  for i = 1:size(inputs, 1)\n"
    for function, what in checked:
        call = ", ".join(f"inputs(i, {j + 1})" for j in range(len(table.rows[0])))
        difference = f"abs({function}({call}) - {what}(i))"
        text += f"    wrong = wrong + ~({difference} <= {TOLERANCE!r} * abs({what}(i)));\n"
    return text + "  end\nend\n"


OCTAVE = Language(
    key="octave",
    title="MATLAB, Octave",
    version="MATLAB R2016b, Octave; tried with Octave 7.3",
    suffix=".m",
    comment="%",
    conjunction=" && ",
    negation="~({})",
    number=_number,
    expression=_expression,
    let=lambda name, value: f"{name} = {value};",
    end=lambda condition, value: (f"if {condition}", f"  y = {value};", "  return", "end"),
    give=lambda value: f"y = {value};",
    lacks=("polygamma",),
    file=_file,
)
