"""What a recorded trajectory must be before a model of a bouncing sphere is fitted to it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from restitution.bounce.forces import GREATEST_RE, expected_reynolds
from restitution.conditions import Conditions
from restitution.doubts import Doubt, falls, refuse
from restitution.doubts.motion import CENTRE_D
from restitution.errors import Defect, InputError
from restitution.laws.drag import excess_weight, terminal_speed
from restitution.stokes import StokesNumber
from restitution.tracks import DETECTION, Contacts, Track, begins_on_rebound

LEAST_FRAMES = 8
LEAST_RISE_D = 0.02
"""Rise of at least one bounce, in diameters."""
BELOW_D = 0.02
"""How far below the wall noise may put the first frame, in diameters."""
IMPOSSIBLE = ("direction", "clock", "moved", "kink")
"""Names of doubts about a record that no start, scale or restitution of the model makes up for."""
SPEEDS = (0.02, 20.0)
"""Between which parts of the terminal speed a record's fastest frames must be; a wrong unit is out by 1000."""


def check(
    name: str, track: Track, contacts: Contacts, conditions: Conditions, doubts: Sequence[Doubt] = ()
) -> None:
    """Refuse what cannot be a bouncing sphere's gap in metres; ``doubts`` are those about the track."""
    excess_weight(conditions)
    d, terminal = conditions.sphere.diameter, terminal_speed(conditions)
    if track.quantity != "gap":
        raise InputError(
            Defect("has velocities; a fit to trajectories needs gaps", file=name, field="velocity_m_s")
        )
    if conditions.sphere.e_dry is None:
        raise InputError(
            Defect("must be stated: the rebound needs a dry restitution", file=name, field="sphere.e_dry")
        )
    if len(track.time_s) < LEAST_FRAMES:
        rule = f"has {len(track.time_s)} frames; a trajectory needs at least {LEAST_FRAMES}"
        raise InputError(Defect(rule, file=name))
    if expected_reynolds(conditions, 0.0) > GREATEST_RE:
        St = StokesNumber.from_speed(terminal, conditions).value
        rule = f"makes the sphere fall at {terminal:.2g} m/s, St = {St:.2g}: in millimetres?"
        raise InputError(Defect(rule, file=name, field="sphere.diameter", value=f"{d:g}"))
    # What the model cannot follow whatever starts it.
    refuse(doubt for doubt in doubts if doubt.name in IMPOSSIBLE)
    fastest = falls.fastest(track, contacts)
    if not SPEEDS[0] * terminal < fastest < SPEEDS[1] * terminal:
        refuse(doubts)
        rule = (
            f"moves at {fastest:.3g} m/s, where this sphere falls at {terminal:.2g} m/s at most: are gap "
            "and diameter "
            "in metres, time in seconds?"
        )
        raise InputError(Defect(rule, file=name))
    if (contacts.level or 0.0) < -CENTRE_D * d:
        rule = f"comes to rest {-contacts.level / d:.2g} d below the wall: is the gap zero where they touch?"
        raise InputError(Defect(rule, file=name, field="gap_m", value=f"{contacts.level:g}"))
    if track.value[0] < -max(DETECTION * track.sigma, BELOW_D * d):
        raise InputError(
            Defect("starts below the wall", file=name, row=2, field="gap_m", value=f"{track.value[0]:g}")
        )
    if not _rises(track, contacts, d):
        rule = f"has no bounce that rises by {LEAST_RISE_D:g} d: nothing to fit (is all in m, kg, s?)"
        raise InputError(Defect(rule, file=name))
    refuse(doubt for doubt in doubts if doubt.name == "centre")


def bounces(track: Track, contacts: Contacts) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """When the sphere bounced, to a frame (nan where that was not filmed), and by how much it then rose in m."""
    touches = [(math.nan, 0)] if begins_on_rebound(track, contacts) else []
    touches += [(float(track.time_s[c.nearest]), c.nearest) for c in contacts.contacts if c.nearest is not None]
    begins = [i for _, i in touches]
    ends = [*begins[1:], len(track.value)][: len(begins)]
    rises = [np.max(track.value[i:j]) - track.value[i] for i, j in zip(begins, ends, strict=True)]
    return tuple(t for t, _ in touches), tuple(map(float, rises))


def _rises(track: Track, contacts: Contacts, d: float) -> bool:
    return max(bounces(track, contacts)[1], default=0.0) > LEAST_RISE_D * d
