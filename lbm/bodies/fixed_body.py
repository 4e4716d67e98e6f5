"""A solid body inside the box: a sparse list of links that cross its surface, reflected after every step.

Linear interpolation of :mod:`lbm.bodies.reflection`, second order for curved and inclined surfaces. With p the
momentum that the body takes at a link, which meets its surface at r::

    F = sum p,      T = sum (r - r_0) x p

The bulk kernel runs over the solid cells as well; what it computes there never reaches the fluid.
"""

from __future__ import annotations

import hashlib

import numpy as np
from numba import prange

from lbm import arguments
from lbm.bodies.body import Body
from lbm.bodies.reflection import LINEAR, Link, exchange_link
from lbm.errors import InputError
from lbm.fluid.cache import kernel
from lbm.fluid.fields import sent_density
from lbm.fluid.lattice import PERIODIC, SLIP, Grid, Lattice
from lbm.fluid.stencil import C, Q

__all__ = ["FixedBody"]

_CHUNK = 512  # links summed by one thread, in order


class FixedBody(Body):
    """A body at rest or with a given velocity of its surface; put it into the fluid by ``Simulation.add``.

    Parameters
    ----------
    solid : boolean (nx, ny, nz), true where a cell centre lies inside.
    fraction : (19, nx, ny, nz), the fraction q in (0, 1] of each link that starts in a fluid cell and ends in
        a solid one, in the order of :data:`lbm.fluid.stencil.C` (others are not looked at); None for half-way.
    velocity : of the surface, 3 components in cells a step.
    origin : point about which ``torque`` is taken, 3 components in cells. Along periodic axes levers lead to the
        nearest image, so that a body may lie across such faces if ``origin`` lies in its middle.

    Attributes
    ----------
    force, torque : (3,), what the fluid did to the body in the last step, a mean over it, in lattice units.
        Pressure counts from that of the fluid at rest with density 1, as it must for a body that a wall cuts. A
        body force on the fluid does not act on the body.

    Raises
    ------
    InputError
        For arguments of wrong shape; ``add`` raises it for fractions out of range.

    Notes
    -----
    The body may touch the faces of the box: at a symmetry plane it meets its mirror image, and a link that
    crosses a wall, an inlet or an outlet belongs to that face. An outlet looks two cells inwards: keep the
    body that far from it. Density and velocity in solid cells mean nothing: leave them out of sums and pictures.
    """

    def __init__(
        self,
        solid: np.ndarray,
        fraction: np.ndarray | None = None,
        velocity=(0.0, 0.0, 0.0),
        origin=(0.0, 0.0, 0.0),
    ):
        self._solid = np.asarray(solid)
        if self._solid.ndim != 3 or self._solid.dtype.kind not in "biu" or self._solid.all():
            raise InputError(
                f"solid: {self._solid.dtype} of shape {self._solid.shape}; give booleans on 3 axes, and some fluid"
            )
        self._solid = self._solid.astype(bool)
        if not self._solid.any():
            raise InputError("solid: no cell is true; the body lies outside the box or between centres of cells")
        self.shape = self._solid.shape
        try:
            self._given = None if fraction is None else np.asarray(fraction, dtype=float)
        except (TypeError, ValueError):
            raise InputError(f"fraction = {arguments.shown(fraction)}: must be an array of numbers") from None
        if self._given is not None and self._given.shape != (Q, *self.shape):
            raise InputError(f"fraction: shape {self._given.shape} given, {(Q, *self.shape)} needed")
        self.velocity = arguments.vector("velocity of a body", velocity).copy()
        arguments.speed("velocity of a body", self.velocity, 0)
        self.origin = arguments.vector("origin of a body", origin).copy()
        self.force, self.torque = np.zeros(3), np.zeros(3)
        self._grid: Grid | None = None

    def prepare(self, lattice: Lattice, step: int) -> None:
        """Find the links when the body is added."""
        grid = lattice.grid
        if self._grid is None:
            if grid.shape != self.shape:
                raise InputError(f"body on a grid of {self.shape} in a simulation of {grid.shape} cells")
            self._find_links(grid)
            self._grid = grid
        elif grid != self._grid:
            raise InputError("body: belongs to a simulation with other faces or precision; make one for each")

    def _find_links(self, grid: Grid) -> None:
        padded = _with_surroundings(self._solid, grid)
        links, fractions = [], []
        for k in range(1, Q):
            cells = np.argwhere(~self._solid & _shifted(padded, C[k]))
            q = np.full(len(cells), 0.5) if self._given is None else self._given[k][tuple(cells.T)]
            if not ((q > 0) & (q <= 1)).all():
                at = tuple(cells[np.argmin((q > 0) & (q <= 1))].tolist())
                raise InputError(f"fraction: outside (0, 1] on the link along {tuple(C[k].tolist())} of cell {at}")
            # Without a fluid cell behind to interpolate from, the surface is taken half-way.
            behind_is_solid = _shifted(padded, -C[k])[tuple(cells.T)]
            fractions.append(np.where((q < 0.5) & behind_is_solid, 0.5, q))
            links.append(np.column_stack([cells, np.full(len(cells), k)]))
        self.links = np.concatenate(links).astype(np.int64)
        self.fraction = np.concatenate(fractions)
        self._levers = self.links[:, :3] + 0.5 + self.fraction[:, None] * C[self.links[:, 3]] - self.origin
        for axis, n in enumerate(grid.shape):
            if grid.faces[2 * axis] == PERIODIC:
                self._levers[:, axis] -= n * np.round(self._levers[:, axis] / n)
        self._sums = np.zeros((-(-len(self.links) // _CHUNK), 6))
        self._given = None  # the links hold what was used of it

    def __call__(self, lattice: Lattice, step: int, force) -> None:
        """Reflect the links and collect force and torque."""
        _reflect(
            lattice.populations, lattice.grid, lattice.parity, self.links, self.fraction, self.velocity,
            self._levers, self._sums,
        )  # fmt: skip
        total = self._sums.sum(axis=0)
        self.force, self.torque = total[:3], total[3:]

    def describe(self) -> dict:
        """Hash of links and fractions, the surface's velocity, the torque's origin."""
        if self._grid is None:
            raise InputError("body: its links are known once it is added to a simulation")
        surface = hashlib.sha256(self.links.tobytes() + self.fraction.tobytes()).hexdigest()[:16]
        return {"surface": surface, "velocity": self.velocity.tolist(), "origin": self.origin.tolist()}

    def state(self) -> dict[str, np.ndarray]:
        """Force and torque of the last step."""
        return {"force": self.force, "torque": self.torque}

    def set_state(self, state: dict[str, np.ndarray]) -> None:
        """Force and torque of the last step."""
        self.force, self.torque = state["force"], state["torque"]


def _with_surroundings(solid: np.ndarray, grid: Grid) -> np.ndarray:
    """``solid`` and one layer around it: what a link through a face ends in; beyond a wall, nothing."""
    for axis in range(3):
        kinds = grid.faces[2 * axis : 2 * axis + 2]
        first, last = solid.take([0], axis), solid.take([-1], axis)
        layers = [
            {PERIODIC: image, SLIP: mirror}.get(kind, np.zeros_like(mirror))
            for kind, image, mirror in zip(kinds, (last, first), (first, last), strict=True)
        ]
        solid = np.concatenate([layers[0], solid, layers[1]], axis)
    return solid


def _shifted(padded: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Value of ``padded`` at x + c for each cell x of the box."""
    return padded[tuple(slice(1 + d, n - 1 + d) for d, n in zip(c, padded.shape, strict=True))]


@kernel
def _reflect(populations, grid, parity, links, fraction, u, levers, sums):
    moves = u[0] != 0 or u[1] != 0 or u[2] != 0
    for chunk in prange(sums.shape[0]):
        fx = fy = fz = tx = ty = tz = 0.0
        first = np.int64(chunk) * _CHUNK
        for link in range(first, min(first + _CHUNK, links.shape[0])):
            x, y, z, k = links[link]
            rho = sent_density(populations, grid, parity, x, y, z) if moves else 0.0
            cut = Link(x, y, z, k, fraction[link])
            px, py, pz, _ = exchange_link(populations, grid, parity, LINEAR, cut, u, rho, False, 0.0)
            rx, ry, rz = levers[link]
            fx += px
            fy += py
            fz += pz
            tx += ry * pz - rz * py
            ty += rz * px - rx * pz
            tz += rx * py - ry * px
        sums[chunk, 0], sums[chunk, 1], sums[chunk, 2] = fx, fy, fz
        sums[chunk, 3], sums[chunk, 4], sums[chunk, 5] = tx, ty, tz
