r"""Whether approach and rebound meet at the wall: frames that were lost, repeated or made up at a contact.

Both sides of a contact, extrapolated from outside the film, come to the wall at nearly one time. If k frames were
lost there and the others numbered on, the rebound seems to leave the wall before the approach reaches it, and the
two meet in mid-air,

    h = t_early v_in v_out/(v_in + v_out)    above the wall,    t_early = k/fps,

where the slopes of the sides are those of another part of the flight: e comes out wrong. Repeated frames do the
reverse. A film delays and wakes advance it: by up to 0.012 d in the measured records, by -0.09 d where a computed
contact is stretched in time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.doubts.doubt import Doubt
from restitution.stokes import H_FILM
from restitution.tracks import DETECTION, Contact, Contacts, Track

_ABOVE = H_FILM / 3
"""Diameters above the wall in which approach and rebound meet at most, whatever film and wake do."""
_BELOW = 1.5 * H_FILM
"""The same below it, which a contact that lasts, or a film, makes."""
_SURE = 4.0
"""Errors of that height: of every tenth record one contact among its several would reach two and a half."""
_LEAST_LOST, _LEAST_MORE = 0.7, 1.5
"""Frames; a single one that was repeated is within what a film does."""


@dataclass(frozen=True)
class Meeting:
    """Where the two sides of an impact meet: its number, height above the level of the record in m, its error,
    and how long the way from there to the wall and back would take, per height, in s/m.
    """

    impact: int
    height: float
    error: float
    slowness: float

    @classmethod
    def of(cls, impact: int, early: NDArray, v_in: NDArray, v_out: NDArray) -> Meeting | None:
        """From draws of the time and speeds; None where they do not tell it."""
        with np.errstate(all="ignore"):
            height = early * v_in * v_out / (v_in + v_out)
        known = np.isfinite(height)
        if np.mean(known) < 0.9:
            return None
        low, middle, high = np.quantile(height[known], (0.15866, 0.5, 0.84134))
        slowness = float(np.nanmedian(1 / v_in + 1 / v_out))
        return cls(impact, float(middle), float(high - low) / 2, slowness)

    def sure(self, track: Track) -> float:
        """The height in m that noise does not make."""
        return _SURE * float(np.hypot(self.error, track.sigma))

    def frames(self, wall: float, frame: float) -> float:
        """How many frames the way from where the sides meet to the ``wall`` and back takes."""
        return (self.height - wall) * self.slowness / frame


def of_meetings(track: Track, found: Contacts, meetings: Sequence[Meeting], diameter: float) -> list[Doubt]:
    """Doubts about the frames at contacts, by where the sides of each impact meet and how low frames are seen."""
    if not meetings:
        return []
    frame, wall = float(np.median(np.diff(track.time_s))), _wall(track, found, meetings)
    early = [
        m
        for m in meetings
        if m.height - wall > _ABOVE * diameter + m.sure(track) and m.frames(wall, frame) > _LEAST_LOST
    ]
    if early:
        first = max(early, key=lambda m: m.height)
        k = first.frames(wall, frame)
        others = f" (also impact {', '.join(str(m.impact) for m in early if m is not first)})" * (len(early) > 1)
        lost = f"{max(round(k), 1)} frame{'s' * (round(k) > 1)}"
        message = (
            f"at impact {first.impact}{others} the rebound, followed back, leaves the wall {k * frame:.3g} s "
            f"before the approach reaches it: was the sphere lost for about {lost} there and the others numbered "
            "on? Number them as the camera took them, the lost ones left empty (e is wrong as it is)"
        )
        return [Doubt("renumbered", message)]
    level = 0.0 if found.level is not None else _middle(meetings)
    for m in meetings:
        late = -m.frames(level, frame)
        if level - m.height > _BELOW * diameter + m.sure(track) and late > _LEAST_MORE:
            message = (
                f"at impact {m.impact} the rebound, followed back, leaves the wall {late * frame:.3g} s, "
                f"{late:.2g} frames, after the approach has reached it: were frames repeated or made up there by "
                "the tracking program, or is the contact so soft? e of a contact without duration is not to be had"
            )
            return [Doubt("delayed", message)]
    return []


def _wall(track: Track, found: Contacts, meetings: Sequence[Meeting]) -> float:
    """The height in m, from the level of the record, above which the wall is not.

    Where the sphere rests it is that level; else no frame is seen below the wall, and most impacts meet there.
    """
    if found.level is not None:
        return 0.0
    lowest = min(float(np.min(track.value[_beside(contact)])) + track.sigma for contact in found.contacts)
    if len(meetings) == 1:
        return lowest
    return min(lowest, _middle(meetings))


def _middle(meetings: Sequence[Meeting]) -> float:
    """Where most impacts meet; of two the stated wall is a third."""
    return float(np.median([*(m.height for m in meetings), *([0.0] if len(meetings) == 2 else [])]))


def _beside(contact: Contact) -> list[int]:
    """The frames next to a contact."""
    near = [contact.approach[-1]] if contact.approach else []
    return [*near, *([] if contact.nearest is None else [contact.nearest]), *contact.rebound[:1]]


def of_mirrored(track: Track, found: Contacts, diameter: float) -> list[Doubt]:
    """Flights below the wall that the sphere touches before or after: those of its image in it."""
    lows = np.array([contact.nearest for contact in found.contacts if contact.nearest is not None], int)
    if track.quantity != "gap" or len(lows) < (3 if found.level is None else 1):
        return []
    wall = float(np.median(track.value[lows])) if found.level is None else found.level
    k = int(lows[np.argmin(track.value[lows])])
    above = np.flatnonzero(track.value > wall - _IMAGE_D * diameter - DETECTION * track.sigma)
    first, last = above[above < k].max(initial=-1) + 1, above[above > k].min(initial=len(track.value)) - 1
    if last - first < _LEAST_SEEN:
        return []
    deep = wall - float(track.value[k])
    return [
        Doubt(
            "mirrored",
            f"from t = {track.time_s[first]:.5g} to {track.time_s[last]:.5g} s the sphere is up to {deep:.2g} m, "
            f"{deep / diameter:.2g} d, below the wall that it touches otherwise: was its mirror image in the wall "
            "followed there? Follow the sphere itself, or leave these frames out (the e beside is wrong)",
        )
    ]


_IMAGE_D = 0.3
"""Diameters below the wall to which no soft contact and no error of its level goes."""
_LEAST_SEEN = 2
"""Frames beyond one that such a flight has."""
