"""Drop tests in YADE: the exported lines with spheres, a wall and the engines."""

from __future__ import annotations

import re
import shutil
import subprocess

import numpy as np
from numpy.typing import NDArray

from restitution.export.dashpot import dashpot
from restitution.export.dem import Request, yade
from restitution.export.dem.snippet import constant_of, fastest, stiffness_for
from restitution.export.dem.yade import YOUNG, law_of_yade, refitted, share
from restitution.export.drops.deck import ABOVE, CONTACTS, STEPS, Deck, Installed, NotInstalledError, Program
from restitution.export.impacts import Impacts

_DROP = """

O.bodies.append(utils.wall(0, axis=2, material=film))
speeds = {speeds!r}
O.dt = {step:.6g}
for i, v in enumerate(speeds):
    place = ({apart:.9g} * i, 0, {radius:.9g} + {above} * O.dt * v)
    ball = utils.sphere(place, {radius:.9g}, material=film)
    ball.state.vel = Vector3(0, 0, -v)
    O.bodies.append(ball)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
    contacts,{damping}
    NewtonIntegrator(damping=0, gravity=(0, 0, 0)),
]
O.run({steps}, True)
for i, v in enumerate(speeds):
    print("drop", v, O.bodies[i + 1].state.vel[2] / v, flush=True)
"""


def deck(impacts: Impacts, request: Request, speeds: NDArray) -> Deck:
    """No gravity: each sphere meets the wall at its speed."""
    d = impacts.conditions.sphere.diameter
    # Level 1 takes its stiffness from Young's modulus, of the order of this.
    stiffness = YOUNG * d if request.level == 1 else stiffness_for(impacts, fastest(impacts, request))
    step = dashpot(1.0, impacts.mass, stiffness=stiffness).contact_time() / STEPS
    text = yade(impacts, request) + _DROP.format(
        speeds=[float(f"{v:.12g}") for v in speeds],
        step=step,
        apart=2 * d,
        radius=d / 2,
        above=ABOVE,
        damping="\n    damping," if request.level == 2 else "",
        steps=int((4 if request.level == 1 else 1) * CONTACTS * STEPS) + ABOVE,
    )
    return Deck("drop.py", {"drop.py": text})


def promised(impacts: Impacts, request: Request, St: NDArray) -> NDArray:
    """A constant, what the refitted law of the program gives, or the law."""
    if request.level == 0:
        return np.full(len(St), constant_of(impacts, request).e)
    if request.level == 1:
        en, loss, _, ratio = refitted(impacts, request)
        return law_of_yade(np.asarray(St) * ratio, en, loss, share(impacts))
    return impacts.restitution(St)


def find(level: int) -> Installed:
    """`yade` in the path; every level runs in it."""
    program = shutil.which("yade")
    if program is None:
        raise NotInstalledError("YADE is not installed: apt-get install yade on Debian")
    said = subprocess.run([program, "--version"], capture_output=True, text=True, check=False)
    version = re.search(r"[Vv]ersion:? (\S+)", said.stdout + said.stderr)
    run = [program, "-n", "-x", "-j1"]
    return Installed(version[1] if version else "unknown version", lambda deck: [[*run, deck.main]])


YADE = Program("YADE", deck, promised, find)
