"""Julia: one module of functions of numbers."""

from __future__ import annotations

from typing import Any

from restitution.export.languages.language import Language, Source, one_line
from restitution.export.self_check import TOLERANCE


def _number(x: float | str) -> str:
    return "NaN" if x == "nan" else repr(float(x))


def _expression(expression: Any) -> str:
    from sympy.printing.julia import JuliaCodePrinter

    return one_line(JuliaCodePrinter({"precision": 17}).doprint(expression))


def _file(language: Language, source: Source) -> str:
    name, table = source.name, source.table
    checked = [(name, "values")] + [(f"{name}_slope", "slopes")] * source.derivative
    public = ", ".join([*(f.name for f in source.functions), f"{name}_self_check"])
    text = language.comments(source.heading) + f"# Self-check: julia {name}.jl\n"
    text += f"\nmodule {name}_module\n\nexport {public}\n"
    for f in source.functions:
        text += f"\n# {f.says}\nfunction {f.name}({', '.join(f.arguments)})\n{language.body(f)}end\n"
    rows = "".join(f"        {row},\n" for row in language.rows(table, "(", ",)", ", "))
    text += "\n# The number of wrong values; 0 where the file is as it was written.\n"
    text += f"function {name}_self_check()\n    inputs = [\n{rows}    ]\n"
    for _, what in checked:
        values = "".join(f"        {_number(x)},\n" for x in getattr(table, what))
        text += f"    {what} = [\n{values}    ]\n"
    text += "    wrong = 0\n    for i in eachindex(inputs)\n"
    for function, what in checked:
        difference = f"abs({function}(inputs[i]...) - {what}[i])"
        text += f"        wrong += !({difference} <= {TOLERANCE!r} * abs({what}[i]))\n"
    text += "    end\n    return wrong\nend\n\nend\n\nif abspath(PROGRAM_FILE) == @__FILE__\n"
    text += f"    wrong = {name}_module.{name}_self_check()\n"
    return text + f'    println("{name}: ", wrong, " wrong")\n    exit(wrong == 0 ? 0 : 1)\nend\n'


JULIA = Language(
    key="julia",
    title="Julia",
    version="Julia 1; tried with Julia 1.5.3",
    suffix=".jl",
    comment="#",
    conjunction=" && ",
    negation="!({})",
    number=_number,
    expression=_expression,
    let=lambda name, value: f"{name} = {value}",
    end=lambda condition, value: (f"if {condition}", f"    return {value}", "end"),
    give=lambda value: f"return {value}",
    lacks=("erf", "gamma", "polygamma"),
    file=_file,
)
