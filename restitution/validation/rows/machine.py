"""What no result may depend on, and the speed: threads, a restart, the memory's roofline."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from numba import get_num_threads

from lbm.problems.roofline import share_of_roofline
from restitution.runs.resolved import ResolvedRun
from restitution.validation.row import Depth, Kind, NotEvaluatedError, Row, Values, at_least, at_most
from restitution.validation.rows.contact import short

_CASE, _CONTACT = "gondret_st152_10", {"mode": "dry"}
_OWNER = "restart"


def _to(run: ResolvedRun, blocks: int) -> np.ndarray:
    """Position, velocity, spin and the populations' sums after so many more blocks of steps."""
    for _ in range(blocks):
        if not run.finished:
            run.advance()
    slots = run.simulation.lattice.slots().astype(float)
    state = [
        *run.spheres.centres[0],
        *run.spheres.velocities[0],
        *run.spheres.spins[0],
        slots.sum(),
        (slots**2).sum(),
    ]
    return np.array(state)


def restart(blocks: int) -> Values:
    """Greatest difference between a run and one that was stopped amid a rebound, written and taken up."""
    case = short(_CASE, _CONTACT)
    whole, first, second = (ResolvedRun(case) for _ in range(3))
    _to(first, blocks)
    with tempfile.TemporaryDirectory() as place:
        first.save(Path(place) / "state.h5", _OWNER, {})
        second.restore(Path(place) / "state.h5", _OWNER)
    reached = _to(second, blocks)
    return {"difference": float(np.abs(_to(whole, 2 * blocks) - reached).max())}


_STATE = """import json, sys
from restitution.validation.rows.machine import state
json.dump(state(int(sys.argv[1])), sys.stdout)
"""


def state(blocks: int) -> list[float]:
    """Where the short case is after some blocks of steps."""
    return [float(x) for x in _to(ResolvedRun(short(_CASE, _CONTACT)), blocks)]


def threads(blocks: int) -> Values:
    """Greatest difference between one thread and two, in processes of their own."""
    found = []
    for count in ("1", "2"):
        environment = os.environ | {"NUMBA_NUM_THREADS": count}
        command = [sys.executable, "-c", _STATE, str(blocks)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if done.returncode:
            raise NotEvaluatedError(f"a process with {count} threads failed: {done.stderr.splitlines()[-1:]}")
        found.append(json.loads(done.stdout))
    return {"difference": float(np.abs(np.subtract(*found)).max())}


ENOUGH = 0.35
"""Share of the roofline that a kernel which is not vectorised never has."""
_ATTEMPTS = 5
_OWN = 0.9
"""Of the cores that the threads ask for: with less, other work has the rest, and the share says nothing."""


def speed(cells: int, rounds: int) -> Values:
    """Share of the memory's roofline, the best of some attempts: other work can only lower it."""
    best, threads = 0.0, get_num_threads()
    for _ in range(_ATTEMPTS):
        clock, processor = time.perf_counter(), time.process_time()
        best = max(best, share_of_roofline(cells, rounds))
        had = (time.process_time() - processor) / (time.perf_counter() - clock) / threads
        if best >= ENOUGH:
            break
    else:
        if had < _OWN or os.getloadavg()[0] > 1.5 * threads:
            raise NotEvaluatedError(f"the machine is busy with other work (share {best:.2f} of {_ATTEMPTS} tries)")
    return {"of roofline": best}


ROWS = (
    Row(
        "restart", "difference of a run that was stopped amid a rebound and taken up", Kind.ANALYTICAL,
        "the same numbers, bit for bit", (at_most("difference", 0.0),), "none", restart, {"blocks": 12},
    ),
    Row(
        "threads", "difference between one thread and two", Kind.ANALYTICAL, "the same numbers, bit for bit",
        (at_most("difference", 0.0),), "none", threads, {"blocks": 8},
    ),
    Row(
        "speed", "cell updates over those that the memory could feed, 96^3 cells, float64, two steps a sweep",
        Kind.REGRESSION, "in-place read and write of the same populations, in the same run",
        (at_least("of roofline", ENOUGH),),
        "0.65 to 1.2 was measured on idle machines, 0.2 to 0.5 on busy ones (the best of five tries counts); a "
        "kernel that is not vectorised has 0.1 to 0.3",
        speed, {"cells": 96, "rounds": 9}, Depth.QUICK,
    ),
)  # fmt: skip
