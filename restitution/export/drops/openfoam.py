"""Drop tests in OpenFOAM: parcels without any force in a box, level 0; its class of level 2 needs wmake."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.errors import Defect, InputError
from restitution.export.dem import Request
from restitution.export.dem.snippet import constant_of
from restitution.export.drops.deck import Deck, Installed, NotInstalledError, Program
from restitution.export.impacts import Impacts
from restitution.export.solvers import openfoam

_SOLVER, _MESHER = "icoUncoupledKinematicParcelFoam", "blockMesh"
_PROJECT = "/usr/share/openfoam"
"""Where Debian has what others find by their shell's set-up."""
_FALL = 0.01
"""s, from the start to the wall; as long again after it."""
_MARK = 1e-3
"""m/s: the speed along the wall by which a parcel is known again, times its number; it is not damped."""
_CLOUD = """solution
{{
    active true; coupled false; transient yes; cellValueSourceCorrection off; maxCo 0.3;
    interpolationSchemes {{ rho cell; U cellPoint; mu cell; }}
    integrationSchemes {{ U Euler; }}
}}
constantProperties {{ rho0 {density:.9g}; youngsModulus 1e9; poissonsRatio 0.3; }}
subModels
{{
    particleForces {{}}
    injectionModels
    {{
{injections}    }}
    dispersionModel none; heatTransferModel none; surfaceFilmModel none;
    stochasticCollisionModel none; collisionModel none;
{interaction}}}
cloudFunctions {{}}
"""
_INJECTION = """        m{i} {{ type manualInjection; massTotal 0; parcelBasisType fixed; nParticle 1; SOI 0;
            positionsFile "p{i}"; U0 ({mark:.9g} 0 {fall:.12g});
            sizeDistribution {{ type fixedValue; fixedValueDistribution {{ value {diameter:.9g}; }} }} }}
"""
_SHOW = """import re
speeds = {speeds!r}
text = open("{end:g}/lagrangian/kinematicCloud/U").read()
found = re.findall(r"\\(([-+.e0-9]+) ([-+.e0-9]+) ([-+.e0-9]+)\\)", text)
for x, y, z in sorted(found, key=lambda u: float(u[0])):
    v = speeds[round(float(x) / {mark:g}) - 1]
    print("drop", v, float(z) / v)
"""


def _file(kind: str, name: str, text: str) -> str:
    return f"FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n{text}"


def deck(impacts: Impacts, request: Request, speeds: NDArray) -> Deck:
    """A case with one parcel for each speed, which all meet the wall at one time."""
    if request.level != 0:
        raise InputError(Defect("of OpenFOAM level 0 can be run from here", field="--level"))
    fluid, sphere = impacts.conditions.fluid, impacts.conditions.sphere
    # The older library's part of the exported text, which is what the solver reads.
    exported = openfoam(impacts, request).partition("\n// newer")[0]
    interaction = "\n".join(line for line in exported.splitlines() if not line.startswith("//")) + "\n"
    size = 3 * _FALL * float(speeds.max())
    corners = " ".join(f"({x:.9g} {y:.9g} {z:.9g})" for z in (0, size) for x, y in _square(size))
    faces = "(0 3 2 1) (4 5 6 7) (0 1 5 4) (2 3 7 6) (0 4 7 3) (1 2 6 5)"
    injections = "".join(
        _INJECTION.format(i=i, mark=_MARK * (i + 1), fall=-v, diameter=sphere.diameter)
        for i, v in enumerate(speeds)
    )
    schemes = "".join(f"{k} {{ default none; }}\n" for k in ("ddtSchemes", "gradSchemes", "divSchemes"))
    schemes += "laplacianSchemes { default none; }\ninterpolationSchemes { default linear; }\n"
    wall_flow = "dimensions [0 1 -1 0 0 0 0];\ninternalField uniform (0 0 0);\n"
    nu = fluid.viscosity / fluid.density
    transport = f"rhoInf rhoInf [1 -3 0 0 0 0 0] {fluid.density:.9g};\ntransportModel Newtonian;\n"
    dictionaries = {
        "system/controlDict": f"startFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime {2 * _FALL:g};\n"
        f"deltaT {_FALL / 10:g};\nwriteControl timeStep;\nwriteInterval 20;\nwritePrecision 12;\n",
        "system/fvSchemes": schemes + "snGradSchemes { default none; }\n",
        "system/fvSolution": "",
        "system/blockMeshDict": f"scale 1;\nvertices ({corners});\n"
        "blocks (hex (0 1 2 3 4 5 6 7) (5 5 5) simpleGrading (1 1 1));\nedges ();\n"
        f"boundary (walls {{ type wall; faces ({faces}); }});\n",
        "constant/transportProperties": f"{transport}nu nu [0 2 -1 0 0 0 0] {nu:.9g};\n",
        "constant/turbulenceProperties": "simulationType laminar;\n",
        "constant/kinematicCloudProperties": _CLOUD.format(
            density=sphere.density, injections=injections, interaction=interaction
        ),
    }
    files = {name: _file("dictionary", name.partition("/")[2], text) for name, text in dictionaries.items()}
    files["constant/g"] = _file(
        "uniformDimensionedVectorField", "g", "dimensions [0 1 -2 0 0 0 0];\nvalue (0 0 0);\n"
    )
    files["0/U"] = _file("volVectorField", "U", f"{wall_flow}boundaryField {{ walls {{ type noSlip; }} }}\n")
    middle = size / 2
    for i, v in enumerate(speeds):
        place = f"(({middle:.9g} {middle:.9g} {_FALL * v:.12g}))\n"
        files[f"constant/p{i}"] = _file("vectorField", f"p{i}", place)
    shown = [float(f"{v:.12g}") for v in speeds]
    files["show.py"] = _SHOW.format(speeds=shown, end=2 * _FALL, mark=_MARK)
    return Deck("constant/kinematicCloudProperties", files)


def _square(size: float) -> tuple[tuple[float, float], ...]:
    return (0.0, 0.0), (size, 0.0), (size, size), (0.0, size)


def promised(impacts: Impacts, request: Request, St: NDArray) -> NDArray:
    """The constant."""
    return np.full(len(St), constant_of(impacts, request).e)


def find(level: int) -> Installed:
    """The solver of parcels alone and the mesher, in the path."""
    if shutil.which(_SOLVER) is None or shutil.which(_MESHER) is None:
        raise NotInstalledError("OpenFOAM is not installed: apt-get install openfoam on Debian")
    project = os.environ.get("WM_PROJECT_DIR", _PROJECT)
    environment = {"WM_PROJECT_DIR": project} if Path(project).is_dir() else {}
    help_text = subprocess.run(
        [_SOLVER, "-help"], env=os.environ | environment, capture_output=True, text=True, check=False
    ).stdout
    version = re.search(r"Using: OpenFOAM\W*(\w+)", help_text)
    name = version[1] if version else "unknown version"
    commands = [[_MESHER], [_SOLVER], [sys.executable, "show.py"]]
    return Installed(name, lambda deck: commands, environment)


OPENFOAM = Program("OpenFOAM", deck, promised, find, levels=(0,))
