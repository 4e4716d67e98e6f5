"""What a surface sends back along a cut link: interpolated bounce-back for a moving wall, second order.

With q the fraction of the link from the fluid cell x along c_k to the surface, k' opposite to k, u_w the
surface's velocity there, rho the density at x; "sent" f*_k(x) and f*_k'(x) are the populations after the last
collision, "arrived" f_k(x) the one that comes to x from behind, be it from a cell or reflected by a wall, so
that the scheme also works where only one cell of fluid is left::

    central linear   f_k' = f*_k + (1 - 2q)/(1 + 2q) (f_k - f*_k') - 12 w_k rho c_k.u_w / (1 + 2q)

Ginzburg, Verhaeghe & d'Humieres, Commun. Comput. Phys. 3 (2008) 427: with two relaxation times the place of
the wall does not move with the viscosity::

    linear           f_k' = 2q f*_k + (1 - 2q) f_k - 6 w_k rho c_k.u_w                      q < 1/2
                     f_k' = (f*_k + (2q - 1) f*_k' - 6 w_k rho c_k.u_w) / (2q)              q >= 1/2

Bouzidi, Firdaouss & Lallemand, Phys. Fluids 13 (2001) 3452. Both are half-way bounce-back at q = 1/2.

The momentum that a body takes at the link is that of Wen, Zhang, Tu, Wang & Fang, J. Comput. Phys. 266 (2014) 161,
which does not depend on the frame::

    p = (c_k - u_w) f*_k - (c_k' - u_w) f_k'

of the deviations from rest: a body that touches a wall is not pressed against it by the fluid at rest.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lbm.fluid.cache import inlined
from lbm.fluid.lattice import incoming, outgoing
from lbm.fluid.stencil import OPPOSITE, C, W


@inlined
def central_linear(q, sent, sent_back, arrived, push):
    """``push`` is 6 w_k rho c_k.u_w."""
    return sent + ((1 - 2 * q) * (arrived - sent_back) - 2 * push) / (1 + 2 * q)


@inlined
def linear(q, sent, sent_back, arrived, push):
    """``push`` is 6 w_k rho c_k.u_w."""
    if q < 0.5:
        return 2 * q * sent + (1 - 2 * q) * arrived - push
    return (sent + (2 * q - 1) * sent_back - push) / (2 * q)


CENTRAL_LINEAR, LINEAR = 0, 1
SCHEMES = {"central-linear": CENTRAL_LINEAR, "linear": LINEAR}
"""Schemes by name."""


@inlined
def reflect(scheme, q, sent, sent_back, arrived, push):
    """The population that comes back, by one of :data:`SCHEMES`."""
    if scheme == CENTRAL_LINEAR:
        return central_linear(q, sent, sent_back, arrived, push)
    return linear(q, sent, sent_back, arrived, push)


class Link(NamedTuple):
    """The link of the fluid cell (x, y, z) along c_k, cut by the surface at the fraction q of its length."""

    x: int
    y: int
    z: int
    k: int
    q: float


@inlined
def exchange_link(populations, grid, parity, scheme, link, u, rho, solid_behind, payback):
    """Reflect a :class:`Link`; the momentum that the body takes there, 3 components, and the mass the fluid gains.

    ``u`` is the surface's velocity where the link meets it, ``rho`` the density of the cell, which counts only
    if the surface moves. With ``solid_behind`` nothing arrives from behind: the surface is taken half-way.
    ``payback`` comes back besides.
    """
    x, y, z, k, q = link
    back = OPPOSITE[k]
    sent = np.float64(populations[outgoing(grid, parity, k, x, y, z)])
    sent_back = np.float64(populations[outgoing(grid, parity, back, x, y, z)])
    arrived = np.float64(populations[incoming(grid, parity, k, x, y, z)])
    if solid_behind:
        q, arrived = 0.5, sent_back
    push = 6 * W[k] * rho * (C[k, 0] * u[0] + C[k, 1] * u[1] + C[k, 2] * u[2])
    value = reflect(scheme, q, sent, sent_back, arrived, push) + payback
    populations[incoming(grid, parity, back, x, y, z)] = value
    both, lost = sent + value, sent - value
    return C[k, 0] * both - u[0] * lost, C[k, 1] * both - u[1] * lost, C[k, 2] * both - u[2] * lost, -lost
