"""What all languages share: a function of :mod:`restitution.export.functions` becomes text line by line.

A language says how it writes a number, an expression, a local name, an early end and a whole file; the order of
things is the same in all.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from restitution.export.functions import Comparison, Function, Give, Let, Unless, When
from restitution.export.self_check import CheckTable


@dataclass(frozen=True)
class Source:
    """What a file of source code is made of."""

    name: str
    heading: Sequence[str]
    functions: Sequence[Function]
    table: CheckTable
    derivative: bool
    part: bool = False
    """Whether the text is to stand in a longer file: no heading, no program of its own."""


def one_line(printed: str) -> str:
    """An expression that a printer spread over lines."""
    return " ".join(printed.split())


@dataclass(frozen=True)
class Language:
    """One language. ``conjunction`` and ``negation`` join and turn comparisons, ``file`` makes a file's text."""

    key: str
    title: str
    version: str
    """What the text is written for, and was tried with."""
    suffix: str
    comment: str
    conjunction: str
    negation: str
    number: Callable[[float | str], str]
    expression: Callable[[Any], str]
    let: Callable[[str, str], str]
    end: Callable[[str, str], Sequence[str]]
    """Lines that end the function with a value where a condition holds."""
    give: Callable[[str], str]
    file: Callable[[Language, Source], str]
    lacks: tuple[str, ...] = ()
    """Functions of a formula, as sympy knows them, that it has not without further libraries."""

    def comments(self, lines: Sequence[str]) -> str:
        """Lines as comments."""
        return "".join(f"{self.comment} {line}\n" for line in lines)

    def body(self, function: Function, indent: str = "    ") -> str:
        """The statements of a function."""
        lines: list[str] = []
        for step in function.body:
            match step:
                case Let(name=name, value=value):
                    lines.append(self.let(name, self._text(value)))
                case Unless(comparisons=comparisons, value=value):
                    condition = self.negation.format(self.conjunction.join(map(self._comparison, comparisons)))
                    lines += self.end(condition, self._result(function, value))
                case When(comparison=comparison, value=value):
                    lines += self.end(self._comparison(comparison), self._result(function, value))
                case Give(value=value):
                    lines.append(self.give(self._text(value)))
        return "".join(f"{indent}{line}\n" for line in "\n".join(lines).splitlines())

    def _text(self, value: Any) -> str:
        if isinstance(value, str):
            return value
        return self.number(value) if isinstance(value, float) else self.expression(value)

    def _result(self, function: Function, value: str | float) -> str:
        if function.flag:
            return f"{value:.0f}"
        return value if isinstance(value, str) and value != "nan" else self.number(value)

    def _comparison(self, comparison: Comparison) -> str:
        left, operator, right = comparison
        return f"{left} {operator} {right if isinstance(right, str) else self.number(right)}"

    def rows(self, table: CheckTable, opening: str, closing: str, separator: str) -> list[str]:
        """The arguments of each check, one text a row."""
        return [opening + separator.join(map(self.number, row)) + closing for row in table.rows]
