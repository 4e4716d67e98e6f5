"""What must be conserved: momentum exchanged with a held sphere, the balance of a free one, of its spin."""

from __future__ import annotations

import numpy as np

from lbm.problems.spheres import STILL, inside
from lbm.rates import Rates
from lbm.simulation import Simulation
from lbm.spheres.spheres import Sphere, Spheres

RATES = Rates.two_relaxation_times(0.1)
_RADIUS = 3.31
"""No round number of cells: the surface cuts links at all places."""
GRAVITY = (1e-5, 2e-5, -1e-4)
_AXES = tuple("xyz")


def unbalanced_exchange(steps: int = 101) -> float:
    """Momentum that a sphere held in a stream takes, less what the fluid loses, over what it takes."""
    centre = (8.1, 8.3, 7.9)
    flow = Simulation((16, 16, 16), RATES)
    flow.set_flow(velocity=(0.02, -0.01, 0.005))
    ball = Spheres([Sphere(_RADIUS, 3.0, centre)], drive=lambda step, gap: STILL)
    flow.add(ball)
    fluid = ~inside(flow.shape, centre, _RADIUS)
    flow.run(1)
    before, begun = _momentum(flow, fluid), len(ball.track()["step"])
    flow.run(steps)
    taken = np.array([ball.track()[f"f{axis}"][begun:].sum() for axis in _AXES])
    return float(np.abs(_momentum(flow, fluid) - before + taken).max() / np.abs(taken).max())


def _momentum(flow: Simulation, fluid: np.ndarray) -> np.ndarray:
    rho, u = flow.fields()
    return (rho * u)[:, fluid].astype(float).sum(axis=1)


def falling(steps: int = 200, ratio: float = 3.0) -> tuple[Simulation, Spheres]:
    """A sphere let fall obliquely, turning, in a periodic box without walls, after ``steps``."""
    flow = Simulation((20, 20, 20), RATES)
    start = Sphere(_RADIUS, ratio, (10.2, 10.1, 9.7), spin=(0.0, 0.0, 0.002))
    ball = Spheres([start], gravity=GRAVITY)
    flow.add(ball)
    flow.run(steps)
    return flow, ball


def unbalanced_motion(ratio: float = 3.0) -> dict[str, float]:
    """How far a falling sphere is from its equations of motion, each over its largest term.

    ``velocity``: m (v' - v) = F + (m - m_f) g, step by step; ``spin``: the sum of the torques is what the sphere
    has gained, I (w - w_0), and I_f times the last change, with I = 2/5 m a^2 and I_f that of the displaced fluid.
    Masses are those of the solid sphere, 4/3 pi a^3 times the density, none is asked of the program.
    """
    _, ball = falling(ratio=ratio)
    track, displaced = ball.track(), 4 / 3 * np.pi * _RADIUS**3
    mass = ratio * displaced
    v = np.stack([track[f"v{axis}"] for axis in _AXES], axis=1)
    force = np.stack([track[f"f{axis}"] for axis in _AXES], axis=1)
    weight = (mass - displaced) * np.array(GRAVITY)
    rest = mass * np.diff(v, axis=0) - force[1:] - weight
    inertia = 0.4 * _RADIUS**2
    w, torque = track["wz"], track["tz"]
    gained = mass * inertia * (w[-1] - 0.002) + displaced * inertia * (w[-1] - w[-2])
    return {
        "velocity": float(np.abs(rest).max() / np.abs(weight).max()),
        "spin": float(abs(gained - torque.sum()) / abs(torque.sum())),
    }


def gained_of_weight(steps: int = 200, ratio: float = 3.0) -> float:
    """Momentum of fluid and falling sphere together, over what its weight less buoyancy gives in that time."""
    flow, ball = falling(steps, ratio)
    displaced = 4 / 3 * np.pi * _RADIUS**3
    total = _momentum(flow, ~inside(flow.shape, ball.centres[0], _RADIUS))
    total += ratio * displaced * ball.velocities[0]
    weight = steps * (ratio - 1) * displaced * np.array(GRAVITY)
    return float(total @ weight / (weight @ weight))


def unbalanced_crossing(velocity=(0.05, 0.02, -0.01), viscosity: float = 0.004, ways: float = 2.0) -> float:
    """Momentum that fluid gains from a sphere moved steadily, less what the sphere loses, over that.

    At low viscosity, where cells beside the surface do not move with it; after one diameter, for ``ways`` more.
    """
    flow = Simulation((24, 24, 24), Rates.quiet(viscosity))
    start = Sphere(_RADIUS, 1.0, (8.1, 8.3, 7.9), velocity=velocity)
    ball = Spheres([start], drive=lambda step, gap: velocity)
    flow.add(ball)
    count = round(2 * _RADIUS / float(np.linalg.norm(velocity)))

    def momentum() -> np.ndarray:
        return _momentum(flow, ~inside(flow.shape, ball.centres[0], _RADIUS))

    flow.run(count)
    before = momentum() - ball.crossings[0, 0]
    flow.run(round(ways * count))
    gained = momentum() - ball.crossings[0, 0] - before
    lost = -np.array([ball.track()[f"f{axis}"][count:].sum() for axis in _AXES])
    return float(np.linalg.norm(gained - lost) / np.linalg.norm(lost))
