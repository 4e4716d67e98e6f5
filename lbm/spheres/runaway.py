"""A sphere that runs away is stopped in the step in which it does: its sub-steps at a wall would have no end."""

from __future__ import annotations

import math

import numpy as np

from lbm.errors import DivergenceError

TOP_SPEED = 1.0
"""Of a surface, in cells a step: beyond, it passes cells between two reflections."""


def stop_runaway(
    sphere: int, step: float, centre: np.ndarray, radius: float, velocity: np.ndarray, spin: np.ndarray
) -> None:
    """Raise :class:`DivergenceError` where the surface of a sphere is too fast, or its speed no number."""
    speed = math.hypot(*velocity) + float(radius) * math.hypot(*spin)
    if not speed <= TOP_SPEED:
        i, j, k = (math.floor(x) for x in centre)
        hint = f" (allowed: up to {TOP_SPEED:g} cell a step); take more cells, or a lower lattice speed"
        raise DivergenceError(round(step) + 1, (i, j, k), f"speed of the surface of sphere {sphere}", speed, hint)
