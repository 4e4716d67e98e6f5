"""Density and velocity fields, read from and written to the lattice."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from lbm.fluid.cache import inlined, kernel
from lbm.fluid.lattice import Lattice, incoming, lend, outgoing, row_starts
from lbm.fluid.memory import load_cell
from lbm.fluid.stencil import C, Q, W

__all__ = ["SUMS", "plane_sums", "read", "read_cell", "sent_density", "with_image", "write"]

SUMS = ("mass", "momentum_x", "momentum_y", "momentum_z", "kinetic_energy", "outside", "top_speed_squared")


@njit(forceinline=True)
def moments_of(f):
    """(rho - 1, j_x, j_y, j_z) of the 19 populations of a cell, without the half force."""
    r, xp, xm, yp, ym, zp, zm, ap, am, bp, bm, cp, cm, dp, dm, ep, em, gp, gm = f
    ap_am, bp_bm, cp_cm, dp_dm, ep_em, gp_gm = ap - am, bp - bm, cp - cm, dp - dm, ep - em, gp - gm
    rho = (
        r
        + ((xp + xm) + (yp + ym) + (zp + zm))
        + ((ap + am) + (bp + bm) + (cp + cm) + (dp + dm) + (ep + em) + (gp + gm))
    )
    jx = (xp - xm) + ((ap_am + bp_bm) + (cp_cm + dp_dm))
    jy = (yp - ym) + ((ap_am - bp_bm) + (ep_em + gp_gm))
    jz = (zp - zm) + ((cp_cm - dp_dm) + (ep_em - gp_gm))
    return rho, jx, jy, jz


@inlined
def sent_density(populations, grid, parity, x, y, z):
    """Density of the cell (x, y, z) after the last collision, of the populations that it has sent."""
    rho = 1.0
    for k in range(Q):
        rho += populations[outgoing(grid, parity, k, x, y, z)]
    return rho


@kernel
def _read(populations, grid, rows, parity, half_force, rho, u):
    for plane in prange(grid.nz):
        z = np.int64(plane)
        for y in range(grid.ny):
            starts = row_starts(grid, rows, parity, y, z)
            lend(populations, grid, rows, parity, y, z)
            for x in range(grid.nx):
                drho, jx, jy, jz = moments_of(load_cell(populations, starts, x))
                density = 1.0 + drho
                rho[z, y, x] = density
                u[0, z, y, x] = (jx + half_force[0]) / density
                u[1, z, y, x] = (jy + half_force[1]) / density
                u[2, z, y, x] = (jz + half_force[2]) / density


@kernel
def _sum_planes(populations, grid, rows, parity, half_force, low, high, top_speed, sums):
    # Each plane in float64 and in fixed order, so that the result does not depend on the threads.
    for plane in prange(grid.nz):
        z = np.int64(plane)
        mass = px = py = pz = energy = outside = top = 0.0
        for y in range(grid.ny):
            starts = row_starts(grid, rows, parity, y, z)
            lend(populations, grid, rows, parity, y, z)
            for x in range(grid.nx):
                drho, jx, jy, jz = moments_of(load_cell(populations, starts, x))
                rho = np.float64(drho) + 1.0
                qx, qy, qz = jx + half_force[0], jy + half_force[1], jz + half_force[2]
                qq = qx * qx + qy * qy + qz * qz
                mass += drho
                px += qx
                py += qy
                pz += qz
                energy += qq / (2.0 * rho)
                # written so that NaN counts as outside
                inside = low <= rho and rho <= high and qq <= top_speed * top_speed * rho * rho
                outside += 0.0 if inside else 1.0
                top = max(top, qq / (rho * rho))
        sums[z, 0], sums[z, 1], sums[z, 2], sums[z, 3] = mass, px, py, pz
        sums[z, 4], sums[z, 5], sums[z, 6] = energy, outside, top


def read(lattice: Lattice, force=None) -> tuple[np.ndarray, np.ndarray]:
    """Density, shape (nx, ny, nz), and velocity, shape (3, nx, ny, nz), in lattice units."""
    g = lattice.grid
    rho = np.empty((g.nz, g.ny, g.nx), lattice.dtype)
    u = np.empty((3, g.nz, g.ny, g.nx), lattice.dtype)
    _read(lattice.populations, g, lattice.rows, lattice.parity, half(force), rho, u)
    return rho.transpose(2, 1, 0), u.transpose(0, 3, 2, 1)


def with_image(field: np.ndarray, axis: int) -> np.ndarray:
    """A scalar (nx, ny, nz) or vector (3, nx, ny, nz) ``field`` behind its mirror image in the low face."""
    along = field.ndim - 3 + axis
    image = np.flip(field, along)
    if field.ndim == 4:
        image = image.copy()
        image[axis] *= -1
    return np.concatenate([image, field], along)


def plane_sums(lattice: Lattice, force=None, density=(0.0, np.inf), top_speed=np.inf) -> np.ndarray:
    """Per plane z the sums :data:`SUMS` of rho - 1, momentum, kinetic energy, and cells out of bounds.

    The last entry is no sum but the largest square of the speed in the plane.
    """
    sums = np.empty((lattice.grid.nz, len(SUMS)))
    low, high = float(density[0]), float(density[1])
    _sum_planes(
        lattice.populations,
        lattice.grid,
        lattice.rows,
        lattice.parity,
        half(force),
        low,
        high,
        float(top_speed),
        sums,
    )
    return sums


def half(force) -> np.ndarray:
    """Half the force density: what the populations' momentum lacks at a full step."""
    return np.zeros(3) if force is None else 0.5 * np.asarray(force, dtype=float)


