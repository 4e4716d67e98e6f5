"""LAMMPS, level 2: a Python script in which every contact is damped by the e of its own impact speed.

The granular package has no damping that knows the speed at first contact. Its elastic force stays LAMMPS's own
(`hooke` without damping); a callback of `fix external` adds the dashpot of each contact, the damping of which is
set once, when the contact begins. Nothing is compiled: the library of PyPI has all that is needed.
"""

from __future__ import annotations

from restitution.export.dashpot import dashpot
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

_ATTACH = '''

STIFFNESS = {stiffness:.9g}
"""N/m; an overlap of 1 % of d at {fastest:.4g} m/s. e does not depend on it."""
LONGEST_STEP = {step:.6g}
"""s; a contact lasts 50 of it, of lighter spheres fewer."""
MODEL = f"hooke {{STIFFNESS}} 0.0 tangential linear_nohistory 0.0 0.0 damping velocity"
"""Contact model of pair_coeff and of the walls: no damping of its own, for that is added here."""
{numbers}
'''
_ADD = '''

def attach(lmp, walls=((2, 0.0),)):
    """Damp every contact of spheres, and of spheres with plane walls at rest, each (axis 0 to 2, its coordinate).

    Call after the styles are set and before run. The input needs units si, atom_style sphere, newton off,
    comm_modify vel yes, pair_style granular with pair_coeff * * MODEL, and fix wall/gran granular MODEL a wall.
    """
    if lmp.extract_setting("newton_pair"):
        raise ValueError("the input needs 'newton off': else a contact across a periodic or processor boundary "
                         "is damped on one side only")
    kept = {{}}
    lmp.command("fix film_loss all external pf/callback 1 1")

    def add(lmp, step, n, tags, x, f):
        f[:] = 0.0
        total = n + lmp.extract_global("nghost")
        get = lmp.numpy.extract_atom
        x, v = get("x", nelem=total, dim=3), get("v", nelem=total, dim=3)
        r, m, tag = get("radius", nelem=total), get("rmass", nelem=total), get("id", nelem=total)
        touching = set()

        def sphere(i):
            return 2 * r[i], m[i] / (math.pi / 6 * (2 * r[i]) ** 3)

        def pull(key, speed, mass, *spheres):
            """The dashpot's force against separation; speed > 0 on approach."""
            touching.add(key)
            if key not in kept:
                log_e = math.log(_restitution(float(speed), spheres))
                kept[key] = -2 * log_e / math.hypot(math.pi, log_e) * math.sqrt(mass * STIFFNESS)
            return kept[key] * speed

        for wall, (axis, place) in enumerate(walls):
            for i in range(n):
                side = x[i, axis] - place
                if abs(side) < r[i]:
                    out = 1.0 if side > 0 else -1.0
                    f[i, axis] += out * pull((tag[i], -1 - wall), -out * v[i, axis], m[i], sphere(i))
        pairs = lmp.numpy.get_neighlist(lmp.find_pair_neighlist("granular"))
        for i, near in pairs:
            for j in near:
                apart = x[i] - x[j]
                distance = math.sqrt(apart @ apart)
                if distance < r[i] + r[j]:
                    out, mass = apart / distance, m[i] * m[j] / (m[i] + m[j])
                    key = (min(tag[i], tag[j]), max(tag[i], tag[j]))
                    push = pull(key, (v[j] - v[i]) @ out, mass, sphere(i), sphere(j)) * out
                    f[i] += push
                    if j < n:
                        f[j] -= push
        for key in set(kept) - touching:
            del kept[key]

    lmp.set_fix_external_callback("film_loss", add, lmp)
'''


def lammps_law(impacts: Impacts, request: Request, version: str) -> str:
    """A module for a Python that has the library of LAMMPS, in SI units."""
    stiffness = stiffness_for(impacts, fastest(impacts, request))
    step = dashpot(1.0, impacts.mass, stiffness=stiffness).contact_time() / STEPS_A_CONTACT
    names = ("v", "d", "rho_p", "d_1", "rho_1", "d_2", "rho_2")
    fluid = at_impact.fluid_numbers(impacts)
    of = {name: name for name in names} | {name: name.upper() for name in fluid}
    said = [
        *at_impact.level_2_lines(impacts),
        "a Python module, nothing is compiled. Saved as film.py, with an input that has no run and takes "
        "${MODEL} in pair_coeff * * and fix wall/gran granular:",
        "   from lammps import lammps; from film import MODEL, attach; lmp = lammps()",
        "   lmp.command(f'variable MODEL string \"{MODEL}\"'); lmp.file('in.yours')",
        "   attach(lmp, walls=[(2, 0.0)]); lmp.command('run 10000')",
        "it needs the packages lammps and numpy, and an MPI library where that of PyPI does not start: pip "
        "install mpich, LD_PRELOAD=.../lib/libmpi.so.12",
        "a loop in Python over the contacts at every step: for some thousand spheres; tried on one process. Walls "
        "are planes at rest, and no sphere is frozen",
        "the contact may pull at its end: e asked is e delivered; damping of rolling and sliding is yours",
        "no coeff_restitution beside it and no lubrication: e_eff holds the viscous loss already",
    ]
    text = comments(impacts, "LAMMPS, Python", version, said) + "\n" + at_impact.functions(impacts, "python")
    return text + (_ATTACH + E_AT_FIRST_CONTACT + _ADD).format(
        stiffness=stiffness,
        fastest=fastest(impacts, request),
        step=step,
        numbers="".join(f"{name.upper()} = {value!r}\n" for name, value in fluid.items()),
        wall=at_impact.restitution_call(impacts, of, pair=False),
        pair=at_impact.restitution_call(impacts, of, pair=True),
        least=at_impact.LEAST_E,
    )
