"""Elastohydrodynamic rebound of a smooth sphere, solved from its equations: where the tabulated e(St) comes from.

Scales: gap D* = [m v^2/(E* sqrt(a))]^(2/5), radius sqrt(a D*), time D*/v, speed v, pressure
(2/pi) E* sqrt(D*/a); a sphere radius, m mass, v approach speed, 1/E* = sum (1 - nu_i^2)/E_i.

    gap          h = D + r^2/2 + u
    half-space   u(r) = (8/pi^2) int_0^inf K(k^2) r'/(r + r') p(r') dr',   k^2 = 4 r r'/(r + r')^2
    film         dh/dt = St (1/r) d_r(r h^3 d_r p),   St = m v/(6 pi mu a^2)
    sphere       dD/dt = V,   dV/dt = 4 int_0^inf p r dr

The kernel is the point force 1/(pi E* |x - x'|) integrated over the angle, (4/(pi E*)) K r'/(r + r') with K the
complete elliptic integral of the parameter k^2; the scales turn 4/(pi E*) into 8/pi^2. Two exact results fix every
factor. Hertz: p = sqrt(c^2 - r^2) gives u = c^2 - r^2/2 in r < c, so h = 0 for D = -c^2. Rigid: u = 0 gives
p = -V/(4 St h^2), so dV/dt = -V/(St D). The sphere starts at D = 1 with V = -1 and this rigid pressure, as if it
came from further out; e is V when D = 1 again. D is the distance of the undeformed surfaces.

Space: finite volumes for the film, p linear between the nodes for the half-space, nodes dense in r < 1, where the
film has its neck, and p ~ 1/h^2 beyond the last one. Time: with p = A^-1 u the film is a stiff ODE for u, which
SciPy's BDF integrates (implicit, order and step adapted to the error).

Source: Davis, Serayssol & Hinch, J. Fluid Mech. 163, 479 (1986); in these variables Bertin, J. Fluid Mech. (2024),
arXiv:2308.10754. The table is in :mod:`restitution.laws.elastohydrodynamic`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipkm1


def nodes(n: int, R: float = 20.0, core: float = 1.5) -> np.ndarray:
    """n + 1 radii from 0 to R (n,), about core/n apart in r < 1."""
    x = np.linspace(0.0, 1.0, n + 1)
    return core * x + (R - core) * x**10


def compliance(r: np.ndarray) -> np.ndarray:
    """A with u = A p at the nodes r, p linear between them and zero beyond the last.

    Gauss-Legendre in each interval; where the kernel has its logarithm at an end, the points crowd there as t^4.
    """
    t, weight = np.polynomial.legendre.leggauss(12)
    t, weight = (t + 1) / 2, weight / 2
    A = np.zeros((r.size, r.size))
    for i, ri in enumerate(r):
        x, w = np.tile(t, (r.size - 1, 1)), np.tile(weight, (r.size - 1, 1))
        if i < r.size - 1:
            x[i], w[i] = t**4, weight * 4 * t**3
        if i > 0:
            x[i - 1], w[i - 1] = 1 - t**4, weight * 4 * t**3
        step = np.diff(r)[:, None]
        s = r[:-1, None] + step * x
        w = 8 / np.pi**2 * w * step * ellipkm1(((s - ri) / (s + ri)) ** 2) * s / (s + ri)
        A[i, :-1] += (w * (1 - x)).sum(1)
        A[i, 1:] += (w * x).sum(1)
    return A


@cache
def _grid(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The nodes, their compliance and its inverse."""
    A = compliance(nodes(n))
    return nodes(n), A, np.linalg.inv(A)


@dataclass(frozen=True)
class Rebound:
    """V where the flight ends and the least gap h until then, both dimensionless."""

    V: float
    film: float


def rebound(St: float, n: int = 200, D_end: float = 1.0, softness: float = 1.0, rtol: float = 1e-6) -> Rebound:
    """From D = 1, V = -1 out to D_end >= 1 after the reversal, or in to D_end < 1, on n intervals.

    `softness` scales the compliance: small is nearly rigid. RuntimeError if D_end is not reached by t = 100.
    """
    r, A, inverse = _grid(n)
    C = inverse / softness  # p = C u
    face, step = (r[1:] + r[:-1]) / 2, np.diff(r)
    area = np.diff(np.concatenate(([0.0], face, r[-1:])) ** 2) / 2
    weight = np.zeros_like(r)  # of int p r dr, p linear
    weight[:-1] += step * (2 * r[:-1] + r[1:]) / 6
    weight[1:] += step * (r[:-1] + 2 * r[1:]) / 6
    mean = (np.eye(n, n + 1) + np.eye(n, n + 1, 1)) / 2

    def film(y: np.ndarray) -> tuple[np.ndarray, ...]:
        """h and p at the nodes; at the faces, gap and slope of p."""
        h, p = y[-2] + r**2 / 2 + y[:-2], C @ y[:-2]
        return h, p, (h[1:] + h[:-1]) / 2, np.diff(p) / step

    def divergence(flux: np.ndarray) -> np.ndarray:
        return St * (np.diff(flux, axis=0, prepend=0 * flux[:1]).T / area).T

    # Beyond the last node p ~ 1/h^2: there d_r p = -2 r p/h, and the rest of int p r dr is p h.
    def rate(_t: float, y: np.ndarray) -> np.ndarray:
        h, p, gap, slope = film(y)
        flux = np.append(face * gap**3 * slope, -2 * (r[-1] * h[-1]) ** 2 * p[-1])
        force = 4 * (weight @ p + p[-1] * h[-1])
        return np.concatenate((divergence(flux) - y[-1], [y[-1], force]))

    def jacobian(_t: float, y: np.ndarray) -> np.ndarray:
        h, p, gap, slope = film(y)
        # h = h(u, D): the part through h is the same for u and D; the part through p is for u alone.
        flux_h = np.vstack(((3 * face * gap**2 * slope)[:, None] * mean, np.zeros(n + 1)))
        flux_h[-1, -1] = -4 * r[-1] ** 2 * h[-1] * p[-1]
        flux_u = np.vstack(
            ((face * gap**3 / step)[:, None] * np.diff(C, axis=0), -2 * (r[-1] * h[-1]) ** 2 * C[-1])
        )
        J = np.zeros((n + 3, n + 3))
        J[:-2, :-2], J[:-2, -2], J[:-2, -1] = divergence(flux_u + flux_h), divergence(flux_h.sum(1)), -1.0
        J[-2, -1] = 1.0
        J[-1, :-2] = 4 * (weight @ C + h[-1] * C[-1])
        J[-1, -3:-1] += 4 * p[-1]
        return J

    def arrived(_t: float, y: np.ndarray) -> float:
        return y[-2] - D_end

    arrived.terminal = True  # type: ignore[attr-defined]  # scipy reads these of a function
    arrived.direction = 1 if D_end >= 1 else -1  # type: ignore[attr-defined]
    start = np.concatenate((softness * A @ (1 / (4 * St * (1 + r**2 / 2) ** 2)), [1.0, -1.0]))
    flight = solve_ivp(rate, (0.0, 100.0), start, "BDF", events=arrived, jac=jacobian, rtol=rtol, atol=rtol / 100)
    if flight.status != 1:
        raise RuntimeError(f"St = {St}, n = {n}: D = {D_end} not reached: {flight.message}")
    least = (flight.y[-2] + r[:, None] ** 2 / 2 + flight.y[:-2]).min()
    return Rebound(float(flight.y_events[0][0, -1]), float(least))
