"""Points of a plot read by a digitizer: WebPlotDigitizer's CSV export or its project, tables of curves over one x.

The points of a project are computed from its pixels, and get the error of a click
(:mod:`restitution.foreign.formats.digitised`). A table has values alone, so their errors come from elsewhere.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from restitution.errors import Defect, InputError
from restitution.foreign.formats.digitised import curves, is_project
from restitution.foreign.formats.kinds import read_lines
from restitution.foreign.heading import data_rows, heading_of
from restitution.foreign.layout import Layout, Row, layout_of
from restitution.foreign.number_text import Decimal, plain
from restitution.foreign.programs import PARTICLES, TIMES, program_of
from restitution.foreign.sections import sections
from restitution.units import NUMBER, UnitError, number

if TYPE_CHECKING:
    import pandas as pd


def is_export(
    path: str | Path, decimal: Decimal | None = None, columns_given: bool = False, sheet: str | None = None
) -> bool:
    """Whether a file is an export: JSON, or CSV of two columns without names, or with X and Y under names, or of
    curves below one another or side by side over one x, unless the caller says what its columns are.
    """
    if is_project(path):
        return True
    try:
        layout = layout_of(read_lines(path, sheet), str(path), decimal)
    except InputError:
        return False  # markup, HDF5: tracks, or for their reader to refuse
    rows = layout.rows
    if not rows:
        return False
    if not columns_given and (_curves(layout) or _over_one_x(layout)):
        return True
    numbers = len(rows[0].cells) == 2 and all(NUMBER.fullmatch(plain(cell, ",")) for cell in rows[0].cells)
    return numbers or (len(rows) > 1 and _is_axes(rows[1].cells))


def read_export(
    path: str | Path, axes: tuple[str, str], decimal: Decimal | None = None, sheet: str | None = None
) -> pd.DataFrame:
    """A table with columns ``source`` (the data set) and those that x and y are, errors where pixels tell them."""
    return _read_project(path, axes) if is_project(path) else _read_csv(path, axes, decimal, sheet)


def bars_left_out(path: str | Path) -> int:
    """How many points of a project are ends of error bars, which are not taken: nobody states what they mean."""
    return sum(curve.bars for curve in curves(path))


def _curves(layout: Layout) -> list[tuple[str, Layout]]:
    """The curves that stand one below another, each under the name of x and its own, as Engauge writes them."""
    parts = sections(layout) if layout.width == 2 else []
    values = {part.names[1] if part.names else part.name for part in parts}
    return [(part.name, part.layout(layout)) for part in parts] if len(values) == len(parts) > 1 else []


def _over_one_x(layout: Layout) -> list[str]:
    """The names of curves that have one column of x for all, as Engauge writes; none in another table."""
    if not layout.rows or layout.rows[0].cells[:1] not in (["x"], ["X"]):
        return []
    heading = heading_of(layout)
    names = list(heading.names.values())
    lower = [name.lower() for name in names]
    known = program_of(names) is not None or set(lower) & {*TIMES, *PARTICLES}
    return names[1:] if len(names) == layout.width > 1 and lower.count("x") == 1 and not known else []


def _is_axes(cells: list[str]) -> bool:
    return len(cells) >= 2 and [c.upper() for c in cells] == ["X", "Y"] * (len(cells) // 2)


def _read_csv(path: str | Path, axes: tuple[str, str], decimal: Decimal | None, sheet: str | None) -> pd.DataFrame:
    import pandas as pd

    layout = layout_of(read_lines(path, sheet), str(path), decimal)
    if below := _curves(layout):
        return pd.concat([_points([name], data_rows(of, heading_of(of)), axes, of) for name, of in below])
    if names := _over_one_x(layout):
        rows = data_rows(layout, heading_of(layout))
        names = names if len(names) > 1 or names[0].lower() != "y" else [Path(path).stem]
        apart = [
            [Row(row.line, [row.cells[0], row.cells[k]]) for row in rows if row.cells[k]]
            for k, _ in enumerate(names, 1)
        ]
        return pd.concat([_points([name], own, axes, layout) for name, own in zip(names, apart, strict=True)])
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


def _read_project(path: str | Path, axes: tuple[str, str]) -> pd.DataFrame:
    import pandas as pd

    x, y = axes
    parts = [
        pd.DataFrame({"source": c.name, x: c.x, f"{x}_sigma": c.x_sigma, y: c.y, f"{y}_sigma": c.y_sigma})
        for c in curves(path)
    ]
    return pd.concat(parts, ignore_index=True)
