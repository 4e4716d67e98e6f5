"""Spheres in the fluid, far from contact: drag, force and momentum, shear, added mass, frames of reference."""

from __future__ import annotations

from math import log2

from lbm.problems import momentum
from lbm.problems import spheres as flows
from lbm.problems.held_sphere import Stream, held_sphere
from lbm.problems.impulsive_start import REYNOLDS, added_mass, exact, excess
from restitution.validation.row import Depth, Kind, Reference, Row, Values, at_most, near

ZICK_HOMSY = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292}
"""K over the solid fraction, simple cubic array: Zick & Homsy, J. Fluid Mech. 115 (1982) 13, four digits."""


def array_drag(fraction: float, cells: int) -> Values:
    """K in an array of ``cells`` and of twice as many, means over places: its limit, the order of its errors."""
    exact_K = ZICK_HOMSY[fraction]
    coarse, fine = (
        sum(flows.array_drag(n, fraction, shift) for shift in flows.SHIFTS) / len(flows.SHIFTS)
        for n in (cells, 2 * cells)
    )
    return {
        "limit": (4 * fine - coarse) / 3,
        "order": log2(abs(coarse / exact_K - 1) / abs(fine / exact_K - 1)),
    }


def steady_drag(
    reynolds: tuple[float, ...], diameter: int, width: float, dtype: str, quarter: bool = True
) -> Values:
    """C_D of a held sphere at each Reynolds number in a box as long as 5/4 of its width; a quarter is computed."""
    box = Stream(width / 2, 0.75 * width, width, quarter, settling=15.0)
    return {f"Re {Re:g}": held_sphere(diameter, Re, box, dtype=dtype).coefficient for Re in reynolds}


def fine_drag(diameter: int, width: float, dtype: str) -> Values:
    """The same on a fine grid, and at Re 300, where vortices are shed and the whole box is needed."""
    return {
        **steady_drag(_STEADY, diameter, width, dtype),
        **steady_drag((300.0,), diameter, width, dtype, quarter=False),
    }


def measured_drag(reynolds: tuple[float, ...]) -> tuple[Reference, ...]:
    """C_D of a towed sphere at each Re, and its error, from the points of Roos & Willmarth within a factor 1.5.

    A parabola of ln C_D in ln Re through them; the error is their scatter about it, of one point, for the scatter
    of neighbouring points is not independent, twice.
    """
    import numpy as np

    from restitution import datasets

    points = datasets.load("roos_willmarth1971")
    found = []
    for Re in reynolds:
        x = np.log(points.reynolds.to_numpy() / Re)
        near_by = np.abs(x) < np.log(1.5)
        y = np.log(points.drag_coefficient.to_numpy()[near_by])
        fit = np.polyfit(x[near_by], y, 2)
        scatter = np.std(y - np.polyval(fit, x[near_by]), ddof=3)
        found.append(near(f"Re {Re:g}", float(np.exp(fit[-1])), relative=2 * float(scatter)))
    return tuple(found)


def balance() -> Values:
    """How far spheres and fluid are from their equations of motion."""
    return {"exchange": momentum.unbalanced_exchange(), **momentum.unbalanced_motion()}


def weight() -> Values:
    """Momentum of a falling sphere and its fluid."""
    return {"momentum": momentum.gained_of_weight()}


def shear(diameter: float, width: float, height: float) -> Values:
    """Turning and torque of a sphere in shear."""
    found = flows.shear(diameter, width=width, height=height)
    return {"turning": found.turning, "torque": found.torque}


def frames(diameter: float, width: float) -> Values:
    """Drag of a sphere at rest in a stream, and oblique to one, over that in fluid at rest."""
    still = flows.drag_in_frame(diameter, (0.04, 0, 0), flows.STILL, width=width)
    moving = {
        "stream": (flows.STILL, (-0.04, 0, 0)),
        "oblique": ((0.05, 0.03, -0.02), (0.01, 0.03, -0.02)),
    }
    return {name: flows.drag_in_frame(diameter, *way, width=width) / still for name, way in moving.items()}


