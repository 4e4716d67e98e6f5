"""Impacts of a simulated trajectory, taken as the record's camera would have taken it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restitution import datasets
from restitution.cases.case import Case
from restitution.impacts.bounces import LEAST_RISE_D
from restitution.impacts.find import find_impacts
from restitution.stokes import MEASURED_SPEEDS
from restitution.tracks import MINIMUM_FRAMES, Track

if TYPE_CHECKING:
    import pandas as pd


def simulated_impacts(trajectory: pd.DataFrame, case: Case) -> tuple[pd.DataFrame, list[str]]:
    """Impacts of a simulated trajectory under all three definitions of speed, and remarks on them.

    Where the case has a measured record, its camera is taken: the same interval between frames, and the same noise
    to weight them by, so that a definition of speed means the same for both.
    """
    import pandas as pd

    columns = list(datasets.schema("impact").columns)
    if case.sphere.e_dry is None or len(trajectory) < MINIMUM_FRAMES:
        return pd.DataFrame(columns=columns), []
    track = _as_filmed(trajectory, case)
    if _camera(case) is None:
        track = at_rest(track, LEAST_RISE_D * case.sphere.diameter)
    rows, notes = [], []
    for speed in MEASURED_SPEEDS:
        found = find_impacts(track, case.conditions, speed, record=case.name, kind="simulated")
        rows += found.rows
        notes += [f"{speed}: {note}" for note in found.notes]
    return pd.DataFrame(rows, columns=columns), notes


def filmed(case: Case) -> dict[str, list[float | str]]:
    """What the impacts of a case are taken with beside its trajectory: conditions, and the record's camera."""
    c, camera = case.conditions, _camera(case)
    content: dict[str, list[float | str]] = {
        "fluid: density, viscosity": [c.fluid.density, c.fluid.viscosity],
        "sphere: diameter, density, e_dry": [c.sphere.diameter, c.sphere.density, c.sphere.e_dry or ""],
        "gravity": [c.gravity],
    }
    if camera is not None:
        content["camera: s a frame, noise in m"] = [_interval(camera), camera.sigma]
    return content


def _camera(case: Case) -> Track | None:
    """The measured record whose camera is taken; None where a case has none of positions."""
    if case.record is None or datasets.resource(case.record).table != "trajectory":
        return None
    return datasets.load_track(case.record)


def _interval(track: Track) -> float:
    return float(np.median(np.diff(track.time_s)))


def _as_filmed(trajectory: pd.DataFrame, case: Case) -> Track:
    """The trajectory as the record's camera would have it."""
    return as_filmed(Track.from_table(trajectory), _camera(case))


def at_rest(track: Track, rise_m: float) -> Track:
    """The track with the sphere still from where it first turns after it has last been above ``rise_m``.

    The fluid goes on stirring a sphere that has come to rest, by less than a thousandth of a diameter. Without a
    camera's noise that looks like impacts, whose e_eff means nothing.
    """
    gaps = track.value.copy()
    above = np.flatnonzero(gaps > rise_m)
    still = gaps[above[-1] :] if len(above) else gaps
    rising = np.flatnonzero(np.diff(still) > 0)
    if len(rising):
        still[rising[0] :] = still[rising[0] :].min()
    return Track(track.time_s, gaps, track.quantity, track.sigma)


def as_filmed(track: Track, camera: Track | None) -> Track:
    """The gaps of a simulated track as a camera has them, the contact in the middle between two frames.

    Time counts from the contact. Without a camera, and where its frames would be too few, the track as it is.
    """
    if camera is None:
        return track
    interval, time = _interval(camera), track.time_s
    first, last = np.ceil(time[0] / interval - 0.5), np.floor(time[-1] / interval - 0.5)
    frames = interval * (np.arange(first, last + 1) + 0.5)
    if len(frames) < MINIMUM_FRAMES:
        return track
    return Track(frames, np.interp(frames, time, track.value), "gap", camera.sigma)
