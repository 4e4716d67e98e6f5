"""What callers may pass: each function returns the value in its proper type or raises :class:`InputError`."""

from __future__ import annotations

import math
import numbers
import operator
import os
import reprlib
from collections.abc import Iterable
from pathlib import Path

import numba
import numpy as np

from lbm.errors import InputError

SMALLEST = 4
"""Fewest cells along an axis."""
DENSITY_RANGE = (0.5, 2.0)
"""Densities outside it are no longer those of a nearly incompressible flow about rest density 1."""
SPEED_OF_SOUND = 1 / math.sqrt(3)
_CELLS_WORTH_A_THREAD = 16_384  # fewer are done before another thread has woken
_ADDRESSABLE = 2**47  # bytes

_short = reprlib.Repr()
_short.maxstring = _short.maxother = 60


def shown(value) -> str:
    """``repr(value)``, cut where it is long."""
    return " ".join(_short.repr(value).split())


def number(name: str, value) -> float:
    """A finite real number."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise InputError(f"{name} = {shown(value)}: must be a number")
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise InputError(f"{name} = {shown(value)}: must be finite")
    return found


def positive(name: str, value) -> float:
    """A finite number greater than 0."""
    found = number(name, value)
    if found <= 0:
        raise InputError(f"{name} = {found:g}: must be finite and greater than 0")
    return found


def count(name: str, value, least: int = 0) -> int:
    """A whole number, at least ``least``."""
    try:
        found = operator.index(value)
    except TypeError:
        raise InputError(f"{name} = {shown(value)}: must be a whole number, at least {least}") from None
    if found < least:
        raise InputError(f"{name} = {found}: must be at least {least}")
    return found


def array(name: str, value) -> np.ndarray:
    """An array of finite real numbers."""
    try:
        found = np.asarray(value)
        if found.dtype.kind not in "biuf":
            raise TypeError
    except (TypeError, ValueError):
        raise InputError(f"{name} = {shown(value)}: must be made of real numbers, in rows of one length") from None
    found = found.astype(float, copy=False)
    if not np.isfinite(found).all():
        first = tuple(int(i) for i in np.argwhere(~np.isfinite(found))[0])
        raise InputError(f"{name}: not finite" + (f", first at index {first}" if first else ""))
    return found


def vector(name: str, value) -> np.ndarray:
    """Three finite components."""
    found = array(name, value)
    if found.shape != (3,):
        raise InputError(f"{name} = {shown(value)}: give 3 components")
    return found


def several(name: str, value, kind: type) -> list:
    """At least one object of ``kind``, as a list."""
    if not isinstance(value, Iterable) or not (found := list(value)):
        raise InputError(f"{name} = {shown(value)}: give a list of {kind.__name__}, also of one")
    for item in found:
        if not isinstance(item, kind):
            raise InputError(f"{name}: {shown(item)} is no {kind.__name__}")
    return found


def field(name: str, value, uniform: tuple[int, ...], shape: tuple[int, ...]) -> np.ndarray:
    """``value`` as a field of ``shape``; nothing but that shape and the ``uniform`` one is taken for a field."""
    found = array(name, value)
    if found.shape not in (uniform, shape):
        raise InputError(f"{name}: shape {found.shape} given, {uniform} or {shape} needed")
    if found.shape == uniform:
        found = found.reshape(uniform + (1,) * (len(shape) - len(uniform)))
    return np.broadcast_to(found, shape)


def density(name: str, value: np.ndarray) -> None:
    """Refuse densities outside :data:`DENSITY_RANGE`."""
    low, high = DENSITY_RANGE
    if value.min() <= 0:
        raise InputError(f"{name}: {value.min():g} at its lowest, must be positive; rest density is 1")
    if value.min() < low or value.max() > high:
        raise InputError(
            f"{name}: {value.min():g} to {value.max():g}; rest density is 1, and the method holds near it only: "
            f"keep to {low:g} to {high:g} (lattice units; lbm.Scales leads to SI)"
        )


def speed(name: str, value: np.ndarray, axis: int) -> None:
    """Refuse velocities, components along ``axis``, faster than sound."""
    fastest = math.sqrt(np.max(np.sum(np.square(value), axis=axis)))
    if fastest > SPEED_OF_SOUND:
        raise InputError(
            f"{name}: speed {fastest:g} is above that of sound, 0.577; stay below about 0.1 "
            "(lattice units; lbm.Scales leads to SI)"
        )


def box(value, itemsize: int) -> tuple[int, int, int]:
    """Cells along x, y, z of a box whose populations can be addressed."""
    try:
        nx, ny, nz = (operator.index(n) for n in value)
    except (TypeError, ValueError):
        raise InputError(f"shape = {shown(value)}: give three whole numbers of cells (nx, ny, nz)") from None
    if min(nx, ny, nz) < SMALLEST:
        raise InputError(f"shape = {(nx, ny, nz)}: at least {SMALLEST} cells along each axis, also periodic ones")
    if 19 * itemsize * nx * ny * nz > _ADDRESSABLE:
        raise too_large((nx, ny, nz), itemsize)
    return nx, ny, nz


def too_large(shape: tuple[int, int, int], itemsize: int) -> InputError:
    """The error for a box that does not fit into memory."""
    needed = 19 * itemsize * math.prod(shape) / 2**30
    return InputError(f"shape = {shown(shape)}: takes {needed:.3g} GiB, more than there is; use fewer cells")


def precision(value) -> np.dtype:
    """float64 or float32."""
    try:
        found = np.dtype(value)
    except TypeError:
        found = None
    if value is None or found is None or found not in (np.dtype(np.float64), np.dtype(np.float32)):
        raise InputError(f"dtype = {shown(value)}: use float64 or float32")
    return found


def threads(value: int | None, cells: int) -> int:
    """Number of threads; None for all that ``cells`` are worth."""
    available = numba.config.NUMBA_NUM_THREADS
    if value is None:
        return max(1, min(available, cells // _CELLS_WORTH_A_THREAD))
    found = count("threads", value)
    if not 1 <= found <= available:
        raise InputError(
            f"threads = {found}: between 1 and {available} "
            f"(of {os.cpu_count()} cores; NUMBA_NUM_THREADS raises it)"
        )
    return found


def path(name: str, value) -> Path:
    """A path."""
    try:
        return Path(value)
    except TypeError:
        raise InputError(f"{name} = {shown(value)}: give a path") from None


def force(given, when: float) -> tuple[float, float, float] | None:
    """Force density at the time ``when``: 3 components, or a function of time that gives them."""
    if given is None:
        return None
    name = f"force at time {when:g}" if callable(given) else "force"
    return tuple(float(v) for v in vector(name, given(when) if callable(given) else given))
