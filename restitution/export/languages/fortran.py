"""Fortran 2008: one module."""

from __future__ import annotations

from typing import Any

from restitution.export.functions import Function, Let
from restitution.export.languages.language import Language, Source
from restitution.export.self_check import TOLERANCE


def _number(x: float | str) -> str:
    if x == "nan":
        return "ieee_value(0d0, ieee_quiet_nan)"
    mantissa, _, exponent = repr(float(x)).partition("e")
    return f"{mantissa}d{exponent or '0'}"


def _expression(expression: Any) -> str:
    from sympy import Max, Min, Piecewise
    from sympy.printing.fortran import FCodePrinter

    # Alternatives must be of one kind in Fortran: no integer beside a real.
    expression = expression.replace(
        lambda x: isinstance(x, Max | Min), lambda x: x.func(*map(_real, x.args), evaluate=False)
    ).replace(
        lambda x: isinstance(x, Piecewise),
        lambda x: Piecewise(*((_real(value), condition) for value, condition in x.args), evaluate=False),
    )
    printer = FCodePrinter({"source_format": "free", "standard": 2008, "precision": 17})
    return " &\n    ".join(line.strip().rstrip("&").rstrip() for line in printer.doprint(expression).splitlines())


def _real(x: Any) -> Any:
    from sympy import Float

    return Float(x.p / x.q, 17) if x.is_Rational else x


def _function(language: Language, f: Function) -> str:
    kind = "integer" if f.flag else "real(dp)"
    local = [step.name for step in f.body if isinstance(step, Let)]
    text = f"  ! {f.says}\n  pure function {f.name}({', '.join(f.arguments)}) result(y)\n"
    text += f"    real(dp), intent(in) :: {', '.join(f.arguments)}\n    {kind} :: y\n"
    text += f"    real(dp) :: {', '.join(local)}\n" if local else ""
    return text + language.body(f) + f"  end function {f.name}\n"


def _vector(values: tuple[float, ...]) -> str:
    return ", &\n      ".join(map(_number, values))


def _file(language: Language, source: Source) -> str:
    name, table = source.name, source.table
    n, width = len(table.rows), len(table.rows[0])
    checked = [(name, "values")] + [(f"{name}_slope", "slopes")] * source.derivative
    text = language.comments(source.heading)
    text += "! Not with -ffast-math or -Ofast, which take it that there is no NaN\n"
    text += (
        f"! Self-check: echo 'use {name}_module; print *, {name}_self_check(), \"wrong\"; end' > check.f90 &&\n"
    )
    text += f"!     gfortran {name}.f90 check.f90 && ./a.out\n"
    text += f"\nmodule {name}_module\n  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan\n"
    text += "  implicit none\n  private\n  integer, parameter :: dp = kind(1d0)\n"
    public = [f.name for f in source.functions] + [f"{name}_self_check"]
    text += "".join(f"  public :: {p}\n" for p in public) + "\ncontains\n"
    text += "".join("\n" + _function(language, f) for f in source.functions)
    text += "\n  ! The number of wrong values; 0 where the file is as it was written.\n"
    text += f"  function {name}_self_check() result(wrong)\n    integer :: wrong, i\n"
    text += f"    real(dp) :: inputs({width}, {n}), {', '.join(f'{what}({n})' for _, what in checked)}\n"
    flat = ", &\n      ".join(language.rows(table, "", "", ", "))
    text += f"    inputs = reshape([ &\n      {flat}], [{width}, {n}])\n"
    for _, what in checked:
        text += f"    {what} = [ &\n      {_vector(getattr(table, what))}]\n"
    text += f"    wrong = 0\n    do i = 1, {n}\n"
    for function, what in checked:
        call = ", ".join(f"inputs({j + 1}, i)" for j in range(width))
        text += f"      if (.not. abs({function}({call}) &\n"
        text += f"          - {what}(i)) <= {_number(TOLERANCE)}*abs({what}(i))) &\n"
        text += "        wrong = wrong + 1\n"
    return text + f"    end do\n  end function {name}_self_check\n\nend module {name}_module\n"


FORTRAN = Language(
    key="fortran",
    title="Fortran",
    version="Fortran 2008; tried with gfortran 12",
    suffix=".f90",
    comment="!",
    conjunction=" .and. ",
    negation=".not. ({})",
    number=_number,
    expression=_expression,
    let=lambda name, value: f"{name} = {value}",
    end=lambda condition, value: (f"if ({condition}) then", f"  y = {value}", "  return", "end if"),
    give=lambda value: f"y = {value}",
    lacks=("polygamma",),
    file=_file,
)
