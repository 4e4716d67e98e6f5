"""What walls that move, inlets and outlets do to the populations that come back from them, after every step.

Which of them has a link through an edge of the box is in :mod:`lbm.faces.returning`; what they do in
:mod:`lbm.faces.moving_wall` and :mod:`lbm.faces.outlet`.
"""

from __future__ import annotations

import warnings

from lbm.errors import OutsideRangeWarning
from lbm.faces.moving_wall import WallPass
from lbm.faces.outlet import OutletPass
from lbm.faces.records import Face, Inlet, NoSlip, Outlet
from lbm.faces.returning import Side
from lbm.fluid.lattice import BOUNCE

_RANK = {NoSlip: 2, Inlet: 1, Outlet: 0}


def passes(faces: tuple[Face, ...], grid) -> list[WallPass | OutletPass]:
    """The corrections that ``faces`` need after every step, in their order."""
    corrections = []
    outlets = tuple(isinstance(face, Outlet) for face in faces)
    # Outlets last: they look at populations that walls and inlets have completed.
    for number in sorted(range(6), key=lambda n: -_RANK.get(type(faces[n]), 0)):
        face = faces[number]
        if face.kind != BOUNCE:
            continue
        goes_before = (
            other.kind == BOUNCE
            and not isinstance(face, NoSlip)
            and (_RANK[type(other)], -(n // 2)) > (_RANK[type(face)], -(number // 2))
            for n, other in enumerate(faces)
        )
        side = Side(number // 2, number % 2 == 1, *goes_before)
        if isinstance(face, Outlet):
            corrections.append(OutletPass(face, side, outlets))
        else:
            wall = WallPass(face, side, faces, grid)
            if wall.moves:
                corrections.append(wall)
    _warn_of_filling(faces, corrections)
    return corrections


def _warn_of_filling(faces: tuple[Face, ...], corrections: list) -> None:
    """Without an outlet, what the inlets bring must balance; functions of time are taken on trust."""
    inlets = [p for p in corrections if isinstance(p, WallPass) and p.is_inlet]
    if any(isinstance(face, Outlet) for face in faces) or any(p.varies for p in inlets):
        return
    inflow = sum(p.inflow() for p in inlets)
    if abs(inflow) > 1e-9 * sum(p.area for p in inlets):
        warnings.warn(
            f"inlets bring a net volume of {inflow:.4g} per step and no face is an outlet: "
            "the mean density will drift; make one face an Outlet() or balance the inlets",
            OutsideRangeWarning,
            stacklevel=4,
        )
