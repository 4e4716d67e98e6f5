"""Tracks in HDF5: tables that pandas has stored (trackpy, DeepLabCut), SLEAP's analysis file.

pandas keeps the names of the columns of a "table" as pickles, which are read here without anything that could be
called; its "fixed" form has them as text. trackpy stores one such table a frame (PandasHDFStore) or one of all.
SLEAP's ``tracks`` are (tracks, 2, nodes, frames), NaN where a node was not seen. Arrays of one length under names
of their own are columns, as in workspaces of MATLAB 7.3.
"""

from __future__ import annotations

import io
import pickle
import pickletools
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from restitution.errors import Defect, InputError
from restitution.foreign.formats.arrays import side_by_side
from restitution.foreign.formats.spots import Spots
from restitution.foreign.layout import Row
from restitution.foreign.programs import SLEAP, program_of

if TYPE_CHECKING:
    import h5py

MAGIC = b"\x89HDF"
_MOST = 2**28
"""Bytes of an array, compared before any of it is read."""
_SURE, _EASED = 2**22, 256
"""Bytes that are read whatever the file stores of them; beyond, so many times what it stores."""
_MOST_ARRAYS = 100
_MOST_NAMES = 2**16
_TABLES = 2**17
"""Groups that are looked at: one a frame."""
_NONE = "N."
"""A pickle of the name that an index has not."""
_DAMAGED = (
    OSError, KeyError, ValueError, RuntimeError, TypeError, IndexError, AttributeError, EOFError, OverflowError,
    pickle.UnpicklingError, UnicodeError,
)  # fmt: skip


def is_hdf5(data: bytes) -> bool:
    """Whether bytes are HDF5, perhaps behind the words with which MATLAB 7.3 begins."""
    return data.startswith(MAGIC) or (data.startswith(b"MATLAB 7.3") and data[512:516] == MAGIC)


def spots(data: bytes, file: str) -> Spots:
    """The tracks in the bytes of a file; raises :class:`InputError` where there are none that are known."""
    import h5py

    try:
        with h5py.File(io.BytesIO(data), "r") as root:
            if "tracks" in root and isinstance(root["tracks"], h5py.Dataset):
                found = _sleap(root)
            else:
                found = _pandas(root, file)
    except InputError:
        raise
    except _DAMAGED as error:
        rule = f"is HDF5 that cannot be read: {str(error).splitlines()[0][:80] if str(error) else 'damaged'}"
        raise InputError(Defect(rule, file=file)) from None
    if not found.rows:
        raise InputError(Defect("is HDF5 without a row of a track", file=file))
    return found


def _sleap(root: h5py.File) -> Spots:
    tracks = _array(root["tracks"])
    if tracks.ndim != 4 or tracks.shape[1] != 2:
        raise ValueError(f"tracks have the shape {tracks.shape}, not (tracks, 2, nodes, frames)")
    labels = [_text(name) for name in _array(root["track_names"])] if "track_names" in root else []
    nodes = [_text(name) for name in _array(root["node_names"])] if "node_names" in root else []
    labels = labels if len(labels) == tracks.shape[0] else [f"track_{i}" for i in range(tracks.shape[0])]
    nodes = nodes if len(nodes) == tracks.shape[2] else [f"node_{i}" for i in range(tracks.shape[2])]
    names = ["track", "frame_idx", *(f"{node}/{axis}" for node in nodes for axis in "xy")]
    rows = []
    for label, track in zip(labels, tracks, strict=True):
        for frame, places in enumerate(track.transpose(2, 1, 0).reshape(tracks.shape[3], -1)):
            if np.isfinite(places).any():
                rows.append(Row(len(rows) + 1, [label, f"{frame}", *map(_cell, places)]))
    return Spots(names, rows, SLEAP)


def _plain_arrays(root: h5py.File) -> dict[str, np.ndarray]:
    """The arrays of numbers under names of their own, as MATLAB 7.3 and users write them."""
    import h5py

    found = {}
    for name, item in list(root.items())[:_MOST_ARRAYS]:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "iuf" and item.ndim in (1, 2) and item.size:
            found[name] = np.atleast_2d(_array(item))
    return found


