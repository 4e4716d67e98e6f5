"""Fields for ParaView: VTKHDF ImageData, cell-centred.

Format: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html, version 2.0.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lbm.errors import InputError
from lbm.files import write_aside


def write_image(
    path: Path | str,
    fields: dict[str, np.ndarray],
    spacing: float = 1.0,
    origin: tuple[float, float, float] = (0, 0, 0),
) -> None:
    """Write scalar (nx, ny, nz) and vector (3, nx, ny, nz) ``fields`` on cells of size ``spacing``."""
    shapes = {name: field.shape[-3:] for name, field in fields.items()}
    if len(set(shapes.values())) != 1:
        raise InputError(f"fields of different or no shape: {shapes}")
    nx, ny, nz = next(iter(shapes.values()))
    with write_aside(path) as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = (2, 0)
        root.attrs.create("Type", np.bytes_("ImageData"))
        root.attrs["WholeExtent"] = np.array([0, nx, 0, ny, 0, nz])
        root.attrs["Origin"] = np.array(origin, dtype=float)
        root.attrs["Spacing"] = np.full(3, float(spacing))
        root.attrs["Direction"] = np.eye(3).ravel()
        cells = root.create_group("CellData")
        for name, field in fields.items():
            # VTK wants x to run fastest, components last
            data = np.ascontiguousarray(
                np.moveaxis(field, 0, -1).transpose(2, 1, 0, 3) if field.ndim == 4 else field.T
            )
            cells.create_dataset(name, data=data)
