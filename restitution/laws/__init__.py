"""Closure laws, one small record each; importing this package fills the registry.

``get(name, **parameters)`` gives a law, ``names(family)`` lists them.
"""

from __future__ import annotations

import importlib
import pkgutil

from restitution.laws.base import REGISTRY, CheckValue, Law, Status, get, parameter
from restitution.laws.rebound import ReboundLaw
from restitution.laws.resistance import ResistanceLaw

__all__ = [
    "REGISTRY",
    "CheckValue",
    "Law",
    "ReboundLaw",
    "ResistanceLaw",
    "Status",
    "get",
    "names",
    "parameter",
]

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")


def names(family: str | None = None) -> list[str]:
    """Names of the laws of one family (``rebound``, ``resistance``, ...) or of all, in the order of modules."""
    return [name for name, law in REGISTRY.items() if family in (None, law.family)]
