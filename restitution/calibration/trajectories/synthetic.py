"""Records with known truth: what tests and the measurement of coverage fit to, and what one may try a set-up with.

A 3 mm steel sphere in oil falls steadily from 9 mm and bounces with the e of ``eq4_exponential``, K = 11, plus, if
wanted, a scatter from bounce to bounce. It is filmed every 2 ms until some time after its third bounce: with an
error of 10 um a frame, every twentieth frame missing, the zero of the gap and the scale of the image wrong by
0.005 d and 1 %, the clock starting anywhere, and, if wanted, correlated noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution import laws
from restitution.bounce import Closures, OwnWake, Release, bounce
from restitution.bounce.wake import STRENGTH, STRENGTH_SIGMA
from restitution.calibration.trajectories.correlated_noise import draw as draw_noise
from restitution.calibration.trajectories.flights import DRAG, DRAG_SIGMA, HISTORY, HISTORY_SIGMA
from restitution.calibration.trajectories.recordings import Recording, recording
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.stokes import StokesNumber
from restitution.tracks import Track

CONDITIONS = Conditions(
    fluid=Fluid(density=935.0, viscosity=0.010), sphere=Sphere(diameter=3e-3, density=7800.0, e_dry=0.97)
)
K = 11.0
SPEED = 0.58
"""Of the steady fall, m/s; every record has its own, within 2 %."""
GAP = 9e-3
"""Where the fall begins, m."""
BOUNCES = 3
INTERVAL = 2e-3
"""Between two frames, s."""
SIGMA = 1e-5
"""Error of a reading, m."""
MISSED = 0.05
"""Part of the frames that are missing."""
ZERO_D = 0.005
"""Standard deviation of the zero of the gap, in diameters."""
SCALE = 0.01
"""Relative standard deviation of the scale."""


@dataclass(frozen=True)
class Filming:
    """What the frames suffer from: correlated noise of ``sigma_u_d`` diameters over ``tau_s``; scatter of e.

    ``forces``: drag, history and wake are as far from those of the model as they are known, drawn anew each time.
    """

    name: str = "errors of reading alone"
    sigma_u_d: float = 0.0
    tau_s: float = 0.02
    scatter: float = 0.0
    wake: bool = False
    forces: bool = False


@dataclass(frozen=True)
class Truth:
    """What a record was made with; ``speed`` (m/s) is that at its first frame."""

    e: NDArray
    speed: float
    scale: float
    contact_s: float


def draw(filming: Filming, rng: np.random.Generator, conditions: Conditions = CONDITIONS) -> tuple[Track, Truth]:
    """One record and its truth."""
    d, law = conditions.sphere.diameter, laws.get("eq4_exponential", K=K)
    speed, own = SPEED * (1 + 0.02 * rng.standard_normal()), _forces(filming, rng)
    release, e = Release(GAP, speed, developed=True), []
    for _ in range(BOUNCES):  # each impact speed follows from the bounces before it
        path = bounce(conditions, release, Closures(measured=(*e, 0.5), **own), 1.0)
        St = StokesNumber.from_speed(path.impacts[len(e)].v_in, conditions)
        e.append(float(law(St, conditions.sphere.e_dry)) + filming.scatter * rng.standard_normal())
    path = bounce(conditions, release, Closures(measured=tuple(e), **own), 1.0)
    last = path.impacts[BOUNCES - 1].time_s
    own = np.arange(rng.uniform(0, INTERVAL), last + 0.6 * (path.impacts[BOUNCES].time_s - last), INTERVAL)
    own = own[rng.random(len(own)) > MISSED]
    scale, begin = 1 + SCALE * rng.standard_normal(), rng.uniform(-0.1, 0.1)
    gap = ZERO_D * d * rng.standard_normal() + scale * path.gap(own)
    gap += draw_noise(own, SIGMA, filming.sigma_u_d * d, filming.tau_s, rng)
    truth = Truth(np.array(e), -float(path.velocity(own[0])), scale, begin + path.impacts[0].time_s)
    return Track(begin + own, gap, "gap", SIGMA), truth


def _forces(filming: Filming, rng: np.random.Generator) -> dict[str, Any]:
    """Factors of drag and history, and the wake."""
    if not filming.forces:
        return {"wake": OwnWake() if filming.wake else None}
    away = np.clip(rng.standard_normal(3), -1.9, 1.9)  # a history force that pushes there is none
    strength = STRENGTH + STRENGTH_SIGMA * float(away[2])
    return {
        DRAG: 1 + DRAG_SIGMA * float(away[0]), HISTORY: 1 + HISTORY_SIGMA * float(away[1]),
        "wake": OwnWake(strength) if filming.wake else None,
    }  # fmt: skip


def filmed(track: Track, conditions: Conditions = CONDITIONS) -> Recording:
    """The record as a fit reads it."""
    return recording("synthetic", track, conditions)
