"""The languages that a law is exported to as functions, one module each: :mod:`.c`, :mod:`.fortran`,
:mod:`.python`, :mod:`.julia`, :mod:`.javascript`, :mod:`.octave`; :mod:`.language` is what they share.
"""

from __future__ import annotations

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

__all__ = ["LANGUAGES", "Language", "source_code"]

LANGUAGES: dict[str, Language] = {
    language.key: language for language in (C, FORTRAN, PYTHON, JULIA, JAVASCRIPT, OCTAVE)
}


def source_code(closure: Closure, key: str, derivative: bool = False) -> str:
    """The text of a file of source code; raises :class:`InputError` for a law without a closed formula."""
    language = LANGUAGES[key]
    functions = functions_of(closure, derivative)
    lines = heading(closure, language.title, language.version)
    return language.file(language, Source(closure.name, lines, functions, check_table(closure), derivative))
