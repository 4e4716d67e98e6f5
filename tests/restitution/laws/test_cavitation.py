"""The cavitating film against a quadrature of the pressure."""

import math

import pytest
from scipy.integrate import quad

from restitution import laws
from restitution.laws.cavitation import ATMOSPHERE, film_edge


@pytest.mark.parametrize("gap", [1e-7, 3e-6, 1.4e-5, 1.6e-5, 4e-5])
def test_force_is_the_integral_of_the_pressure_cut_at_the_tension(gap):
    mu, r, v = 0.01, 1.5e-3, 0.5

    def pressure(s):
        return min(3 * mu * r * v / (gap + s * s / (2 * r)) ** 2, ATMOSPHERE)

    bends = [math.sqrt(2 * r * max(r * film_edge(mu, v, r) - gap, 0.0))]
    inner = quad(lambda s: 2 * math.pi * s * pressure(s), 0, 1e-3, points=bends, epsabs=0, epsrel=1e-10, limit=400)
    outer = quad(lambda s: 2 * math.pi * s * pressure(s), 1e-3, math.inf, epsabs=0, epsrel=1e-10)
    force = inner[0] + outer[0]
    law = laws.get("cavitating_film")
    value = law(gap / r, film_edge(mu, v, r))
    assert 6 * math.pi * mu * r * v * value == pytest.approx(force, rel=1e-7)


def test_without_a_limit_of_tension_it_is_reynolds_film():
    law = laws.get("cavitating_film")
    assert law(1e-4, film_edge(0.01, 0.5, 1.5e-3, p_c=1e15)) == pytest.approx(1e4, rel=1e-12)
