"""YADE: a constant e, or its own lubrication law of the impact with refitted inputs.

Its ViscEl contact does not pull, so a constant e is typed as the inverse of what that makes of it. At a wall, a
facet or a fixed sphere it takes half the sphere's mass, so that the damping ratio is 1/sqrt(2) of the one meant:
with 0.7 typed it was measured to deliver 0.718 between two spheres and 0.788 at a wall. With
`lubrication=True` the contact takes, at its first step,

    e = en [1 - ln(d/(2 roughness))/St_d],   St_d = rho_p v d/mu, without the 9,

so en and `roughnessScale` are fitted to the law over a range; being linear in 1/St it misses a law that is
exponential in it by much where St is small. Where `tc` and `en` are given `lubrication` is silently ignored.
Level 2 is :mod:`.yade_law`.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from restitution.export.dashpot import End, damping_ratio, dashpot, restitution, typed
from restitution.export.dem.snippet import (
    STEPS_A_CONTACT,
    Request,
    comments,
    constant_of,
    fastest,
    range_lines,
    stiffness_for,
    stokes_points,
)
from restitution.export.dem.yade_law import yade_law
from restitution.export.impacts import Impacts

VERSION = "2023.02a"
SHARE_AT_A_WALL = 1 / math.sqrt(2)
"""Of the damping ratio that is meant, at a body that does not move."""
YOUNG = 5e7
"""Pa, of level 1: the user's to change."""
OWN_LAW = 0.01
"""By how much the program's e was measured to differ from what is said of it: 0.008 at most."""
_RATIOS = np.geomspace(1e-6, 1e4, 4000)
"""Damping ratios that what becomes of e at a wall is tabulated at."""


def yade(impacts: Impacts, request: Request) -> str:
    """Lines for a script in SI units."""
    if request.level == 2:
        return yade_law(impacts, request, VERSION)
    return _constant(impacts, request) if request.level == 0 else _refitted(impacts, request)


def _constant(impacts: Impacts, request: Request) -> str:
    constant = constant_of(impacts, request)
    e = typed(constant.e, share(impacts))
    contact = dashpot(
        constant.e, impacts.mass, stiffness=stiffness_for(impacts, fastest(impacts, request)), end=End.FORCE
    )
    said = [
        *range_lines(impacts, constant),
        f"the contact does not pull: en = {e:.6g} is typed to have {constant.e:.6g} delivered "
        "(Schwager & Poeschel 2007)",
        _for_whom(impacts, f"{restitution(damping_ratio(e), End.FORCE):.4f} of this one"),
        f"tc for an overlap of 1 % of d at {request.speed:.4g} m/s; e does not depend on it; time step at most "
        f"tc/{STEPS_A_CONTACT}",
        "no lubrication=True beside it: the program ignores it here, and e_eff holds the viscous loss already",
    ]
    text = comments(impacts, "YADE", VERSION, said)
    material = f"tc={contact.contact_time():.6g}, en={e:.9g}, et=1.0, frictionAngle=0.0"
    return text + _engines(impacts, material)


def share(impacts: Impacts) -> float:
    """Of the damping ratio that is meant, what the contact gets."""
    return SHARE_AT_A_WALL if impacts.conditions.partner is None else 1.0


def _for_whom(impacts: Impacts, otherwise: str) -> str:
    """Which contacts a material is for, ``otherwise`` being what free spheres get of one for walls."""
    if impacts.conditions.partner is not None:
        return "for two free spheres: walls, facets and fixed spheres get another e of it; export --sphere alone"
    return (
        "for walls, facets and fixed spheres, where the program takes half the mass: two free spheres get "
        f"{otherwise}; export theirs with a partner in --conditions, as a material of its own"
    )


def law_of_yade(St_d: NDArray, en: float, loss: float, part: float = 1.0) -> NDArray:
    """en (1 - loss/St_d), not below 0, and what is delivered of it with a ``part`` of the damping ratio.

    ``loss`` = ln(d/(2 roughness)).
    """
    e = np.maximum(en * (1 - loss / np.asarray(St_d)), 0.0)
    if part == 1:
        return e
    return np.interp(e, *_part_given(part))


@cache
def _part_given(part: float) -> tuple[NDArray, NDArray]:
    """e meant and e delivered with a part of its damping ratio, both rising."""
    meant, given = (np.array([restitution(z, End.FORCE) for z in scale * _RATIOS]) for scale in (1.0, part))
    return meant[::-1], given[::-1]


def _diameter(impacts: Impacts) -> float:
    """The one that the program's law takes: the mean of the two, which was measured for spheres of one density."""
    sphere, partner = impacts.conditions.sphere, impacts.conditions.partner
    return sphere.diameter if partner is None else (sphere.diameter + partner.diameter) / 2


def own_stokes_per_speed(impacts: Impacts) -> float:
    """The program's rho_p v d/mu over v, s/m: of two spheres not by reduced mass and radius."""
    return impacts.conditions.sphere.density * _diameter(impacts) / impacts.conditions.fluid.viscosity


def refitted(impacts: Impacts, request: Request) -> tuple[float, float, float, float]:
    """en and loss of the code's law, the deviation that remains, and its Stokes number over that of ours."""
    ratio = own_stokes_per_speed(impacts) / impacts.per_speed
    St = np.geomspace(*request.stokes, 200)
    e = impacts.restitution(St)

    def inputs(p: NDArray) -> tuple[float, float]:
        return float(np.clip(p[0], 0.01, 1.0)), float(abs(p[1]))

    def worst(p: NDArray) -> float:
        return float(np.abs(law_of_yade(St * ratio, *inputs(p), share(impacts)) - e).max())

    start = [float(e.max()), 0.5 * request.stokes[0] * ratio]
    best = minimize(worst, start, method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-8, "maxiter": 2000})
    return *inputs(best.x), worst(best.x), ratio


def _refitted(impacts: Impacts, request: Request) -> str:
    en, loss, deviation, ratio = refitted(impacts, request)
    roughness = _diameter(impacts) / 2 * float(np.exp(-loss))
    shown = stokes_points(request)
    low, high = request.stokes
    said = [
        f"e delivered is within {deviation:.3f} of the law for {low:g} <= St <= {high:g} "
        f"({impacts.closure.convention}); measured within {OWN_LAW:g} of what this table says",
        *(
            f"St {x:8.4g}: asked {a:.3f}, delivered {g:.3f}"
            for x, a, g in zip(
                shown,
                impacts.restitution(shown),
                law_of_yade(shown * ratio, en, loss, share(impacts)),
                strict=True,
            )
        ),
        _for_whom(impacts, "another e of this one"),
        "en and roughnessScale are fitted inputs: neither the dry restitution nor a height of asperities",
        "young and poisson are yours; no tc beside them, or lubrication is silently ignored",
    ]
    mu = impacts.conditions.fluid.viscosity
    material = (
        f"en={en:.9g}, et=1.0, young={YOUNG:g}, poisson=0.3, frictionAngle=0.0, lubrication=True, "
        f"viscoDyn={mu:.6g}, roughnessScale={roughness:.6g}"
    )
    return comments(impacts, "YADE", VERSION, said) + _engines(impacts, material)


def _engines(impacts: Impacts, material: str) -> str:
    density = impacts.conditions.sphere.density
    return (
        f"\nfilm = O.materials.append(ViscElMat({material}, density={density:.9g}))\n"
        "contacts = InteractionLoop(\n"
        "    [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],\n"
        "    [Ip2_ViscElMat_ViscElMat_ViscElPhys()],\n"
        "    [Law2_ScGeom_ViscElPhys_Basic()],\n)\n"
    )
