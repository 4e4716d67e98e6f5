"""All that is doubtful about a record, whether its conditions are known or not."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from restitution.doubts.clock import of_frames
from restitution.doubts.doubt import Doubt
from restitution.doubts.mistracked import cleaned
from restitution.doubts.motion import of_track
from restitution.doubts.pieces import of_pieces
from restitution.doubts.place import still, unsigned
from restitution.tracks import Track, contacts

if TYPE_CHECKING:
    from restitution.conditions import Conditions


def of_record(track: Track, conditions: Conditions | None, where: str = "") -> list[Doubt]:
    """The doubts that ``impacts`` would print; without ``conditions`` those that need no fluid and sphere: frames
    that no flight passes through, repeated or renumbered ones, jumps, and a coordinate that does not move.
    """
    clean = cleaned(track, where)
    if conditions is not None:
        return [*clean.doubts, *of_track(clean.track, contacts(clean.track), conditions, where)]
    # How high the film is nobody knows, so that no turn is above it.
    told = clean.track, math.inf, 0.0
    found = still(clean.track) or unsigned(clean.track) or of_frames(*told) or of_pieces(*told)
    return [*clean.doubts, *(replace(doubt, where=where) for doubt in found)]
