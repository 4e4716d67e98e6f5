"""Where spheres may be: what the box cannot hold is refused before the first step, and before the one it leads to.

At the start no sphere may lie beyond a face. On its way one may, where nothing stops it: without a contact it goes
into a wall, and out through an inlet or an outlet, until its centre is there. Beyond, the box holds less than
half of it, and what its surface does to the fluid is no more that of a sphere. A free-slip face shows the mirror
image of all that is in the box: a sphere that reaches one, unless it is cut through its centre for good, meets its
own image, and so do two spheres that overlap: what lies between them is no fluid any more.
"""

from __future__ import annotations

import numpy as np

from lbm.errors import InputError
from lbm.faces.records import FACES
from lbm.fluid.lattice import PERIODIC, SLIP, Grid
from lbm.spheres.surface import REACH
from lbm.spheres.symmetry import mirrored_axes
from lbm.spheres.wall_motion import gap_to


def refuse_outside(grid: Grid, centres: np.ndarray, radii: np.ndarray) -> None:
    """Refuse spheres that a box of this ``grid`` cannot hold at the start; raises :class:`InputError`."""
    for s, (r, centre) in enumerate(zip(radii, centres, strict=True)):
        mirrors = mirrored_axes(grid, centre)
        if 2 * (r + REACH) > min(grid.shape * np.where(mirrors, 2, 1)):
            raise InputError(f"sphere {s}: diameter {2 * r:g} cells in a box of {grid.shape}: enlarge the box")
        for face, kind in enumerate(grid.faces):
            gap = gap_to(centre, r, face, grid.shape)
            if kind != PERIODIC and gap < 0 and not mirrors[face // 2]:
                hint = ", which may cut it through the centre only" if kind == SLIP else ""
                raise InputError(f"sphere {s}: {-gap:g} cells beyond the face {FACES[face]}{hint}")
    if (pair := _overlapping(grid, centres, radii)) is not None:
        raise InputError(f"spheres {pair[0]} and {pair[1]} overlap")


def refuse_lost(grid: Grid, centres: np.ndarray, radii: np.ndarray, step: int) -> None:
    """Refuse to go on with spheres that have left the box or met; raises :class:`InputError`."""
    bounded = [(face, kind == SLIP) for face, kind in enumerate(grid.faces) if kind != PERIODIC]
    shape = grid.shape
    for s, centre in enumerate(centres.tolist()):  # numbers, not arrays: this is asked in every step
        for face, mirror in bounded:
            out = centre[face // 2] - shape[face // 2] if face % 2 else -centre[face // 2]
            # whose centre lies on a mirror stays there exactly
            if not out > (-radii[s] if mirror else 0) or (mirror and out == 0):
                continue
            where = f"sphere {s} at step {step}"
            if mirror:
                raise InputError(
                    f"{where}: {out + radii[s]:.3g} cells beyond the free-slip face {FACES[face]}, where it "
                    "would meet its mirror image: stop the run before, or take a larger box or another face"
                )
            raise InputError(
                f"{where}: its centre has gone through the face {FACES[face]}: stop the run before, or give a "
                "contact, which stops it at walls"
            )
    if (pair := _overlapping(grid, centres, radii)) is not None:
        raise InputError(
            f"spheres {pair[0]} and {pair[1]} at step {step}: they overlap, for nothing acts between spheres that "
            "meet; stop the run before"
        )


def _overlapping(grid: Grid, centres: np.ndarray, radii: np.ndarray) -> tuple[int, int] | None:
    """The first two spheres, or images across periodic faces, that overlap."""
    for s in range(1, len(radii)):
        periodic = np.array(grid.faces[::2]) == PERIODIC
        apart = centres[:s] - centres[s]
        apart -= np.where(periodic, grid.shape * np.round(apart / grid.shape), 0.0)
        found = np.flatnonzero(np.linalg.norm(apart, axis=1) < radii[:s] + radii[s])
        if len(found):
            return int(found[0]), s
    return None
