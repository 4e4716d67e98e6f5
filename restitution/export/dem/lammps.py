"""LAMMPS, granular package: a constant e, which `coeff_restitution` delivers exactly while the contact may pull.

LAMMPS has no law of e that could be refitted, so level 1 is the constant that is best over a range, delivered by a
contact that does not pull (`limit_damping`): the e typed is the inverse of what such a contact makes of it.
"""

from __future__ import annotations

import numpy as np

from restitution.export.dashpot import End, dashpot, typed
from restitution.export.dem.snippet import (
    STEPS_A_CONTACT,
    Request,
    check_level,
    comments,
    constant_of,
    fastest,
    range_lines,
    stiffness_for,
)
from restitution.export.impacts import Impacts

VERSION = "22 Jul 2025, package GRANULAR"
AT_LARGEST_STEP = 0.008
"""Error of the e delivered at the largest step, hooke, e = 0.62."""
_STARTS_ABOVE = 10
"""Time steps before first contact that the spheres of a drop test are set free."""


def _contact(impacts: Impacts, request: Request) -> tuple[str, float, list[str]]:
    """The model as LAMMPS takes it, the time step in s, and what is to be said."""
    check_level(request, "lammps", 1)
    constant = constant_of(impacts, request)
    stiffness = stiffness_for(impacts, fastest(impacts, request))
    end, e = (End.FORCE, typed(constant.e)) if request.level == 1 else (End.OVERLAP, constant.e)
    contact = dashpot(constant.e, impacts.mass, stiffness=stiffness, end=end)
    step = contact.contact_time() / STEPS_A_CONTACT
    said = [
        *range_lines(impacts, constant),
        "the contact may pull at its end; e typed is e delivered"
        if request.level == 0
        else f"the contact does not pull (limit_damping): {e:.6g} is typed to have {constant.e:.6g} delivered "
        "(Schwager & Poeschel 2007)",
        f"stiffness for an overlap of 1 % of d at {fastest(impacts, request):.4g} m/s; yours may differ, e does "
        "not depend on it",
        f"time step at most contact time/{STEPS_A_CONTACT}; there e was measured {AT_LARGEST_STEP:g} too high, "
        "at a tenth of the step a tenth of that",
        "set diameter before density, or LAMMPS takes the mass of a sphere of 1 m",
    ]
    model = f"hooke {stiffness:.6g} {e:.9g} tangential linear_nohistory 0.0 0.0 damping coeff_restitution"
    return model + (" limit_damping" if request.level == 1 else ""), step, said


def lammps(impacts: Impacts, request: Request) -> str:
    """Commands for an input script in SI units."""
    model, step, said = _contact(impacts, request)
    text = comments(impacts, "LAMMPS", VERSION, said) + "\nunits           si\n"
    text += f"pair_style      granular\npair_coeff      * * {model}\n"
    return (
        text + f"fix             film all wall/gran granular {model} zplane 0.0 NULL\ntimestep        {step:.6g}\n"
    )


def lammps_drop_test(impacts: Impacts, request: Request, speeds: np.ndarray) -> str:
    """An input script that drops a sphere at each speed on a wall and prints the e delivered; no gravity."""
    model, step, said = _contact(impacts, request)
    sphere = impacts.conditions.sphere
    d, n = sphere.diameter, len(speeds)
    text = comments(impacts, "LAMMPS, drop test", VERSION, said)
    text += "\nunits           si\natom_style      sphere\natom_modify     map array\n"
    text += "boundary        f f f\ncomm_modify     vel yes\n"
    text += (
        f"region          box block 0 {2 * d * (n + 1):.9g} 0 {4 * d:.9g} 0 {20 * d:.9g}\ncreate_box      1 box\n"
    )
    for i, v in enumerate(speeds):
        height = d / 2 + _STARTS_ABOVE * step * v
        text += f"create_atoms    1 single {2 * d * (i + 1):.9g} {2 * d:.9g} {height:.12g}\n"
    text += f"set             type 1 diameter {d:.9g}\nset             type 1 density {sphere.density:.9g}\n"
    text += "".join(f"set             atom {i + 1} vz {-v:.12g}\n" for i, v in enumerate(speeds))
    text += f"pair_style      granular\npair_coeff      * * {model}\n"
    text += f"fix             film all wall/gran granular {model} zplane 0.0 NULL\n"
    text += f"fix             move all nve/sphere\ntimestep        {step / 10:.6g}\nthermo          0\n"
    text += f"run             {10 * (2 * STEPS_A_CONTACT + 3 * _STARTS_ABOVE)}\n"
    for i, v in enumerate(speeds):
        asked = float(impacts.restitution(impacts.stokes(v)))
        text += f"variable        e equal vz[{i + 1}]/{v:.12g}\n"
        text += f'print           "speed {v:.6g} m/s, law {asked:.6f}, delivered $(v_e)"\n'
    return text
