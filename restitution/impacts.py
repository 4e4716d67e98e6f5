"""How e_eff is taken from a track: one row an impact, measured or simulated alike.

    e_eff = v_out / v_in,    St = v_in * (St per speed of the stated convention),

both speeds by one definition (:mod:`restitution.impact_speed`). Values are medians, uncertainties half the
central 68 % range of the draws, with a fixed seed.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions
from restitution.errors import Defect, InputError
from restitution.impact_speed import H_FILM, SpeedMeasure, Speeds, UnresolvedError
from restitution.stokes import Speed, convention
from restitution.tracks import DETECTION, Contact, Track, contacts

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Impacts:
    """Rows of the impact table, the noise that was used, and what could not be evaluated and why."""

    rows: list[dict] = field(repr=False)
    sigma: float
    notes: list[str]

    def table(self) -> pd.DataFrame:
        """The rows as a table with the columns of the impact schema."""
        import pandas as pd

        from restitution import datasets

        return pd.DataFrame(self.rows, columns=datasets.schema("impact").columns)


def find_impacts(
    track: Track,
    conditions: Conditions,
    speed: Speed | str = Speed.FAR,
    stokes: str = "st",
    record: str = "",
    kind: str = "measured",
    window_frames: int = 2,
    h_film: float = H_FILM,
    seed: int = 0,
) -> Impacts:
    """All impacts of a track.

    ``stokes`` is the convention of the St reported; ``window_frames`` serves ``window`` and ``h_film`` (in
    diameters) serves ``far`` only. A contact that cannot be evaluated gives no row but a note. Raises
    :class:`InputError` where ``e_dry`` is not stated.
    """
    if conditions.sphere.e_dry is None:
        raise InputError(Defect("must be stated: impacts are compared by e_eff / e_dry", field="sphere.e_dry"))
    measure = SpeedMeasure(track, conditions, Speed(speed), window_frames, h_film * conditions.sphere.diameter)
    rows, notes = [], []
    for i, contact in enumerate(_with_quoted_first(track, conditions, notes)):
        number = len(rows) + 1
        try:
            found = measure(contact, np.random.default_rng([seed, i]))
        except UnresolvedError as reason:
            time = track.time_s[contact.nearest if contact.nearest is not None else contact.approach[-1]]
            notes.append(f"contact near t = {time:.4g} s: {reason}")
            continue
        rows.append({"record": record, "impact": number, "kind": kind} | _row(found, conditions, speed, stokes))
    return Impacts(rows, track.sigma, notes)


def _with_quoted_first(track: Track, conditions: Conditions, notes: list[str]) -> list[Contact]:
    """The contacts, preceded by the one before the first frame if the record begins on a rebound."""
    found = contacts(track)
    end = found[0].approach.stop if found else len(track.time_s)
    flight = track.value[:end]
    if track.quantity == "gap":
        rising = end >= 3 and np.max(flight) - flight[0] > DETECTION * track.sigma
    else:
        rising = end >= 3 and flight[0] > DETECTION * track.sigma
    if rising and conditions.impact is not None:
        return [Contact(range(0), None, range(end)), *found]
    if rising:
        notes.append("the record begins on a rebound; give [impact] speed in the conditions to use it")
    return found


def _row(found: Speeds, conditions: Conditions, speed: Speed | str, stokes: str) -> dict:
    per_speed = convention(stokes).per_speed(conditions)
    v_in, v_in_sigma = _summary(found.v_in)
    row = {
        "outcome": "rebound" if found.v_out is not None else "not_resolved",
        "time_s": _summary(found.time_s)[0],
        "speed_definition": str(Speed(speed)),
        "impact_speed_m_s": v_in,
        "impact_speed_sigma_m_s": v_in_sigma,
        "stokes_convention": stokes,
        "stokes": v_in * per_speed,
        "stokes_sigma": v_in_sigma * per_speed,
        "e_dry": conditions.sphere.e_dry,
        "note": found.note,
    }
    if found.v_out is None:
        return row | {"e_eff_upper": min(1.0, found.v_out_upper / v_in)}
    row["rebound_speed_m_s"], row["rebound_speed_sigma_m_s"] = _summary(found.v_out)
    row["e_eff"], row["e_eff_sigma"] = _summary(found.v_out / found.v_in)
    return row


def _summary(draws: NDArray) -> tuple[float, float]:
    """Median and half the central 68.27 % range."""
    low, middle, high = np.nanquantile(draws, (0.15866, 0.5, 0.84134))
    return float(middle), float((high - low) / 2)
