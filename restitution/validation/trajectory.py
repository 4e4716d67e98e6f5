"""A trajectory of somebody else's solver against the record of the same case, by the measures of our own runs.

Apexes, times between contacts, e_eff of each bounce, and the distance from the record, of gaps. Velocities are
integrated to gaps from contact to contact, where the gap is nought::

    h(t) = integral of v dt from t_c on,   v(t_c) = the rebound speed;  before the first contact backwards from it

What the trajectory does not reach is not evaluated, and named. Which impact it is has to agree first: at another
approach speed the rebounds are of another Stokes number.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution import datasets
from restitution.cases.case import Case
from restitution.cases.reading import names, of_record, plain, read_case
from restitution.errors import Defect, InputError
from restitution.impacts.bounces import Bounces, filmed
from restitution.impacts.find import Impacts, find_impacts
from restitution.impacts.shipped import impacts_of
from restitution.stokes import H_FILM, Speed
from restitution.tracks import Track, contacts
from restitution.validation.rebound import Errors, quantities, record_bounces, references
from restitution.validation.row import Kind, Reference, Row, Values, near
from restitution.validation.scorecard import Judged, Result
from restitution.validation.trajectory_file import read_trajectory
from restitution.validation.verdict import Verdict

APPROACH = "approach, m/s"
ANOTHER = 1.5
"""Ratio of approach speeds from which on it cannot be the same impact: a unit is wrong, or the case."""
_LASTING = 3.0
"""Ratio of first flights from which on it cannot be the same gravity: at most ``ANOTHER``, and e is at most 1."""
_AT_REST = 0.02
"""Diameters from which on the level of a trajectory is told: above noise, deeper than stiff contacts go."""
_FINER = 4.0
"""Times more frames than the record's camera from which on a track may be filmed anew with it: between coarser
frames straight lines cut the flight short."""


@dataclass(frozen=True)
class Scored:
    """One trajectory, its bounces, and its verdicts against the truth."""

    name: str
    case: Case
    judged: Judged
    bounces: Bounces
    notes: Sequence[str]

    @property
    def values(self) -> dict[str, float]:
        """What could be evaluated, by label."""
        return self.judged.result.numbers or {}

    @property
    def left_open(self) -> list[str]:
        """Labels of what the trajectory has no value for."""
        verdicts = self.judged.truth_by_label
        return [label for label, verdict in verdicts.items() if verdict is Verdict.NOT_EVALUATED]

    @property
    def missed(self) -> list[str]:
        """Labels of what is not as the record has it."""
        return [label for label, verdict in self.judged.truth_by_label.items() if verdict is Verdict.FAIL]


def case_of(given: str) -> Case:
    """The case of a record or of a shipped case, by its name, its year left out and dashes for strokes if need be.

    Raises :class:`InputError` offering names.
    """
    known = _cases()
    if plain(given) in known:
        return known[plain(given)]
    near_names = difflib.get_close_matches(plain(given), known, n=3, cutoff=0.4) or list(known)[:3]
    rule = f"is no record with a rebound, nor a case of one; did you mean {' or '.join(near_names)}?"
    raise InputError(Defect(rule, field="--case", value=given))


@cache
def _cases() -> dict[str, Case]:
    """Cases with a record and a contact, by every name they go by."""
    cases = [case for case in map(read_case, names()) if case.record and case.contact is not None]
    return of_record() | {plain(case.name): case for case in cases}


def score(
    name: str,
    track: Track,
    case: Case,
    errors: Errors | None = None,
    first_s: float | None = None,
    notes: Sequence[str] = (),
) -> Scored:
    """The score of a trajectory.

    Parameters
    ----------
    name : what it is called.
    track : gap in m, or velocity away from the wall in m/s.
    case : of :func:`case_of`, whose record it is held against.
    errors : relative errors of a first apex by the solver's grid and by what it was given; by default none of the
        grid, and those of e_dry known to 0.02.
    first_s : time of the first contact, where it is better known: a contact stretched in time counts from its end.
    notes : on how the track was read.

    Raises
    ------
    InputError : for a track without a contact, and one that meets the wall so much faster or slower than the
        record that a unit must be wrong; for a first contact outside the track.
    """
    errors = errors if errors is not None else Errors(grid=0.0)
    found = find_impacts(track, case.conditions, Speed.FAR, record=name, kind="simulated")
    # A fall from rest has its greatest speed before the first rebound, towards the wall.
    downward = track.quantity == "velocity" and float(np.max(track.value)) > -float(np.min(track.value))
    approach = _approach(found, case, name, downward)
    own: list[str] = []
    if track.quantity == "velocity":
        track = integrated(track, found)
        own.append("velocities: the moment of a contact is known to a step, and times between contacts to that")
    else:
        track, own = from_rest(track, case.conditions.sphere.diameter, stretched=first_s is not None)
    if first_s is not None and not track.time_s[0] <= first_s <= track.time_s[-1]:
        rule = f"is outside the trajectory, {track.time_s[0]:g} to {track.time_s[-1]:g} s"
        raise InputError(Defect(rule, file=name, field="--first-contact", value=f"{first_s:g} s"))
    if first_s is not None:
        _check_touch(track, first_s, case.conditions.sphere.diameter, name)
    bounces = filmed(track, case.conditions, first_s)
    _check_clock(bounces, case, name)
    values = _values(bounces, track, found, case)
    row = _row(name, case, errors)
    labels = {r.label for r in row.truth()}
    values = {APPROACH: approach} | {label: float(v) for label, v in values.items() if label in labels}
    judged = Judged.of(row, Result(key=row.key, values=values), None)
    doubts = [f"doubt: {doubt.message}" for doubt in found.doubts]
    return Scored(name, case, judged, bounces, [*notes, *found.notes, *own, *doubts])


def from_rest(track: Track, diameter: float, stretched: bool = False) -> tuple[Track, list[str]]:
    """The gaps from where the sphere rests, where that is no matter of noise; what else their level says.

    A sphere whose contact is known to be ``stretched`` in time may go into the wall.
    """
    level, deepest = contacts(track).level or 0.0, float(np.min(track.value))
    if abs(level) > _AT_REST * diameter:
        return replace(track, value=track.value - level), []
    if deepest < -_AT_REST * diameter and not stretched:
        return track, [
            f"doubt: it goes {-deepest / diameter:.2g} d into the wall: where its contact is stretched in time, "
            "times count from its end (--first-contact S); else the wall is lower than stated (--wall)"
        ]
    return track, []


def _check_touch(track: Track, first_s: float, diameter: float, name: str) -> None:
    """Refuse a first contact in the middle of a flight; a stretched one ends at the wall, to within the film."""
    gap = float(np.interp(first_s, track.time_s, track.value)) / diameter
    if gap > H_FILM:
        rule = f"the sphere is {gap:.2g} d above the wall then: this is no contact, nor the end of one"
        raise InputError(Defect(rule, file=name, field="--first-contact", value=f"{first_s:g} s"))


def _row(name: str, case: Case, errors: Errors) -> Row:
    r = datasets.resource(case.record)
    why = (
        f"reading error of the record, twice; {errors.given:.1%} of the first apex by what the solver was given "
        f"(e_dry known to 0.02), {errors.grid:.1%} by its grid; the n-th apex has n times that, times and e half"
    )
    truth = (_first(case), *references(case.record, errors))
    source = f"{r.experiment.cite}, figure {r.experiment.figure}"
    return Row(name, f"trajectory beside {case.record}", Kind.MEASURED, source, truth, why, dict, unit="as named")


def _first(case: Case) -> Reference:
    """The approach speed of the record, twice its error."""
    row = impacts_of(case.record, Speed.FAR).rows[0]
    return near(APPROACH, row["impact_speed_m_s"], absolute=2 * row["impact_speed_sigma_m_s"])


def _approach(found: Impacts, case: Case, name: str, downward: bool) -> float:
    """The speed of the first impact; refused where it cannot be that of the record."""
    hint = "; or are these velocities counted downwards (--direction down)?" if downward else ""
    if not found.rows:
        why = f": {found.notes[-1]}" if found.notes else ""
        raise InputError(Defect(f"has no contact that could be evaluated{why}{hint}", file=name))
    speed, theirs = found.rows[0]["impact_speed_m_s"], _first(case).value
    if not 1 / ANOTHER <= speed / theirs <= ANOTHER:
        St = found.rows[0]["stokes"]
        rule = (
            f"meets the wall at {speed:.4g} m/s, St {St:.3g}, where {case.record} has {theirs:.4g} m/s, St "
            f"{St * theirs / speed:.3g}: wrong unit of length or time (--unit, --time-unit), or another case{hint}"
        )
        raise InputError(Defect(rule, file=name))
    return float(speed)


def _check_clock(bounces: Bounces, case: Case, name: str) -> None:
    """Refuse a flight that gravity does not make: units of length and time that are both wrong keep a speed."""
    if not (len(bounces.intervals_s) and len(record_bounces(case.record).intervals_s)):
        return
    theirs = record_bounces(case.record).intervals_s[0]
    if bounces.intervals_s[0] > _LASTING * theirs:
        rule = (
            f"flies {bounces.intervals_s[0]:.3g} s between its first two contacts, where {case.record} has "
            f"{theirs:.3g} s at the same speed: wrong units of length and time (--unit, --time-unit)"
        )
        raise InputError(Defect(rule, file=name))


def _values(bounces: Bounces, track: Track, found: Impacts, case: Case) -> Values:
    """e_eff as the record's camera would have it, or, of a track about as coarse, by its own frames."""
    values = dict(quantities(bounces, case.record, case))
    camera = float(np.median(np.diff(datasets.load_track(case.record).time_s)))
    if _FINER * np.median(np.diff(track.time_s)) > camera:
        values = {label: v for label, v in values.items() if not label.startswith("e ")}
        values |= {f"e {row['impact']}": row["e_eff"] for row in found.rows if row["outcome"] == "rebound"}
    return values


