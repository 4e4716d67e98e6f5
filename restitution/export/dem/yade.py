"""YADE: a constant e, or its own lubrication law of the impact with refitted inputs.

Its ViscEl contact does not pull, so a constant e is typed as the inverse of what that makes of it. With
`lubrication=True` the contact takes, at its first step,

    e = en [1 - ln(d/(2 roughness))/St_d],   St_d = rho_p v d/mu, without the 9,

so en and `roughnessScale` are fitted to the law over a range; being linear in 1/St it misses a law that is
exponential in it by much where St is small. Where `tc` and `en` are given `lubrication` is silently ignored.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

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
    stokes_points,
)
from restitution.export.impacts import Impacts
from restitution.stokes import convention

VERSION = "2023.02a; this text was not run"
OWN_LAW = 0.01
"""By how much the program's e was measured to differ from its own law: 0.008 at most."""


def yade(impacts: Impacts, request: Request) -> str:
    """Lines for a script in SI units."""
    check_level(request, "yade", 1)
    return _constant(impacts, request) if request.level == 0 else _refitted(impacts, request)


def _constant(impacts: Impacts, request: Request) -> str:
    constant = constant_of(impacts, request)
    e = typed(constant.e)
    contact = dashpot(
        constant.e, impacts.mass, stiffness=stiffness_for(impacts, fastest(impacts, request)), end=End.FORCE
    )
    said = [
        *range_lines(impacts, constant),
        f"the contact does not pull: en = {e:.6g} is typed to have {constant.e:.6g} delivered "
        "(Schwager & Poeschel 2007)",
        f"tc for an overlap of 1 % of d at {request.speed:.4g} m/s; e does not depend on it; time step at most "
        f"tc/{STEPS_A_CONTACT}",
        "no lubrication=True beside it: the program ignores it here, and e_eff holds the viscous loss already",
    ]
    text = comments(impacts, "YADE", VERSION, said)
    material = f"tc={contact.contact_time():.6g}, en={e:.9g}, et=1.0, frictionAngle=0.0"
    return text + _engines(impacts, material)


def law_of_yade(St_d: NDArray, en: float, loss: float) -> NDArray:
    """en (1 - loss/St_d), not below 0; ``loss`` = ln(d/(2 roughness))."""
    return np.maximum(en * (1 - loss / np.asarray(St_d)), 0.0)


def _refitted(impacts: Impacts, request: Request) -> str:
    ratio = float(convention("st_d").per_speed(impacts.conditions)) / impacts.per_speed
    St = np.geomspace(*request.stokes, 200)
    e = impacts.restitution(St)

    def inputs(p: NDArray) -> tuple[float, float]:
        return float(np.clip(p[0], 0.01, 1.0)), float(abs(p[1]))

    def worst(p: NDArray) -> float:
        return float(np.abs(law_of_yade(St * ratio, *inputs(p)) - e).max())

    start = [float(e.max()), 0.5 * request.stokes[0] * ratio]
    best = minimize(worst, start, method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-8, "maxiter": 2000})
    en, loss = inputs(best.x)
    roughness = impacts.conditions.sphere.diameter / 2 * float(np.exp(-loss))
    shown = stokes_points(request)
    low, high = request.stokes
    said = [
        f"e by the program's law is within {worst(best.x):.3f} of ours for {low:g} <= St <= {high:g} "
        f"({impacts.closure.convention}); the program was measured within {OWN_LAW:g} of its law",
        *(
            f"St {x:8.4g}: asked {a:.3f}, its law {g:.3f}"
            for x, a, g in zip(
                shown, impacts.restitution(shown), law_of_yade(shown * ratio, en, loss), strict=True
            )
        ),
        "en and roughnessScale are fitted inputs: neither the dry restitution nor a height of asperities",
        "young and poisson are yours; no tc beside them, or lubrication is silently ignored",
    ]
    mu = impacts.conditions.fluid.viscosity
    material = (
        f"en={en:.9g}, et=1.0, young=5e7, poisson=0.3, frictionAngle=0.0, lubrication=True, viscoDyn={mu:.6g}, "
        f"roughnessScale={roughness:.6g}"
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
