"""Checkpoints: a description, whole numbers and arrays in one HDF5 file, written aside, then renamed.

What is described and what the arrays mean is the caller's. A file is read only by one whose own description agrees
with the one in the file, so that a restart goes on with what was saved. HDF5 keeps a check sum of arrays; one
over all the rest, names and shapes of the arrays among it, is an attribute. No array is read before its size is
known to be that of the file.
"""

from __future__ import annotations

import hashlib
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

__all__ = ["FORMAT", "VERSION", "described", "read", "save"]

FORMAT = "lbm checkpoint"
VERSION = 4
_ROUND_OFF = 1e-12
"""Relative difference up to which two numbers of a description agree: functions in it may give round-off."""
_DAMAGED = (OSError, KeyError, TypeError, ValueError, AttributeError, OverflowError, RecursionError, MemoryError)
"""What HDF5, JSON and NumPy may make of a damaged file."""


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
    text = json.dumps(description)
    with write_aside(path) as file:
        file.attrs["format"] = FORMAT
        file.attrs["version"] = VERSION
        file.create_dataset("description", data=text)  # may be too long for an attribute
        for name, number in numbers.items():
            file.attrs[name] = number
        for name, array in arrays.items():
            # a check sum, which HDF5 has for what is not empty and not a single number
            file.create_dataset(name, data=array, **({"fletcher32": True} if array.ndim and array.size else {}))
        file.attrs["seal"] = _seal(text, dict(numbers), arrays)


def described(path: Path | str) -> dict:
    """The description in a checkpoint; raises :class:`InputError` as :func:`read` does."""
    with _Opened(path) as file:
        return json.loads(_text(file))


def read(
    path: Path | str,
    description: dict,
    numbers: Iterable[str],
    exact: Mapping[str, np.ndarray],
    rest: tuple[str, ...],
) -> tuple[dict[str, int], dict[str, np.ndarray]]:
    """The named numbers of a checkpoint and all its arrays.

    Parameters
    ----------
    path : path
        Of the file.
    description : dict
        The caller's own, with which that of the file must agree.
    numbers : names
        What is to be found.
    exact : mapping
        Arrays of the caller's whose shapes and types those of the file must have.
    rest : names
        Beginnings of the names of all others, which are read as they are.

    Raises
    ------
    InputError
        For a file that is truncated, edited, of another version, or whose description differs from
        ``description``; the first difference is named.
    """
    with _Opened(path) as file:
        text = _text(file)
        for where, then, now in _differences(json.loads(text), json.loads(json.dumps(description))):
            raise InputError(f"{path}: saved with {where} = {shown(then)}, this simulation has {shown(now)}")
        found: dict[str, h5py.Dataset] = {}

        def collect(name: str, item) -> None:
            if isinstance(item, h5py.Dataset) and name != "description":
                found[name] = item

        file.visititems(collect)
        whole = {name: int(file.attrs[name]) for name in numbers}
        if file.attrs["seal"] != _seal(text, whole, found):
            raise InputError(
                f"{path}: damaged or edited checkpoint: not as it was written; use an earlier one, or start anew"
            )
        for name, item in found.items():
            own = exact.get(name)
            if own is None and not name.startswith(rest):
                raise InputError(f"{path}: damaged checkpoint: holds {shown(name)}, which nobody asked for")
            if own is not None and (own.shape, own.dtype) != (item.shape, item.dtype):
                raise InputError(f"{path}: damaged checkpoint: {name} is of shape {item.shape}, {item.dtype}")
            if item.id.get_storage_size() < item.size * item.dtype.itemsize or item.dtype.kind not in "biufS":
                raise InputError(f"{path}: damaged checkpoint: {name} declares more than the file holds")
        return whole, {name: item[...] for name, item in found.items()}


class _Opened:
    """A checkpoint of this version, open for reading; all that a damaged file may raise as one error."""

    def __init__(self, path: Path | str):
        self.path = arguments.path("checkpoint", path)
        self.file: h5py.File | None = None

    def __enter__(self) -> h5py.File:
        try:
            self.file = file = h5py.File(self.path, "r")
            if file.attrs.get("format") != FORMAT:
                raise InputError(f"{self.path}: not an lbm checkpoint")
            if (version := file.attrs["version"]) != VERSION:
                raise InputError(
                    f"{self.path}: checkpoint of version {version}, this program reads {VERSION}; "
                    "start anew or use the program that wrote it"
                )
        except BaseException as error:
            self.__exit__(type(error), error, None)
            raise
        return file

    def __exit__(self, _kind, error, _trace) -> None:
        if self.file is not None:
            self.file.close()
        path = self.path
        if isinstance(error, FileNotFoundError):
            raise InputError(f"{shown(str(path))}: no such checkpoint") from None
        if isinstance(error, PermissionError | IsADirectoryError):
            raise InputError(f"{path}: may not be read ({error.strerror})") from error
        if isinstance(error, _DAMAGED) and not isinstance(error, InputError):
            if not _is_file(path):
                raise InputError(f"{shown(str(path))}: no such checkpoint") from None
            what = " ".join(str(error).split())[:200]
            raise InputError(
                f"{path}: damaged or truncated checkpoint ({what}); use an earlier one, or start anew"
            ) from error


def _text(file: h5py.File) -> str:
    item = file["description"]
    if item.shape != () or h5py.check_string_dtype(item.dtype) is None or item.dtype.kind != "O":
        raise ValueError("its description is no text")
    return item[()].decode()


def _seal(description: str, numbers: Mapping[str, int], arrays: Mapping[str, np.ndarray | h5py.Dataset]) -> str:
    """SHA-256 over all that is not within an array."""
    kinds = {name: [str(array.dtype), list(array.shape)] for name, array in arrays.items()}
    numbers = {name: int(number) for name, number in numbers.items()}
    content = json.dumps([FORMAT, VERSION, description, numbers, kinds], sort_keys=True)
    return hashlib.sha256(content.encode()).hexdigest()


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name too long for the file system
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
