"""MFIX and OpenLB: codes with contacts of their own, the e of which is a constant or a function to be written."""

from __future__ import annotations

from restitution.export.dashpot import damping_ratio
from restitution.export.dem import at_impact
from restitution.export.dem.snippet import (
    STEPS_A_CONTACT,
    Request,
    check_level,
    comments,
    constant_of,
    range_lines,
)
from restitution.export.heading import NOT_TRIED
from restitution.export.impacts import Impacts
from restitution.stokes import Speed

MFIX_VERSION = "manual of 24.2 and a source of 2017"
OPENLB_VERSION = "1.9-dev of January 2026, from its source"


def mfix(impacts: Impacts, request: Request) -> str:
    """Keys of mfix.dat: a constant e."""
    check_level(request, "mfix", (0,))
    constant = constant_of(impacts, request)
    key = "DES_EN_WALL_INPUT(1)" if impacts.conditions.partner is None else "DES_EN_INPUT(1)"
    said = [
        NOT_TRIED,
        *range_lines(impacts, constant),
        "for one solids phase and the linear spring-dashpot: the contact may pull at its end, so that e typed is "
        f"e delivered; it damps with {damping_ratio(constant.e):.4g} of the critical damping",
        "DES_EN_WALL_INPUT is for walls, DES_EN_INPUT for pairs of spheres, the St of which is twice that of a "
        "wall at the same speed: export those with a partner in --conditions",
        f"KN, KN_W are yours; time step at most contact time/{STEPS_A_CONTACT}. No lubrication beside it",
        "no hook for e of the impact speed: that takes --to fortran and a copy of calc_force_dem.f in the case",
    ]
    text = comments(impacts, "MFIX", MFIX_VERSION, said)
    return text + f"\n  DES_COLL_MODEL = 'LSD'\n  {key} = {constant.e:.9g}\n"


def openlb(impacts: Impacts, request: Request) -> str:
    """A C++ function of the contact's initial normal speed, which every contact of OpenLB stores."""
    check_level(request, "openlb", (2,))
    slowed = [] if impacts.closure.speed is Speed.CONTACT else [
        f"this law takes a speed that is {impacts.closure.speed}; OpenLB gives the one at contact, which the "
        "resolved flow has slowed already: that part of the loss counts twice. A fit with --speed contact does not"
    ]  # fmt: skip
    fluid = at_impact.fluid_numbers(impacts)
    of = {n: n for n in ("v", "d", "rho_p", "d_1", "rho_1", "d_2", "rho_2", *fluid)}
    said = [
        NOT_TRIED,
        *at_impact.level_2_lines(impacts),
        "in src/particles/contact/contactFunctions.h the damping factor is made of e and the contact's initial "
        "normal speed: call restitution_at_wall or restitution_of_pair there in place of the constant e",
        *slowed,
        "no lubrication correction beside it: e_eff holds the viscous loss. Lattice units must be made SI first",
    ]
    numbers = "".join(f"    const double {n} = {value!r};\n" for n, value in fluid.items())
    least = f"    return e > {at_impact.LEAST_E!r} ? e : {at_impact.LEAST_E!r};\n}}\n"
    return (
        comments(impacts, "OpenLB, C++", OPENLB_VERSION, said, "//")
        + "\n"
        + at_impact.functions(impacts, "c")
        + "\n/* v m/s at first contact, d m, rho kg/m3 */\n"
        + "static inline double restitution_at_wall(double v, double d, double rho_p)\n{\n"
        + f"{numbers}    const double e = {at_impact.restitution_call(impacts, of, pair=False)};\n{least}"
        + "\nstatic inline double restitution_of_pair(\n"
        + "    double v, double d_1, double rho_1, double d_2, double rho_2)\n"
        + f"{{\n{numbers}    const double e = {at_impact.restitution_call(impacts, of, pair=True)};\n{least}"
    )
