"""Closure laws, one small record each; importing this package fills the registry.

``get(name, **parameters)`` gives a law, ``names(family)`` lists them. Read :mod:`~restitution.laws.base` (what a
law is), :mod:`~restitution.laws.rebound` and :mod:`~restitution.laws.resistance` (the two large families), then
any law; :mod:`~restitution.laws.formula` and :mod:`~restitution.laws.registry` serve them.
"""

from __future__ import annotations

import importlib
import pkgutil

from restitution.laws.base import REGISTRY, CheckValue, Law, Status, parameter
from restitution.laws.rebound import ReboundLaw
from restitution.laws.registry import get, get_rebound, names
from restitution.laws.resistance import ResistanceLaw

__all__ = [
    "REGISTRY",
    "CheckValue",
    "Law",
    "ReboundLaw",
    "ResistanceLaw",
    "Status",
    "get",
    "get_rebound",
    "names",
    "parameter",
]

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
