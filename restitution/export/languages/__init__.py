"""The languages that a law is exported to as functions, one module each: :mod:`.c`, :mod:`.fortran`,
:mod:`.python`, :mod:`.julia`, :mod:`.javascript`, :mod:`.octave`; :mod:`.language` is what they share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

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
    return language.file(language, _source(closure, lines, derivative))


def part_of_a_file(closure: Closure, key: str) -> str:
    """The functions and their self-check without heading, in C or Python, to stand in a longer file."""
    language = LANGUAGES[key]
    return language.file(language, replace(_source(closure, (), False), part=True))


def _source(closure: Closure, lines: Sequence[str], derivative: bool) -> Source:
    functions = functions_of(closure, derivative)
    return Source(closure.name, lines, functions, check_table(closure), derivative)
