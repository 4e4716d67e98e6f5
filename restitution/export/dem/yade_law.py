"""YADE, level 2: a function for PyRunner that sets the damping of every new contact by its own impact speed.

The ViscEl contact does not pull, so the damping is the one that delivers e under that rule. The program makes the
contact undamped (en = 1); right after its first step the damping is set, and the damping force which that step
lacks is added.
"""

from __future__ import annotations

import inspect

from restitution.export.dashpot import CONTACT_WITHOUT_TENSION, dashpot
from restitution.export.dem import at_impact
from restitution.export.dem.snippet import (
    E_AT_FIRST_CONTACT,
    STEPS_A_CONTACT,
    Request,
    comments,
    fastest,
    stiffness_for,
)
from restitution.export.impacts import Impacts

_CONTACT = """

{contact}
{numbers}
"""
_DAMP = '''

def damp_new_contacts():
    """Set the damping of the contacts that began in this step."""
    for i in O.interactions:
        if i.iterMadeReal != O.iter:
            continue
        bodies = O.bodies[i.id1], O.bodies[i.id2]
        spheres = [b for b in bodies if isinstance(b.shape, Sphere)]
        normal = i.geom.normal
        speed = (bodies[0].state.vel - bodies[1].state.vel).dot(normal)
        masses = [math.inf if b.state.blockedDOFs == "xyzXYZ" else b.state.mass for b in spheres]
        mass = 1 / sum(1 / m for m in masses)
        # A fixed sphere is as heavy as a wall, and as round as it is.
        heavier = [1 if m < math.inf else 1e12 for m in masses]
        e = _restitution(
            speed, [(2 * b.shape.radius, k * b.material.density) for b, k in zip(spheres, heavier)]
        )
        if e < 1:
            i.phys.cn = 2 * _ratio_of_a_contact_that_does_not_pull(e) * math.sqrt(mass * i.phys.kn)
        push = i.phys.cn * speed * normal
        O.forces.addF(i.id1, -push)
        O.forces.addF(i.id2, push)


film = O.materials.append(ViscElMat(tc={time:.6g}, en=1.0, et=1.0, frictionAngle=0.0, density={density:.9g}))
contacts = InteractionLoop(
    [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
    [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
    [Law2_ScGeom_ViscElPhys_Basic()],
)
# In O.engines, in this order and directly after each other: contacts, damping, NewtonIntegrator(damping=0).
damping = PyRunner(command="damp_new_contacts()", iterPeriod=1)
'''


def yade_law(impacts: Impacts, request: Request, version: str) -> str:
    """Lines for a script in SI units."""
    contact = dashpot(1.0, impacts.mass, stiffness=stiffness_for(impacts, fastest(impacts, request)), end="force")
    names = ("v", "d", "rho_p", "d_1", "rho_1", "d_2", "rho_2")
    fluid = at_impact.fluid_numbers(impacts)
    of = {name: name for name in names} | {name: name.upper() for name in fluid}
    said = [
        *at_impact.level_2_lines(impacts),
        "the contact does not pull: the damping set is the one that delivers e under that rule (Schwager & "
        "Poeschel 2007)",
        f"tc for an overlap of 1 % of d at {fastest(impacts, request):.4g} m/s; e does not depend on it; time "
        f"step at most tc/{STEPS_A_CONTACT}",
        "walls and facets (add Ig2_Facet_Sphere_ScGeom) are of infinite mass, fixed spheres too; no clumps. No "
        "lubrication=True beside it",
    ]
    text = comments(impacts, "YADE", version, said) + "\n" + at_impact.functions(impacts, "python")
    return text + (_CONTACT + E_AT_FIRST_CONTACT + _DAMP).format(
        contact="\n\n".join(inspect.getsource(f) for f in CONTACT_WITHOUT_TENSION) + "\n",
        numbers="".join(f"{name.upper()} = {value!r}\n" for name, value in fluid.items()),
        wall=at_impact.restitution_call(impacts, of, pair=False),
        pair=at_impact.restitution_call(impacts, of, pair=True),
        least=at_impact.LEAST_E,
        time=contact.contact_time(),
        density=impacts.conditions.sphere.density,
    )
