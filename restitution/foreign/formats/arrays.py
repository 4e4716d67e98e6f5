"""Numbers kept as arrays: NumPy's .npy and .npz, workspaces of MATLAB, as text.

What is written out has a line of names where there are any, then a row a line, as if saved as text. Of a workspace
are taken the arrays as long as the longest; tracks of u-track (``tracksFinal``) are rows of track, frame, x, y.
"""

from __future__ import annotations

import io
import tokenize
import zipfile
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from restitution.errors import Defect, InputError
from restitution.inputs import MOST_TABLE

NUMPY, MATLAB, ZIP = b"\x93NUMPY", b"MATLAB 5.0", b"PK\x03\x04"
_NO_ARRAY = (ValueError, OSError, EOFError, SyntaxError, tokenize.TokenError, MemoryError)
_WIDEST = 200
"""Columns of an array that are read."""


def is_array(data: bytes) -> bool:
    """Whether bytes are an array of NumPy, several in an .npz, or a workspace of MATLAB."""
    return data.startswith((NUMPY, MATLAB)) or (data.startswith(ZIP) and bool(_packed(data)))


def text_of_array(data: bytes, file: str) -> str:
    """Its numbers as text; raises :class:`InputError` where it holds no table of numbers."""
    if data.startswith(ZIP):
        return _several(data, file)
    return _numpy(data, file) if data.startswith(NUMPY) else _matlab(data, file)


def _text(names: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    lines = ["\t".join(" ".join(name.split()) for name in names)] if names else []
    return "\n".join([*lines, *("\t".join("" if v is None else str(v) for v in row) for row in rows)])


def _numpy(data: bytes, file: str) -> str:
    try:
        array = np.load(io.BytesIO(data), allow_pickle=False)
    except _NO_ARRAY:
        raise InputError(Defect("is no array of NumPy that holds numbers alone", file=file)) from None
    if array.dtype.names and array.ndim == 1:
        return _text(array.dtype.names, array.tolist())
    if array.ndim != 2 or array.dtype.kind not in "iuf":
        shape = " x ".join(map(str, array.shape)) or "a single value"
        raise InputError(Defect(f"is an array of {shape}, no table of rows and columns of numbers", file=file))
    return _text([], _upright(array).tolist())


def _packed(data: bytes) -> list[zipfile.ZipInfo]:
    """The arrays in an .npz; none where it is another archive."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            parts = archive.infolist()
    except (zipfile.BadZipFile, OSError, EOFError, ValueError, LookupError, RuntimeError):
        return []
    return parts if all(part.filename.endswith(".npy") for part in parts) else []


def _several(data: bytes, file: str) -> str:
    """The arrays of an .npz that are as long as the longest, side by side."""
    if sum(part.file_size for part in _packed(data)) > MOST_TABLE:
        raise InputError(Defect("is larger unpacked than what is read of a table", file=file))
    arrays: dict[str, np.ndarray] = {}
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as content:
            for name in content.files:
                if (array := content[name]).dtype.kind in "iuf" and array.ndim in (1, 2) and array.size:
                    arrays[name] = array[:, None] if array.ndim == 1 else array
    except (*_NO_ARRAY, zipfile.BadZipFile, zlib.error, LookupError, RuntimeError):
        raise InputError(Defect("is no archive of NumPy that holds numbers alone", file=file)) from None
    names, columns = side_by_side(arrays)
    if len(columns) < 2:
        found = ", ".join(arrays) or "none"
        rule = f"is an archive of NumPy without two columns of one length; arrays of numbers in it: {found}"
        raise InputError(Defect(rule, file=file))
    return _text(names, np.column_stack(columns).tolist())


def _upright(array: np.ndarray) -> np.ndarray:
    """Rows are the frames, of which there are more than columns."""
    return array.T if array.shape[0] < array.shape[1] else array


def _matlab(data: bytes, file: str) -> str:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    wrong = (
        MatReadError, ValueError, TypeError, LookupError, OSError, EOFError, NotImplementedError, MemoryError,
        ArithmeticError, AttributeError, zlib.error,
    )  # fmt: skip
    try:
        content = loadmat(io.BytesIO(data), squeeze_me=False, struct_as_record=True)
    except wrong:
        raise InputError(Defect("is a workspace of MATLAB that cannot be read", file=file)) from None
    if (tracks := content.get("tracksFinal")) is not None and "tracksCoordAmpCG" in (tracks.dtype.names or ()):
        return _u_track(tracks)
    arrays = {
        name: value
        for name, value in content.items()
        if not name.startswith("__")
        and isinstance(value, np.ndarray)
        and value.dtype.kind in "iuf"
        and value.ndim == 2
    }
    names, columns = side_by_side(arrays)
    if len(columns) < 2:
        found = ", ".join(arrays) or "none"
        rule = f"is a workspace of MATLAB without two columns of one length; arrays of numbers in it: {found}"
        raise InputError(Defect(rule, file=file))
    return _text(names, np.column_stack(columns).tolist())


def side_by_side(arrays: dict[str, np.ndarray]) -> tuple[list[str], list[np.ndarray]]:
    """Names and columns of the arrays that are as long as the longest; of those of several columns, by number."""
    longest = max((max(value.shape) for value in arrays.values()), default=0)
    names, columns = list[str](), list[np.ndarray]()
    for name, value in arrays.items():
        upright = _upright(value)
        if len(upright) == longest > 1 and upright.shape[1] <= _WIDEST:
            several = upright.shape[1] > 1
            names += [f"{name}_{k + 1}" if several else name for k in range(upright.shape[1])]
            columns += list(upright.T)
    return names, columns


def _u_track(tracks: np.ndarray) -> str:
    """Eight numbers a frame, x and y first, from the frame in which the track begins."""
    rows = []
    for number, track in enumerate(tracks.ravel(), 1):
        coordinates = np.atleast_2d(track["tracksCoordAmpCG"])[0]
        begin = int(np.atleast_2d(track["seqOfEvents"])[:, 0].min()) if "seqOfEvents" in tracks.dtype.names else 1
        for k, (x, y) in enumerate(zip(coordinates[0::8], coordinates[1::8], strict=False)):
            rows.append([number, begin + k, float(x), float(y)])
    return _text(["track", "frame", "x", "y"], rows)
