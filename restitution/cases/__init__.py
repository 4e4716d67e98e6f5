"""What is to be run: a sphere, a fluid, a release and the numerics, in one TOML file.

Read :mod:`~restitution.cases.case` (what may be said), :mod:`~restitution.cases.rules` (what cannot be run),
:mod:`~restitution.cases.reading` (files, and those in ``shipped/``), :mod:`~restitution.cases.numbers` (Re, St).
"""

from restitution.cases.case import Case, ContactModel, FilmModel, Numerics, Release, Span, Study
from restitution.cases.reading import TEMPLATE, find, names, read_case

__all__ = [
    "TEMPLATE",
    "Case",
    "ContactModel",
    "FilmModel",
    "Numerics",
    "Release",
    "Span",
    "Study",
    "find",
    "names",
    "read_case",
]
