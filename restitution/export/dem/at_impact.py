"""The law at an impact, as text of level 2: its functions, and the calls that give e at a speed."""

from __future__ import annotations

from collections.abc import Mapping

from restitution.export.functions import arguments_of_stokes
from restitution.export.impacts import Impacts
from restitution.export.languages import part_of_a_file

LEAST_E = 0.001
"""What is delivered where the law says less, as at St near 0: a dashpot cannot give nothing."""


def functions(impacts: Impacts, language: str) -> str:
    """The law's functions with their self-check, in C or Python."""
    return part_of_a_file(impacts.closure, language)


def fluid_numbers(impacts: Impacts) -> dict[str, float]:
    """What the law takes beside the spheres, by the names it has in the functions."""
    fluid = impacts.conditions.fluid
    known = {"rho_f": fluid.density, "mu": fluid.viscosity}
    used = arguments_of_stokes(impacts.closure.convention)
    numbers = {name: known[name] for name in known if name in used}
    return numbers | ({"e_dry": impacts.e_dry} if "e_dry" in impacts.closure.variables else {})


def restitution_call(impacts: Impacts, of: Mapping[str, str], pair: bool) -> str:
    """The call that gives e_eff, ``of`` being the texts for v, d and rho (of a pair d_1, rho_1, d_2, rho_2)."""
    name = impacts.closure.name
    fluid = [of[a] for a in ("rho_f", "mu") if a in arguments_of_stokes(impacts.closure.convention)]
    spheres = ("d_1", "rho_1", "d_2", "rho_2") if pair else ("d", "rho_p")
    stokes = f"{name}_stokes{'_pair' if pair else ''}({', '.join([of['v'], *(of[s] for s in spheres), *fluid])})"
    dry = [of["e_dry"]] if "e_dry" in impacts.closure.variables else []
    return f"{name}({', '.join([stokes, *dry])})"


def level_2_lines(impacts: Impacts, dashpot: bool = True) -> list[str]:
    """What is to be said of every text of level 2; ``dashpot``: e is delivered by one."""
    low, high = impacts.closure.validity
    least = f"; an e below {LEAST_E:g} is delivered as {LEAST_E:g}" if dashpot else ""
    return [
        f"e is that of the normal speed at first contact; beyond {low:.4g} <= St <= {high:.4g} the law's formula "
        f"goes on and in_range says so{least}",
        "the numbers of fluid and e_dry below are those of the pair above: change them there, in SI units",
    ]