def integrated(track: Track, found: Impacts) -> Track:
    """The gaps of a track of velocities, up to where the last flight that could be evaluated comes down."""
    touches = [row["time_s"] for row in found.rows]
    first = track.time_s < touches[0]
    t = np.r_[track.time_s[first], touches[0]]
    v = np.r_[track.value[first], -found.rows[0]["impact_speed_m_s"]]
    time, gap = [t], [_sums(t[::-1], v[::-1])[::-1]]
    for row, end in zip(found.rows, [*touches[1:], math.inf], strict=True):
        flight = (track.time_s > row["time_s"]) & (track.time_s < end)
        if row["outcome"] != "rebound" or not flight.any():
            break
        v_out = row["rebound_speed_m_s"]
        h = _sums(np.r_[row["time_s"], track.time_s[flight]], np.r_[v_out, track.value[flight]])[1:]
        down = np.flatnonzero(h < 0)
        h = h[: down[0]] if len(down) else h
        time.append(track.time_s[flight][: len(h)])
        gap.append(h)
    return Track(np.concatenate(time), np.concatenate(gap), "gap", 1e-6 * float(np.ptp(np.concatenate(gap))))


def _sums(time: NDArray, value: NDArray) -> NDArray:
    """Trapezoidal sums from the first time on."""
    return np.r_[0.0, np.cumsum(0.5 * (value[1:] + value[:-1]) * np.diff(time))]


