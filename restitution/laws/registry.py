"""The laws by name. They are there once the package :mod:`restitution.laws` has been imported."""

from __future__ import annotations

import difflib

from restitution.errors import InputError
from restitution.laws.base import REGISTRY, Law
from restitution.laws.rebound import ReboundLaw


def get(name: str, **parameters: float) -> Law:
    """A law by its name.

    Parameters
    ----------
    name : one of :func:`names`.
    parameters : values other than the defaults, within each parameter's bounds.

    Returns
    -------
    The law, to be called with its variables; ``reference``, ``status``, ``validity`` and ``checks`` are its
    attributes, ``parameters()`` says what each parameter is and where its default comes from.

    Raises
    ------
    InputError : for an unknown name or parameter, or a value outside its bounds.
    """
    try:
        law = REGISTRY[name]
    except KeyError:
        near = difflib.get_close_matches(name, REGISTRY, n=3)
        hint = f"; did you mean {', '.join(near)}?" if near else "; see 'restitution laws list'"
        raise InputError(f"unknown law {name!r}{hint}") from None
    return law().replace(**parameters)


def get_rebound(name: str, **parameters: float) -> ReboundLaw:
    """:func:`get` where only a rebound law will do; raises :class:`InputError` for a law of another family."""
    law = get(name, **parameters)
    if not isinstance(law, ReboundLaw):
        raise InputError(f"{name} is a {law.family} law; known: {', '.join(names('rebound'))}")
    return law


def names(family: str | None = None) -> list[str]:
    """Names of the laws of one family (``rebound``, ``resistance``, ...) or of all, in the order of modules."""
    return [name for name, law in REGISTRY.items() if family in (None, law.family)]
