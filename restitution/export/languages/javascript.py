"""JavaScript: one script, for a page as well as for node, there a CommonJS module, which ES modules import too."""

from __future__ import annotations

from typing import Any

from restitution.export.languages.language import Language, Source, one_line
from restitution.export.self_check import TOLERANCE


def _number(x: float | str) -> str:
    return "NaN" if x == "nan" else repr(float(x))


def _expression(expression: Any) -> str:
    from sympy.printing.jscode import JavascriptCodePrinter

    return one_line(JavascriptCodePrinter({"precision": 17}).doprint(expression))


def _file(language: Language, source: Source) -> str:
    name, table = source.name, source.table
    checked = [(name, "values")] + [(f"{name}_slope", "slopes")] * source.derivative
    text = (
        language.comments(source.heading)
        + f'// Self-check: node {name}.js (.cjs in a package of "type": "module")\n"use strict";\n'
    )
    for f in source.functions:
        text += f"\n// {f.says}\nfunction {f.name}({', '.join(f.arguments)}) {{\n{language.body(f)}}}\n"
    rows = "".join(f"        {row},\n" for row in language.rows(table, "[", "]", ", "))
    text += "\n// The number of wrong values; 0 where the file is as it was written.\n"
    text += f"function {name}_self_check() {{\n    const inputs = [\n{rows}    ];\n"
    for _, what in checked:
        values = "".join(f"        {_number(x)},\n" for x in getattr(table, what))
        text += f"    const {what} = [\n{values}    ];\n"
    text += "    let wrong = 0;\n    inputs.forEach((row, i) => {\n"
    for function, what in checked:
        difference = f"Math.abs({function}(...row) - {what}[i])"
        text += f"        if (!({difference} <= {TOLERANCE!r} * Math.abs({what}[i]))) wrong++;\n"
    text += "    });\n    return wrong;\n}\n"
    public = ", ".join([*(f.name for f in source.functions), f"{name}_self_check"])
    text += f'\nif (typeof module === "undefined") {{\n    globalThis.{name}_law = {{ {public} }};\n'
    text += '    if (typeof process === "object" && process.versions && process.versions.node) {\n'
    text += f'        throw new Error("{name} is no ES module: save it as .cjs, import it from there");\n    }}\n'
    text += f"}} else {{\n    module.exports = {{ {public} }};\n"
    text += "    if (require.main === module) {\n"
    text += f"        const wrong = {name}_self_check();\n        console.log(`{name}: ${{wrong}} wrong`);\n"
    return text + "        process.exitCode = wrong ? 1 : 0;\n    }\n}\n"


JAVASCRIPT = Language(
    key="javascript",
    title="JavaScript",
    version="ECMAScript 2015; tried with node",
    suffix=".js",
    comment="//",
    conjunction=" && ",
    negation="!({})",
    number=_number,
    expression=_expression,
    let=lambda name, value: f"const {name} = {value};",
    end=lambda condition, value: (f"if ({condition}) return {value};",),
    give=lambda value: f"return {value};",
    lacks=("erf", "gamma", "polygamma"),
    file=_file,
)