def assert_trajectory(
    track: Track | str | Path | Mapping[str, Sequence[float]],
    case: str,
    *,
    name: str = "",
    grid_error: float = 0.0,
    allow: Mapping[str, float] | None = None,
    may_lack: Collection[str] = (),
) -> Scored:
    """For a test of one's own solver: fail unless a trajectory is as the record has it, within the errors of both.

    Parameters
    ----------
    track : a :class:`restitution.tracks.Track`; or a file of any form, whose header says what it holds, as
        ``t [s],gap [mm]`` or ``t/sqrt(d/g),gap/d`` does; or columns ``time_s`` and ``gap_m`` (or
        ``velocity_m_s``), in SI.
    case : name of a record or a shipped case, such as "gondret-st152".
    name : what the message calls it; its file, if it is one, else "trajectory".
    grid_error : relative error of a first apex by the solver's own grid, from its own convergence study.
    allow : by label, such as ``{"apex 1, mm": 0.5}``, the greatest deviation from the record, in its unit, in
        place of the record's error: to hold a known shortfall where it is.
    may_lack : labels of what the trajectory need not reach; what else it lacks fails, for it was not evaluated.

    Returns
    -------
    The score, for further assertions.

    Raises
    ------
    AssertionError : naming every value that is not as the record has it, with what it should be.
    InputError : for what is no trajectory of the case.
    """
    import pandas as pd

    __tracebackhide__ = True  # pytest then shows the test's line and the message alone
    held_against, notes = case_of(case), ()
    name = name or (str(track) if isinstance(track, str | Path) else "trajectory")
    try:
        if isinstance(track, str | Path):
            found = read_trajectory(track, held_against.conditions)
            track, notes = found.track, found.notes
        elif not isinstance(track, Track):
            track = Track.from_table(pd.DataFrame(track))
        scored = score(name, track, held_against, Errors(grid=grid_error), notes=notes)
    except InputError as error:  # anew, without the frames of what read it
        raise InputError(*error.defects) from None
    allowed = dict(allow or {})
    truth = {r.label: r for r in scored.judged.row.truth()}
    for field, labels in (("allow", allowed), ("may_lack", may_lack)):
        unknown = [label for label in labels if label not in truth]
        if unknown:
            raise InputError(Defect(f"is none of {', '.join(truth)}", field=field, value=unknown[0]))
    wrong = [f"{label} was not evaluated" for label in scored.left_open if label not in may_lack]
    for label, value in scored.values.items():
        held = truth[label]
        goal = 0.0 if held.side == "at most" else held.value
        within = abs(value - goal) <= allowed[label] if label in allowed else held.holds(value)
        if not within:
            room = allowed.get(label, held.tolerance if held.side == "both" else held.value)
            wrong.append(f"{label} {value:.4g} where {scored.case.record} has {goal:.4g} +- {room:.2g}")
    if wrong:
        raise AssertionError(f"{name}: " + "; ".join(wrong))
    return scored
