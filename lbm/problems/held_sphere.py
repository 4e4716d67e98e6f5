"""A sphere held in a steady stream: its drag coefficient."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lbm.faces.records import Inlet
from lbm.rates import Rates
from lbm.rates_by_place import RatesByPlace
from lbm.simulation import Simulation
from lbm.spheres.spheres import Sphere, Spheres

SPEED = 0.08
"""Of the stream, in cells a step."""


@dataclass(frozen=True)
class Stream:
    """A box in diameters: ``upstream`` and ``downstream`` of the centre, ``width`` across, free-slip sides.

    ``quarter``: the stream is symmetric about two planes, of which the box holds a quarter (steady below Re 210).
    ``settling`` and ``measured``: how long the flow develops, and over how long it is looked at, in d/U.
    ``inviscid``: it starts from the flow of an inviscid fluid, which makes little sound, not from a stream.
    """

    upstream: float = 2.5
    downstream: float = 5.5
    width: float = 5.0
    quarter: bool = False
    settling: float = 15.0
    measured: float = 4.0
    inviscid: bool = False


@dataclass(frozen=True)
class Drag:
    """``coefficient`` = F/(rho U^2/2 pi d^2/4), ``noise``: rms of the force about its trend, over the mean."""

    coefficient: float
    noise: float


def held_sphere(
    diameter: int,
    reynolds: float,
    stream: Stream | None = None,
    rates: Callable[[float], Rates | RatesByPlace] = Rates.balanced,
    dtype: str = "float32",
) -> Drag:
    """Drag of a sphere of ``diameter`` cells at Re = U d/nu."""
    d, box = diameter, stream or Stream()
    faces = {"x-": Inlet((SPEED, 0, 0)), "x+": "outlet", "y": "free-slip", "z": "free-slip"}
    length, wide = round((box.upstream + box.downstream) * d), round(box.width * d / (2 if box.quarter else 1))
    flow = Simulation((length, wide, wide), rates(SPEED * d / reynolds), faces=faces, dtype=dtype)
    middle = (0.0, 0.0) if box.quarter else (box.width / 2 * d + 0.3, box.width / 2 * d + 0.2)
    centre = (box.upstream * d, *middle)
    flow.set_flow(*(inviscid(flow.shape, centre, d / 2, SPEED) if box.inviscid else (1.0, (SPEED, 0, 0))))
    held = Spheres([Sphere(d / 2, 1.0, centre)], drive=lambda step, gap: (0.0, 0.0, 0.0))
    flow.add(held)
    flow.run(round(box.settling * d / SPEED))
    count = round(box.measured * d / SPEED)
    flow.run(count)
    drag = held.track()["fx"][-count:]
    steps = np.linspace(-1, 1, count)
    trend = np.polyval(np.polyfit(steps, drag, 6), steps)
    mean = float(np.mean(drag))
    return Drag(mean / (0.5 * SPEED**2 * math.pi / 4 * d**2), float(np.std(drag - trend)) / mean)


def inviscid(shape, centre, radius: float, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Density and velocity about a sphere in a stream of potential flow along x, at rest within it."""
    x, y, z = np.meshgrid(*(np.arange(n) + 0.5 - c for n, c in zip(shape, centre, strict=True)), indexing="ij")
    r = np.sqrt(x**2 + y**2 + z**2).clip(0.5 * radius)
    dipole = radius**3 / (2 * r**3)
    velocity = -3 * speed * dipole * x / r**2 * np.array([x, y, z])
    velocity[0] += speed * (1 + dipole)
    velocity[:, r < radius] = 0
    speed2 = (velocity**2).sum(axis=0)
    return np.where(r < radius, 1.0, 1 + 1.5 * (speed**2 - speed2)), velocity
