"""What the solver is told of a case, as numbers and words by name: a kept run holds only as long as these agree.

Closures, drive and rebound are callables; they are sampled over the range in which a run uses them. So a law, a
record or the rules of a case may be rewritten at will, as long as no number that reaches the solver changes.
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Mapping

import numpy as np

from lbm import OutsideRangeWarning
from lbm.contact import Contact, DryRebound, FilmRebound
from lbm.film import Film
from restitution.case import Case
from restitution.flow_pictures import AFTER_D, BEFORE_D, HALF_WIDTH_D, HEIGHT_D
from restitution.runs.setup import Setup, set_up

Entry = list[float | str]

AGREE = 1e-9
"""Largest relative difference that counts as none: the libraries' last digits.

Measured between the oldest and the newest supported numpy and scipy: 2e-13. A change of a law's constant by 1e-6
is a thousand times larger.
"""
_NOTHING = 1e-13
"""What counts as zero, over the largest number of an entry."""
_DIGITS = 13
"""Digits kept of each number."""
_GAPS = (0.9, 0.5, 0.2, 0.1, 0.05)
"""Gaps at which a film is sampled, over its cut-off."""
_SPEEDS = (1.0, -1.0, 0.1, -0.1)
"""Speeds at which a film is sampled, over the reference speed."""
_IMPACT_SPEEDS = (1.0, 0.5, 0.2, 0.1, 0.02)
"""Speeds at which a rebound is sampled, over the reference speed; the rebound numbers are 0 to 5."""
_OVERLAPS = (0.01, 0.05, 0.1, 0.2, 0.3)
"""Overlaps at which a soft contact is sampled, over reference speed x its duration."""
_TIMES = (0.01, 0.1, 0.3, 1.0, 3.0, 10.0)
"""Times at which a drive is sampled, over diameter / reference speed."""


def told(case: Case) -> dict[str, Entry]:
    """Everything that decides the run of a case but the program, by name; nothing without ``[numerics]``."""
    if case.numerics is None:
        return {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutsideRangeWarning)
        setup = set_up(case)
    span = case.run
    content: dict[str, Entry] = {
        "box": [*setup.shape],
        "faces": [f"{face} {kind}" for face, kind in setup.faces.items()],
        "method": [setup.precision, setup.interpolation],
        "rates": [float(rate) for rate in setup.rates.diagonal()],
        "units: cell_m, step_s, density": [setup.flow.scales.unit(q) for q in ("length", "time", "density")],
        "sphere: radius, density, centre": [setup.sphere.radius, setup.sphere.density, *setup.sphere.position],
        "gravity": [setup.gravity],
        "span: s after contact, s": [span.after_contact or "", span.duration or ""],
        "floor, m": [case.floor or ""],
        "steps from row to row": [setup.rows_apart],
        "pictures, d": [BEFORE_D, AFTER_D, HALF_WIDTH_D, HEIGHT_D],
        "drive": _drive(setup, case.release.free_below_d * setup.flow.length),
        **_film(setup.film, setup.flow.speed),
        **_contact(setup.contact, setup.flow.speed),
    }
    return {name: [v if isinstance(v, str) else _rounded(v) for v in entry] for name, entry in content.items()}


def departures(kept: Mapping[str, Entry], now: Mapping[str, Entry]) -> list[str]:
    """Names of the entries in which two cases differ: one is missing, or by more than :data:`AGREE`."""
    return [name for name in sorted({*kept, *now}) if not _agree(kept.get(name, []), now.get(name, []))]


def _agree(one: Entry, other: Entry) -> bool:
    if [isinstance(v, str) for v in one] != [isinstance(v, str) for v in other]:
        return False
    nothing = _NOTHING * max((abs(v) for v in one if not isinstance(v, str)), default=0.0)
    pairs = zip(one, other, strict=True)
    return all(a == b if isinstance(a, str) else abs(a - b) <= AGREE * abs(a) + nothing for a, b in pairs)


def _drive(setup: Setup, free_below: float) -> Entry:
    if setup.drive is None:
        return []
    passing = setup.flow.length / setup.flow.speed
    sampled = (setup.drive(t * passing, side * free_below) for t in _TIMES for side in (0.99, 1.01))
    return [*itertools.chain.from_iterable(["free"] if v is None else v for v in sampled)]


def _film(film: Film | None, speed: float) -> dict[str, Entry]:
    if film is None:
        return {}
    content: dict[str, Entry] = {"film: cut-off, floor": [film.cut_off, film.floor]}
    states = [
        (gap, part * speed)
        for gap in (*(part * film.cut_off for part in _GAPS), film.floor, 0.5 * film.floor)
        for part in _SPEEDS
    ]
    if film.normal is not None:
        across = [film.resistance(gap, v, onset) for gap, v in states for onset in (v, 1.5 * v)]
        content["film across: force at rest, slope"] = [*itertools.chain.from_iterable(across)]
    if film.tangential is not None:
        still, up = np.zeros(3), np.array([0.0, 0.0, 1.0])
        sliding = [film.along(gap, v * np.array([1.0, 0.0, 0.0]), still, up) for gap, v in states]
        turning = [film.along(gap, still, v * np.array([0.0, 1.0, 0.0]), up) for gap, v in states]
        content["film along: forces, torques"] = [
            float(f[i]) for f in np.array(sliding + turning).reshape(-1, 3) for i in (0, 1)
        ]
    return content


def _contact(contact: Contact | None, speed: float) -> dict[str, Entry]:
    if contact is None:
        return {}
    kind = type(contact).__name__
    if isinstance(contact, DryRebound):
        return {"contact": [kind, contact.e_dry, contact.added_mass]}
    if isinstance(contact, FilmRebound):
        bounces = itertools.product(_IMPACT_SPEEDS, range(6))
        rebounds = [contact.rebound(part * speed, count) for part, count in bounces]
        return {"contact": [kind, contact.edge, contact.free_fall], "rebound": rebounds}
    overlaps = itertools.product(_OVERLAPS, (-1.0, -0.3, 0.0, 0.3))
    forces = [contact.force(o * speed * contact.duration, v * speed, speed) for o, v in overlaps]
    return {"contact": [kind, contact.duration], "push of the contact": forces}


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}") + 0.0  # no minus before a zero
