"""Into the users' codes: a law or a fit as functions, tables, or input of a DEM code, and what that delivers.

:mod:`.closure` is what is exported, a law of the registry or, by :mod:`.fitted`, a fit; :mod:`.heading` the words
that go with it, :mod:`.self_check` the table that a file checks itself by. :mod:`.functions` says which functions
a file gets, :mod:`.languages` writes them; :mod:`.tables` writes CSV and JSON. With fluid and sphere a closure
becomes :mod:`.impacts` of one pair, which :mod:`.dem` and :mod:`.solvers` need; :mod:`.drops` measures what
programs deliver of it; :mod:`.dashpot` inverts spring-dashpot contacts.
:mod:`.targets` has them all by name.

    export("eq4_exponential", "c")                          source code, as text
    dashpot(0.5, mass=1e-4, stiffness=1e4, end="force")     the contact of a code that cuts the tension
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from restitution.export.closure import Closure, law_closure
from restitution.export.dashpot import Dashpot, dashpot
from restitution.export.dem import Request
from restitution.export.fitted import fit_closure
from restitution.export.solvers import FilmRequest
from restitution.export.targets import TARGETS, Options, target

__all__ = [
    "TARGETS",
    "Closure",
    "Dashpot",
    "FilmRequest",
    "Options",
    "Request",
    "closure_of",
    "dashpot",
    "export",
    "fit_closure",
    "law_closure",
]


def closure_of(
    law_or_fit: str | Path, parameters: Mapping[str, float] | None = None, levels: Mapping[str, str] | None = None
) -> Closure:
    """A law of the registry at parameters, or the fit in a JSON file."""
    from restitution import laws
    from restitution.errors import InputError

    if str(law_or_fit) not in laws.REGISTRY and Path(law_or_fit).suffix.lower() == ".json":
        if parameters:
            raise InputError("a fit has its parameters: only a law takes NAME=NUMBER")
        return fit_closure(law_or_fit, levels=levels)
    if levels:
        raise InputError("a law has no separate parameters: only a fit takes --of COLUMN=NAME")
    return law_closure(laws.get(str(law_or_fit), **(parameters or {})))


def export(law_or_fit: str | Path, to: str, options: Options | None = None, **parameters: float) -> str:
    """The text of an exported file.

    Parameters
    ----------
    law_or_fit : name of a law, or path of a fit's JSON file.
    to : one of :data:`TARGETS`.
    options : what the target needs beside it.
    parameters : of a law, other than the defaults.

    Raises
    ------
    InputError : for an unknown law or target, a target that lacks something, a law that it cannot take.
    """
    wanted = target(to)
    return wanted.text(closure_of(law_or_fit, parameters), options or Options())