def write(
    lattice: Lattice, rho: np.ndarray, u: np.ndarray, force, nu: float, periodic: tuple[bool, bool, bool]
) -> None:
    """Set populations of density ``rho`` (nx, ny, nz) and velocity ``u`` (3, nx, ny, nz), and parity 0.

    Equilibrium, less half the force, plus the first-order non-equilibrium of the gradients of u::

        f_k^neq = -3 w_k rho tau (c_a c_b - delta_ab/3) d_a u_b,   tau = 3 nu + 1/2

    (Skordos, Phys. Rev. E 48 (1993) 4823), with central differences.
    """
    gradient = np.array([_derivative(u, axis, periodic[axis]) for axis in range(3)])  # d_a u_b
    tau = 3 * nu + 0.5
    f = half(force)
    slots = lattice.slots()
    trace = (gradient[0, 0] + gradient[1, 1] + gradient[2, 2]) / 3
    uu = np.sum(u * u, axis=0)
    for k in range(Q):
        c = C[k].astype(float)
        cu = c[0] * u[0] + c[1] * u[1] + c[2] * u[2]
        stretch = -trace
        for a in range(3):
            for b in range(3):
                if c[a] * c[b] != 0:
                    stretch = stretch + c[a] * c[b] * gradient[a, b]
        pull = 3 * ((c @ f) - np.tensordot(f, u, axes=1)) + 9 * cu * (c @ f)
        slots[k] = (
            W[k] * ((rho - 1) + rho * (3 * cu + 4.5 * cu**2 - 1.5 * uu) - pull - 3 * tau * rho * stretch)
        ).transpose(2, 1, 0)
    lattice.parity = 0


def _derivative(u: np.ndarray, axis: int, periodic: bool) -> np.ndarray:
    along = axis + 1
    if periodic:
        return (np.roll(u, -1, along) - np.roll(u, 1, along)) / 2
    return np.gradient(u, axis=along)


@kernel(parallel=False)
def _gather(populations, grid, parity, x, y, z, f):
    for k in range(Q):
        f[k] = populations[incoming(grid, parity, k, x, y, z)]


def read_cell(
    lattice: Lattice, cell: tuple[int, int, int], force=None
) -> tuple[float, tuple[float, float, float]]:
    """Density and velocity of one cell."""
    f = np.empty(Q)
    _gather(lattice.populations, lattice.grid, lattice.parity, *cell, f)
    rho = 1.0 + float(f.sum())
    return rho, tuple(float(v) for v in (C.T @ f + half(force)) / rho)
