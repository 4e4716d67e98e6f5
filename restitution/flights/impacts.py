"""Rows of the table of impacts from times of contact or apexes, with errors from those of the values.

Each value has an independent error; e and St follow from several values, so that their errors come from the slopes

    cov = J diag(sigma^2) J^T

by differences over one error, and neighbouring impacts share values. Where the approach to the first contact is
not known, what is assumed of it is among them.

What the flights say depends on the forces that act in them. A few times do not tell which history force acts,
whether a wake is left, and how far the wall reaches, so the :data:`MODELS` are tried as equally likely: values are
their mean, and their scatter is among the errors.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from restitution.bounce import Closures, OwnWake, terminal_speed
from restitution.conditions import Conditions, QuotedImpact
from restitution.doubts import Doubt, of_conditions
from restitution.errors import InputError
from restitution.flights import drag, free
from restitution.flights.table import Flights, Kind
from restitution.stokes import H_FILM, Speed, convention

if TYPE_CHECKING:
    import pandas as pd

FIRST, FIRST_SIGMA = 0.33, 0.10
"""(e_1 - e_2)/(1 - e_2) of the first two contacts, where nothing tells the approach to the first: mean of the six
measured records with two rebounds, 0.28 to 0.39 (``restitution/runs/restitutions.csv``, film up to 0.1 d, the
model that the frames prefer), and twice their spread, for five of them are of one sphere."""
_FULL = Closures(measured=())
MODELS: dict[str, Closures] = {
    "history and wall": _FULL,
    "drag alone": replace(_FULL, history=None, wall=None),
    "history and wake": replace(_FULL, wake=OwnWake(), wall=None),
    "wake and wall": replace(_FULL, wake=OwnWake(), history=None),
}
"""The forces that are tried beside drag and added mass: history, the wake of the approach, and the wall's
resistance, which is known without inertia alone. Of the eight ways to have them or not these are four in which
each is there as often as not, beside each other as well; the two that differ most are among them. The first is for
the slopes."""
GRAVITY = 9.81
"""In m/s2, for speeds without drag where no conditions are stated."""
BEYOND = 1.3
"""Times the terminal speed above which no flight begins or ends."""
_WORDS = {"times": "times of contact", "apexes": "apexes"}


@dataclass(frozen=True)
class FlightImpacts:
    """Rows of the impact table (without St where conditions are not stated), ``free`` e without drag of each row,
    ``forces`` the least and the greatest e by the forces that are tried.

    ``notes`` say what was assumed, ``doubts`` what contradicts the input.
    """

    rows: list[dict] = field(repr=False)
    free: list[float]
    forces: list[tuple[float, float]]
    notes: list[str]
    doubts: list[Doubt]

    def table(self) -> pd.DataFrame:
        """The rows as a table with the columns of the impact schema."""
        import pandas as pd

        from restitution import datasets

        return pd.DataFrame(self.rows, columns=datasets.schema("impact").columns)


def impacts_of(
    flights: Flights,
    conditions: Conditions | None,
    with_drag: bool = True,
    stokes: str = "st",
    record: str = "",
    edge: float = H_FILM,
    models: Mapping[str, Closures] = MODELS,
) -> FlightImpacts:
    """The impacts that lie between two known flights, or between a release or quoted speed and the first one.

    Parameters
    ----------
    flights : times of contact or apexes.
    conditions : fluid and sphere; None: e without drag alone.
    with_drag : by the point particle, else in the limit of no drag.
    stokes : convention of the St reported.
    record : name that every row carries.
    edge : gap in diameters within which e stands for every viscous force.
    models : the forces that are tried, by name.

    Raises
    ------
    InputError : where no two flights follow each other, or for a sphere that does not sink.
    """
    found = FlightImpacts([], [], [], [], [])
    quoted = None if conditions is None else conditions.impact
    missing = sorted(set(range(flights.number[0], flights.number[-1] + 1)) - set(flights.number.tolist()))
    if missing:
        found.notes.append(
            f"bounce {', '.join(map(str, missing[:5]))} is missing: the flights beside it are not used"
        )
    if np.isnan(flights.sigma).any():
        what = _WORDS[flights.kind]
        found.notes.append(
            f"errors of the {what} are not stated (a column sigma, or --sigma): those of e are left open"
        )
    for rows in flights.runs():
        number, value, sigma = flights.number[rows], flights.value[rows], flights.sigma[rows]
        if len(number) > 1:
            first = quoted if number[0] == 1 else None
            by_drag = with_drag and conditions is not None
            run = _Succession(flights.kind, number, value, sigma, conditions, first, by_drag, edge, models)
            _of_succession(found, run, flights, stokes, record)
    if not found.rows and not found.doubts:
        least = (
            "three times of contact in a row" if flights.kind == "times" else "the apexes of two flights in a row"
        )
        raise InputError(f"no impact lies between two known flights: {least} are needed")
    found.doubts.extend(of_conditions([conditions]))
    return found


@dataclass(frozen=True)
class _Succession:
    """Bounces whose numbers follow each other, and what their speeds follow from.

    Inputs are the values, the quoted speed of the first contact (0: none), and :data:`FIRST`.
    """

    kind: Kind
    numbers: NDArray
    values: NDArray
    sigma: NDArray
    conditions: Conditions | None
    quoted: QuotedImpact | None
    by_drag: bool
    edge: float
    models: Mapping[str, Closures]

    @property
    def released(self) -> bool:
        return bool(self.numbers[0] == 0)

    @property
    def contacts(self) -> NDArray:
        """Numbers of the contacts."""
        return self.numbers[1:] if self.released else self.numbers

    @property
    def assumed(self) -> bool:
        """Whether the speed of the first approach is assumed."""
        return self.by_drag and not self.released and self.quoted is None

    def inputs(self) -> tuple[NDArray, NDArray]:
        """The inputs and their errors, NaN where an error is not stated."""
        quoted = (0.0, 0.0) if self.quoted is None else (self.quoted.speed, self.quoted.speed_sigma)
        errors = np.array([*self.sigma, quoted[1], FIRST_SIGMA if self.assumed else 0.0])
        return np.array([*self.values, quoted[0], FIRST]), errors

    def without_drag(self, x: NDArray) -> NDArray:
        """Speeds before and after each contact, shape (2, contacts)."""
        g_eff = GRAVITY if self.conditions is None else self.conditions.free_fall
        before, after = free.speeds(self.kind, self.numbers, x[:-2], g_eff)
        if self.quoted is not None:
            before[0] = x[-2]
        return np.array([before, after])

    def speeds(self, x: NDArray, forces: Closures, fallen: bool = False) -> NDArray:
        """The same with drag and these forces."""
        quoted = None if self.quoted is None else float(x[-2])
        told = (self.kind, self.numbers, x[:-2], self.conditions, quoted, float(x[-1]), fallen)
        return np.array(drag.speeds(*told, replace(forces, film=self.edge)))

    def solved(self) -> Solved:
        """The speeds, which models give them, and how far each error moves them."""
        x, errors = self.inputs()
        if not self.by_drag:
            before, after = speeds = self.without_drag(x)
            slopes = [*self._slopes(self.without_drag, x, errors, speeds)]
            return Solved(speeds, np.array(slopes), (after / before)[None])
        speeds = np.array([self.speeds(x, forces) for forces in self.models.values()])
        # What leaves as fast as it comes would need an e above 1: with these forces the flight cannot be.
        possible = ~(speeds[:, 1] >= speeds[:, 0] * (1 - _ELASTIC))
        some = np.logical_and.accumulate(possible.any(axis=0))
        with np.errstate(all="ignore"):
            weight = possible / possible.sum(axis=0)
        mean = np.where(some, np.nansum(weight[:, None] * np.nan_to_num(speeds), axis=0), np.nan)
        mean[np.isnan(speeds).all(axis=0)] = np.nan
        best = max(range(len(speeds)), key=lambda k: (np.sum(possible[k]), -k))
        forces = list(self.models.values())[best]
        moves = [*self._slopes(lambda at: self.speeds(at, forces), x, errors, speeds[best])]
        if not self.released:  # an approach that was steady and one that was a fall from rest are equally likely
            half = (self.speeds(x, forces, fallen=True) - speeds[best]) / 2
            mean, speeds = mean + half, speeds + half
            moves.append(half)
        # Of a model that would need more than 1 the elastic contact counts.
        scatter = (speeds - mean) / math.sqrt(max(len(speeds) - 1, 1))
        unlike = tuple(n for n, can in zip(self.models, possible[:, some], strict=True) if not can.all())
        return Solved(mean, np.array([*moves, *scatter]), speeds[:, 1] / speeds[:, 0], unlike)

    @staticmethod
    def _slopes(
        speeds: Callable[[NDArray], NDArray], x: NDArray, errors: NDArray, here: NDArray
    ) -> Iterator[NDArray]:
        """How far each error moves the speeds from where they are ``here``; NaN for an error not stated."""
        for i, error in enumerate(errors):
            up = x.copy()
            up[i] += error
            if math.isnan(error):
                yield np.full_like(here, math.nan)
            elif error > 0:
                yield speeds(up) - here


_ELASTIC = 1e-7
"""Below 1, from which on a contact is elastic: an e is solved for to 1e-9."""


@dataclass(frozen=True)
class Solved:
    """``speeds`` before and after each contact, (2, contacts), how far each error ``moves`` them, (errors, 2,
    contacts), e by each of the forces, (models, contacts), and those that are ``unlike`` these flights: they would
    need an e above 1.
    """

    speeds: NDArray
    moves: NDArray
    e_by_forces: NDArray
    unlike: tuple[str, ...] = ()


def _of_succession(found: FlightImpacts, run: _Succession, flights: Flights, stokes: str, record: str) -> None:
    """Add its impacts."""
    solved = run.solved()
    (before, after), moves = solved.speeds, solved.moves.reshape(-1, 2, len(run.contacts))
    e_free = np.divide(*run.without_drag(run.inputs()[0])[::-1])
    found.doubts.extend(_doubts(run, (before, after), e_free))
    known = np.flatnonzero(np.isfinite(before) & np.isfinite(after))
    if run.assumed and len(known):
        found.notes.append(
            f"the approach to bounce {run.numbers[0]} is not in the {_WORDS[run.kind]}: taken to be one of which "
            f"{FIRST:.0%} +- {FIRST_SIGMA:.0%} less is lost than of the next (a row 0, the release, or [impact] "
            "speed says it)"
        )
    if solved.unlike:
        found.notes.append(
            f"forces {', '.join(solved.unlike)} would need an e above 1: in the errors alone they count, as e = 1"
        )
    for k in known:
        v, out, contact = float(before[k]), float(after[k]), int(run.contacts[k])
        v_moves, out_moves = moves[:, 0, k], moves[:, 1, k]
        e_moves = (out_moves - out / v * v_moves) / v
        v_sigma, out_sigma, e_sigma = (float(np.linalg.norm(m)) for m in (v_moves, out_moves, e_moves))
        both = v_sigma * e_sigma
        label = f"by {_WORDS[run.kind]}, "
        label += f"with drag (without: e {e_free[k]:.3f})" if run.by_drag else "in the limit of no drag"
        row = {
            "record": record, "impact": contact, "kind": "measured", "outcome": "rebound",
            "time_s": _time(flights, contact), "speed_definition": str(Speed.FAR), "film_edge_d": run.edge,
            "impact_speed_m_s": v, "impact_speed_sigma_m_s": v_sigma,
            "rebound_speed_m_s": out, "rebound_speed_sigma_m_s": out_sigma,
            "e_eff": out / v, "e_eff_sigma": e_sigma,
            "e_stokes_correlation": float(v_moves @ e_moves) / both if both > 0 else math.nan, "note": label,
        }  # fmt: skip
        if run.conditions is not None:
            per_speed = convention(stokes).per_speed(run.conditions)
            row |= {
                "stokes_convention": stokes, "stokes": v * per_speed, "stokes_sigma": v_sigma * per_speed,
                "e_dry": run.conditions.sphere.e_dry,
            }  # fmt: skip
        found.rows.append(row)
        found.free.append(float(e_free[k]))
        found.forces.append((float(solved.e_by_forces[:, k].min()), float(solved.e_by_forces[:, k].max())))


def _time(flights: Flights, contact: int) -> float:
    if flights.kind == "apexes":
        return math.nan
    return float(flights.value[np.flatnonzero(flights.number == contact)[0]])


def _doubts(run: _Succession, speeds: tuple[NDArray, NDArray], e_free: NDArray) -> Iterator[Doubt]:
    """What the flights contradict."""
    for contact in run.contacts[e_free > 1]:
        what = "lasts longer" if run.kind == "times" else "rises higher"
        message = f"the flight after bounce {contact} {what} than the one before: is a bounce missing, or one "
        yield Doubt("longer", message + "too many counted?")
    lacking = run.contacts[np.isnan(speeds[1]) & np.isfinite(e_free)]
    if len(lacking):
        message = f"no e up to 1 gives the flight after bounce {lacking[0]} with the drag of these conditions: "
        yield Doubt("drag", message + "this and later bounces have no e (--no-drag gives the ratio of flights)")
    c = run.conditions
    if c is not None and c.sphere.density > c.fluid.density:
        fast, terminal = float(np.nanmax(speeds[0], initial=0.0)), terminal_speed(c)
        if fast > BEYOND * terminal:
            option = "--time-unit" if run.kind == "times" else "--unit"
            yield Doubt(
                "speed",
                f"bounces come in at {fast:.3g} m/s, {fast / terminal:.2g} times the terminal speed under these "
                f"conditions ({terminal:.3g} m/s): are the {_WORDS[run.kind]} in this unit ({option}), fluid and "
                "sphere these?",
            )
