"""The languages that a law is exported to as functions, one module each: :mod:`.c`, :mod:`.fortran`,
:mod:`.python`, :mod:`.julia`, :mod:`.javascript`, :mod:`.octave`; :mod:`.language` is what they share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from restitution.errors import Defect, InputError
from restitution.export.closure import Closure
from restitution.export.functions import functions_of
from restitution.export.heading import heading
from restitution.export.languages.c import C
from restitution.export.languages.fortran import FORTRAN
from restitution.export.languages.javascript import JAVASCRIPT
from restitution.export.languages.julia import JULIA
from restitution.export.languages.language import Language, Source
from restitution.export.languages.octave import OCTAVE
from restitution.export.languages.python import PYTHON
from restitution.export.self_check import check_table

__all__ = ["LANGUAGES", "Language", "part_of_a_file", "source_code"]

LANGUAGES: dict[str, Language] = {
    language.key: language for language in (C, FORTRAN, PYTHON, JULIA, JAVASCRIPT, OCTAVE)
}


def source_code(closure: Closure, key: str, derivative: bool = False) -> str:
    """The text of a file of source code; raises :class:`InputError` for a law without a closed formula."""
    language = LANGUAGES[key]
    lines = heading(closure, language.title, language.version)
    return language.file(language, _source(closure, language, lines, derivative))


def part_of_a_file(closure: Closure, key: str) -> str:
    """The functions and their self-check without heading, in C or Python, to stand in a longer file."""
    language = LANGUAGES[key]
    return language.file(language, replace(_source(closure, language, (), False), part=True))


def _source(closure: Closure, language: Language, lines: Sequence[str], derivative: bool) -> Source:
    _check_known(closure, language, derivative)
    functions = functions_of(closure, derivative)
    return Source(closure.name, lines, functions, check_table(closure), derivative)


def _check_known(closure: Closure, language: Language, derivative: bool) -> None:
    """Raise :class:`InputError` for a formula with a function that the language has not."""
    import sympy

    parts = [closure.expression]
    if derivative:
        parts.append(closure.expression.diff(sympy.Symbol(closure.variables[0], positive=True)))
    used = {type(f).__name__ for part in parts for f in part.atoms(sympy.Function)}
    if unknown := sorted(used & set(language.lacks)):
        able = [o.key for o in LANGUAGES.values() if not used & set(o.lacks)]
        rule = f"has no {', '.join(unknown)}, which the formula{' or its slope' * derivative} needs"
        where = f"; {', '.join(able)} do" if able else " (without the slope it may go)"
        raise InputError(Defect(rule + where, field="--to", value=language.key))
