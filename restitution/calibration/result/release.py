"""How fast a sphere is after falling from rest in a liquid: what speeds an experiment can reach.

    (m + m_f/2) v dv/dy = w - D(v),    w = (m - m_f) g,    D = C_D(Re) pi d^2 rho_f v^2/8,

m_f being the mass of the displaced liquid, so that the way y to a speed v is an integral over the speeds below it.
With v = v_t (1 - exp(-s)), v_t the terminal speed, its integrand stays finite up to v_t:

    y(s) = (m + m_f/2) int_0^s v v_t exp(-s')/(w - D(v)) ds'.

The drag is the standard curve (:mod:`restitution.laws.drag`). History force and the wall's retardation are left
out: the speed is that far from the wall; it serves to choose an experiment, not to evaluate one.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import cumulative_simpson

from restitution.conditions import Conditions
from restitution.laws.drag import STANDARD, steady

_NEAREST = 20.0
"""s of the greatest speed that is told from v_t: 1 - exp(-20) of it."""
_POINTS = 4001


def fall_speed(conditions: Conditions, height: float) -> float:
    """Speed in m/s after a fall of ``height`` in m; 0 for a sphere that does not sink."""
    fluid, sphere, drag = conditions.fluid, conditions.sphere, STANDARD()
    displaced = fluid.density * math.pi * sphere.diameter**3 / 6
    weight = (sphere.mass - displaced) * conditions.gravity
    if weight <= 0:
        return 0.0
    terminal = steady(drag, weight, sphere.diameter, fluid.density, fluid.viscosity)
    s = np.linspace(0.0, _NEAREST, _POINTS)[1:]
    v = -terminal * np.expm1(-s)
    C_D = drag(v * sphere.diameter * fluid.density / fluid.viscosity, out_of_range="ignore")
    resistance = C_D * math.pi * sphere.diameter**2 * fluid.density * v**2 / 8
    rate = (sphere.mass + displaced / 2) * v * terminal * np.exp(-s) / (weight - resistance)
    way = cumulative_simpson(np.append(0.0, rate), dx=s[0], initial=0.0)
    # v^2 is linear in y where the fall begins.
    return float(np.sqrt(np.interp(height, way, np.append(0.0, v**2))))
