"""Flows around spheres whose answer is known: each function sets one up, runs it and returns what it measured.

Lattice units; ``diameter`` is in cells. :mod:`benchmarks.sphere` compares the results with their references.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lbm.faces.records import NoSlip
from lbm.rates import Rates
from lbm.rates_by_place import RatesByPlace
from lbm.simulation import Simulation
from lbm.spheres.spheres import Sphere, Spheres

Preset = Callable[[float], Rates | RatesByPlace]
"""Rates from the viscosity."""

STILL = (0.0, 0.0, 0.0)
SHIFTS = ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (0.25, 0.4, 0.1), (0.7, 0.15, 0.35), (0.9, 0.6, 0.8))
"""Places of a centre within its cell: a single one is off by chance."""


def array_drag(
    cells: int,
    fraction: float,
    shift=STILL,
    *,
    scheme="linear",
    viscosity=1 / 6,
    preset: Preset = Rates.two_relaxation_times,
) -> float:
    """K = F/(6 pi mu a U) of a fixed sphere in a periodic cube of ``cells``, ``fraction`` of it solid, Re -> 0.

    F is the drag with the mean pressure gradient's share: what is exchanged with the fluid, and the body force
    on the sphere's volume that a pressure gradient in its place would add. U is the mean velocity over the
    whole cube, the sphere included as zero.
    """
    radius = cells * (3 * fraction / (4 * math.pi)) ** (1 / 3)
    push = 1e-6
    flow = Simulation((cells,) * 3, preset(viscosity), force=(push, 0.0, 0.0))
    centre = cells // 2 + np.asarray(shift)
    ball = Spheres([Sphere(radius, 1.0, tuple(centre))], drive=lambda step, gap: STILL, interpolation=scheme)
    flow.add(ball)
    fluid = ~inside(flow.shape, centre, radius)
    # Time in which the mean flow relaxes, by Hasimoto's series
    series = 1 - 1.7601 * fraction ** (1 / 3) + fraction - 1.5593 * fraction**2
    relaxation = cells**3 / (6 * math.pi * viscosity * radius) * series
    drag = 0.0
    for _ in range(40):
        flow.run(int(relaxation / 2))
        mean = flow.velocity[0][fluid].sum() / cells**3
        before, drag = drag, ball.forces[0, 0] + push * ball.volumes[0]
        drag /= 6 * math.pi * viscosity * radius * mean
        if abs(drag - before) < 3e-5 * drag:
            return drag
    raise RuntimeError(f"no steady state after {flow.steps} steps")


def inside(shape, centre, radius) -> np.ndarray:
    """Cells whose centre lies in a sphere, its periodic images included."""
    offsets = [np.arange(n) + 0.5 - c for n, c in zip(shape, centre, strict=True)]
    x, y, z = np.meshgrid(*(d - n * np.round(d / n) for d, n in zip(offsets, shape, strict=True)), indexing="ij")
    return x**2 + y**2 + z**2 < radius**2


@dataclass(frozen=True)
class Approach:
    """Resistance lambda = F/(6 pi mu a U) of a sphere driven towards a wall, over the gap in cells."""

    radius: float
    speed: float
    viscosity: float
    gap: np.ndarray
    resistance: np.ndarray


def approach(
    diameter: float,
    *,
    width=6.0,
    height=4.0,
    start=1.0,
    speed=1e-3,
    viscosity=1 / 6,
    scheme="linear",
    preset: Preset = Rates.two_relaxation_times,
    dtype="float64",
) -> Approach:
    """Sphere moved at constant speed to a wall; ``width``, ``height`` of the box and ``start`` gap in diameters.

    Sides periodic, ceiling free-slip.
    """
    shape = (round(width * diameter), round(width * diameter), round(height * diameter))
    radius = diameter / 2
    flow = Simulation(shape, preset(viscosity), faces={"z-": "no-slip", "z+": "free-slip"}, dtype=dtype)
    ramp = diameter**2 / (6 * viscosity)

    def drive(step, gap):
        return 0.0, 0.0, (-speed * math.sin(math.pi / 2 * min(1.0, step / ramp)) if gap > 0.04 else 0.0)

    centre = (shape[0] // 2 + 0.3, shape[1] // 2 + 0.17, radius * (1 + 2 * start))
    ball = Spheres([Sphere(radius, 8.0, centre)], drive=drive, interpolation=scheme)
    flow.add(ball)
    flow.run(int((start * diameter - 0.05) / speed + 0.4 * ramp))
    track = ball.track()
    steady = (track["step"] > ramp) & (track["vz"] == -speed)
    unit = 6 * math.pi * viscosity * radius * speed
    # the force of a step was exchanged where the sphere was before it
    return Approach(radius, speed, viscosity, track["gap"][steady] + speed, track["fz"][steady] / unit)


@dataclass(frozen=True)
class Translation:
    """Force on a sphere moved steadily across the grid, as shares of the mean drag."""

    reynolds: float
    drag: float
    noise: float
    lateral: float


def translation(
    diameter: float,
    direction,
    *,
    speed=0.05,
    viscosity=0.1,
    width=6.0,
    scheme="linear",
    crossings=60,
    preset: Preset = Rates.two_relaxation_times,
    dtype="float64",
) -> Translation:
    """Noise of the force on a sphere that crosses ``crossings`` cells of a periodic cube along ``direction``.

    The speed is ramped over the first half of the way, so that little sound is made. ``noise`` is the rms of
    drag less its running mean over four cells of the way, which takes out what the wake does; ``lateral`` that
    of the whole force across the motion, which is zero for a sphere on its own.
    """
    direction = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    shape = (round(width * diameter),) * 3
    flow = Simulation(shape, preset(viscosity), dtype=dtype)
    steps = int(crossings / speed)
    ramp = steps // 2

    def drive(step, gap):
        return tuple(speed * math.sin(math.pi / 2 * min(1.0, step / ramp)) ** 2 * direction)

    ball = Spheres([Sphere(diameter / 2, 2.0, (3.3, 4.17, 5.06))], drive=drive, interpolation=scheme)
    flow.add(ball)
    flow.run(ramp + steps)
    force = np.stack([ball.track()[f] for f in ("fx", "fy", "fz")], axis=1)[ramp:]
    along = force @ direction
    window = round(4 / speed)
    trend = np.convolve(along, np.ones(window) / window, "valid")
    middle = along[window // 2 : window // 2 + len(trend)]
    across = force - along[:, None] * direction
    drag = -along.mean()
    return Translation(
        speed * diameter / viscosity,
        drag,
        np.std(middle - trend) / drag,
        np.sqrt((across**2).sum(1).mean()) / drag,
    )


def drag_in_frame(
    diameter: float,
    sphere_velocity,
    fluid_velocity,
    *,
    viscosity=0.05,
    width=5.0,
    preset: Preset = Rates.two_relaxation_times,
) -> float:
    """Mean drag, against the motion of the sphere through the fluid, after both were set going at once."""
    shape = (round(width * diameter),) * 3
    flow = Simulation(shape, preset(viscosity))
    flow.set_flow(velocity=fluid_velocity)
    velocity = tuple(float(v) for v in sphere_velocity)
    start = Sphere(diameter / 2, 2.0, (3.3, 4.17, 5.06), velocity=velocity)
    ball = Spheres([start], drive=lambda step, gap: velocity)
    flow.add(ball)
    relative = np.subtract(sphere_velocity, fluid_velocity)
    flow.run(int(3 * diameter / np.linalg.norm(relative)))
    track = ball.track()
    force = np.stack([track[f] for f in ("fx", "fy", "fz")], axis=1)
    return float(-(force[len(force) // 3 :] @ relative).mean() / np.linalg.norm(relative))


def moved_over_held(
    diameter: float, *, speed: float, viscosity: float, width: float, preset: Preset = RatesByPlace.balanced
) -> float:
    """Drag of a sphere moved through fluid at rest over that of one held in the equal stream: 1 (Galileo)."""
    told = {"viscosity": viscosity, "width": width, "preset": preset}
    moved = drag_in_frame(diameter, (speed, 0.0, 0.0), STILL, **told)
    return moved / drag_in_frame(diameter, STILL, (-speed, 0.0, 0.0), **told)


@dataclass(frozen=True)
class Shear:
    """Of a sphere in shear flow: turning rate over half the shear rate, torque when held over 4 pi mu a^3 G."""

    reynolds: float
    turning: float
    torque: float


def shear(
    diameter: float,
    *,
    width=5.0,
    height=6.0,
    rate=2e-5,
    viscosity=1 / 6,
    shift=STILL,
    preset: Preset = Rates.two_relaxation_times,
) -> Shear:
    """A sphere midway between walls that slide past each other: free to turn, and held."""
    shape = tuple(round(n * diameter) for n in (width, width, height))
    speed = rate * shape[2] / 2
    z = np.arange(shape[2]) + 0.5 - shape[2] / 2
    start = np.zeros((3, *shape))
    start[0] = rate * z
    found = []
    for free in (True, False):
        faces = {"z-": NoSlip((-speed, 0.0, 0.0)), "z+": NoSlip((speed, 0.0, 0.0))}
        flow = Simulation(shape, preset(viscosity), faces=faces)
        flow.set_flow(velocity=start)
        centre = (shape[0] / 2 + shift[0], shape[1] / 2 + shift[1], shape[2] / 2)
        spin = (0.0, rate / 2 if free else 0.0, 0.0)
        ball = Spheres(
            [Sphere(diameter / 2, 1.0, centre, spin=spin)], drive=None if free else lambda step, gap: STILL
        )
        flow.add(ball)
        flow.run(int(2 * diameter**2 / viscosity))
        found.append(ball.spins[0, 1] if free else ball.torques[0, 1])
    unit = 4 * math.pi * viscosity * (diameter / 2) ** 3 * rate
    return Shear(rate * diameter**2 / viscosity, 2 * found[0] / rate, found[1] / unit)
