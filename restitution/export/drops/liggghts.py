"""Drop tests in LIGGGHTS; level 2 needs its headers and an MPI compiler beside it."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.export.dashpot import dashpot
from restitution.export.dem import Request, liggghts
from restitution.export.dem.liggghts import refitted
from restitution.export.dem.liggghts_law import HEADERS, STYLE_FILES, compile_command, style_file, style_of
from restitution.export.dem.snippet import constant_of, fastest, stiffness_for
from restitution.export.dem.viscous_contact import delivered
from restitution.export.drops.deck import ABOVE, CONTACTS, STEPS, Deck, Installed, NotInstalledError, Program
from restitution.export.impacts import Impacts

_POISSON = 0.3
_YOUNG = (5e6, 1e9)
"""Pa; the program refuses less, and more unless told otherwise."""
_SOURCE, _LIBRARY = "normal_model.h", "./normal_model.so"


def stiffness_of(young: float, impacts: Impacts, characteristic: float) -> float:
    """N/m of a hooke contact with a wall of the same material, as the program's manual has it."""
    root = (impacts.conditions.sphere.diameter / 2) ** 0.5
    effective = young / (2 * (1 - _POISSON**2))
    slope = 15 * impacts.mass * characteristic**2 / (16 * root * effective)
    return 16 / 15 * root * effective * slope**0.2


def _material(impacts: Impacts, request: Request) -> tuple[float, float]:
    """Young's modulus in Pa that the overlap of the fastest impact is small with, and the contact's stiffness."""
    speed = fastest(impacts, request)
    wanted = stiffness_for(impacts, speed)
    # The stiffness grows as the modulus to the 4/5.
    young = float(np.clip((wanted / stiffness_of(1.0, impacts, speed)) ** 1.25, *_YOUNG))
    return young, stiffness_of(young, impacts, speed)


def deck(impacts: Impacts, request: Request, speeds: NDArray) -> Deck:
    """No gravity: each sphere meets the wall at its speed."""
    exported = liggghts(impacts, request)
    files = {}
    if request.level == 2:
        model = f"model {style_of(impacts)}"
        files = {_SOURCE: exported, "style_contact_model.h": ""}
        files |= {f"style_{kind}_model.h": style_file(kind) for kind in STYLE_FILES}
        exported = "".join(f"# {line[3:]}\n" for line in exported.splitlines() if line.startswith("// "))
        exported += "fix             e all property/global coefficientRestitution peratomtypepair 1 0.5\n"
        speed = fastest(impacts, request)
        exported += f"fix             v all property/global characteristicVelocity scalar {speed:.6g}\n"
        exported += f"pair_style      gran {model}\npair_coeff      * *\n"
        exported += f"fix             film all wall/gran {model} primitive type 1 zplane 0.0\n"
    young, stiffness = _material(impacts, request)
    step = dashpot(1.0, impacts.mass, stiffness=stiffness).contact_time() / STEPS
    sphere = impacts.conditions.sphere
    d, n = sphere.diameter, len(speeds)
    text = "units           si\natom_style      granular\natom_modify     map array\nboundary        f f f\n"
    text += "newton          off\ncommunicate     single vel yes\n"
    text += f"region          box block 0 {2 * d * (n + 1):.9g} 0 {4 * d:.9g} 0 {20 * d:.9g} units box\n"
    text += f"create_box      1 box\nneighbor        {d / 3:.6g} bin\nneigh_modify    delay 0\n"
    text += f"fix             Y all property/global youngsModulus peratomtype {young:.6g}\n"
    text += f"fix             nu all property/global poissonsRatio peratomtype {_POISSON:g}\n"
    text += exported
    for i, v in enumerate(speeds):
        height = d / 2 + ABOVE * step * v
        text += f"create_atoms    1 single {2 * d * (i + 1):.9g} {2 * d:.9g} {height:.12g} units box\n"
    text += f"set             group all diameter {d:.9g} density {sphere.density:.9g}\n"
    for i, v in enumerate(speeds):
        text += f"group           sphere{i + 1} id {i + 1}\n"
        text += f"velocity        sphere{i + 1} set 0 0 {-v:.12g} units box\n"
        text += f"variable        e{i + 1} equal vz[{i + 1}]/{v:.12g}\n"
    text += f"fix             move all nve/sphere\ntimestep        {step:.6g}\n"
    text += f"run             {int(CONTACTS * STEPS) + ABOVE}\n"
    text += "".join(f'print           "drop {v:.12g} ${{e{i + 1}}}"\n' for i, v in enumerate(speeds))
    return Deck("in.drop", {"in.drop": text, **files})


def promised(impacts: Impacts, request: Request, St: NDArray) -> NDArray:
    """A constant, what the refitted contact gives, or the law."""
    if request.level == 0:
        return np.full(len(St), constant_of(impacts, request).e)
    if request.level == 1:
        inputs, ratio = refitted(impacts, request)
        return delivered(np.asarray(St) * ratio, inputs.critical, inputs.most)
    return impacts.restitution(St)


def find(level: int) -> Installed:
    """`liggghts` in the path."""
    program = shutil.which("liggghts")
    if program is None:
        raise NotInstalledError("LIGGGHTS is not installed: apt-get install liggghts on Debian")
    run = [program, "-in", "in.drop", "-log", "none"]
    # told to write no log, for it would lie where the user stands
    said = subprocess.run([program, "-log", "none", "-h"], capture_output=True, text=True, check=False).stdout
    version = re.search(r"PUBLIC \S+", said)
    # Open MPI would start a daemon, and load the library there too.
    alone = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1"}
    name = version[0].rstrip(",") if version else "unknown version"
    if level < 2:
        return Installed(name, lambda deck: [run], alone)
    if not (Path(HEADERS) / "granular_styles.h").exists() or shutil.which("mpicxx") is None:
        raise NotInstalledError(
            "level 2 of LIGGGHTS needs its headers and an MPI compiler: apt-get install libliggghts-dev "
            "libopenmpi-dev on Debian"
        )
    with_model = ["env", f"LD_PRELOAD={_LIBRARY}", *run]
    return Installed(name, lambda deck: [compile_command(_SOURCE, _LIBRARY), with_model], alone)


LIGGGHTS = Program("LIGGGHTS", deck, promised, find)
