"""LIGGGHTS PUBLIC, also in CFDEMcoupling: a constant e, or its Legendre-like hooke contact with refitted inputs.

`viscous on` takes the Stokes number of the instantaneous speed, so Legendre's constants typed in do not give his
law (:mod:`.viscous_contact`). Level 1 are the inputs with which it comes nearest to ours, and what it misses by;
level 2 is :mod:`.liggghts_law`.
"""

from __future__ import annotations

from restitution.errors import Defect, InputError
from restitution.export.dem.liggghts_law import liggghts_law
from restitution.export.dem.snippet import (
    STEPS_A_CONTACT,
    Request,
    between_two,
    comments,
    constant_of,
    fastest,
    range_lines,
    stokes_points,
)
from restitution.export.dem.viscous_contact import Refit, delivered, refit, refit_points
from restitution.export.impacts import Impacts, stokes_per_speed

VERSION = "PUBLIC 3.8.0"
LEAST = 0.05
"""e must be greater, or the program stops."""


def liggghts(impacts: Impacts, request: Request) -> str:
    """Commands for an input script in SI units; of level 2 the C++ source of a normal model."""
    if request.level == 2:
        return liggghts_law(impacts, request, VERSION)
    return _constant(impacts, request) if request.level == 0 else _refitted(impacts, request)


def _constant(impacts: Impacts, request: Request) -> str:
    constant = constant_of(impacts, request)
    if not LEAST < constant.e <= 1:
        rule = f"LIGGGHTS takes {LEAST:g} < e <= 1; the law gives {constant.e:.3g} at {request.speed:g} m/s"
        raise InputError(Defect(rule, field="--speed"))
    said = [
        *range_lines(impacts, constant),
        "the contact may pull at its end (no limitForce): e typed is e delivered",
        _other_contacts(impacts, request),
        *_step(),
    ]
    text = comments(impacts, "LIGGGHTS", VERSION, said)
    text += f"\nfix             e all property/global coefficientRestitution peratomtypepair 1 {constant.e:.9g}\n"
    text += f"fix             v all property/global characteristicVelocity scalar {request.speed:.6g}\n"
    text += "pair_style      gran model hooke\npair_coeff      * *\n"
    if impacts.conditions.partner is not None:
        return text
    return text + "fix             film all wall/gran model hooke primitive type 1 zplane 0.0\n"


def _other_contacts(impacts: Impacts, request: Request) -> str:
    """A type has one e, for walls and for spheres: whom it is for."""
    if impacts.conditions.partner is not None:
        return "for these spheres alone: a wall is to have its own type, with the e of an export of --sphere alone"
    return (
        "for walls: spheres of the same type get it too, where the law gives two of them "
        f"{between_two(impacts, request):.6g} at that relative speed, of twice the St. Where they meet, the wall "
        "is to have its own type, and the spheres the e of an export with a partner in --conditions"
    )


def refitted(impacts: Impacts, request: Request) -> tuple[Refit, float]:
    """The inputs of `viscous on`, and the code's own Stokes number, st_b, over that of the law."""
    ratio = stokes_per_speed("st_b", impacts.conditions) / impacts.per_speed
    points = refit_points(*request.stokes)
    return refit(points * ratio, impacts.restitution(points)), ratio


def _refitted(impacts: Impacts, request: Request) -> str:
    inputs, ratio = refitted(impacts, request)
    low, high = request.stokes
    shown = stokes_points(request)
    asked, given = impacts.restitution(shown), delivered(shown * ratio, inputs.critical, inputs.most)
    said = [
        f"e delivered is within {inputs.deviation:.3f} of the law for {low:g} <= St <= {high:g} "
        f"({impacts.closure.convention}), worst at St = {inputs.worst / ratio:.4g}",
        *(f"St {St:8.4g}: asked {a:.3f}, delivered {g:.3f}" for St, a, g in zip(shown, asked, given, strict=True)),
        "CriticalStokes and MaximumRestitution are fitted inputs, not the law's constants: the code evaluates its "
        "law at the instantaneous speed",
        "limitForce on belongs to them. They stand for the whole viscous loss: no lubrication model beside them",
        "for contacts of spheres the code takes its own reduced mass and radius",
        *_step(),
    ]
    mu = impacts.conditions.fluid.viscosity
    text = comments(impacts, "LIGGGHTS", VERSION, said)
    text += f"\nfix             e all property/global coefficientRestitution peratomtypepair 1 {inputs.most:.6g}\n"
    for key, value in (
        ("FluidViscosity", mu),
        ("CriticalStokes", inputs.critical),
        ("MaximumRestitution", inputs.most),
    ):
        text += f"fix             {key} all property/global {key} peratomtypepair 1 {value:.6g}\n"
    text += (
        f"fix             v all property/global characteristicVelocity scalar {fastest(impacts, request):.6g}\n"
    )
    model = "model hooke"
    text += f"pair_style      gran {model} viscous on limitForce on\npair_coeff      * *\n"
    return (
        text + f"fix             film all wall/gran {model} primitive type 1 zplane 0.0 viscous on limitForce on\n"
    )


def _step() -> list[str]:
    return [
        "written for one atom type: other types take the same number for each pair of a kind",
        f"time step at most contact time/{STEPS_A_CONTACT}; youngsModulus and poissonsRatio are yours, e does not "
        "depend on them",
    ]
