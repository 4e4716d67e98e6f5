"""A law as numbers: CSV of one pair, for programs that take no formula, and JSON of all that is known of it."""

from __future__ import annotations

import json

import numpy as np

from restitution import __version__
from restitution.conditions import Conditions
from restitution.export.closure import Closure
from restitution.export.heading import heading
from restitution.export.impacts import at_a_wall, impacts_of, stokes_per_speed
from restitution.export.self_check import TOLERANCE, check_table
from restitution.stokes import convention

ROWS = 60
"""Of a CSV; across a factor 100 in St a smooth law is linear between two rows to 0.001."""


def csv_table(
    closure: Closure, conditions: Conditions | None, e_dry: float | None = None, bare: bool = False
) -> str:
    """Impact speed in m/s, St, e_eff, of a fit also its 95 % interval, over the validity range of the law.

    ``bare`` leaves out the comments, for programs that read numbers alone.
    """
    pair = impacts_of(closure, conditions, e_dry, "csv")
    St = np.geomspace(*closure.validity, ROWS)
    speed = St / pair.per_speed
    columns = {"impact_speed_m_s": speed, "stokes": St, "e_eff": pair.restitution(St)}
    if closure.interval is not None:
        wall = at_a_wall(conditions)
        ends = closure.interval(St / stokes_per_speed(closure.convention, wall), wall)
        ends = np.clip(ends, 0.0, 1.0)
        columns |= {"e_eff_low_95": ends[:, 0], "e_eff_high_95": ends[:, 1]}
    said = [*heading(closure, "CSV"), *pair_lines(pair.conditions), f"e_dry {pair.e_dry:g}"]
    said.append("beyond the first and the last row this table says nothing: hold their e_eff, and say so")
    text = "" if bare else "".join(f"# {line}\n" for line in said)
    text += ",".join(columns) + "\n"
    return text + "".join(",".join(f"{x:.9g}" for x in row) + "\n" for row in zip(*columns.values(), strict=True))


def pair_lines(conditions: Conditions) -> list[str]:
    fluid, sphere, partner = conditions.fluid, conditions.sphere, conditions.partner
    lines = [
        f"fluid: density {fluid.density:g} kg/m3, viscosity {fluid.viscosity:g} Pa s",
        f"sphere: diameter {sphere.diameter:g} m, density {sphere.density:g} kg/m3",
    ]
    if partner is None:
        return [*lines, "against a wall"]
    return [*lines, f"against a sphere of diameter {partner.diameter:g} m, density {partner.density:g} kg/m3"]


def json_record(closure: Closure, derivative: bool = False) -> str:
    """All that is known of the law at its parameters, with the table that a program can check itself by."""
    low, high = closure.validity
    table = check_table(closure)
    record = {
        "format": "restitution-closure/1",
        "written_by": f"restitution {__version__}",
        "name": closure.name,
        "title": closure.title,
        "family": closure.family,
        "formula": closure.text if closure.closed else None,
        "formula_note": None if closure.closed else closure.text,
        "variables": list(closure.variables),
        "parameters": [
            {"name": c.name, "value": c.value, "unit": c.unit, "origin": c.origin, "interval": c.interval or None}
            for c in closure.constants
        ],
        "stokes": None
        if closure.convention is None
        else {"convention": closure.convention, "definition": convention(closure.convention).definition},
        "speed": str(closure.speed) if closure.rebound else None,
        "validity": {
            "variable": closure.variables[0],
            "low": low,
            "high": None if np.isinf(high) else high,
            "source": closure.validity_source,
            "outside": "the formula goes on"
            + ("; e_eff is held within 0 and e_dry, 0 for St <= 0" if closure.rebound else ""),
        },
        "reference": closure.reference,
        "status": closure.status,
        "identity": list(closure.identity),
        "heading": heading(closure, "JSON"),
        "self_check": {
            "arguments": [list(row) for row in table.rows],
            "values": list(table.values),
            "relative_tolerance": TOLERANCE,
        }
        | ({"slopes": list(table.slopes)} if derivative else {}),
    }
    return json.dumps(record, indent=1, allow_nan=False) + "\n"
