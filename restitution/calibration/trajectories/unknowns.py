"""The unknowns of a recorded trajectory: one vector (b, s, t, r, x_1, ..., x_P), read by name.

b is the zero of the gap, s the scale of the digitisation, t the recorded time of the first contact or of the
release, r the relative error of the clock (only where one is stated): they make the camera. The x alone make the
flight; which they are, a model of the flight says (:mod:`.flights`): what is open at the start, then, say, the
effective restitution of each bounce.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from numpy.typing import NDArray

from restitution.calibration.trajectories.recordings import Recording


@dataclass(frozen=True)
class Open:
    """An unknown of the flight: name with its unit, normal prior, range of the model, step of a first map."""

    name: str
    mean: float
    sigma: float
    low: float
    high: float
    step: float


@dataclass(frozen=True)
class Unknowns:
    """Names for the last axis of ``array``: of values in their units, or of derivatives to each, one row a frame.

    What the names give are views: writing to them writes to the array.
    """

    array: NDArray
    has_rate: bool

    @classmethod
    def of(cls, r: Recording, array: NDArray) -> Unknowns:
        """Those of a record."""
        return cls(array, bool(r.clock_rate))

    @property
    def zero(self) -> NDArray:
        """b, the zero of the gap in m."""
        return self.array[..., 0]

    @property
    def scale(self) -> NDArray:
        """s, the scale of the digitisation."""
        return self.array[..., 1]

    @property
    def time(self) -> NDArray:
        """t, the recorded time in s of the first contact or of the release."""
        return self.array[..., 2]

    @property
    def rate(self) -> NDArray | float:
        """r, the relative error of the clock; 0 where none is stated."""
        return self.array[..., 3] if self.has_rate else 0.0

    @property
    def flight(self) -> NDArray:
        """(x_1, ..., x_P)."""
        return self.array[..., self.flight_places]

    @property
    def flight_places(self) -> slice:
        """Where (x_1, ..., x_P) stand."""
        return slice(4 if self.has_rate else 3, None)

    @property
    def start(self) -> NDArray:
        """x_1, what is open at the start, in m/s or m."""
        return self.flight[..., 0]


def priors(r: Recording, flight: Sequence[Open]) -> dict[str, tuple[float, float]]:
    """Mean and standard deviation of each unknown before the frames are seen, in order, by name with its unit."""
    clock = "contact_time_s" if r.clock_of == "contact" else "release_time_s"
    known = {"zero_m": (0.0, r.level), "scale": (1.0, r.scale), clock: (r.clock.mean, r.clock.sigma)}
    if r.clock_rate:
        known["clock_rate"] = (0.0, r.clock_rate)
    return known | {x.name: (x.mean, x.sigma) for x in flight}
