"""The cube with a moving lid at Re 1000 against a spectral solution: three dimensions, walls, no sphere."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from lbm.problems.cavity import cubic_cavity
from restitution.validation.row import Depth, Kind, Reference, Row, Values, near

_SOURCE = "Albensoeder & Kuhlmann, J. Comput. Phys. 206 (2005) 536, tables 5 and 6, 96^3 spectral"
_SHORTFALL = "the layers at lid and walls, Re^(-1/2) of the edge, are one to three cells thick"


def profile(cells: int, lid_times: float, dtype: str) -> Values:
    """Velocities over the lid's at the places of the tables, by linear interpolation between cells."""
    lines = cubic_cavity(cells, 1000.0, lid_times=lid_times, dtype=dtype)
    of = {"along": lines.along_velocity, "across": lines.across_velocity}
    return {p.label: float(np.interp(p.place, lines.place, of[p.direction])) for p in points()}


@dataclass(frozen=True)
class Point:
    """A point of the tables in the frame of :class:`lbm.problems.cavity.CentreLines`, and its velocity."""

    direction: str
    place: float
    velocity: float

    @property
    def label(self) -> str:
        """Which velocity, and where."""
        return f"{self.direction} the lid at {self.place:+.3f}"


@cache
def points() -> tuple[Point, ...]:
    """Every third point inside the cube; walls and lid themselves are no test.

    The tables have the lid at x = -1/2, moving in +y; here it is at +1/2 across and moves in + along.
    """
    from restitution import datasets

    along, across = (datasets.load(f"albensoeder2005_{name}") for name in ("v_along_x", "u_along_y"))
    found = [Point("along", -float(x), float(v)) for x, v in zip(along.place, along.velocity, strict=True)]
    found += [Point("across", float(y), -float(u)) for y, u in zip(across.place, across.velocity, strict=True)]
    return tuple(point for point in found if abs(point.place) < 0.5)[::3]


def _truth() -> tuple[Reference, ...]:
    return tuple(near(point.label, point.velocity, absolute=0.005) for point in points())


def _row(cells: int, depth: Depth) -> Row:
    return Row(
        f"cubic-cavity-{cells}", f"velocities on the centre lines of the lid-driven cube, Re 1000, {cells}^3",
        Kind.PUBLISHED, _SOURCE, _truth,
        "five decimals are printed; a goal for the grid: a hundredth of the extrema, 0.005 of the lid's speed",
        profile, {"cells": cells, "lid_times": 40.0, "dtype": "float32"}, depth, "U",
        {point.label: _SHORTFALL for point in points()},
    )  # fmt: skip


ROWS = (_row(32, Depth.QUICK), _row(48, Depth.FULL), _row(96, Depth.FULL))
