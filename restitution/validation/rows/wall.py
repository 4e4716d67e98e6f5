"""A sphere driven towards a wall: its resistance against Brenner's, from two cells of gap to a twentieth."""

from __future__ import annotations

import numpy as np

from lbm.problems import spheres as flows
from lbm.spheres import lost_to_grid
from restitution.cases.reading import read_case
from restitution.laws.brenner_1961 import Brenner1961
from restitution.runs.setup import set_up
from restitution.validation.row import Depth, Kind, NotEvaluatedError, Row, Values, near

GAPS = (2.0, 1.5, 1.0, 0.75, 0.5, 0.4, 0.3, 0.2, 0.1, 0.05)
"""In cells."""
_WINDOW = 0.05
"""Half width of the mean about a gap, of the gap."""


def approach(diameter: float, width: float, height: float, dtype: str) -> Values:
    """Resistance of lattice and film together over Brenner's, by gap."""
    made = flows.approach(diameter, width=width, height=height, start=2.5 / diameter, speed=2e-3, dtype=dtype)
    whole = made.resistance + made.radius * np.array([lost_to_grid(h) for h in made.gap])
    over = whole / Brenner1961()(eps=made.gap / made.radius)
    return {_label(gap): float(over[np.abs(made.gap - gap) < _WINDOW * gap].mean()) for gap in GAPS}


def _label(gap: float) -> str:
    return f"gap {gap:g}"


def _row(diameter: int, width: float, height: float, depth: Depth, missed: tuple[float, ...]) -> Row:
    return Row(
        f"wall-approach-{diameter}", f"resistance towards a wall over Brenner's, {diameter} cells a diameter",
        Kind.ANALYTICAL, "Brenner, Chem. Eng. Sci. 16 (1961) 242, exact series",
        tuple(near(_label(gap), 1.0, absolute=0.03) for gap in GAPS),
        "the series is exact; the mean over a tenth of the gap has noise of 2 to 3 % as the sphere crosses cells",
        approach, {"diameter": diameter, "width": width, "height": height, "dtype": "float32"}, depth,
        known={_label(gap): "one or two cells of fluid must carry the film; nothing is fitted" for gap in missed},
    )  # fmt: skip


def film_of_case(case: str) -> Values:
    """Force of a case's film on a sphere that comes, over that of Taylor's lubrication less the grid's share.

    The share by quadrature of Reynolds' equation for a film that ends where it is half a cell thick::

        1/h - 2 int_c^inf (H - c)^2/((H - h) H^3) dH,   c = 1/2 cell
    """
    from scipy.integrate import quad

    setup = set_up(read_case(case))
    force = setup.film.normal if setup.film is not None else None
    if force is None:
        raise NotEvaluatedError(f"case {case} has no film across the wall")
    radius, viscosity, speed, c = setup.flow.length / 2, setup.flow.viscosity, 1e-3, 0.5
    found = {}
    for gap in FILM_GAPS:
        share, _ = quad(lambda H, h: 2 * (H - c) ** 2 / ((H - h) * H**3), c, np.inf, args=(gap,), epsabs=1e-12)
        lacking = 6 * np.pi * viscosity * radius**2 * speed * (1 / gap - share)
        found[_label(gap)] = float(force(gap, -speed, -speed)) / lacking
    return found


FILM_GAPS = (0.02, 0.1, 0.3, 0.45)
"""In cells."""

ROWS = (
    Row(
        "film-force", "force of the film of case li_drop1 on a sphere that comes, over what the grid lacks",
        Kind.ANALYTICAL,
        "Taylor's lubrication; Reynolds' equation for the share of a grid that ends at half a cell",
        tuple(near(_label(gap), 1.0, absolute=1e-6) for gap in FILM_GAPS), "quadrature", film_of_case,
        {"case": "li_drop1"},
    ),
    _row(10, 4, 3, Depth.QUICK, (1.0, 0.75, 0.5, 0.4, 0.3)),
    _row(16, 4, 3, Depth.DEFAULT, (1.5, 1.0, 0.75, 0.5)),
)  # fmt: skip
