"""The cubic cavity whose lid moves: a steady flow in three dimensions with nothing in it but walls."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from lbm.errors import InputError
from lbm.faces.records import NoSlip
from lbm.rates import Rates
from lbm.simulation import Simulation

LID_SPEED = 0.1
"""Cells a step."""
UNSETTLED = 40.0
"""Re of one cell from which on no rates are known with which the cube settles: 24 cells at Re 1000 diverge or keep
changing with all of them, 32 settle."""


@dataclass(frozen=True)
class CentreLines:
    """Velocities over the lid's on the two lines through the middle of the cube, places from -1/2 to 1/2.

    The lid is at ``across`` = 1/2 and moves along ``along``: ``along_velocity`` over ``across``, that towards the
    lid over ``along``. ``drift`` is the largest change of either over the last tenth of the run.
    """

    place: np.ndarray
    along_velocity: np.ndarray
    across_velocity: np.ndarray
    drift: float


def cubic_cavity(cells: int, reynolds: float, *, lid_times: float = 60.0, dtype: str = "float32") -> CentreLines:
    """The cube of ``cells`` along each edge, half of it on the lattice: the middle plane is one of symmetry.

    ``lid_times``: how often the lid crosses the cube, from rest. Rates are d'Humieres', with which such a flow is
    stable at a grid Reynolds number where two relaxation times are not.

    Raises
    ------
    InputError : for so few cells that the flow would not settle.
    """
    if cells % 2:
        raise ValueError(f"cells = {cells}: must be even, for the middle plane is a face of the half cube")
    if reynolds / cells > UNSETTLED:
        raise InputError(
            f"cavity of {cells} cells at Re {reynolds:g}: never settles at {reynolds / cells:.3g} a cell; take at "
            f"least {2 * ceil(reynolds / UNSETTLED / 2)} cells"
        )
    faces = {
        "x": "no-slip", "z-": "no-slip", "z+": NoSlip((LID_SPEED, 0.0, 0.0)), "y-": "no-slip", "y+": "free-slip"
    }  # fmt: skip
    rates = Rates.dhumieres2002(LID_SPEED * cells / reynolds)
    flow = Simulation((cells, cells // 2, cells), rates, faces=faces, dtype=dtype)
    steps = round(lid_times * cells / LID_SPEED)
    flow.run(round(0.9 * steps))
    before = _lines(flow)
    flow.run(steps - flow.steps)
    after = _lines(flow)
    drift = max(float(np.abs(b - a).max()) for a, b in zip(before, after, strict=True))
    return CentreLines((np.arange(cells) + 0.5) / cells - 0.5, *after, drift)


def _lines(flow: Simulation) -> tuple[np.ndarray, np.ndarray]:
    """Cells beside the plane of symmetry: their distance of half a cell from it is of second order."""
    u = flow.velocity[:, :, -1, :].astype(float) / LID_SPEED
    middle = slice(flow.shape[0] // 2 - 1, flow.shape[0] // 2 + 1)
    return u[0, middle].mean(axis=0), u[2][:, middle].mean(axis=1)
