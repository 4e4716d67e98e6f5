"""C99, which is valid C++: one header of inline functions."""

from __future__ import annotations

from typing import Any

from restitution.export.languages.language import Language, Source, one_line
from restitution.export.self_check import TOLERANCE


def _number(x: float | str) -> str:
    return "NAN" if x == "nan" else repr(float(x))


def _expression(expression: Any) -> str:
    from sympy.printing.c import C99CodePrinter

    # Without the macros for constants such as ln 10: strict C99 does not have them.
    return one_line(C99CodePrinter({"precision": 17, "math_macros": {}}).doprint(expression))


def _file(language: Language, source: Source) -> str:
    name, upper, table = source.name, source.name.upper(), source.table
    text = "#include <math.h>\n"
    if not source.part:
        check = f"{language.comment} Not with -ffast-math or -Ofast, which take it that there is no NaN\n"
        check += f"{language.comment} Self-check: cc -std=c99 -D{upper}_MAIN -x c {name}.h -lm && ./a.out\n"
        guard = f"\n#ifndef {upper}_H\n#define {upper}_H\n\n"
        text = language.comments(source.heading) + check + guard + text
    for f in source.functions:
        kind, arguments = ("int" if f.flag else "double"), ", ".join(f"double {a}" for a in f.arguments)
        text += f"\n/* {f.says} */\nstatic inline {kind} {f.name}({arguments})\n{{\n{language.body(f)}}}\n"
    n, width = len(table.rows), len(table.rows[0])
    checked = [(name, "values")] + [(f"{name}_slope", "slopes")] * source.derivative
    text += "\n/* The number of wrong values; 0 where the file is as it was written. */\n"
    text += f"static inline int {name}_self_check(void)\n{{\n"
    text += f"    static const double inputs[{n}][{width}] = {{\n"
    text += "".join(f"        {row},\n" for row in language.rows(table, "{", "}", ", ")) + "    };\n"
    for _, what in checked:
        values = ",\n".join(f"        {_number(x)}" for x in getattr(table, what))
        text += f"    static const double {what}[{n}] = {{\n{values}\n    }};\n"
    text += f"    int i, wrong = 0;\n    for (i = 0; i < {n}; i++) {{\n"
    for function, what in checked:
        call = ", ".join(f"inputs[i][{j}]" for j in range(width))
        text += (
            f"        if (!(fabs({function}({call}) - {what}[i]) <= {TOLERANCE!r} * fabs({what}[i]))) wrong++;\n"
        )
    text += "    }\n    return wrong;\n}\n"
    if source.part:
        return text
    text += (
        f"\n#ifdef {upper}_MAIN\n#include <stdio.h>\nint main(void)\n{{\n    int wrong = {name}_self_check();\n"
    )
    text += f'    printf("{name}: %d wrong\\n", wrong);\n    return wrong != 0;\n}}\n#endif\n\n#endif\n'
    return text


C = Language(
    key="c",
    title="C99, C++",
    version="C99; tried with gcc 12",
    suffix=".h",
    comment="//",
    conjunction=" && ",
    negation="!({})",
    number=_number,
    expression=_expression,
    let=lambda name, value: f"const double {name} = {value};",
    end=lambda condition, value: (f"if ({condition}) return {value};",),
    give=lambda value: f"return {value};",
    lacks=("polygamma",),
    file=_file,
)
