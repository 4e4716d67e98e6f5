"""Functions made comparable: what a function gives at fixed arguments stands for the function in a description.

The functions that decide a run, a rebound law or the force of a film, depend on their arguments alone. Two that
agree at some tens of arguments, spread over what a run meets, are taken for one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

_UNDEFINED = (ArithmeticError, LookupError, TypeError, ValueError)
"""What a function may raise at an argument that no run reaches, as a list of measured values past its end."""


def sampled(function: Callable | None, arguments: Iterable[tuple]) -> list | None:
    """The values of ``function`` at each of ``arguments``, in JSON's terms; None without a function."""
    return None if function is None else [_value(function, given) for given in arguments]


def _value(function: Callable, given: tuple) -> float | list | str | None:
    try:
        value = function(*given)
        return None if value is None else _plain(np.asarray(value, dtype=float).tolist())
    except _UNDEFINED as error:
        return type(error).__name__


def _plain(value: float | list) -> float | list | str:
    """Numbers that are not finite as text: NaN would differ from itself."""
    if isinstance(value, list):
        return [_plain(v) for v in value]
    return value if math.isfinite(value) else repr(value)
