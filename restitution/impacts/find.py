"""How e_eff is taken from a track: one row an impact, measured or simulated alike.

    e_eff = v_out / v_in,    St = v_in * (St per speed of the stated convention),

both speeds by one definition (:mod:`restitution.impacts.speed`). Values are medians, uncertainties half the
central 68 % range of the draws, with a fixed seed.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.conditions import Conditions
from restitution.doubts import Doubt, Meeting, cleaned, holes, of_meetings, of_track
from restitution.errors import InputError
from restitution.impacts.speed import SpeedMeasure, Speeds, UnresolvedError
from restitution.stokes import H_FILM, Speed, convention
from restitution.tracks import DETECTION, Contact, Contacts, Track, begins_on_rebound, contacts

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Impacts:
    """Rows of the impact table, the noise that was used, what could not be evaluated and why, what is doubtful.

    ``contacts`` are those that were evaluated by ``measure``, in order: impact 1, 2, ...; the track of ``measure``
    is without its mistracked frames.
    """

    rows: list[dict] = field(repr=False)
    sigma: float
    notes: list[str]
    doubts: list[Doubt]
    contacts: list[Contact] = field(repr=False)
    measure: SpeedMeasure = field(repr=False)

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
    """All impacts of a track: impact speed, St and e_eff with their errors, a row a contact.

    e_eff = rebound speed / impact speed, both under one definition of the speed
    (:mod:`restitution.impacts.speed`); their errors come from the noise of the frames and from the
    choice of window, and carry their correlation.

    Parameters
    ----------
    track : positions or velocities in time.
    conditions : fluid and sphere; where ``sphere.e_dry`` is not stated its column stays empty.
    speed : definition of the impact speed, "far", "contact" or "window".
    stokes : convention of the St reported, a key of :mod:`restitution.stokes`.
    record, kind : name and kind ("measured", "simulated") that every row carries.
    window_frames : frames of the mean slope; for "window" only.
    h_film : edge of the film in diameters; for "far" only.
    seed : of the draws from which errors are taken.

    Returns
    -------
    Rows in the schema of impacts; a contact that cannot be evaluated gives no row but a note. Frames that no
    flight passes through are left out. What contradicts the conditions is in ``doubts``.

    Raises
    ------
    InputError : where the numbers of the track are too large to compute with.
    """
    if not np.isfinite(track.sigma):
        raise InputError("the numbers of the track are too large to compute with: wrong unit?")
    clean = cleaned(track, record)
    track, found = clean.track, contacts(clean.track)
    level = found.level or 0.0
    measure = SpeedMeasure(
        track, conditions, Speed(speed), window_frames, h_film * conditions.sphere.diameter, level
    )
    rows, notes = [], _remarks(track, found)
    edge = h_film if Speed(speed) is Speed.FAR else None
    touches = _with_quoted_first(track, conditions, found, notes)
    lost = holes(track, found, conditions)
    meetings: list[Meeting | None] = []
    for i, contact in enumerate(touches):
        if any(_holds(contact, hole.last) for hole in lost):
            notes.append(f"impact {i + 1}: frames are missing in which a whole flight lies")
            continue
        try:
            speeds = measure(contact, np.random.default_rng([seed, i]))
        except UnresolvedError as reason:
            frame = contact.approach[-1] if contact.approach else contact.rebound[0]
            t = track.time_s[frame]
            when = f"{t:.4g}" if abs(t) < 100 else f"{t:.4f}"  # a computer's clock needs all its digits
            notes.append(f"impact {i + 1}, near t = {when} s: {reason}")
            continue
        if speeds.v_out is not None and speeds.early_s is not None:
            meetings.append(Meeting.of(i + 1, speeds.early_s, speeds.v_in, speeds.v_out))
        if speeds.v_out is None and track.quantity == "velocity":
            speeds = _within_a_frame(speeds, track, conditions, np.random.default_rng([seed, i, 1]))
        rows.append(
            {"record": record, "impact": i + 1, "kind": kind} | _row(speeds, conditions, speed, edge, stokes)
        )
    doubts = [*clean.doubts, *of_track(track, found, conditions, record)]
    if not doubts and kind == "measured":  # where frames are doubtful already, they are so at the contacts too
        at_wall = of_meetings(track, found, [m for m in meetings if m is not None], conditions.sphere.diameter)
        doubts = [replace(doubt, where=record) for doubt in at_wall]
    return Impacts(rows, track.sigma, notes, doubts, touches, measure)


def _within_a_frame(speeds: Speeds, track: Track, conditions: Conditions, rng: np.random.Generator) -> Speeds:
    """Velocities tell a contact to within a frame alone, before and after which gravity acts.

    The approach goes on for up to a frame; the rebound was faster by up to a frame's fall than what is seen of it,
    and by the wake or drag, which about double that.
    """
    frame = float(np.median(np.diff(track.time_s)))
    fall = abs(conditions.free_fall) * frame
    v_in = speeds.v_in + fall * rng.uniform(-0.5, 0.5, len(speeds.v_in))
    return replace(speeds, v_in=v_in, v_out_upper=speeds.v_out_upper + _BRAKED * fall)


_BRAKED = 2.0
"""Free falls with which a rebound is braked at first: gravity, and as much by drag and wake."""


def _holds(contact: Contact, frame: int) -> bool:
    """Whether the frames after ``frame`` are missing beside the contact, from its third frame on each side."""
    if not contact.approach or not contact.rebound:
        return False
    return contact.approach[-1] - 3 <= frame <= contact.rebound[0] + 2


def _remarks(track: Track, found: Contacts) -> list[str]:
    """How a track was taken where it does not say so itself."""
    if not found.contacts and not begins_on_rebound(track, found):
        what = "nearer to the wall and away again" if track.quantity == "gap" else "towards the wall and back"
        return [f"no contact: the sphere never moves {what} (does the record end before it?)"]
    if found.level is None or abs(found.level) <= DETECTION * track.sigma:
        return []
    return [f"the sphere rests at a gap of {found.level:.3g} m: gaps are counted from there"]


def _with_quoted_first(track: Track, conditions: Conditions, found: Contacts, notes: list[str]) -> list[Contact]:
    """The contacts, preceded by the one before the first frame if the record begins on a rebound."""
    end = found.contacts[0].approach.stop if found.contacts else len(track.time_s)
    rising = begins_on_rebound(track, found)
    if rising and conditions.impact is not None:
        return [Contact(range(0), None, range(end)), *found.contacts]
    if rising:
        notes.append("the record begins on a rebound; give [impact] speed in the conditions to use it")
    elif conditions.impact is not None:
        notes.append("[impact] in the conditions is not used: the record does not begin on a rebound")
    return found.contacts


def _row(found: Speeds, conditions: Conditions, speed: Speed | str, edge: float | None, stokes: str) -> dict:
    per_speed = convention(stokes).per_speed(conditions)
    v_in, v_in_sigma = _summary(found.v_in)
    row = {
        "outcome": "rebound" if found.v_out is not None else "not_resolved",
        "time_s": _summary(found.time_s)[0],
        "speed_definition": str(Speed(speed)),
        "film_edge_d": edge,
        "impact_speed_m_s": v_in,
        "impact_speed_sigma_m_s": v_in_sigma,
        "stokes_convention": stokes,
        "stokes": v_in * per_speed,
        "stokes_sigma": v_in_sigma * per_speed,
        "e_dry": conditions.sphere.e_dry,
        "note": found.note,
    }
    if found.v_out is None:
        slowest = np.nanquantile(found.v_in, 0.15866)
        return row | {"e_eff_upper": min(1.0, found.v_out_upper / slowest)}
    e = found.v_out / found.v_in
    row["rebound_speed_m_s"], row["rebound_speed_sigma_m_s"] = _summary(found.v_out)
    row["e_eff"], row["e_eff_sigma"] = _summary(e)
    row["e_stokes_correlation"] = _correlation(e, found.v_in)
    return row


def _correlation(a: NDArray, b: NDArray) -> float:
    """Correlation of two quantities over the central 95 % of their draws; 0 where one does not vary."""
    (low_a, high_a), (low_b, high_b) = np.nanquantile(a, (0.025, 0.975)), np.nanquantile(b, (0.025, 0.975))
    central = (a > low_a) & (a < high_a) & (b > low_b) & (b < high_b)
    return float(np.corrcoef(a[central], b[central])[0, 1]) if central.any() else 0.0


def _summary(draws: NDArray) -> tuple[float, float]:
    """Median and half the central 68.27 % range."""
    low, middle, high = np.nanquantile(draws, (0.15866, 0.5, 0.84134))
    return float(middle), float((high - low) / 2)
