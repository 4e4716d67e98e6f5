"""The account of mass of a sphere's surface: what it has brought into the fluid by error, and how that goes back.

A sphere that moves changes the mass of the fluid around it three ways: reflection by interpolation sends back what
other cells have sent, cells that are covered take their deviation from rest with them, cells that come free are
filled. On average the three should cancel, and with interpolation they do not: of the volume swept 1 to 1.5 % is
lost. So all of it is counted, sphere by sphere, as a ``surplus`` of deviations from the density at rest, and paid
back over a time T through the links: a link along c_k brings

    -w_k surplus / (T sum w),      sum w = (1 + sqrt(2))/12 A   over the links of a surface of area A

besides. As sum w_k c_k over the links of a closed surface is zero whatever its place on the grid, this is a
pressure that pushes the sphere nowhere. The sum of the wall's own push, 6 w_k rho c_k.u, vanishes likewise.

The lag leaves T times the rate of loss in the flow; T is long enough that sound has evened the pressure out.
"""

from __future__ import annotations

import math

import numpy as np

from lbm.fluid.stencil import CS2

LINK_WEIGHTS = (1 + math.sqrt(2)) / 12
"""Sum of w_k over the links through a unit area, mean over its directions: of w_k |c_k.n| over half the links."""
DELAY = 4.0
"""T in the times d/c_s that sound needs to pass the sphere."""


def payback(surplus: np.ndarray, radii: np.ndarray) -> np.ndarray:
    """What each link of a sphere brings in a step over its weight w_k, (n,)."""
    delay = DELAY * 2 * radii / math.sqrt(CS2)
    return -surplus / (delay * LINK_WEIGHTS * 4 * math.pi * radii**2)
