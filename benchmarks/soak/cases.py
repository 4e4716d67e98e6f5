"""Cases in TOML, spoiled by hand and at random."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from random import Random

from benchmarks.soak import inputs
from benchmarks.soak.outcome import Attempt, noted
from benchmarks.soak.trying import may, names, tried


def cases(random: Random) -> Iterator[Attempt]:
    """Cases in TOML, through the point particle, and through the solver where they are to be refused."""
    both = (("bounce", "case.toml", "--out", "out"), ("simulate", "case.toml", "--out", "out"))
    changes = {
        'name = "../outside"\n': "", 'name = "/tmp/outside"\n': "", 'name = ""\n': "", 'name = "a\\u0000b"\n': "",
        f'base = "{"x" * 300}"\n': "", "speed = 1e300": "speed = 0.5", "height_d = 1e308": "height_d = 7.0",
        f"density = {'9' * 5000}": "density = 1150", "after_contact = -1": "after_contact = 0.05",
        'law = "eq5"': 'law = "legendre_2005"', 'mode = "soft"': 'mode = "effective"',
        'mode = "effective"\nadded_mass = 1e9': 'mode = "effective"',
        "cells_per_diameter = 0": "cells_per_diameter = 6",
        "density = 1.0": "density = 7800", "viscosity = 0.0": "viscosity = 0.05", "gap_d = nan": "gap_d = 2.0",
    }  # fmt: skip
    for (new, old), command in product(changes.items(), both):
        text = inputs.CASE.replace(old, new, 1) if old else new + inputs.CASE
        if command[0] == "bounce" and new.startswith(('mode = "effective', "cells_")):
            continue  # not asked by the point particle, which says so
        yield tried(
            f"{command[0]} {new.strip()[:30]!r}",
            {"case.toml": text},
            command,
            names("case.toml", left=["out", "../outside"]),
        )
    too_long = inputs.CASE.replace("after_contact = 0.05", "after_contact = 1e9")
    yield tried("bounce of 1e9 s", {"case.toml": too_long}, both[0], names("case.toml"))
    slow = inputs.CASE.replace("viscosity = 0.05", "viscosity = 10.0").replace(
        'kind = "drive"\ngap_d = 2.0\nspeed = 0.5\nramp = 0.008', 'kind = "rest"\ngap_d = 2.0').replace(
        "lattice_speed = 0.05", "lattice_speed = 0.05\nreference_speed = 0.5")  # fmt: skip
    yield tried("simulate that never arrives", {"case.toml": slow}, both[1], noted)
    while True:
        text = inputs.spoiled(inputs.CASE, random)
        yield tried("case at random", {"case.toml": text}, both[0], may("case.toml"))
