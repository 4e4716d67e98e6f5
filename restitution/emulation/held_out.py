"""A record as the emulated solver has it, before the calibration and after, beside what was measured.

The clock of each is brought together with the record's by the least squares of the gaps over the first contact's
time alone. Bands have the parameters and the emulator's own error in them, not the solver's discrepancy.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from restitution.emulation.emulated import Emulated

QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)
GAIN = 0.9
"""Distance to records after over that before, below which something is gained; one apex read anew moves it so."""
_DRAWS = 400
_TOUCHES, _REACH = 121, 1.5
"""Times of the first contact that are tried, over so many frames to both sides, then nearer."""


@dataclass(frozen=True)
class Value:
    """One quantity: measured with its error of reading; quantiles before and after (:data:`QUANTILES`)."""

    label: str
    measured: float
    sigma: float
    before: tuple[float, ...]
    after: tuple[float, ...]


@dataclass(frozen=True)
class Predicted:
    """One record: its frames in use, bands of the gap at them, and its quantities; ``rms_d`` of the medians."""

    record: str
    held_out: bool
    time_s: NDArray
    gap_m: NDArray
    sigma_m: float
    before: NDArray
    after: NDArray
    """Quantiles of the gap in m at the frames, (5, n)."""
    rms_before_d: float
    rms_after_d: float
    values: tuple[Value, ...]


def predicted(e: Emulated, before: NDArray, after: NDArray, rng: np.random.Generator, held_out: bool) -> Predicted:
    """The prediction with parameters drawn ``before`` and ``after`` the calibration, (n, parameters) each."""
    f, r = e.frames, e.recording
    flights = [e.emulator.draws(_some(theta, rng), rng) for theta in (before, after)]
    bands, rms = [], []
    for q in flights:
        touch = _aligned(e, np.median(q, axis=0))
        gaps = f.predicted(q, np.full(len(q), touch))
        bands.append(np.quantile(gaps, QUANTILES, axis=0))
        rms.append(float(np.sqrt(np.mean((bands[-1][2] - r.gap_m[f.use]) ** 2))) / e.registration.d)
    told = [e.registration.quantities(q) for q in flights]
    return Predicted(
        e.name, held_out, r.time_s[f.use], r.gap_m[f.use], r.sigma, bands[0], bands[1], rms[0], rms[1],
        _values(e.measured, told[0], told[1]),
    )  # fmt: skip


def _some(theta: NDArray, rng: np.random.Generator) -> NDArray:
    return theta[rng.integers(0, len(theta), _DRAWS)]


def _aligned(e: Emulated, q: NDArray) -> float:
    """The time of the first contact at which a flight is nearest to the frames."""
    at, reach = e.frames.touch.mean, _REACH * e.frames.touch.sigma
    for _ in range(2):
        times = np.linspace(at - reach, at + reach, _TOUCHES)
        h = e.frames.predicted(np.tile(q, (_TOUCHES, 1)), times)
        at = float(times[np.argmin(np.sum((h - e.recording.gap_m[e.frames.use]) ** 2, axis=1))])
        reach *= 2 / _TOUCHES
    return at


def _values(
    measured: Mapping[str, tuple[float, float]], before: Mapping[str, NDArray], after: Mapping[str, NDArray]
) -> tuple[Value, ...]:
    """Of the quantities that the record and the runs both have."""
    found = []
    for label in after:
        if label in measured:
            bands = [tuple(map(float, np.quantile(x[label], QUANTILES))) for x in (before, after)]
            found.append(Value(label, *map(float, measured[label]), *bands))
    return tuple(found)


class Distances(Protocol):
    """A record: whether it was held out, root mean square distances of its frames in diameters."""

    @property
    def held_out(self) -> bool: ...
    @property
    def rms_before_d(self) -> float: ...
    @property
    def rms_after_d(self) -> float: ...


def distances(records: Iterable[Distances]) -> dict[bool, tuple[float, float]]:
    """Root mean square distance before and after, of records held out (True) and of those met (False)."""
    records, found = list(records), {}
    for held in (False, True):
        own = [r for r in records if r.held_out is held]
        if own:
            before, after = (
                math.sqrt(sum(x**2 for x in each) / len(own))
                for each in ([r.rms_before_d for r in own], [r.rms_after_d for r in own])
            )
            found[held] = (before, after)
    return found


def closer(records: Iterable[Distances]) -> float:
    """Distance after over that before: of records that had no say, else of those met."""
    known = distances(records)
    before, after = known.get(True, known[False])
    return after / before
