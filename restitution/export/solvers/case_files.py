"""Input files of other solvers for a case: the same fluid, sphere, release, box and film, in their keys.

waLBerla: the whole input of apps/benchmarks/FluidParticleCoupling/SphereWallCollision, which has no defaults for
its keys. Lethe: a parameter file of lethe-fluid-sharp. Both resolve the film down to a least gap and take e_dry,
whatever contact the case has for this project's solver; an e_eff there would count the viscous loss twice.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable
from dataclasses import dataclass

from restitution import __version__
from restitution.cases.case import Case
from restitution.cases.numbers import numbers_of
from restitution.errors import Defect, InputError
from restitution.export.heading import NOT_TRIED
from restitution.export.solvers.film_codes import FILM_CODES, Film, lethe_keys, walberla_keys

_STARTS_BELOW_TOP = 2.0
"""Diameters from the top to the lowest point of waLBerla's sphere: its centre starts 1.5 d below the top."""
_STEPS_A_CELL = 2.0
"""Time steps in which the reference speed crosses one of Lethe's finest cells."""


def case_file(to: str, case: Case, file: str) -> str:
    """The input of ``to`` (:data:`CASE_TARGETS`) for a case.

    Raises :class:`InputError` for an unknown target, a case without a grid, film floor or e_dry, and what the
    target cannot do.
    """
    if to not in CASE_TARGETS:
        raise InputError(Defect(f"is none of {', '.join(CASE_TARGETS)}", field="--to", value=to))
    if case.numerics is None:
        rule = "is needed: cells_per_diameter and the box of the other solver come from it"
        raise InputError(Defect(rule, file=file, field="numerics"))
    if case.reference_speed is None:
        rule = "is needed: the time step of the other solver comes from it"
        raise InputError(Defect(rule, file=file, field="numerics.reference_speed"))
    if case.floor is None:
        rule = "is needed, or film.floor: the least gap of the other solver's film"
        raise InputError(Defect(rule, file=file, field="sphere.roughness"))
    if case.sphere.e_dry is None:
        raise InputError(Defect("is needed: the other solver resolves the film", file=file, field="sphere.e_dry"))
    if case.release.along:
        rule = f"cannot be told to {to}: this export is for falls normal to the wall"
        raise InputError(Defect(rule, file=file, field="release.along"))
    return CASE_TARGETS[to](case)


def _said(case: Case, target: str, version: str, lines: list[str], sign: str) -> str:
    n = numbers_of(case)
    facts = [
        f"case {case.name}, written by restitution {__version__} for {target} ({version})",
        *([case.title] if case.title else []),
        NOT_TRIED,
        f"at {n.speed:g} m/s ({n.of_what}): Re {n.reynolds:.4g}, St = rho_p v d/(9 mu) {n.stokes['st']:.4g}, "
        f"St* (added mass) {n.stokes['st_star']:.4g}; rho_p/rho_f {n.density_ratio:.4g}, Ga {n.galileo:.4g}",
        *lines,
    ]
    if case.contact is not None and case.contact.mode != "dry":
        facts.append(
            f"the case itself has a contact of mode {case.contact.mode}; this file has e_dry at the least gap, "
            "since an e_eff beside a resolved film would count the viscous loss twice"
        )
    return "".join(f"{sign} {' '.join(line.split())}\n" for line in facts)


def _film(case: Case, cell: float) -> Film:
    return Film(case.floor, case.sphere.e_dry, case.sphere.diameter, cell, case.fluid.viscosity, case.floor)


def _walberla(case: Case) -> str:
    n, driven = case.numerics, case.release.kind == "drive"
    cell = case.sphere.diameter / n.cells_per_diameter
    name, film, written = walberla_keys(_film(case, cell))
    lines = [
        *film,
        f"the sphere starts {case.release.gap_d:g} d above the wall, 2 d below the top: the box is "
        f"{case.release.gap_d + _STARTS_BELOW_TOP:g} d high where the case has {n.height_d:g} d",
        "accelerated to Re by the program's own way" if driven else "let go at rest",
        "magicNumber, bulkViscRateFactor, numRPDSubCycles, collisionTime (steps), StCrit and what follows are "
        "those of the program's own input",
        "numberOfBlocksPerDirection must divide the box in cells: one block here, yours for MPI",
    ]
    keys = dict(line.rstrip(";").split(" ", 1) for line in written.splitlines())
    of_case = {
        "Re": f"{numbers_of(case).reynolds:.9g}",
        "densityFluid_SI": f"{case.fluid.density:.9g}",
        "dynamicViscosityFluid_SI": f"{case.fluid.viscosity:.9g}",
        "densitySphere_SI": f"{case.sphere.density:.9g}",
        "diameter_SI": f"{case.sphere.diameter:.9g}",
        "gravitationalAcceleration_SI": f"{case.gravity:.9g}",
        "restitutionCoeff": keys.pop("restitutionCoeff"),
        "numberOfBouncesUntilTermination": "4",
        "domainSize": f"<{n.width_d:g},{n.width_d:g},{case.release.gap_d + _STARTS_BELOW_TOP:g}>",
        "numberOfBlocksPerDirection": "<1,1,1>",
    }
    setup = "Case_" + "".join(c if c.isascii() and c.isalnum() else "_" for c in case.name)
    of_run = {
        "setup": setup,
        "randomizeInitialSpherePosition": "false",
        "initializeSphereVelocity": "false",
        "applyOutflowBCAtTop": str(n.top == "outlet").lower(),
        "artificiallyAccelerateSphere": str(driven).lower(),
        "uIn": f"{n.lattice_speed:.9g}",
        "magicNumber": "0.1875",
        "bulkViscRateFactor": "100.",
        "useOmegaBulkAdaption": "true",
        "numRPDSubCycles": "100",
        **keys,
        "useVelocityVerlet": "true",
        "collisionTime": "60",
        "StCrit": "5",
        "useACTM": "false",
        "averageForceTorqueOverTwoTimeSteps": "true",
        "conserveMomentum": "false",
        "disableFluidForceDuringContact": "false",
        "reconstructorType": "Grad",
        "baseFolder": f"vtk_out_{setup}",
        "fileIO": "true",
        "vtkIOFreq": "0",
        "vtkOutputOnCollision": "false",
        "writeCheckPointFile": "false",
        "readFromCheckPointFile": "false",
    }
    said = _said(case, name, FILM_CODES["walberla"][1], lines, "//")
    return said + "\n" + _block("BouncingSphere", of_run) + "\n" + _block(setup, of_case)