def _pandas(root: h5py.File, file: str) -> Spots:
    """All tables of the same columns, one below the other."""
    tables = sorted(_tables(root), key=lambda pair: (len(pair[0]), pair[0]))
    if not tables and len((columns := side_by_side(_plain_arrays(root)))[0]) > 1:
        pairs = enumerate(np.column_stack(columns[1]).tolist(), 1)
        return Spots(columns[0], [Row(n, list(map(_cell, values))) for n, values in pairs], None)
    if not tables:
        rule = "is HDF5 without a table of pandas or tracks of SLEAP; export the table as CSV"
        raise InputError(Defect(rule, file=file))
    names: list[str] = []
    rows: list[Row] = []
    for key, group in tables:
        here, columns = _columns(group)
        if names and here != names:
            raise InputError(Defect("has tables of several kinds; export the one as CSV", file=file, field=key))
        names = here
        rows += [
            Row(len(rows) + i, [_cell(x) for x in row]) for i, row in enumerate(zip(*columns, strict=True), 1)
        ]
    return Spots(names, rows, program_of(names))


def _tables(root: h5py.File) -> Iterable[tuple[str, Any]]:
    import h5py

    for key in list(root)[:_TABLES]:
        group = root[key]
        if isinstance(group, h5py.Group) and ("table" in group or "block0_values" in group):
            yield key, group


def _columns(group: h5py.Group) -> tuple[list[str], list[NDArray]]:
    """Names and columns of one table; an index of floats, as times are, is one, that of DeepLabCut's frames, whose
    columns are named on levels, too.
    """
    if "table" in group:
        table = group["table"]
        content, found = _array(table), dict[Any, NDArray]()
        for field in content.dtype.names or ():
            own = content[field]
            kind = table.attrs.get(f"{field}_kind")
            labels = _labels(kind) if own.ndim == 2 else [field]
            if field != "index":
                found |= dict(zip(labels, own.reshape(len(own), -1).T, strict=True))
        index = content["index"]
    else:
        index, found = _array(group["axis1"]), {}
        for k in range(int(group.attrs["nblocks"])):
            labels = _items(group, f"block{k}_items")
            found |= dict(zip(labels, _array(group[f"block{k}_values"]).T, strict=True))
    if any(isinstance(label, tuple) for label in found):
        # the scorer, who is the same for all, is left out
        return ["coords", *("/".join(map(str, label[1:])) for label in found)], [index, *found.values()]
    named = _text(group["axis1"].attrs.get("name", "")) if "axis1" in group else ""
    named = "index" if named in ("", _NONE) else named
    if index.dtype.kind == "f" and named not in found:
        found = {named: index, **found}
    return [f"{label}" for label in found], list(found.values())


def _items(group: h5py.Group, name: str) -> list[Any]:
    if name in group:
        return [_text(label) for label in _array(group[name])]
    levels = range(int(group.attrs[f"{name}_nlevels"]))
    texts = [[_text(label) for label in _array(group[f"{name}_level{n}"])] for n in levels]
    codes = [_array(group[f"{name}_label{n}"]) for n in levels]
    return [tuple(text[code] for text, code in zip(texts, row, strict=True)) for row in zip(*codes, strict=True)]


class _Plain(pickle.Unpickler):
    """Lists, tuples, texts and numbers; nothing that has a name."""

    def find_class(self, module: str, name: str) -> Any:
        raise pickle.UnpicklingError(f"names {module}.{name}")


def _labels(kind: Any) -> list[Any]:
    data = bytes(kind) if isinstance(kind, bytes | np.bytes_) else str(kind).encode("utf-8")
    if len(data) > _MOST_NAMES:
        raise ValueError("the names of its columns are too long")
    # Places of the memo are allocated up to the one that is named.
    if any(code.name.endswith("PUT") and int(place) > len(data) for code, place, _ in pickletools.genops(data)):
        raise ValueError("the names of its columns are damaged")
    labels = [
        tuple(label) if isinstance(label, tuple | list) else label for label in _Plain(io.BytesIO(data)).load()
    ]
    # A name may be on levels, no deeper: what holds itself many times over is longer than any memory as a text.
    parts = [part for label in labels for part in (label if isinstance(label, tuple) else (label,))]
    if not all(isinstance(part, str | int | float | bytes | None) for part in parts):
        raise ValueError("the names of its columns are not texts")
    return labels


def _array(dataset: Any) -> NDArray:
    """The content of a dataset that is no larger than is sensible and lies in the file itself."""
    size = int(dataset.size) * max(1, int(dataset.dtype.itemsize))
    stored = int(dataset.id.get_storage_size())
    if size > min(_MOST, max(_SURE, _EASED * stored)) or dataset.is_virtual or dataset.external:
        raise ValueError(f"{dataset.name}: {size} bytes, or not in this file")
    return np.asarray(dataset[()])


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes | np.bytes_) else str(value)


def _cell(value: Any) -> str:
    """A number as text; lost is empty."""
    if isinstance(value, bytes | np.bytes_ | str):
        return _text(value)
    number = float(value)
    return "" if not np.isfinite(number) else f"{int(number)}" if number.is_integer() else repr(number)
