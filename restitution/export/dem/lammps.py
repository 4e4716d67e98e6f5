"""LAMMPS, granular package: a constant e, which `coeff_restitution` delivers exactly while the contact may pull.

LAMMPS has no law of e that could be refitted, so level 1 is the constant that is best over a range, delivered by a
contact that does not pull (`limit_damping`): the e typed is the inverse of what such a contact makes of it. Level
2 is :mod:`.lammps_law`.
"""

from __future__ import annotations

from restitution.export.dashpot import End, dashpot, typed
from restitution.export.dem.lammps_law import lammps_law
from restitution.export.dem.snippet import (
    STEPS_A_CONTACT,
    Request,
    between_two,
    comments,
    constant_of,
    fastest,
    range_lines,
    stiffness_for,
)
from restitution.export.impacts import Impacts

VERSION = "22 Jul 2025, package GRANULAR"
AT_LARGEST_STEP = 0.008
"""Error of the e delivered at the largest step, hooke: 0.008 too high at e = 0.62, 0.002 too low at 0.77."""


def contact(impacts: Impacts, request: Request) -> tuple[str, float, list[str]]:
    """The model as LAMMPS takes it, the time step in s, and what is to be said."""
    constant = constant_of(impacts, request)
    stiffness = stiffness_for(impacts, fastest(impacts, request))
    end, e = (End.FORCE, typed(constant.e)) if request.level == 1 else (End.OVERLAP, constant.e)
    step = dashpot(constant.e, impacts.mass, stiffness=stiffness, end=end).contact_time() / STEPS_A_CONTACT
    said = [
        *range_lines(impacts, constant),
        "the contact may pull at its end; e typed is e delivered"
        if request.level == 0
        else f"the contact does not pull (limit_damping): {e:.6g} is typed to have {constant.e:.6g} delivered "
        "(Schwager & Poeschel 2007)",
        f"stiffness for an overlap of 1 % of d at {fastest(impacts, request):.4g} m/s; yours may differ, e does "
        "not depend on it",
        f"time step at most contact time/{STEPS_A_CONTACT}; there e was measured up to {AT_LARGEST_STEP:g} off, "
        "at a tenth of the step a tenth of that",
        "set diameter before density, or LAMMPS takes the mass of a sphere of 1 m",
    ]
    return _model(stiffness, e, request), step, said


def _model(stiffness: float, e: float, request: Request) -> str:
    model = f"hooke {stiffness:.6g} {e:.9g} tangential linear_nohistory 0.0 0.0 damping coeff_restitution"
    return model + (" limit_damping" if request.level == 1 else "")


def _pairs(impacts: Impacts, request: Request, at_wall: str) -> tuple[str, list[str]]:
    """What contacts of two spheres are given, and what is to be said; the constant of level 1 serves any St."""
    if impacts.conditions.partner is not None:
        return at_wall, ["for these spheres alone, no walls: export theirs with --sphere alone"]
    if request.level == 1:
        return at_wall, []
    e = between_two(impacts, request)
    said = f"pair_coeff is for two of these spheres at that relative speed, of twice the St: e_eff = {e:.6g}"
    return _model(stiffness_for(impacts, fastest(impacts, request)), e, request), [said]


def lammps(impacts: Impacts, request: Request) -> str:
    """Commands for an input script in SI units; of level 2 a Python script."""
    if request.level == 2:
        return lammps_law(impacts, request, VERSION)
    model, step, said = contact(impacts, request)
    pair, of_pairs = _pairs(impacts, request, model)
    said += [*of_pairs, "units si belongs to the head of your input, the rest behind its box"]
    text = comments(impacts, "LAMMPS", VERSION, said) + "\nunits           si\n"
    text += f"pair_style      granular\npair_coeff      * * {pair}\n"
    if impacts.conditions.partner is None:
        text += f"fix             film all wall/gran granular {model} zplane 0.0 NULL\n"
    return text + f"timestep        {step:.6g}\n"