def fast_frames(diameter: float, speed: float, viscosity: float, width: float) -> Values:
    """Drag of a moved sphere over that of one held in the equal stream, with the rates of cases."""
    return {"moved": flows.moved_over_held(diameter, speed=speed, viscosity=viscosity, width=width)}


def noise(diameter: float, width: float, crossings: int, viscosity: float) -> Values:
    """Noise of the force on a sphere that crosses the grid obliquely."""
    found = flows.translation(diameter, (1, 0.62, 0.37), width=width, crossings=crossings, viscosity=viscosity)
    return {"along": found.noise, "across": found.lateral}


def impulsive_start(diameter: int, width: int) -> Values:
    """J/(m_f u) of a sphere set moving at once, 0.1 and 0.15 d later."""
    times = (0.1, 0.15)
    found = excess(diameter, 0.025, times=times, width=width)
    return {f"t U/d = {t:g}": float(e + exact(4 * t / REYNOLDS)) for t, e in zip(times, found, strict=True)}


def touching(diameter: int) -> Values:
    """Added mass of a sphere that touches the wall, over the displaced mass."""
    return {"C_M": added_mass(diameter)}


_IMPULSE = tuple(near(f"t U/d = {t:g}", float(exact(4 * t / REYNOLDS)), relative=0.05) for t in (0.1, 0.15))
_BASSET = "Boussinesq 1885, Basset 1888: J/(m_f u) = 1/2 + 9 (T/pi)^(1/2) + 9/2 T, unsteady Stokes flow"
_CELL = (
    "the layer set moving, (nu t)^(1/2), is half a cell thick at 16 cells a diameter: its share, a third of J, is "
    "met to the 15 % by which a mean over cells is off"
)
_CLOUD = "twice the scatter of the measured points about their own trend"
_LAYER = "the boundary layer, d/Re^(1/2), is one cell thick at Re 100: drag is 12 % high there, 3 % at Re 50"
_ROOS = "Roos & Willmarth, AIAA J. 9 (1971) 285, towed spheres"
_COARSE = (50.0, 100.0)
_STEADY = (20.0, 50.0, 100.0, 200.0)
"""Above Re 210 the wake is no longer symmetric about two planes."""

