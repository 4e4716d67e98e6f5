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
"""

from __future__ import annotations

from numba import njit


@njit(forceinline=True)
def central_linear(q, sent, sent_back, arrived, push):
    """``push`` is 6 w_k rho c_k.u_w."""
    return sent + ((1 - 2 * q) * (arrived - sent_back) - 2 * push) / (1 + 2 * q)


@njit(forceinline=True)
def linear(q, sent, sent_back, arrived, push):
    """``push`` is 6 w_k rho c_k.u_w."""
    if q < 0.5:
        return 2 * q * sent + (1 - 2 * q) * arrived - push
    return (sent + (2 * q - 1) * sent_back - push) / (2 * q)


CENTRAL_LINEAR, LINEAR = 0, 1
SCHEMES = {"central-linear": CENTRAL_LINEAR, "linear": LINEAR}
"""Schemes by name."""


@njit(forceinline=True)
def reflect(scheme, q, sent, sent_back, arrived, push):
    """The population that comes back, by one of :data:`SCHEMES`."""
    if scheme == CENTRAL_LINEAR:
        return central_linear(q, sent, sent_back, arrived, push)
    return linear(q, sent, sent_back, arrived, push)
