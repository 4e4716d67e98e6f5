"""Spheres that move in the fluid: what happens to them after each step of the fluid.

1. The fluid's populations are reflected at the surfaces, which gives force and torque
  (:mod:`lbm.spheres.spheres.exchange`).
2. Each sphere moves (Crank-Nicolson), near a wall in sub-steps (:mod:`lbm.spheres.wall_motion`)::

       v' = v + F/m,  x' = x + (v + v')/2,  (I + I_f) (omega' - omega) = T + I_f (omega - omega_before)

   F with gravity and buoyancy; the fluid's force is its momentum exchange over the very step. I_f is the moment
   of inertia of the displaced fluid: the last two terms cancel for all but changes from step to step, which in
   fluid of low viscosity would otherwise grow, the fluid having no pressure to pass on a torque at once.
3. Cells that come free are filled; what momentum they and the covered ones have beyond that of the surface goes
   to the sphere, within the time of sound (:mod:`lbm.spheres.refill`).
4. What mass all this has brought into the fluid or out of it goes back (:mod:`lbm.spheres.mass`).

A sphere whose centre lies on a free-slip face is the whole one, of which the box holds a half or a quarter
(:mod:`lbm.spheres.symmetry`); masses, forces and tracks are those of the whole.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from lbm import arguments
from lbm.bodies.body import Body
from lbm.bodies.reflection import SCHEMES
from lbm.errors import InputError
from lbm.faces.records import FACES
from lbm.fluid.lattice import BOUNCE, PERIODIC, Lattice
from lbm.spheres.contact import Contact, Impact
from lbm.spheres.exchange import exchange
from lbm.spheres.film import Film
from lbm.spheres.mass import payback
from lbm.spheres.refill import crossing_time, refill
from lbm.spheres.runaway import stop_runaway
from lbm.spheres.sampling import sampled
from lbm.spheres.surface import REACH, Surfaces
from lbm.spheres.symmetry import mirrored_axes, of_whole, parts, refuse_asymmetric, refuse_asymmetric_spin
from lbm.spheres.wall_motion import FRACTION, away, gap_to, motion_at_wall, refuse_met
from lbm.spheres.within import refuse_lost, refuse_outside

Drive = Callable[[float, float], Sequence[float] | None]
COLUMNS = ("step", "gap", "x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz", "fx", "fy", "fz", "tx", "ty", "tz")
"""Columns of :meth:`Spheres.track`; f and t are force and torque of the fluid."""
_MOVING = ("centres", "velocities", "spins", "spin_changes", "forces", "torques", "surplus", "crossings")
_SMALLEST_RADIUS = 2.0
"""In cells: below, a sphere is not resolved."""
_STEPS = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)
"""Steps at which a description samples the drive."""
_GAPS = (0.0, 0.03, 0.1, 0.2, 0.4, 0.7, 0.9, 1.1, 1.5, 3.0)
"""Gaps in radii at which it does."""


@dataclass(frozen=True)
class Sphere:
    """Start of one sphere.

    Parameters
    ----------
    radius : in cells, at least 2.
    density : over the fluid's rest density.
    position : of the centre, (3,) in cells from the low corner of the box.
    velocity : (3,) in cells a step.
    spin : angular velocity, (3,) in radians a step.
    """

    radius: float
    density: float
    position: tuple[float, float, float]
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spin: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class SphereImpact(Impact):
    """An impact of sphere number ``sphere`` (from 0) at the wall ``face``, such as "z-"."""

    sphere: int = 0
    face: str = ""


class Spheres(Body):
    """Moving spheres for one :class:`lbm.Simulation`; lattice units. See the head of this module for the motion.

    Parameters
    ----------
    spheres : where and how they start, a :class:`Sphere` each.
    gravity : acceleration, (3,) in cells a step^2; buoyancy follows, the fluid itself is not accelerated.
    film : what a film thinner than a cell adds to the fluid's force at no-slip walls, a :class:`lbm.spheres.Film`.
    contact : what happens where a sphere touches such a wall, a record of :mod:`lbm.spheres.contact`; without one
        nothing stops the sphere: where its centre goes through a face the run is refused, as where spheres meet.
    drive : ``drive(step, gap)`` gives the velocity (3,) of all spheres at the end of that step, or None, which
        sets them free for good; ``gap`` in cells, to the nearest wall. Like all functions given here it depends on
        its arguments alone, for a checkpoint knows it by what it gives at some of them.
    interpolation : "linear" or "central-linear", a scheme of :mod:`lbm.bodies.reflection`.
    fraction : size of the sub-steps at a wall, in (0, 0.5] of gap over speed; see :mod:`lbm.spheres.wall_motion`.

    Attributes
    ----------
    radii, volumes, masses : (n,), of the n spheres.
    centres, velocities, spins : (n, 3), now.
    forces, torques : (n, 3), what the fluid did to them in the last step.
    crossings : (n, 2, 3), what cells that they covered and freed have still to give them of force and torque.
    surplus : (n,), mass that their surfaces have still to take back from the fluid (:mod:`lbm.spheres.mass`).
    impacts : list of :class:`SphereImpact`, as they came.

    Raises
    ------
    InputError
        For arguments that cannot be used; ``add`` raises it for spheres that the box cannot hold.
    """

    def __init__(
        self,
        spheres: Sequence[Sphere],
        *,
        gravity: Sequence[float] = (0.0, 0.0, 0.0),
        film: Film | None = None,
        contact: Contact | None = None,
        drive: Drive | None = None,
        interpolation: str = "linear",
        fraction: float = FRACTION,
    ):
        if interpolation not in SCHEMES:
            raise InputError(f"interpolation {interpolation!r} unknown; known: {', '.join(SCHEMES)}")
        spheres = arguments.several("spheres", spheres, Sphere)
        self.radii = np.array([arguments.positive("radius", s.radius) for s in spheres])
        if self.radii.min() < _SMALLEST_RADIUS:
            raise InputError(f"radius: at least {_SMALLEST_RADIUS:g} cells are needed to resolve a sphere")
        self.volumes = 4 / 3 * np.pi * self.radii**3
        self.masses = self.volumes * [arguments.positive("density", s.density) for s in spheres]
        self.centres = np.array([arguments.vector("position", s.position) for s in spheres])
        self.velocities = np.array([arguments.vector("velocity", s.velocity) for s in spheres])
        self.spins = np.array([arguments.vector("spin", s.spin) for s in spheres])
        arguments.speed("velocity of a sphere", self.velocities, axis=1)
        arguments.speed("surface of a sphere, spin x radius", self.spins * self.radii[:, None], axis=1)
        self.spin_changes = np.zeros_like(self.spins)
        self.gravity = arguments.vector("gravity", gravity).copy()
        self.film, self.contact, self.drive = film, contact, drive
        self.fraction = fraction
        self.scheme = SCHEMES[interpolation]
        self.forces, self.torques = np.zeros_like(self.centres), np.zeros_like(self.centres)
        self.surplus = np.zeros(len(spheres))
        self.crossings = np.zeros((len(spheres), 2, 3))
        self.impacts: list[SphereImpact] = []
        self._at_walls = {
            (s, face): motion_at_wall(film, contact, fraction) for s in range(len(spheres)) for face in range(6)
        }
        self._free = drive is None
        self._tracks: list[list[tuple[float, ...]]] = [[] for _ in spheres]
        self._sums = [np.zeros((2 * math.ceil(r + REACH) + 2, 7)) for r in self.radii]

    def take_film_and_contact(self, film: Film | None, contact: Contact | None, grid) -> None:
        """Go on with another film and contact at the walls of ``grid``, as if they had been there from the start.

        Raises :class:`InputError` where the present ones or the others may have acted in a step that was made.
        """
        others = {at: motion_at_wall(film, contact, self.fraction) for at in self._at_walls}
        for s, track in enumerate(self._tracks):
            refuse_met(s, self.radii[s], track, grid, self._at_walls, others)
        self.film, self.contact, self._at_walls = film, contact, others

    def track(self, sphere: int = 0) -> dict[str, np.ndarray]:
        """Motion of one sphere, a row a step.

        Returns
        -------
        dict
            By the names :data:`COLUMNS`, arrays (steps,); ``gap`` is that to the nearest wall, NaN without one.
        """
        rows = np.array(self._tracks[sphere]).reshape(-1, len(COLUMNS))
        return {name: rows[:, i].copy() for i, name in enumerate(COLUMNS)}

    def prepare(self, lattice: Lattice, step: int) -> None:
        """Refuse spheres that the box cannot hold, or holds no more; raises :class:`InputError`."""
        grid = lattice.grid
        if step > 0:
            refuse_lost(grid, self.centres, self.radii, step)
            return
        refuse_outside(grid, self.centres, self.radii)
        for s, centre in enumerate(self.centres):
            mirrors = mirrored_axes(grid, centre)
            refuse_asymmetric(mirrors, f"velocity of sphere {s}", self.velocities[s])
            refuse_asymmetric(mirrors, "gravity", self.gravity)
            refuse_asymmetric_spin(mirrors, f"spin of sphere {s}", self.spins[s])

    def reach(self, lattice: Lattice) -> np.ndarray:
        """The planes with links and refilled cells, their neighbours, and the neighbours of these."""
        n, periodic = lattice.grid.nz, lattice.grid.z_low == PERIODIC
        ends = zip(self.centres[:, 2] - self.radii - 3, self.centres[:, 2] + self.radii + 3, strict=True)
        planes = np.concatenate([np.arange(math.floor(low), math.ceil(high)) for low, high in ends])
        return planes % n if periodic else planes[(planes >= 0) & (planes < n)]

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        """Exchange momentum, move, refill."""
        grid, populations, parity = lattice.grid, lattice.populations, lattice.parity
        back = payback(self.surplus, self.radii)
        surfaces = Surfaces(self.centres, self.radii, self.velocities, self.spins, back)
        mirrors = [mirrored_axes(grid, centre) for centre in self.centres]
        for s, sums in enumerate(self._sums):
            exchange(populations, grid, parity, self.scheme, surfaces, s, sums)
            total = np.add.reduce(sums)
            due = self.crossings[s] / crossing_time(self.radii[s])
            self.crossings[s] -= due
            self.forces[s], self.torques[s] = of_whole(mirrors[s], total[:3], total[3:6]) + due
            self.surplus[s] += parts(mirrors[s]) * total[6]
        before = self.centres.copy()
        for s in range(len(self.radii)):
            self._move(s, float(step), grid)
        for s in range(len(self.radii)):
            sums = np.zeros(7)
            refill(populations, grid, parity, before, surfaces, s, sums)
            self.crossings[s] += of_whole(mirrors[s], sums[:3], sums[3:6])
            self.surplus[s] += parts(mirrors[s]) * sums[6]

    def _move(self, s: int, step: float, grid) -> None:
        walls = [f for f, kind in enumerate(grid.faces) if kind == BOUNCE]
        gaps = {f: gap_to(self.centres[s], self.radii[s], f, grid.shape) for f in walls}
        nearest = min(gaps.values(), default=math.inf)
        given = None if self._free or self.drive is None else self.drive(step + 1, nearest)
        v = self.velocities[s].copy()
        if given is not None:
            new = arguments.vector("drive", given)
            refuse_asymmetric(mirrored_axes(grid, self.centres[s]), "drive", new)
            stop_runaway(s, step, self.centres[s], self.radii[s], new, self.spins[s])
            self.centres[s] += 0.5 * (v + new)
        else:
            self._free = True
            new = self._free_motion(s, step, v, gaps)
        self.velocities[s] = new
        nearest = min((gap_to(self.centres[s], self.radii[s], f, grid.shape) for f in walls), default=math.nan)
        row = (step + 1, nearest, *self.centres[s], *new, *self.spins[s], *self.forces[s], *self.torques[s])
        self._tracks[s].append(tuple(float(x) for x in row))

    def _free_motion(self, s: int, step: float, v: np.ndarray, gaps: dict[int, float]) -> np.ndarray:
        """Moves sphere ``s`` from velocity ``v``; returns the new one."""
        mass, radius = self.masses[s], self.radii[s]
        weight = (mass - self.volumes[s]) * self.gravity
        force = self.forces[s].copy()
        torque = self.torques[s].copy()
        near = {f: gap for f, gap in gaps.items() if self._at_walls[s, f].matters(gap, away(f) * v[f // 2])}
        for f, gap in near.items():
            if self.film is not None:
                push, turn = self.film.along(gap, v, self.spins[s], away(f) * np.eye(3)[f // 2])
                force, torque = force + push, torque + turn
        new = v + (force + weight) / mass
        stop_runaway(s, step, self.centres[s], self.radii[s], new, self.spins[s])
        centre = self.centres[s] + 0.5 * (v + new)
        for f, gap in near.items():
            axis, sign = f // 2, away(f)
            after, speed, impacts = self._at_walls[s, f].step(
                step, gap, sign * v[axis], sign * force[axis], sign * weight[axis], mass
            )
            new[axis] = sign * speed
            centre[axis] = self.centres[s, axis] + sign * (after - gap)
            self.impacts += [
                SphereImpact(i.step, i.speed_in, i.speed_out, sphere=s, face=FACES[f]) for i in impacts
            ]
        self.centres[s] = centre
        shell = 0.4 * self.volumes[s] * radius**2
        self.spin_changes[s] = (torque + shell * self.spin_changes[s]) / (0.4 * mass * radius**2 + shell)
        self.spins[s] += self.spin_changes[s]
        stop_runaway(s, step, self.centres[s], self.radii[s], new, self.spins[s])
        return new

    def describe(self) -> dict:
        """Every number that decides the motion; functions by what they give at a few arguments."""
        return {
            "radii": self.radii.tolist(),
            "masses": self.masses.tolist(),
            "gravity": self.gravity.tolist(),
            "interpolation": self.scheme,
            "film": None if self.film is None else self.film.describe(),
            "contact": None if self.contact is None else self.contact.describe(),
            "drive": sampled(self.drive, [(step, r * self.radii[0]) for step in _STEPS for r in _GAPS]),
            "fraction": float(self.fraction),
        }

    def state(self) -> dict[str, np.ndarray]:
        """What changes in time."""
        return {
            **{name: getattr(self, name) for name in _MOVING},
            "at_walls": np.array([motion.numbers() for motion in self._at_walls.values()]),
            "impacts": np.array(
                [(i.step, i.speed_in, i.speed_out, i.sphere, FACES.index(i.face)) for i in self.impacts]
            ).reshape(-1, 5),
            "free": np.array([self._free]),
            "tracks": np.array(self._tracks),
        }

    def set_state(self, state: dict[str, np.ndarray]) -> None:
        """Continue from a :meth:`state`."""
        for name in _MOVING:
            getattr(self, name)[...] = state[name]
        for motion, numbers in zip(self._at_walls.values(), state["at_walls"], strict=True):
            motion.remember(numbers)
        self.impacts = [
            SphereImpact(float(step), float(speed_in), float(speed_out), int(sphere), FACES[int(face)])
            for step, speed_in, speed_out, sphere, face in state["impacts"]
        ]
        self._free = bool(state["free"][0])
        self._tracks = [[tuple(float(x) for x in row) for row in track] for track in state["tracks"]]
