"""Checkpoints: a description, whole numbers and arrays in one HDF5 file, written aside, then renamed.

What is described and what the arrays mean is the caller's. A file is read only by one whose own description agrees
with the one in the file, so that a restart goes on with what was saved.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import h5py
import numpy as np

from lbm import arguments
from lbm.arguments import shown
from lbm.errors import InputError
from lbm.io.files import write_aside

__all__ = ["FORMAT", "VERSION", "read", "save"]

FORMAT = "lbm checkpoint"
VERSION = 3
_ROUND_OFF = 1e-12
"""Relative difference up to which two numbers of a description agree: functions in it may give round-off."""


def save(
    path: Path | str, description: dict, numbers: Mapping[str, int], arrays: Mapping[str, np.ndarray]
) -> None:
    """Write a checkpoint.

    Parameters
    ----------
    path : path
        Where; on failure the file that was there is left as it was.
    description : dict
        In JSON's terms.
    numbers, arrays : mappings
        What is to be found again, by name; a slash in the name of an array makes a group.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    with write_aside(path) as file:
        file.attrs["format"] = FORMAT
        file.attrs["version"] = VERSION
        file.create_dataset("description", data=json.dumps(description))  # may be too long for an attribute
        for name, number in numbers.items():
            file.attrs[name] = number
        for name, array in arrays.items():
            # a check sum, which HDF5 has for what is not empty and not a single number
            file.create_dataset(name, data=array, **({"fletcher32": True} if array.ndim and array.size else {}))


def read(
    path: Path | str, description: dict, numbers: Iterable[str], arrays: Iterable[str]
) -> tuple[dict[str, int], dict[str, np.ndarray]]:
    """The named numbers and arrays of a checkpoint.

    Raises
    ------
    InputError
        For a file that is truncated, of another version, or whose description differs from ``description``; the
        first difference is named.
    """
    path = arguments.path("checkpoint", path)
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise InputError(f"{path}: not an lbm checkpoint")
            if file.attrs["version"] != VERSION:
                raise InputError(
                    f"{path}: checkpoint of version {file.attrs['version']}, this program reads {VERSION}; "
                    "start anew or use the program that wrote it"
                )
            saved, own = json.loads(file["description"][()]), json.loads(json.dumps(description))
            for where, then, now in _differences(saved, own):
                raise InputError(f"{path}: saved with {where} = {shown(then)}, this simulation has {shown(now)}")
            return {name: int(file.attrs[name]) for name in numbers}, {name: file[name][...] for name in arrays}
    except FileNotFoundError:
        raise InputError(f"{path}: no such checkpoint") from None
    except (PermissionError, IsADirectoryError) as error:
        raise InputError(f"{path}: may not be read ({error.strerror})") from error
    except (OSError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        if not _is_file(path):
            raise InputError(f"{shown(str(path))}: no such checkpoint") from None
        raise InputError(f"{path}: damaged or truncated checkpoint ({error}); use an earlier one") from error


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # a name too long for the file system
        return False


def _differences(saved, own, where: str = "") -> Iterator[tuple[str, object, object]]:
    """Place and both values of every entry that differs."""
    if isinstance(saved, dict) and isinstance(own, dict):
        for name in sorted(saved.keys() | own.keys()):
            yield from _differences(saved.get(name), own.get(name), f"{where}.{name}" if where else name)
    elif _records(saved) and _records(own) and len(saved) == len(own):
        for index, (then, now) in enumerate(zip(saved, own, strict=True)):
            yield from _differences(then, now, f"{where}[{index}]")
    elif not _agree(saved, own):
        yield where, saved, own


def _records(value) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(entry, dict) for entry in value)


def _agree(saved, own) -> bool:
    if isinstance(saved, list) and isinstance(own, list):
        return len(saved) == len(own) and all(_agree(then, now) for then, now in zip(saved, own, strict=True))
    if isinstance(saved, float) and isinstance(own, float):
        return math.isclose(saved, own, rel_tol=_ROUND_OFF)
    return saved == own
