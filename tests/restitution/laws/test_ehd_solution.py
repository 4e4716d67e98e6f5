"""The EHD equations: kernel against Hertz, film against the rigid limit, rebound against the table."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from restitution.laws.ehd_solution import compliance, nodes, rebound
from restitution.laws.elastohydrodynamic import NODES_E, NODES_ST


def hertz(r: np.ndarray, c: float) -> np.ndarray:
    """Deflection by p = sqrt(c^2 - r^2), r < c: Johnson, Contact Mechanics (1985), section 3.4."""
    outside = np.maximum(r, c)
    u = ((2 * c**2 - r**2) * np.arcsin(c / outside) + c * np.sqrt(outside**2 - c**2)) / np.pi
    return np.where(r < c, c**2 - r**2 / 2, u)


def test_the_kernel_gives_the_deflection_of_the_hertz_contact():
    """Hertz pressures of all radii k < c, each times 3 k, add up to the smoother p = (c^2 - r^2)^(3/2).

    p linear between the nodes: second order, but for the root in p'' at c, which keeps it above 3/2.
    """
    c, shared = 0.9, nodes(50)[:45:4]
    exact = [quad(lambda k, r=r: 3 * k * hertz(r, k), 0, c, points=[min(r, c)], limit=200)[0] for r in shared]
    errors = []
    for n in (50, 100, 200):
        r = nodes(n)
        u = compliance(r) @ np.maximum(c**2 - r**2, 0.0) ** 1.5
        errors.append(np.abs(u[np.searchsorted(r, shared - 1e-9)] - exact).max())
    assert errors[-1] < 1e-4 * exact[0]
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 1.5)


@pytest.mark.parametrize("St", [10.0, 100.0])
def test_a_stiff_sphere_slows_down_as_the_rigid_one(St):
    """V = V0 [1 - ln(D0/D)/St] from D0 = 1 to D = 0.1: the error falls as the second power of the spacing."""
    exact = -(1 - np.log(10.0) / St)
    errors = [abs(rebound(St, n, D_end=0.1, softness=1e-6, rtol=1e-8).V - exact) for n in (50, 100)]
    assert errors[1] < 1e-2 / St
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.25)


def test_the_rebound_converges_at_second_order():
    coarse, middle, fine = (rebound(50.0, n).V for n in (30, 60, 120))
    assert np.log2((coarse - middle) / (middle - fine)) == pytest.approx(2.0, abs=0.1)


def test_the_table_is_the_solution():
    """Within 5e-4 and the correction the two grids give."""
    coarse, fine = (np.array([rebound(St, n).V for St in NODES_ST]) for n in (50, 100))
    correction = (fine - coarse) / 3
    assert np.all(np.abs(fine + correction - np.asarray(NODES_E)) <= 5e-4 + np.abs(correction))
