"""What the texts for DEM codes share: which impacts, the constant and its range, stiffness, time step."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from restitution.errors import Defect, InputError
from restitution.export.dem.constant import Constant, best_constant, constant_at
from restitution.export.heading import comment_lines
from restitution.export.impacts import Impacts
from restitution.export.tables import pair_lines

OVERLAP = 0.01
"""Greatest overlap of an undamped contact, in diameters, that the stiffness is chosen for."""
E_AT_FIRST_CONTACT = '''
def _restitution(v, spheres):
    """e at first contact: v the normal speed of approach in m/s, spheres (d, rho) of one at a wall or of two."""
    if len(spheres) == 1:
        ((d, rho_p),) = spheres
        e = {wall}
    else:
        (d_1, rho_1), (d_2, rho_2) = spheres
        e = {pair}
    return max(e, {least!r})
'''
"""Python of level 2: e of a contact, for str.format with e at a ``wall``, of a ``pair``, and the ``least`` e."""
STEPS_A_CONTACT = 50
"""Time steps that a contact must last."""


@dataclass(frozen=True)
class Request:
    """What is asked of a DEM target: for level 0 the impact ``speed`` in m/s, for 1 Stokes numbers of the law."""

    level: int
    speed: float | None
    within: float
    stokes: tuple[float, float]


def constant_of(impacts: Impacts, request: Request) -> Constant:
    """Level 0: e at the speed asked for. Level 1: the constant that is best over the range of Stokes numbers."""
    if request.level == 1:
        return best_constant(impacts, *request.stokes)
    if request.speed is None:
        raise InputError(Defect("level 0 takes e at one impact speed: --speed V, in m/s", field="--speed"))
    return constant_at(impacts, request.speed, request.within)


def between_two(impacts: Impacts, request: Request) -> float:
    """Level 0: e of two spheres at the speed asked for; of a sphere at a wall, that of two of its like."""
    if impacts.conditions.partner is not None or request.speed is None:
        return constant_of(impacts, request).e
    two = impacts.conditions.model_copy(update={"partner": impacts.conditions.sphere})
    return constant_at(replace(impacts, conditions=two), request.speed, request.within).e


def check_level(request: Request, target: str, levels: tuple[int, ...]) -> None:
    """Refuse a level that a target has not."""
    if request.level not in levels:
        known = " and ".join(map(str, levels))
        raise InputError(Defect(f"{target} has level {known}", field="--level", value=str(request.level)))


def fastest(impacts: Impacts, request: Request) -> float:
    """The greatest impact speed that a text is for, m/s."""
    if request.level == 0 and request.speed is not None:
        return request.speed
    return request.stokes[1] / impacts.per_speed


def stiffness_for(impacts: Impacts, speed: float) -> float:
    """Of a linear spring, N/m: an impact at ``speed`` overlaps by :data:`OVERLAP` diameters."""
    return impacts.mass * (speed / (OVERLAP * impacts.conditions.sphere.diameter)) ** 2


def range_lines(impacts: Impacts, constant: Constant) -> list[str]:
    """Where the constant holds, in Stokes numbers and speeds."""
    low, high = constant.stokes
    v_low, v_high = low / impacts.per_speed, high / impacts.per_speed
    valid = impacts.closure.validity
    lines = [
        f"e_eff = {constant.e:.6g} holds within {constant.within:.3g} for {low:.4g} <= St <= {high:.4g} "
        f"({impacts.closure.convention}), that is impact speeds of {v_low:.4g} to {v_high:.4g} m/s"
    ]
    if low < valid[0] or high > valid[1]:
        lines.append(f"the law itself is stated for {valid[0]:g} <= St <= {valid[1]:g} only")
    return lines


def comments(impacts: Impacts, target: str, version: str, lines: list[str], sign: str = "#") -> str:
    """The heading of a text, and what is to be said of this target; indented lines are commands, kept whole."""
    pair = [*pair_lines(impacts.conditions), f"e_dry {impacts.e_dry:g}"]
    return comment_lines(impacts.closure, target, version, [*pair, *lines], sign)


def stokes_points(request: Request, n: int = 9) -> np.ndarray:
    """Stokes numbers across the range, for tables."""
    return np.geomspace(*request.stokes, n)
