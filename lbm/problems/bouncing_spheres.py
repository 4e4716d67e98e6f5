"""Spheres that fall or bounce, with what the grid lacks; see :mod:`lbm.problems.spheres`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lbm.problems.spheres import Preset, inside
from lbm.rates import Rates
from lbm.rates_by_place import RatesByPlace
from lbm.simulation import Simulation
from lbm.spheres.contact import DryRebound
from lbm.spheres.film import RESOLVED, Film, lost_to_grid
from lbm.spheres.spheres import Sphere, Spheres
from lbm.spheres.wall_motion import FRACTION


def film(radius: float, viscosity: float, floor: float = 1e-3) -> Film:
    """Film of what the grid lacks of Taylor's lubrication force."""
    unit = 6 * math.pi * viscosity * radius**2

    def normal(gap, velocity, onset):
        return -unit * velocity * lost_to_grid(gap)

    return Film(RESOLVED, floor, normal)


@dataclass(frozen=True)
class Settling:
    """Time in s, gap in m and velocity in m/s of a sphere that settles on a floor."""

    time: np.ndarray
    gap: np.ndarray
    velocity: np.ndarray


def settling(
    conditions,
    diameter: float,
    *,
    speed: float,
    terminal: float,
    duration: float,
    preset: Preset = Rates.two_relaxation_times,
    dtype="float64",
) -> Settling:
    """Sphere released in a closed box of 100 x 100 x 160 mm, 120 mm above its floor (ten Cate et al. 2002).

    ``speed`` in lattice units stands for ``terminal`` in m/s.
    """
    fluid, sphere = conditions.fluid, conditions.sphere
    dx = sphere.diameter / diameter
    dt = speed / terminal * dx
    shape = tuple(round(length / dx) for length in (0.1, 0.1, 0.16))
    viscosity = fluid.viscosity / fluid.density * dt / dx**2
    radius = diameter / 2
    flow = Simulation(shape, preset(viscosity), faces=dict.fromkeys("xyz", "no-slip"), dtype=dtype)
    ball = Spheres(
        [Sphere(radius, sphere.density / fluid.density, (shape[0] / 2, shape[1] / 2, 0.12 / dx + radius))],
        gravity=(0.0, 0.0, -conditions.gravity * dt**2 / dx),
        film=film(radius, viscosity),
        contact=DryRebound(0.5, 2 / 3 * math.pi * radius**3, diameter, viscosity),
    )
    flow.add(ball)
    flow.run(int(duration / dt))
    track = ball.track()
    # the nearest wall is the ceiling at first
    return Settling(track["step"] * dt, (track["z"] - radius) * dx, track["vz"] * dx / dt)


