"""What is not known, as a band about a run: the least and the greatest gap of the runs that vary it.

A case whose ``[study]`` says ``unknown`` varies, one at a time, a number that nobody knows better: K within its
interval, the dry restitution within its error. The band is the envelope of such runs and of the run they stand
against, at each time from the first contact of each; it is no standard error, and errors that go together are not
added up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from restitution.report.fig2.content import Fig2


@dataclass(frozen=True)
class Band:
    """Least and greatest gap in m at ``time_s``, and the cases whose runs span it."""

    time_s: NDArray
    low_m: NDArray
    high_m: NDArray
    cases: tuple[str, ...]


def band(fig2: Fig2, name: str) -> Band | None:
    """The band about the run of the case ``name``; None where no run of what is unknown is kept."""
    if name not in fig2.runs:
        return None
    others = tuple(other for other, run in fig2.runs.items() if _spans(run.case.study, name))
    if not others:
        return None
    trajectories = [fig2.runs[n].trajectory for n in (name, *others)]
    end = min(t.time_s.iloc[-1] for t in trajectories)
    time = trajectories[0].time_s.to_numpy(float)
    time = time[time <= end]
    gaps = [np.interp(time, t.time_s, t.gap_m) for t in trajectories]
    return Band(time, np.min(gaps, axis=0), np.max(gaps, axis=0), others)


def _spans(study, name: str) -> bool:
    return study is not None and study.unknown and study.against == name
