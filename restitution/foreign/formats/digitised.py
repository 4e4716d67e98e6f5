"""Curves of a plot in a project of WebPlotDigitizer: JSON of versions 3 and 4, or the .tar that has it inside.

The project has the pixels of every point and of four calibration points, X1 and X2 with known x, Y1 and Y2 with
known y. A pixel p is s along a = X2 - X1 and t along b = Y2 - Y1,

    p - X1 = s a + t b,   x = x_1 + s (x_2 - x_1);      p - Y1 = s' a + t' b,   y = y_1 + t' (y_2 - y_1),

in the logarithm where the axis is logarithmic. The values are computed from the pixels, not taken from the file,
and get the error of a click: one pixel.
"""

from __future__ import annotations

import codecs
import io
import math
import tarfile
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, Field, ValidationError

from restitution.conditions import defects_of
from restitution.errors import Defect, InputError
from restitution.inputs import MOST_JSON, json_of, read_bytes

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


@dataclass(frozen=True)
class Curve:
    """The points of one data set and their errors of a click; ``bars`` counts the ends of error bars left out."""

    name: str
    x: np.ndarray
    y: np.ndarray
    x_sigma: np.ndarray
    y_sigma: np.ndarray
    bars: int


_KEYS = (b'"axesColl"', b'"datasetColl"', b'"axesType"', b'"dataSeries"')
_MOST_FILES = 1000
"""Files in an archive that are looked at."""


def is_archive(data: bytes) -> bool:
    """Whether the bytes are a tar archive."""
    return data[257:262] == b"ustar"


def is_project(path: str | Path) -> bool:
    """Whether a file is a project, by the keys of one of its versions or as an archive."""
    data = read_bytes(path)
    json = data.lstrip().removeprefix(codecs.BOM_UTF8).lstrip()[:1] == b"{"
    return is_archive(data) or (json and any(key in data for key in _KEYS))


def curves(path: str | Path) -> list[Curve]:
    """The curves of a project; raises :class:`InputError` where it is none, or its axes are not calibrated."""
    file = str(path)
    try:
        project = _Project.model_validate(_of_version_4(json_of(_content(path), file)))
    except ValidationError as error:
        raise InputError(*defects_of(error, file)) from None
    known = {a.name: a for a in project.axes}
    found = []
    for dataset in project.datasets:
        if dataset.axes not in known:
            rule = f"is not the name of axes; there are: {', '.join(known) or 'none'}"
            raise InputError(Defect(rule, file=file, field=f"{dataset.name}.axesName", value=dataset.axes))
        points = [p for p in dataset.data if not p.group]  # the others are ends of error bars
        pixels = np.array([(p.x, p.y) for p in points]).reshape(-1, 2)
        x, y, x_sigma, y_sigma = _values(known[dataset.axes], pixels, file)
        found.append(Curve(dataset.name, x, y, x_sigma, y_sigma, len(dataset.data) - len(points)))
    if not any(len(curve.x) for curve in found):
        raise InputError(Defect("has no points", file=file))
    return found


def _content(path: str | Path) -> bytes:
    """The JSON of a project, from the archive if it is in one."""
    data = read_bytes(path)
    if not is_archive(data):
        return read_bytes(path, MOST_JSON)
    try:
        with tarfile.open(fileobj=io.BytesIO(data), mode="r:") as archive:
            for member in islice(archive, _MOST_FILES):
                inner = archive.extractfile(member) if Path(member.name).name == "wpd.json" else None
                if inner is not None and member.size <= MOST_JSON:
                    return inner.read()
    except (tarfile.TarError, EOFError):
        pass
    raise InputError(Defect("is an archive without a project of WebPlotDigitizer (wpd.json)", file=str(path)))


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
