"""The drawing: e of each program against St over its deviation from what was asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restitution.export.drops.kept import steel
from restitution.report.drawing import Drawing, save, stokes_axis, style

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

_LOOKS = {0: ("s", "white", (0, (6, 2))), 1: ("^", "#999999", (0, (1, 1.2))), 2: ("o", "black", "-")}
"""Marker, its face, and dashes of what is asked, by level."""


def draw(table: pd.DataFrame) -> Drawing:
    """A column of two panels for each program."""
    from matplotlib.figure import Figure

    programs = list(dict.fromkeys(table["program"]))
    St = np.geomspace(table["stokes"].min(), table["stokes"].max(), 200)
    with style():
        figure = Figure(figsize=(3.4 * len(programs) + 0.6, 5.6), layout="constrained")
        panels = figure.subplots(
            2, len(programs), sharex=True, sharey="row", squeeze=False, height_ratios=(2.2, 1)
        )
        for (upper, lower), program in zip(panels.T, programs, strict=True):
            _column(upper, lower, table[table["program"] == program], St)
            version = table.loc[table["program"] == program, "version"].iloc[0]
            upper.set_title(f"{program} {version.partition(',')[0]}", fontsize=10)
            lower.set_xlabel("Stokes number of the law (st)  [-]")
        panels[0, 0].set_ylabel("e  [-]")
        panels[0, 0].set_ylim(0, 1)
        panels[1, 0].set_ylabel("delivered $-$ asked\n[$10^{-3}$]")
        panels[0, 0].legend(fontsize=8.5, loc="lower right")
        return save(figure)


def _column(upper: Axes, lower: Axes, table: pd.DataFrame, St: np.ndarray) -> None:
    upper.plot(St, steel().restitution(St), color="black", lw=1.0, label="the law")
    lower.axhline(0.0, color="#999999", lw=0.8, zorder=0)
    for level, rows in table.groupby("level"):
        marker, face, dashes = _LOOKS[int(level)]
        look = {"marker": marker, "ms": 5, "mfc": face, "mec": "black", "ls": "none"}
        if level != 2:
            upper.plot(rows["stokes"], rows["e_asked"], color="#777777", lw=1.0, ls=dashes)
        upper.plot(rows["stokes"], rows["e_delivered"], label=f"level {level}, delivered", **look)
        lower.plot(rows["stokes"], 1e3 * (rows["e_delivered"] - rows["e_asked"]), **look)
    stokes_axis(upper)
