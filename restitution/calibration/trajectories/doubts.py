"""What in a fit to whole trajectories makes one doubt its model, in words.

The errors of the restitutions have the correlated noise in them, but not what another drag or history law would
change. Where the forces of the model are not those of the flight, these signs show. A factor of drag or history
away from 1 is none within what was known of it beforehand, however exactly the frames tell it: the fit has taken
it up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from restitution.calibration.estimation.fitting import Fit
from restitution.calibration.trajectories.flights import DRAG, DRAG_SIGMA, HISTORY, HISTORY_SIGMA
from restitution.doubts import Doubt

if TYPE_CHECKING:
    from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory

KNOWN = 3.0
"""Conflict with what was known from which on a scale, a level, a factor of drag or history are a doubt."""
EXCLUDED = 4.0
"""Errors from 1 from which on the frames exclude the model's history force, for the doubt that they have none."""
NOTHING = 2.0
"""Errors from 0 within which the frames have none of a force."""
NOISES = 5.0
"""Errors of reading from which on the correlated noise is one."""


def of_records(trajectories: Sequence[WholeTrajectory]) -> Iterator[Doubt]:
    """Records that the model does not follow, law or no law; and what was doubtful before it was tried."""
    for t in trajectories:
        r = t.recording
        yield from r.doubts
        if not t.settled:
            yield Doubt(
                "model",
                "start, forces and restitutions do not come to rest: the model is far from these frames, or they "
                "leave it open",
                r.name,
            )
        scale, _ = t.unknowns["scale"]
        if conflict(t, "scale", r.scale) > KNOWN:
            yield Doubt(
                "scale",
                f"the gaps meet the model only scaled by {scale:.3f}: the scale of the record (--unit, "
                "--pixel) or the forces of the model are off, and e with them",
                r.name,
            )
        for name, known in ((DRAG, DRAG_SIGMA), (HISTORY, HISTORY_SIGMA)):
            value, sigma = t.unknowns[name]
            if conflict(t, name, known) > KNOWN:
                yield Doubt(
                    "forces",
                    f"the frames want {value:.2f} +- {sigma:.2f} times the {name.removesuffix('_factor')} of the "
                    f"model, known to {known:g}: fluid, sphere, scale or clock are not as stated, or the flight "
                    "has other forces",
                    r.name,
                )
        # Its prior reaches zero, but a fluid always has one: what has none was computed, or is not this flight.
        history, sigma = t.unknowns[HISTORY]
        if history < NOTHING * sigma and 1 - history > EXCLUDED * sigma:
            yield Doubt(
                "history",
                f"the frames have no history force ({history:.2f} +- {sigma:.2f} of the model's): if "
                "a solver made them, 'restitution impacts' needs no model; else fluid, sphere, scale or clock are "
                "not as stated",
                r.name,
            )
        if conflict(t, "zero_m", r.level, 0.0) > KNOWN:
            yield Doubt(
                "level",
                f"the wall lies {1e3 * t.unknowns['zero_m'][0]:.3g} mm from the zero of the gaps, known to "
                f"{1e3 * r.level:.2g} mm: --wall, --point",
                r.name,
            )
        if t.sigma_u[0] > NOISES * r.sigma:
            yield Doubt(
                "model",
                f"the record departs from the model by {t.sigma_u[0] / r.sigma:.0f} times the error of "
                "reading, over "
                "several frames: what a wrong drag or history law does to e is not in the intervals (of a solver "
                "without history force, 'restitution impacts' needs no model)",
                r.name,
            )


def conflict(t: WholeTrajectory, name: str, known: float, mean: float = 1.0) -> float:
    """|posterior mean - prior mean| over what it is expected to be, sqrt(prior variance - posterior variance)."""
    value, sigma = t.unknowns[name]
    return abs(value - mean) / math.sqrt(max(known**2 - sigma**2, 1e-6 * known**2))


def of_parameters(fit: Fit, slopes: Fit | str) -> Iterator[Doubt]:
    """Parameters whose 68 % intervals by whole trajectories and by slopes do not overlap."""
    if isinstance(slopes, str):
        return
    others = {p.name: slopes.maximum.intervals[0.68][j] for j, p in enumerate(slopes.maximum.parameters) if p.mean}
    for j, p in enumerate(fit.maximum.parameters):
        if p.name not in others or not p.mean:
            continue
        (low, high), (a, b) = fit.maximum.intervals[0.68][j], others[p.name]
        if high < a or low > b:
            yield Doubt(
                "slopes",
                f"{p.name} by whole trajectories, {low:.4g} to {high:.4g}, and by the slopes beside the contacts, "
                f"{a:.4g} to {b:.4g}, do not overlap (68 %)",
            )


def within_the_film(trajectories: Sequence[WholeTrajectory]) -> Iterator[str]:
    """Bounces that are modelled but tell no e outside the film."""
    for t in trajectories:
        within = [f"{n + 1}" for n, outside in enumerate(t.outside()) if not outside]
        if within:
            yield (
                f"{t.recording.name}: bounce {', '.join(within)} stays within the film on one side: its e is no "
                "impact of the fit, but a limit where no rebound was resolved"
            )
