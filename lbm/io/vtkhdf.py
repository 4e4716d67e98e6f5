"""Fields for ParaView: VTKHDF ImageData, cell-centred.

Format: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html, version 2.0.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from lbm import arguments
from lbm.errors import InputError
from lbm.io.files import write_aside

__all__ = ["write_image"]


def write_image(
    path: Path | str,
    fields: dict[str, np.ndarray],
    spacing: float = 1.0,
    origin: tuple[float, float, float] = (0, 0, 0),
    **facts: float,
) -> None:
    """Write scalar (nx, ny, nz) and vector (3, nx, ny, nz) ``fields`` on cells of size ``spacing``.

    ``facts`` are single numbers about the whole, in VTK's field data; ``TimeValue`` is its name for the time.
    """
    spacing, origin = arguments.positive("spacing", spacing), arguments.vector("origin", origin)
    if not isinstance(fields, Mapping) or not fields:
        raise InputError(f"fields = {arguments.shown(fields)}: give arrays by name, at least one")
    arrays = {name: np.asarray(field) for name, field in fields.items()}
    for name, found in arrays.items():
        if not isinstance(name, str) or not name or "/" in name or "\0" in name or name == ".":
            raise InputError(f"field name {arguments.shown(name)}: give letters, without a slash")
        vectors = found.ndim == 4 and found.shape[0] == 3
        if found.dtype.kind not in "biuf" or not (found.ndim == 3 or vectors) or not found.size:
            raise InputError(
                f"field {name!r}: {found.dtype} of shape {found.shape}; "
                "give numbers (nx, ny, nz) or (3, nx, ny, nz)"
            )
    shapes = {name: found.shape[-3:] for name, found in arrays.items()}
    if len(set(shapes.values())) != 1:
        raise InputError(f"fields of different shape: {shapes}")
    nx, ny, nz = next(iter(shapes.values()))
    facts = {name: arguments.number(name, value) for name, value in facts.items()}
    with write_aside(path) as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = (2, 0)
        root.attrs.create("Type", np.bytes_("ImageData"))
        root.attrs["WholeExtent"] = np.array([0, nx, 0, ny, 0, nz])
        root.attrs["Origin"] = origin
        root.attrs["Spacing"] = np.full(3, spacing)
        root.attrs["Direction"] = np.eye(3).ravel()
        cells = root.create_group("CellData")
        for name, field in arrays.items():
            # VTK wants x to run fastest, components last
            data = np.ascontiguousarray(
                np.moveaxis(field, 0, -1).transpose(2, 1, 0, 3) if field.ndim == 4 else field.T
            )
            cells.create_dataset(name, data=data)
        whole = root.create_group("FieldData")
        for name, value in facts.items():
            whole.create_dataset(name, data=[value])
