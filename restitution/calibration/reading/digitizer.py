"""Points of a plot read by WebPlotDigitizer: its CSV export, or its JSON project with axis calibration.

The project has the pixels of every point and of four calibration points, X1 and X2 with known x, Y1 and Y2 with
known y. A pixel p is s along a = X2 - X1 and t along b = Y2 - Y1,

    p - X1 = s a + t b,   x = x_1 + s (x_2 - x_1);      p - Y1 = s' a + t' b,   y = y_1 + t' (y_2 - y_1),

in the logarithm where the axis is logarithmic. The values are computed from the pixels, not taken from the file,
and get the error of a click: one pixel. The CSV export has values alone, so their errors come from elsewhere.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, Field, ValidationError

from restitution.conditions import defects_of
from restitution.errors import Defect, InputError
from restitution.foreign.file_text import read_lines
from restitution.foreign.heading import data_rows, heading_of
from restitution.foreign.layout import Layout, Row, layout_of
from restitution.foreign.number_text import Decimal, plain
from restitution.foreign.sections import sections
from restitution.inputs import read_json
from restitution.units import NUMBER, UnitError, number

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
    group: int | None = None
    """Of several points that belong together, as a mean and the ends of its error bar, which one it is."""


class _Dataset(_Part):
    name: str
    axes: str = Field(alias="axesName")
    data: list[_Point]
    groups: list[str] = Field(default_factory=list, alias="groupNames")


class _Project(_Part):
    axes: list[_Axes] = Field(alias="axesColl")
    datasets: list[_Dataset] = Field(alias="datasetColl")


def is_export(path: str | Path, decimal: Decimal | None = None, columns_given: bool = False) -> bool:
    """Whether a file is an export: JSON, or CSV of two columns without names, or with X and Y under names, or of
    curves below one another, unless the caller says what its columns are.
    """
    if str(path).endswith(".json"):
        return True
    layout = layout_of(read_lines(path), str(path), decimal)
    rows = layout.rows
    if not rows:
        return False
    if not columns_given and _curves(layout):
        return True
    numbers = len(rows[0].cells) == 2 and all(NUMBER.fullmatch(plain(cell, ",")) for cell in rows[0].cells)
    return numbers or (len(rows) > 1 and _is_axes(rows[1].cells))


def read_export(path: str | Path, axes: tuple[str, str], decimal: Decimal | None = None) -> pd.DataFrame:
    """A table with columns ``source`` (the data set) and those that x and y are, errors where pixels tell them."""
    return _read_project(path, axes) if str(path).endswith(".json") else _read_csv(path, axes, decimal)


def bars_left_out(path: str | Path) -> int:
    """How many points of a project are ends of error bars, which are not taken: nobody states what they mean."""
    project = _Project.model_validate(_of_version_4(read_json(path)))
    return sum(bool(p.group) for dataset in project.datasets for p in dataset.data)


def _curves(layout: Layout) -> list[tuple[str, Layout]]:
    """The curves that stand one below another, each under the name of x and its own, as Engauge writes them."""
    parts = sections(layout) if layout.width == 2 else []
    values = {part.names[1] if part.names else part.name for part in parts}
    return [(part.name, part.layout(layout)) for part in parts] if len(values) == len(parts) > 1 else []


def _is_axes(cells: list[str]) -> bool:
    return len(cells) >= 2 and [c.upper() for c in cells] == ["X", "Y"] * (len(cells) // 2)


def _read_csv(path: str | Path, axes: tuple[str, str], decimal: Decimal | None) -> pd.DataFrame:
    import pandas as pd

    layout = layout_of(read_lines(path), str(path), decimal)
    if curves := _curves(layout):
        return pd.concat([_points([name], data_rows(of, heading_of(of)), axes, of) for name, of in curves])
    names, rows = [Path(path).stem], layout.rows
    if len(rows) > 1 and _is_axes(rows[1].cells):
        names, rows = _set_names(layout), rows[2:]
    return _points(names, rows, axes, layout)


def _points(names: list[str], rows: list[Row], axes: tuple[str, str], layout: Layout) -> pd.DataFrame:
    """The points of data sets side by side, an x and a y each."""
    import pandas as pd

    path = layout.file
    columns: dict[str, list] = {"source": [], axes[0]: [], axes[1]: []}
    lines = []
    for row in rows:
        cells = [plain(cell, layout.decimal) for cell in row.cells]
        if len(cells) % 2 or any(cells[2 * len(names) :]):
            rule = f"has {len(cells)} values where there are {2 * len(names)} columns, an x and a y a data set"
            raise InputError(Defect(rule, file=path, row=row.line))
        for k, name in enumerate(names):
            pair = cells[2 * k : 2 * k + 2]
            if not any(pair):
                continue  # data sets of different length leave empty cells
            columns["source"].append(name)
            for axis, cell in zip(axes, pair, strict=True):
                try:
                    columns[axis].append(number(cell))
                except UnitError as error:
                    place = {"file": path, "row": row.line, "field": name}
                    raise InputError(Defect(str(error), **place, value=cell)) from None
            lines.append(row.line)
    return pd.DataFrame(columns, index=pd.Index(lines, name="row"))


def _set_names(layout: Layout) -> list[str]:
    """The names of the data sets, each followed by an empty cell; the program does not quote a comma in them."""
    names, axes = layout.rows[0], layout.rows[1].cells
    if len(names.cells) == len(axes):
        return names.cells[::2]
    apart = layout.lines[names.line - 1].strip().removesuffix(layout.separator).split(2 * layout.separator)
    if len(apart) != len(axes) // 2:
        rule = f"has names that are not to be told apart: there are {len(axes) // 2} data sets below"
        raise InputError(Defect(rule, file=layout.file, row=names.line))
    return [name.strip() for name in apart]


def _of_version_4(content: Any) -> Any:
    """A project in the form of WebPlotDigitizer 4; version 3 has one pair of axes, and calls its parts otherwise.

    Axes that no data set uses are left out: they may be of a kind that is not read.
    """
    if not isinstance(content, dict):
        return content
    inner = content.get("wpd", content)
    if isinstance(inner, dict) and "axesType" in inner and isinstance(inner.get("dataSeries"), list):
        axes = {
            "name": "XY", "type": inner["axesType"], "calibrationPoints": inner.get("calibration"),
            **(inner.get("axesParameters") or {}),
        }  # fmt: skip
        series = [{**s, "axesName": "XY"} if isinstance(s, dict) else s for s in inner["dataSeries"]]
        return {"axesColl": [axes], "datasetColl": series}
    if isinstance(inner, dict) and all(isinstance(inner.get(key), list) for key in ("axesColl", "datasetColl")):
        used = {d.get("axesName") for d in inner["datasetColl"] if isinstance(d, dict)}
        known = [a for a in inner["axesColl"] if not isinstance(a, dict) or a.get("name") in used]
        return {**inner, "axesColl": known or inner["axesColl"]}
    return inner


def _read_project(path: str | Path, axes: tuple[str, str]) -> pd.DataFrame:
    import pandas as pd

    try:
        project = _Project.model_validate(_of_version_4(read_json(path)))
    except ValidationError as error:
        raise InputError(*defects_of(error, str(path))) from None
    known = {a.name: a for a in project.axes}
    parts = []
    for dataset in project.datasets:
        if dataset.axes not in known:
            rule = f"is not the name of axes; there are: {', '.join(known) or 'none'}"
            raise InputError(Defect(rule, file=str(path), field=f"{dataset.name}.axesName", value=dataset.axes))
        points = [p for p in dataset.data if not p.group]  # the others are ends of error bars
        pixels = np.array([(p.x, p.y) for p in points]).reshape(-1, 2)
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
