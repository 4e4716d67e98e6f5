"""What in a fit to whole trajectories makes one doubt its model, in words.

The errors of the restitutions have the correlated noise in them, but not what another drag or history law would
change. Where the forces of the model are not those of the flight, these signs show.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from restitution.calibration.estimation.fitting import Fit

if TYPE_CHECKING:
    from restitution.calibration.trajectories.whole_trajectories import WholeTrajectory

SCALES = 3.0
"""Standard deviations of its prior from which on a scale is a doubt."""
NOISES = 5.0
"""Errors of reading from which on the correlated noise is one."""


def in_words(trajectories: Sequence[WholeTrajectory], fit: Fit, slopes: Fit | str) -> list[str]:
    """Everything that is doubtful; nothing where nothing is."""
    return [*_records(trajectories), *_parameters(fit, slopes), *_bounces(trajectories)]


def _records(trajectories: Sequence[WholeTrajectory]) -> Iterator[str]:
    for t in trajectories:
        r = t.recording
        scale, _ = t.unknowns["scale"]
        if abs(scale - 1) > SCALES * r.scale:
            yield (
                f"doubt: the gaps of {r.name} meet the model only scaled by {scale:.3f}: the scale of the record "
                "or the forces of the model are off, and e with them"
            )
        if t.sigma_u[0] > NOISES * r.sigma:
            yield (
                f"doubt: {r.name} departs from the model by {t.sigma_u[0] / r.sigma:.0f} times the error of "
                "reading, over several frames: what a wrong drag or history law does to e is not in the intervals"
            )


def _parameters(fit: Fit, slopes: Fit | str) -> Iterator[str]:
    """Parameters whose 68 % intervals by whole trajectories and by slopes do not overlap."""
    if isinstance(slopes, str):
        return
    others = {p.name: slopes.maximum.intervals[0.68][j] for j, p in enumerate(slopes.maximum.parameters) if p.mean}
    for j, p in enumerate(fit.maximum.parameters):
        if p.name not in others or not p.mean:
            continue
        (low, high), (a, b) = fit.maximum.intervals[0.68][j], others[p.name]
        if high < a or low > b:
            yield (
                f"doubt: {p.name} by whole trajectories, {low:.4g} to {high:.4g}, and by the slopes beside the "
                f"contacts, {a:.4g} to {b:.4g}, do not overlap (68 %)"
            )


def _bounces(trajectories: Sequence[WholeTrajectory]) -> Iterator[str]:
    """Bounces that are modelled but tell no e outside the film."""
    for t in trajectories:
        within = [f"{n + 1}" for n, outside in enumerate(t.outside()) if not outside]
        if within:
            yield (
                f"{t.recording.name}: bounce {', '.join(within)} stays within the film on one side: its e is no "
                "impact of the fit, but a limit where no rebound was resolved"
            )
