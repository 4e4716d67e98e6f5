"""Points of a plot read by WebPlotDigitizer: its CSV export, or its JSON project with axis calibration.

The project has the pixels of every point and of four calibration points, X1 and X2 with known x, Y1 and Y2 with
known y. A pixel p is s along a = X2 - X1 and t along b = Y2 - Y1,

    p - X1 = s a + t b,   x = x_1 + s (x_2 - x_1);      p - Y1 = s' a + t' b,   y = y_1 + t' (y_2 - y_1),

in the logarithm where the axis is logarithmic. The values are computed from the pixels, not taken from the file,
and get the error of a click: one pixel. The CSV export has values alone, so their errors come from elsewhere.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, Field, ValidationError

from restitution.conditions import defects_of
from restitution.errors import Defect, InputError
from restitution.tables.csv_text import NUMBER, CsvText

if TYPE_CHECKING:
    import pandas as pd

PIXEL = 1.0
"""Standard error of a click, in pixels."""


class _Part(BaseModel):
    """Of a project only what is needed is read: the program adds keys from version to version."""


class _CalibrationPoint(_Part):
    px: float
    py: float
    dx: Annotated[float | None, BeforeValidator(lambda x: None if x in ("", None) else x)] = None
    dy: Annotated[float | None, BeforeValidator(lambda x: None if x in ("", None) else x)] = None


class _Axes(_Part):
    name: str
    type: Literal["XYAxes"]
    log_x: bool = Field(False, alias="isLogX")
    log_y: bool = Field(False, alias="isLogY")
    aligned: bool = Field(False, alias="noRotation")
    points: Annotated[list[_CalibrationPoint], Field(min_length=4)] = Field(alias="calibrationPoints")


class _Point(_Part):
    x: float
    y: float


class _Dataset(_Part):
    name: str
    axes: str = Field(alias="axesName")
    data: list[_Point]


class _Project(_Part):
    axes: list[_Axes] = Field(alias="axesColl")
    datasets: list[_Dataset] = Field(alias="datasetColl")


def is_export(path: str | Path) -> bool:
    """Whether a file is an export: JSON, or CSV of two columns without names, or with X and Y under names."""
    if str(path).endswith(".json"):
        return True
    rows = _cells(path)[:2]
    if not rows:
        return False
    numbers = all(NUMBER.fullmatch(cell) for cell in rows[0][1]) and len(rows[0][1]) == 2
    return numbers or (len(rows) > 1 and _is_axes(rows[1][1]))


def read_export(path: str | Path, axes: tuple[str, str]) -> pd.DataFrame:
    """A table with columns ``source`` (the data set) and those that x and y are, errors where pixels tell them."""
    return _read_project(path, axes) if str(path).endswith(".json") else _read_csv(path, axes)


def _is_axes(cells: list[str]) -> bool:
    return len(cells) >= 2 and [c.upper() for c in cells] == ["X", "Y"] * (len(cells) // 2)


def _cells(path: str | Path) -> list[tuple[int, list[str]]]:
    """Rows of text by line number; the strict reader is for tables with a header, which these have not."""
    text = CsvText(path)
    if not text.header and not text.defects:
        return []
    try:
        lines = Path(path).read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError):
        return []
    return [(i, [c.strip() for c in line.split(",")]) for i, line in enumerate(lines, 1) if line.strip()]


def _read_csv(path: str | Path, axes: tuple[str, str]) -> pd.DataFrame:
    import pandas as pd

    rows = _cells(path)
    names = [Path(path).stem]
    if len(rows) > 1 and _is_axes(rows[1][1]):
        names = rows[0][1][::2]
        rows = rows[2:]
    columns: dict[str, list] = {"source": [], axes[0]: [], axes[1]: []}
    for line, cells in rows:
        for k, name in enumerate(names):
            pair = cells[2 * k : 2 * k + 2]
            if not any(pair):
                continue  # data sets of different length leave empty cells
            for cell in pair:
                if not NUMBER.fullmatch(cell):
                    raise InputError(Defect("is not a number", file=str(path), row=line, field=name, value=cell))
            columns["source"].append(name)
            columns[axes[0]].append(float(pair[0]))
            columns[axes[1]].append(float(pair[1]))
    return pd.DataFrame(columns)


def _read_project(path: str | Path, axes: tuple[str, str]) -> pd.DataFrame:
    import pandas as pd

    try:
        content = json.loads(Path(path).read_bytes())
        project = _Project.model_validate(content.get("wpd", content) if isinstance(content, dict) else content)
    except OSError as error:
        raise InputError(Defect(f"cannot be read: {error.strerror}", file=str(path))) from None
    except ValidationError as error:
        raise InputError(*defects_of(error, str(path))) from None
    except ValueError as error:
        raise InputError(Defect(f"is not JSON: {error}", file=str(path))) from None
    known = {a.name: a for a in project.axes}
    parts = []
    for dataset in project.datasets:
        if dataset.axes not in known:
            rule = f"is not the name of axes; there are: {', '.join(known) or 'none'}"
            raise InputError(Defect(rule, file=str(path), field=f"{dataset.name}.axesName", value=dataset.axes))
        pixels = np.array([(p.x, p.y) for p in dataset.data]).reshape(-1, 2)
        x, y, x_sigma, y_sigma = _values(known[dataset.axes], pixels, str(path))
        parts.append(
            pd.DataFrame(
                {
                    "source": dataset.name,
                    axes[0]: x,
                    f"{axes[0]}_sigma": x_sigma,
                    axes[1]: y,
                    f"{axes[1]}_sigma": y_sigma,
                }
            )
        )
    if not parts or not sum(map(len, parts)):
        raise InputError(Defect("has no points", file=str(path)))
    return pd.concat(parts, ignore_index=True)


def _values(axes: _Axes, pixels: np.ndarray, file: str) -> tuple[np.ndarray, ...]:
    """X, y and their errors of a click at each pixel."""
    X1, X2, Y1, Y2 = (np.array([p.px, p.py]) for p in axes.points[:4])
    a, b = X2 - X1, Y2 - Y1
    if axes.aligned:
        a, b = np.array([a[0], 0.0]), np.array([0.0, b[1]])
    basis = np.stack([a, b], axis=1)
    if abs(np.linalg.det(basis)) < 1e-9:
        raise InputError(Defect("the calibration points lie on one line", file=file, field=axes.name))
    result, errors = [], []
    for k, (origin, key, logarithmic) in enumerate(((X1, "dx", axes.log_x), (Y1, "dy", axes.log_y))):
        ends = [getattr(p, key) for p in axes.points[2 * k : 2 * k + 2]]
        if None in ends or ends[0] == ends[1] or (logarithmic and min(ends) <= 0):
            rule = "needs two calibration points of different" + (", positive" * logarithmic) + " value"
            raise InputError(Defect(rule, file=file, field=f"{axes.name}, {key[1]} axis"))
        low, high = (math.log(e) for e in ends) if logarithmic else ends
        inverse = np.linalg.inv(basis)[k]
        value = low + (pixels - origin) @ inverse * (high - low)
        step = PIXEL * np.linalg.norm(inverse) * abs(high - low)
        value = np.exp(value) if logarithmic else value
        result.append(value)
        errors.append(step * value if logarithmic else np.full(len(value), step))
    return *result, *errors