ROWS = (
    Row(
        "array-drag", "drag of a sphere in a periodic array, K at solid fraction 1/8", Kind.PUBLISHED,
        "Zick & Homsy, J. Fluid Mech. 115 (1982) 13, four digits",
        (near("limit", ZICK_HOMSY[0.125], relative=0.01), near("order", 2.0, absolute=0.2)),
        "the place in the cell moves K by 3 % at 10 cells, the mean over five of them by 1 %, which is 0.2 of "
        "an order where the error is 7 %", array_drag,
        {"fraction": 0.125, "cells": 10},
    ),
    Row(
        "steady-drag-20", "C_D of a held sphere, Re 20, 8 cells a diameter", Kind.MEASURED, _ROOS,
        lambda: measured_drag((20.0,)), _CLOUD, steady_drag,
        {"reynolds": (20.0,), "diameter": 8, "width": 10.0, "dtype": "float32"},
    ),
    Row(
        "steady-drag", "C_D of a held sphere, 10 cells a diameter", Kind.MEASURED, _ROOS,
        lambda: measured_drag(_COARSE), _CLOUD, steady_drag,
        {"reynolds": _COARSE, "diameter": 10, "width": 8.0, "dtype": "float32"}, Depth.DEFAULT,
        known={"Re 50": _LAYER, "Re 100": _LAYER},
    ),
    Row(
        "steady-drag-fine", "C_D of a held sphere, 16 cells a diameter", Kind.MEASURED, _ROOS,
        lambda: measured_drag((*_STEADY, 300.0)), _CLOUD, fine_drag,
        {"diameter": 16, "width": 8.0, "dtype": "float32"}, Depth.FULL,
    ),
    Row(
        "force-balance", "what is missing of the equations of motion, over the largest term", Kind.ANALYTICAL,
        "action is reaction; m dv/dt = F + (m - m_f) g; 2/5 m a^2 dw/dt = T",
        (at_most("exchange", 1e-10), at_most("velocity", 1e-12), at_most("spin", 1e-9)),
        "round-off of 100 to 200 steps", balance,
    ),
    Row(
        "falling-momentum", "momentum of a falling sphere and its fluid over what the weight gives",
        Kind.ANALYTICAL, "momentum is conserved", (near("momentum", 1.0, absolute=0.02),),
        "cells that come free get the momentum of their neighbours: of second order in the cell, 2 % at 6.6 cells",
        weight,
    ),
    Row(
        "shear-rotation", "sphere between sliding walls: turning over G/2, torque when held over 4 pi mu a^3 G",
        Kind.ANALYTICAL, "Jeffery, Proc. R. Soc. A 102 (1922) 161; Stokes",
        (near("turning", 1.0, absolute=0.015), near("torque", 1.0, absolute=0.05)),
        "walls at 2.5 d and images at 4 d: 1 %; the grid at 8 cells: as in an array, up to 4 % of a torque", shear,
        {"diameter": 8, "width": 4, "height": 5},
    ),
    Row(
        "frames", "drag in a moving frame over that at rest", Kind.ANALYTICAL, "Galilean invariance",
        (near("stream", 1.0, absolute=0.01), near("oblique", 1.0, absolute=0.015)),
        "the stencil's own error is 3 U^2 of the viscosity: 0.5 % at U = 0.04, 1.1 % at 0.06", frames,
        {"diameter": 8, "width": 3},
    ),
    Row(
        "frames-fast", "drag of a moved sphere over that of a held one, Re 100, 8 cells a diameter",
        Kind.ANALYTICAL, "Galilean invariance", (near("moved", 1.0, absolute=0.02),),
        "the stencil's own error is 3 U^2 of the viscosity, 2 % at U = 0.08", fast_frames,
        {"diameter": 8, "speed": 0.08, "viscosity": 0.0064, "width": 3},
    ),
    Row(
        "force-noise", "rms of the force on a sphere that crosses the grid, over its drag, viscosity 0.1",
        Kind.ANALYTICAL, "a steady motion has a steady force", (at_most("along", 0.02), at_most("across", 0.02)),
        "a goal: a fiftieth of the drag", noise, {"diameter": 8, "width": 4, "crossings": 16, "viscosity": 0.1},
    ),
    Row(
        "force-noise-low-viscosity", "the same at viscosity 0.02", Kind.ANALYTICAL,
        "a steady motion has a steady force", (at_most("along", 0.02), at_most("across", 0.02)),
        "a goal: a fiftieth of the drag", noise, {"diameter": 8, "width": 4, "crossings": 16, "viscosity": 0.02},
        Depth.DEFAULT,
        known=dict.fromkeys(
            ("along", "across"),
            "two relaxation times carry the sound of each uncovered cell: 4 % at this viscosity, 40 % at 0.003",
        ),
    ),
    Row(
        "impulsive-start", "impulse taken by a sphere set moving at once, 16 cells a diameter", Kind.ANALYTICAL,
        _BASSET, _IMPULSE, _CELL, impulsive_start, {"diameter": 16, "width": 6}, Depth.DEFAULT,
    ),
    Row(
        "added-mass-touching", "added mass of a sphere that touches a wall, 8 cells a diameter", Kind.ANALYTICAL,
        "potential flow, 3/2 zeta(3) - 1", (near("C_M", 0.8030854, relative=0.02),),
        "the method's own friction, taken out by the same impulse far from the wall", touching, {"diameter": 8},
        known={"C_M": "where the film is thinner than half a cell no fluid is reversed"},
    ),
)  # fmt: skip
