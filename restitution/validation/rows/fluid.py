"""The fluid without a sphere, against exact solutions of the Navier-Stokes equations."""

from __future__ import annotations

from lbm.problems import PROBLEMS
from lbm.problems.flows import measured_viscosity, observed_order
from restitution.validation.row import Depth, Kind, Row, Values, at_most, near

_RICHARDSON = "what is left once the k^2 of two grids is taken out is of order k^4 = (2 pi/64)^4 = 9e-5"
_ORDER = "the next term of the error, of two orders more, moves the slope between two grids by some hundredths"


def limit_of_viscosity(flow: str, coarse: int) -> Values:
    """nu measured over nu set, the error of second order taken out by twice the cells."""
    low, high = (measured_viscosity(flow, cells) for cells in (coarse, 2 * coarse))
    return {"limit": (4 * high - low) / 3}


def order(flow: str, coarse: int) -> Values:
    """Observed order in space."""
    return {"order": observed_order(flow, coarse)}


def error(flow: str, cells: int, longer: int) -> Values:
    """Relative error of the velocity once the flow is steady."""
    case = PROBLEMS[flow].case(cells)
    case.simulation.run(longer * case.steps)
    return {"error": case.error()}


def _decay(name: str, solution: str) -> tuple[Row, Row]:
    return (
        Row(
            name, "viscosity from the decay over the one set", Kind.ANALYTICAL, solution,
            (near("limit", 1.0, absolute=1e-4),), _RICHARDSON, limit_of_viscosity, {"flow": name, "coarse": 32},
        ),
        Row(
            f"{name}-order", "order in space, 32 and 64 cells", Kind.ANALYTICAL, solution,
            (near("order", 2.0, absolute=0.1),), _ORDER, order, {"flow": name, "coarse": 32},
        ),
    )  # fmt: skip


ROWS = (
    *_decay("shear-wave", PROBLEMS["shear-wave"].solution),
    *_decay("taylor-green", PROBLEMS["taylor-green"].solution),
    Row(
        "poiseuille", "relative error of the velocity, 8 cells across", Kind.ANALYTICAL,
        PROBLEMS["poiseuille"].solution, (at_most("error", 1e-10),),
        "with the magic number 3/16 a parabola along the grid is exact: round-off of 13000 steps", error,
        {"flow": "poiseuille", "cells": 8, "longer": 10},
    ),
    Row(
        "couette", "relative error of the velocity, 8 cells across", Kind.ANALYTICAL, PROBLEMS["couette"].solution,
        (at_most("error", 1e-12),), "a linear profile is exact: round-off", error,
        {"flow": "couette", "cells": 8, "longer": 4},
    ),
    Row(
        "inclined-walls-order", "order in space of a channel whose walls cut the cells, 16 and 32 cells across",
        Kind.ANALYTICAL, PROBLEMS["inclined-poiseuille"].solution, (near("order", 2.0, absolute=0.1),), _ORDER,
        order, {"flow": "inclined-poiseuille", "coarse": 16},
    ),
    Row(
        "womersley-order", "order in space and time of a force that oscillates between walls, 8 and 16 cells",
        Kind.ANALYTICAL, PROBLEMS["womersley"].solution, (near("order", 2.0, absolute=0.1),), _ORDER, order,
        {"flow": "womersley", "coarse": 8},
    ),
    Row(
        "inlet-outlet-order", "order in space between inlet and outlet, 16 and 32 cells across", Kind.ANALYTICAL,
        PROBLEMS["entering-poiseuille"].solution, (near("order", 2.0, absolute=0.1),), _ORDER, order,
        {"flow": "entering-poiseuille", "coarse": 16}, Depth.DEFAULT,
    ),
)  # fmt: skip
