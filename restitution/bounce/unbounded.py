r"""The forces of the point particle without a wall, held against references that no closure here was fitted to.

- Steady drag: what Roos & Willmarth (1971) measured of towed spheres, law by law (:func:`drag_errors`).
- Drag, added mass and history together: a sphere that oscillates, u = U sin(w t), at Re = U d/nu = 40 and
  w d/U = 3.2, computed by Schneiders et al. (2013) (:func:`oscillation_errors`). Added to the drag at the present
  speed, the history force is :mod:`restitution.bounce.history`'s, its lagged velocities being those of the
  periodic motion,

      v - Z_j = U w [w sin(w t) + lambda_j cos(w t)]/(w^2 + lambda_j^2).

  Forces are coefficients F/(rho U^2/2 pi d^2/4). That in phase with u is what a steady stream would resist with,
  and with du/dt what the fluid's inertia does; potential flow's added mass is 2/3 w d/U = 2.133 of the latter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution import datasets, laws
from restitution.bounce import history
from restitution.bounce.closures import Closures
from restitution.bounce.forces import drag_table
from restitution.bounce.tables import look
from restitution.laws.drag import DragLaw
from restitution.laws.history import FiniteReynolds, HistoryLaw

MEASURED_DRAG, OSCILLATING = "roos_willmarth1971", "schneiders2013_oscillating"
RE_OSCILLATING, FREQUENCY = 40.0, 3.2
"""Re = U d/nu and w d/U of the oscillating sphere."""
REYNOLDS = (5.0, 1000.0)
"""Range of Re in which drag laws are scored: that of rebounds with a history force to speak of."""
_HARMONICS = 5
"""Odd and even, up to which the reference is resolved: its points scatter by 0.01."""
PHASES = np.arange(720) / 720
"""Of a period, evenly."""


@dataclass(frozen=True)
class DragError:
    """C_D of a law over the measured one, less 1: mean and root mean square over ``points``."""

    law: str
    points: int
    bias: float
    rms: float


@dataclass(frozen=True)
class OscillationError:
    """Amplitudes in phase with u and with du/dt; rms of C_D(t) less the reference's over the latter's amplitude.

    ``history`` is None where no history force acts.
    """

    history: str | None
    drag: str
    in_velocity: float
    in_acceleration: float
    rms: float


def measured_drag(low: float = REYNOLDS[0], high: float = REYNOLDS[1]) -> tuple[NDArray, NDArray]:
    """Re and C_D of the towed spheres with ``low`` <= Re <= ``high``."""
    table = datasets.load(MEASURED_DRAG)
    Re, C_D = table.reynolds.to_numpy(), table.drag_coefficient.to_numpy()
    within = (Re >= low) & (Re <= high)
    return Re[within], C_D[within]


def drag_errors(low: float = REYNOLDS[0], high: float = REYNOLDS[1]) -> list[DragError]:
    """Every drag law against the towed spheres with ``low`` <= Re <= ``high``."""
    Re, C_D = measured_drag(low, high)
    errors = []
    for name in laws.names("drag"):
        away = laws.get(name)(Re, out_of_range="ignore") / C_D - 1
        errors.append(DragError(name, len(Re), float(away.mean()), float(np.sqrt(np.mean(away**2)))))
    return errors


def reference_oscillation() -> tuple[NDArray, NDArray]:
    """t/T, and the force of the sphere on the fluid as a coefficient: positive where it is along du/dt."""
    table = datasets.load(OSCILLATING)
    return table.time_over_period.to_numpy(), -table.drag_coefficient.to_numpy()


def oscillation(
    drag: DragLaw | None, memory: HistoryLaw | None, phase: NDArray, Re: float, frequency: float
) -> NDArray:
    """The coefficient at ``phase`` = t/T; ``Re`` = U d/nu, ``frequency`` = w d/U; either law may be left out."""
    U, omega = Re / 2, frequency * Re / 4  # with r = nu = rho = 1
    angle = 2 * math.pi * np.asarray(phase, float)
    v, dv = U * np.sin(angle), U * omega * np.cos(angle)
    now = np.maximum(2 * np.abs(v), 1e-9)
    force = 2 / 3 * math.pi * dv
    if drag is not None:
        force = force + 6 * math.pi * look(drag_table(drag), now) * v
    if memory is not None:
        terms = history.modes(1.0, 1.0, slowest=1e-5 * omega, fastest=1e8 * omega)
        rates = terms.rates[:, None]
        lag = U * omega * (omega * np.sin(angle) + rates * np.cos(angle)) / (omega**2 + rates**2)
        share = np.full_like(lag, history.BASSET)
        if isinstance(memory, FiniteReynolds):
            share = history.shape(np.log(rates * memory.crossover(now)), memory.c_1)
        kept = (terms.weights[:, None] * share * lag).sum(axis=0)
        force = force + 6 * math.pi * (kept + history.BASSET * terms.tail * dv)
    return force / (math.pi * U**2 / 2)


def amplitudes(phase: NDArray, force: NDArray) -> tuple[float, float]:
    """The first harmonic of ``force`` in phase with u and with du/dt, by least squares with the higher ones."""
    angle = 2 * math.pi * np.asarray(phase)
    columns = [np.ones_like(angle)]
    for k in range(1, _HARMONICS + 1):
        columns += [np.sin(k * angle), np.cos(k * angle)]
    found = np.linalg.lstsq(np.column_stack(columns), force, rcond=None)[0]
    return float(found[1]), float(found[2])


def oscillation_errors(drag: DragLaw | None = None) -> list[OscillationError]:
    """No history and every history law, each added to ``drag`` (by default that of :class:`Closures`)."""
    drag = Closures().drag if drag is None else drag
    flow = RE_OSCILLATING, FREQUENCY
    phase, force = reference_oscillation()
    height = math.hypot(*amplitudes(phase, force))
    errors = []
    for memory in (None, *map(laws.get, laws.names("history"))):
        away = oscillation(drag, memory, phase, *flow) - force
        name = None if memory is None else memory.name
        both = amplitudes(PHASES, oscillation(drag, memory, PHASES, *flow))
        errors.append(OscillationError(name, drag.name, *both, float(np.sqrt(np.mean(away**2)) / height)))
    return errors
