"""How fast a sphere is after falling from rest in a liquid: what speeds an experiment can reach.

    (m + m_a) dv/dt = (m - m_f) g - C_D(Re) pi d^2 rho_f v^2/8,    m_a = m_f/2,
    C_D = 24/Re (1 + 0.15 Re^0.687) below Re = 1000, 0.44 above  (Schiller & Naumann 1933),

m_f being the mass of the displaced liquid. History force and the wall's retardation are left out: the speed is
that far from the wall; it serves to choose an experiment, not to evaluate one.
"""

from __future__ import annotations

import math

import numpy as np

from restitution.conditions import Conditions


def fall_speed(conditions: Conditions, height: float) -> float:
    """Speed in m/s after a fall of ``height`` in m, steps of 1/400 of it in the energy form d(v^2)/dy."""
    fluid, sphere = conditions.fluid, conditions.sphere
    volume = math.pi * sphere.diameter**3 / 6
    inertia = volume * (sphere.density + 0.5 * fluid.density)
    weight = volume * (sphere.density - fluid.density) * conditions.gravity
    if weight <= 0:
        return 0.0

    def drag(v: float) -> float:
        Re = fluid.density * v * sphere.diameter / fluid.viscosity
        if Re <= 0:
            return 0.0
        C_D = 24 / Re * (1 + 0.15 * Re**0.687) if Re < 1000 else 0.44
        return C_D * math.pi * sphere.diameter**2 * fluid.density * v**2 / 8

    # Near the terminal speed the equation is stiff in y: no step goes beyond it.
    low, high = 0.0, 100.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if drag(middle) < weight else (low, middle)
    square, steps = 0.0, 400
    for _ in range(steps):
        v = math.sqrt(square)
        square = min(square + 2 * (weight - drag(v)) / inertia * height / steps, low**2)
    return float(np.sqrt(square))