def _block(name: str, keys: dict[str, str]) -> str:
    return f"{name}\n{{\n" + "".join(f"   {key} {value};\n" for key, value in keys.items()) + "}\n"


@dataclass(frozen=True)
class _Mesh:
    """Lethe's box of cubes of about one diameter, halved ``times`` times at the sphere."""

    wide: int
    high: int
    edge: float
    times: int

    @property
    def finest(self) -> float:
        return self.edge / 2**self.times


def _mesh(case: Case) -> _Mesh:
    n, d = case.numerics, case.sphere.diameter
    wide = max(1, round(n.width_d))
    edge = n.width_d * d / wide
    return _Mesh(
        wide, math.ceil(n.height_d * d / edge), edge, math.ceil(math.log2(n.cells_per_diameter * edge / d))
    )


def _lethe(case: Case) -> str:
    n, d, speed = case.numerics, case.sphere.diameter, case.reference_speed
    mesh = _mesh(case)
    name, film, keys = lethe_keys(_film(case, mesh.finest))
    driven = case.release.kind == "drive"
    start = -case.release.speed if driven else 0.0
    middle = mesh.wide * mesh.edge / 2
    centre = f"{middle:.9g}; {middle:.9g}; {d / 2 + case.release.gap_d * d:.9g}"
    end = _end(case)
    lines = [
        *film,
        f"cells of {mesh.edge:.6g} m, halved {mesh.times} times at the sphere: {d / mesh.finest:.4g} a diameter "
        f"there, the case has {n.cells_per_diameter:g}",
        "the wall is z = 0; "
        + (
            f"the case drives the sphere up to {case.release.speed:g} m/s in {case.release.ramp:g} s and sets it "
            f"free {case.release.free_below_d:g} d above the wall; here it is free from the start, at that speed"
            if driven
            else "the sphere is let go at rest"
        ),
        "periodic sides are slip walls here: half-way between images lies a plane of symmetry",
        "youngs modulus, DEM coupling frequency and the solvers' settings are the program's defaults",
    ]
    side = "noslip" if n.sides == "no-slip" else "slip"
    walls = [side] * 4 + ["noslip", {"no-slip": "noslip", "free-slip": "slip", "outlet": "outlet"}[n.top]]
    conditions = "".join(
        f"  subsection bc {i}\n    set id   = {i}\n    set type = {kind}\n  end\n" for i, kind in enumerate(walls)
    )
    refined = f"0,0,0 : {mesh.wide * mesh.edge:.9g},{mesh.wide * mesh.edge:.9g},{mesh.high * mesh.edge:.9g} : true"
    contact = textwrap.indent(keys.removeprefix("subsection DEM\n").removesuffix("end\n"), "  ")
    return (
        _said(case, name, FILM_CODES["lethe"][1], lines, "#")
        + f"""
set dimension = 3

subsection simulation control
  set method    = bdf2
  set time step = {mesh.finest / speed / _STEPS_A_CELL:.6g}
  set time end  = {end:.6g}
end

subsection physical properties
  subsection fluid 0
    set kinematic viscosity = {case.fluid.viscosity / case.fluid.density:.9g}
    set density             = {case.fluid.density:.9g}
  end
end

subsection mesh
  set type               = dealii
  set grid type          = subdivided_hyper_rectangle
  set grid arguments     = {mesh.wide},{mesh.wide},{mesh.high} : {refined}
  set initial refinement = 0
end

subsection mesh adaptation
  set type                 = adaptive
  set error estimator      = kelly
  set variable             = velocity
  set max refinement level = {mesh.times}
end

subsection boundary conditions
  set number = {len(walls)}
{conditions}end

subsection particles
  set number of particles = 1
  subsection local mesh refinement
    set initial refinement                = {mesh.times}
    set refine mesh inside radius factor  = 0.8
    set refine mesh outside radius factor = 1.3
  end
  subsection DEM
{contact}    subsection gravity
      set Function expression = 0; 0; {-case.gravity:.9g}
    end
  end
  subsection particle info 0
    set type             = sphere
    set shape arguments  = {d / 2:.9g}
    set integrate motion = true
    subsection position
      set Function expression = {centre}
    end
    subsection velocity
      set Function expression = 0; 0; {start:.9g}
    end
    subsection physical properties
      set density                 = {case.sphere.density:.9g}
      set restitution coefficient = {case.sphere.e_dry:.9g}
    end
  end
end
"""
    )


def _end(case: Case) -> float:
    """End of the run in s, from the release: as the case says, the fall estimated from its speed."""
    if case.run.after_contact is None:
        return case.run.duration
    return case.release.gap_d * case.sphere.diameter / case.reference_speed + case.run.after_contact


CASE_TARGETS: dict[str, Callable[[Case], str]] = {"walberla": _walberla, "lethe": _lethe}
"""Solvers whose input files can be written for a case."""
