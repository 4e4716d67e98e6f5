"""The moment of contact: what must not decide a rebound, and what must."""

from __future__ import annotations

import numpy as np

from lbm.problems import bouncing_spheres as bouncing
from lbm.problems import spheres as flows
from lbm.problems.impulsive_start import added_mass
from lbm.spheres import lattice_added_mass
from lbm.spheres.wall_motion import FRACTION
from restitution.cases.reading import read_case
from restitution.runs.resolved import ResolvedRun
from restitution.validation.row import Depth, Kind, Row, Values, at_most, near

_SMALL = {"diameter": 8, "width": 3, "start": 1.2}
"""A rebound at St 30 that takes a second."""


def sub_steps() -> Values:
    """Change of e when the sub-steps at the wall are half and twice as large."""
    e = bouncing.restitution(*bouncing.rebound(**_SMALL))
    return {
        f"{factor:g} of the default": bouncing.restitution(*bouncing.rebound(**_SMALL, fraction=factor * FRACTION))
        - e
        for factor in (0.5, 2.0)
    }


def place() -> Values:
    """Spread of the first apex over places of the sphere in its cell."""
    lateral = [bouncing.apex(*bouncing.rebound(**_SMALL, lateral=shift[:2])) for shift in flows.SHIFTS[:3]]
    return {"across": float(np.ptp(lateral) / np.mean(lateral))}


def impulse(diameter: int) -> Values:
    """What the contact makes the wall pay for the fluid, less what the fluid takes, over the displaced mass."""
    return {"difference": float(lattice_added_mass(diameter) - added_mass(diameter))}


def stretched(case: str, steps: float) -> Values:
    """e at 0.1 d of a short rebound with the contact stretched in time, less that of an instantaneous one."""
    found = {}
    for mode in ("dry", "soft_linear", "soft_hertz"):
        of = short(case, {"mode": mode} if mode == "dry" else {"mode": mode, "duration_steps": steps})
        motion = finished(of).motion()
        found[mode] = bouncing.restitution(motion.gap_m.to_numpy() / of.sphere.diameter, motion.vz_m_s.to_numpy())
    return {mode: found[mode] - found["dry"] for mode in ("soft_linear", "soft_hertz")}


def short(case: str, contact: dict):
    """A shipped case with another contact, in a small box, a millisecond of rebound."""
    given = read_case(case)
    changes = {
        "contact": given.contact.model_copy(update=contact),
        "numerics": given.numerics.model_copy(update={"width_d": 3.0, "height_d": 4.0}),
        "release": given.release.model_copy(update={"gap_d": 1.0}),
        "run": given.run.model_copy(update={"after_contact": 4e-3}),
        "record": None,
    }
    return given.model_copy(update=changes)


def finished(case) -> ResolvedRun:
    """The run of a case, to its end."""
    run = ResolvedRun(case)
    while not run.finished:
        run.advance()
    return run


def imposed(case: str, values: tuple[float, ...]) -> Values:
    """Restitution delivered where one is imposed, first contact."""
    given = {"mode": "effective", "law": None, "measured": values}
    run = finished(short(case, given))
    return {"e": run.contacts[0].speed_out_m_s / run.contacts[0].speed_in_m_s}


ROWS = (
    Row(
        "sub-steps", "change of e, sub-steps at the wall of half and twice the size", Kind.ANALYTICAL,
        "numerics decide no rebound", (at_most("0.5 of the default", 0.002), at_most("2 of the default", 0.002)),
        "a fifth of the error of the best measured e (0.01)", sub_steps,
    ),
    Row(
        "place-in-cell", "spread of the first apex over places in the cell", Kind.ANALYTICAL,
        "numerics decide no rebound", (at_most("across", 0.01),), "half the error of a measured apex of 2 mm",
        place, depth=Depth.DEFAULT,
        known={"across": "the force on a sphere that crosses cells has noise of 1 %, by where in them it does"},
    ),
    Row(
        "impact-momentum", "what the wall pays for the fluid at an impact, less what the fluid takes, 8 cells",
        Kind.ANALYTICAL, "momentum is conserved through an impact", (at_most("difference", 0.03),),
        "the fit of lattice_added_mass over 8 to 24 cells misses single grids by up to 0.03", impulse,
        {"diameter": 8},
    ),
    Row(
        "imposed-restitution", "e delivered where 0.7 is imposed", Kind.ANALYTICAL, "what is asked for",
        (near("e", 0.7, absolute=1e-9),), "the speed at contact is multiplied: round-off of SI and back", imposed,
        {"case": "gondret_st152_10_imposed", "values": (0.7,)},
    ),
    Row(
        "contact-time", "change of e at 0.1 d where the contact is stretched over 20 steps", Kind.ANALYTICAL,
        "numerics decide no rebound", (at_most("soft_linear", 0.02), at_most("soft_hertz", 0.02)),
        "the error of the best measured dry e (0.02, data of steel and glass in air)", stretched,
        {"case": "gondret_st152_10", "steps": 20.0}, Depth.DEFAULT,
        known=dict.fromkeys(
            ("soft_linear", "soft_hertz"), "a contact that takes time keeps the sphere in the film: 7 % of e"
        ),
    ),
)  # fmt: skip