def rebound(
    diameter: float = 10,
    *,
    stokes=30.0,
    ratio=8.0,
    speed=0.05,
    start=1.5,
    lateral=(0.0, 0.0),
    width=4.0,
    fraction=FRACTION,
    preset: Preset = Rates.two_relaxation_times,
) -> tuple[np.ndarray, np.ndarray]:
    """Gap in diameters over steps of a sphere that is brought to ``speed`` and left to bounce off a wall.

    St = (rho_p/rho_f) U d/(9 nu). The film is what the grid lacks, the contact dry with e = 0.97 at
    1e-3 radii; gravity is what gives the rebound height of a diameter without fluid.
    """
    radius = diameter / 2
    viscosity = ratio * speed * diameter / (9 * stokes)
    shape = (round(width * diameter),) * 2 + (round(4 * diameter),)
    flow = Simulation(shape, preset(viscosity), faces={"z-": "no-slip", "z+": "free-slip"})
    height = start * diameter
    ramp = 0.6 * start * diameter / speed

    def drive(step, gap):
        return (0.0, 0.0, -speed * math.sin(math.pi / 2 * min(1.0, step / ramp))) if gap > 0.5 * diameter else None

    centre = (shape[0] // 2 + lateral[0], shape[1] // 2 + lateral[1], radius + height)
    ball = Spheres(
        [Sphere(radius, ratio, centre)],
        gravity=(0.0, 0.0, -(speed**2) / (2 * diameter)),
        film=film(radius, viscosity, floor=1e-3 * radius),
        contact=DryRebound(0.97, 2 / 3 * math.pi * radius**3, diameter, viscosity),
        drive=drive,
        fraction=fraction,
    )
    flow.add(ball)
    while not ball.impacts:
        flow.run(10)
    flow.run(int(1.5 * diameter / speed))
    track = ball.track()
    return track["gap"] / diameter, track["vz"] / speed


def restitution(gap: np.ndarray, velocity: np.ndarray, edge: float = 0.1) -> float:
    """-v_out/v_in where a :func:`rebound` crosses the gap ``edge``, in diameters."""
    turn = int(np.argmin(gap))
    into = np.flatnonzero(gap[:turn] > edge)[-1]
    out = turn + np.flatnonzero(gap[turn:] > edge)[0]
    return -float(velocity[out] / velocity[into])


def apex(gap: np.ndarray, velocity: np.ndarray) -> float:
    """Height of a :func:`rebound`, in diameters."""
    return float(gap[np.argmin(gap) :].max())


def flight(speed: float, diameter: int = 10, preset: Preset = RatesByPlace.balanced, width=5, height=7) -> float:
    """Gap in diameters, 6.24 d/U after its launch, of a sphere sent up from a wall through fluid at rest.

    The rebound of St 152 as it leaves the film: 8.34 times the density of the fluid, Re = U d/nu = 164,
    g d/U^2 = 0.086, sent off at 0.8 U from a gap of 0.3 d; ``speed`` is U in cells a step. A quarter of the box.
    """
    n = diameter
    flow = Simulation(
        (width * n // 2, width * n // 2, height * n),
        preset(speed * n / 164),
        faces={"x": "free-slip", "y": "free-slip", "z": "no-slip"},
        dtype="float32",
    )
    start = Sphere(n / 2, 8.34, (0.0, 0.0, 0.8 * n), velocity=(0.0, 0.0, 0.8 * speed))
    ball = Spheres([start], gravity=(0.0, 0.0, -0.086 * speed**2 / n))
    flow.add(ball)
    flow.run(round(6.24 * n / speed))
    return float(ball.track()["gap"][-1]) / n


def beads(diameter: int = 10, speed: float = 0.05, preset: Preset = RatesByPlace.balanced) -> np.ndarray:
    """Fastest fall of each of three free beads over ``speed``, their terminal speed by the standard drag curve.

    Glass in water (2.5 times as dense) at Re 370, C_D 0.62 (Clift, Grace & Weber 1978); they fall 15 d from rest
    through a box 6 x 6 x 20 d, side by side, two diameters apart, and bounce off its floor.
    """
    n, density, viscosity = diameter, 2.5, speed * diameter / 370
    radius, height = n / 2, 20 * n
    flow = Simulation((6 * n, 6 * n, height), preset(viscosity), faces={"z": "no-slip"}, dtype="float32")
    places = [(1.5, 1.5), (3.6, 1.7), (2.4, 3.5)]
    falling = Spheres(
        [Sphere(radius, density, (x * n, y * n, height - 3.5 * n - 4 * i)) for i, (x, y) in enumerate(places)],
        gravity=(0.0, 0.0, -0.75 * 0.62 * speed**2 / n / (density - 1)),
        film=film(radius, viscosity, floor=1e-3 * radius),
        contact=DryRebound(0.97, 2 / 3 * math.pi * radius**3, n, viscosity),
    )
    flow.add(falling)
    while len({impact.sphere for impact in falling.impacts}) < len(places):
        flow.run(200)
    return np.array([-falling.track(s)["vz"].min() / speed for s in range(len(places))])


def base_pressure(diameter: int = 8, preset: Preset = RatesByPlace.balanced, width=4, height=4) -> np.ndarray:
    """Mean pressure in a closed box over rho c_s^2, less that at rest, while a sphere lies on its floor.

    It falls from a gap of d/2 at about 0.03 cells a step, nu = 0.02, and rests; once a d/c_s over 40 of them.
    """
    n, viscosity, ratio = diameter, 0.02, 2.0
    radius = n / 2
    shape = (width * n, width * n, height * n)
    flow = Simulation(shape, preset(viscosity), faces=dict.fromkeys("xyz", "no-slip"))
    ball = Spheres(
        [Sphere(radius, ratio, (shape[0] / 2 + 0.3, shape[1] / 2 + 0.17, n))],
        gravity=(0.0, 0.0, -(0.03**2) / n),
        film=film(radius, viscosity),
        contact=DryRebound(0.5, 2 / 3 * math.pi * radius**3, n, viscosity),
    )
    flow.add(ball)
    flow.run(round(8 * n / 0.03))
    fluid = ~inside(shape, ball.centres[0], radius)
    found = []
    for _ in range(40):
        flow.run(round(n * math.sqrt(3)))
        found.append((flow.density[fluid] - 1).mean())
    return np.array(found)
