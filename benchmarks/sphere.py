"""Moving spheres against what is known of them: drag, walls, noise, frames, shear, settling, contact.

    python -m benchmarks.sphere [--only NAME ...] [--fresh] [--json FILE]

Each row is written to the file as soon as it is measured; a second call measures what is missing. Without a
reference value, ``measured`` is itself an error. Rows are fast or slow by their box; all of them take about an
hour of one core.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from lbm import Rates, Simulation
from lbm.problems import bouncing_spheres as bouncing
from lbm.problems import spheres as flows
from lbm.spheres import RESOLVED, Sphere, Spheres, lost_to_grid
from lbm.spheres.wall_motion import FRACTION
from restitution import datasets
from restitution.files import write_whole
from restitution.laws.brenner_1961 import Brenner1961
from restitution.report.fig2.checks import Check, read_checks, text_of
from restitution.runs.validity import physics

ARRAYS = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292}
"""K over the solid fraction: Zick & Homsy, J. Fluid Mech. 115 (1982) 13, simple cubic array."""
GAPS = (2.0, 1.5, 1.0, 0.75, 0.6, 0.5, 0.45, 0.4, 0.35, 0.3, 0.25, 0.2, 0.15, 0.1, 0.07, 0.05)
CUT_OFFS = (0.5, 2 / 3, 1.0, 1.5, 2.0)
_BRENNER = "Brenner 1961, exact series"
_EXACT = "by definition"


def _row(name, case, measured, reference, target, source) -> Check:
    error = measured / reference - 1 if reference else measured
    return Check(
        name=name, case=case, measured=measured, reference=reference, error=error, target=target, source=source
    )


def arrays(scheme: str = "linear") -> Iterator[Check]:
    """Drag in a periodic array at d = 8 and 16, mean over places in the cell, and the order between them."""
    for fraction, K in ARRAYS.items():
        errors = {}
        for d in (8, 16):
            cells = round(d * (math.pi / (6 * fraction)) ** (1 / 3))
            drag = [flows.array_drag(cells, fraction, shift, scheme=scheme) for shift in flows.SHIFTS]
            case = f"{scheme}, phi {fraction}, d {d}, {cells}^3 cells"
            target = 0.01 if d == 16 else None
            row = _row("array drag", case, np.mean(drag), K, target, "Zick & Homsy 1982")
            errors[cells] = row.error
            yield row
            yield _row("array drag, spread over places", case, np.ptp(drag) / K, 0, None, _EXACT)
        coarse, fine = errors
        order = math.log(abs(errors[coarse] / errors[fine])) / math.log(fine / coarse)
        case = f"{scheme}, phi {fraction}"
        source = "second-order scheme"
        yield Check(
            name="array drag, order", case=case, measured=order, reference=2, error=order - 2, source=source
        )


def wall(diameter: float, scheme: str = "linear", **box) -> Iterator[Check]:
    """Resistance towards a wall: lattice alone over the gap, then with a film for each cut-off and form."""
    made = flows.approach(diameter, scheme=scheme, dtype="float32", speed=2e-3, start=2.5 / diameter, **box)
    exact = Brenner1961()
    about = f"{scheme}, d {diameter:g}" + "".join(f", {k} {v:g} d" for k, v in box.items())
    for gap in GAPS:
        near = np.abs(made.gap - gap) < 0.05 * gap
        measured, reference = made.resistance[near].mean(), exact(eps=made.gap[near] / made.radius).mean()
        target = 0.03 if gap >= 2 else None
        yield _row("wall, no film", f"{about}, gap {gap:g}", measured, reference, target, _BRENNER)
    below = (made.gap >= 0.045) & (made.gap <= 2.1)
    gap, resistance = made.gap[below], made.resistance[below]
    eps = gap / made.radius
    reference = exact(eps=eps)
    films = {"what the grid lacks": made.radius * np.array([lost_to_grid(h) for h in gap])}
    for form, law in (("1/h", lambda e: 1 / e), ("Brenner", lambda e: exact(eps=e))):
        for cut_off in CUT_OFFS:
            film = np.where(gap < cut_off, law(eps) - law(cut_off / made.radius), 0.0)
            films[f"{form} difference, cut-off {cut_off:.3g} cells"] = film
    for form, film in films.items():
        error = (resistance + film) / reference - 1
        means = [error[np.abs(gap - h) < 0.05 * h].mean() for h in GAPS]
        yield _row("wall with film, worst", f"{about}, {form}", max(means, key=abs), 0, 0.02, _BRENNER)
        low = [mean for mean, h in zip(means, GAPS, strict=True) if h < RESOLVED]
        yield _row(
            "wall with film below half a cell, worst", f"{about}, {form}", max(low, key=abs), 0, 0.02, _BRENNER
        )


def noise(scheme: str = "linear", viscosities=(0.1, 0.02, 0.003)) -> Iterator[Check]:
    """Force noise of a sphere that crosses the grid."""
    for viscosity in viscosities:
        for name, direction in (("straight", (1, 0, 0)), ("oblique", (1, 0.62, 0.37))):
            found = flows.translation(10, direction, viscosity=viscosity, scheme=scheme, dtype="float32")
            case = f"{scheme}, d 10, nu {viscosity:g}, Re {found.reynolds:.3g}, {name}"
            yield _row("force noise", case, found.noise, 0, 0.02, _EXACT)
            yield _row("lateral force", case, found.lateral, 0, 0.02, _EXACT)


def mass(diameter: int = 10, way: float = 8.0) -> Iterator[Check]:
    """Mass that a closed box gains, over the volume swept, while a sphere falls ``way`` diameters at Re 164."""
    for speed in (0.05, 0.025):
        shape = (4 * diameter, 4 * diameter, round((way + 3) * diameter))
        rates = Rates.two_relaxation_times(speed * diameter / 164)
        flow = Simulation(shape, rates, faces={"z": "no-slip"}, dtype="float32")
        start = (2 * diameter + 0.3, 2 * diameter + 0.17, shape[2] - 1.5 * diameter)
        fall = [Sphere(diameter / 2, 8.0, start)]
        ball = Spheres(fall, drive=lambda step, gap, u=speed: (0.0, 0.0, -u * min(1.0, step / 200)))
        flow.add(ball)
        flow.run(round(way * diameter / speed) + 100)
        fluid = ~flows.inside(shape, ball.centres[0], diameter / 2)
        gained = float((flow.density.astype(float) - 1)[fluid].sum())
        swept = math.pi / 4 * diameter**2 * way * diameter
        case = f"d {diameter}, Re 164, lattice speed {speed:g}, way {way:g} d"
        yield _row("mass gained over volume swept", case, gained / swept, 0, 0.001, _EXACT)


def frames() -> Iterator[Check]:
    """Drag in moving frames over that in the frame of the fluid."""
    still = flows.drag_in_frame(10, (0.04, 0, 0), (0, 0, 0))
    for case, sphere, fluid in (
        ("sphere at rest", (0, 0, 0), (-0.04, 0, 0)),
        ("half each", (0.02, 0, 0), (-0.02, 0, 0)),
        ("oblique", (0.05, 0.03, -0.02), (0.01, 0.03, -0.02)),
    ):
        drag = flows.drag_in_frame(10, sphere, fluid)
        yield _row("frames", f"d 10, Re 8, {case}", drag, still, 0.01, "frame of the fluid")


def shear() -> Iterator[Check]:
    """Rotation rate and torque in shear; the wider box tells what is the box's."""
    for width, height in ((5, 6), (7, 9)):
        found = flows.shear(10, width=width, height=height)
        case = f"d 10, Re {found.reynolds:.2g}, box {width} x {width} x {height} d"
        yield _row("shear, turning", case, found.turning, 1, 0.01, "Jeffery 1922: half the shear rate")
        yield _row("shear, torque", case, found.torque, 1, None, "Stokes: 4 pi mu a^3 G, unbounded")


SETTLING = {"e1": (0.015, 4.2), "e3": (0.03, 1.75)}
"""Lattice speed that stands for the terminal speed, and duration in s."""


def settling(case: str, diameter: float) -> Iterator[Check]:
    """Peak speed and trajectory of ten Cate's sphere."""
    record = datasets.resource(f"tencate2002_{case}_gap")
    terminal, ratio = record.quoted["terminal_speed_m_s"], record.quoted["maximum_over_terminal_speed"]
    speed, duration = SETTLING[case]
    run = bouncing.settling(record.conditions, diameter, speed=speed, terminal=terminal, duration=duration)
    about = f"ten Cate {case.upper()}, d {diameter:g}, lattice speed {speed:g}"
    source = f"{record.experiment.cite}, table II"
    yield _row("settling, peak speed", about, -run.velocity.min() / terminal, ratio, 0.015, source)
    table = datasets.load(record.name)
    difference = np.interp(table.time_s, run.time, run.gap) - table.gap_m
    drop = 0.12
    rms = math.sqrt(np.mean(difference**2)) / drop
    yield _row("settling, trajectory rms over the drop", about, rms, 0, 0.02, "measured track, as digitised")
    yield _row("settling, trajectory mean over the drop", about, difference.mean() / drop, 0, None, "likewise")


def contact() -> Iterator[Check]:
    """What the sub-steps and the place in the cell change in a rebound at St = 30."""
    gap, velocity = bouncing.rebound()
    e = bouncing.restitution(gap, velocity)
    for factor in (0.5, 2):
        other = bouncing.restitution(*bouncing.rebound(fraction=factor * FRACTION))
        case = f"d 10, St 30, sub-step {factor:g} of the default"
        yield _row("contact, change of e", case, other - e, 0, 0.002, _EXACT)
    for name, places in (
        ("start height", [{"start": 1.5 + s / 10} for s in (0, 0.2, 0.4, 0.6, 0.8)]),
        ("lateral place", [{"lateral": s[:2]} for s in flows.SHIFTS]),
    ):
        apexes = [bouncing.apex(*bouncing.rebound(**place)) for place in places]
        yield _row(
            "contact, spread of first apex",
            f"d 10, St 30, {name}",
            np.ptp(apexes) / np.mean(apexes),
            0,
            None,
            _EXACT,
        )


def flight() -> Iterator[Check]:
    """How far the flight of a sphere that is sent off a wall depends on the lattice speed, and on the cells."""
    reference = bouncing.flight(0.025)
    for speed, cells, target in ((0.05, 10, 0.005), (0.0125, 10, 0.005), (0.025, 16, None)):
        gap = bouncing.flight(speed, cells)
        yield _row("flight, gap", f"lattice speed {speed:g}, d {cells}", gap, reference, target, "at 0.025, d 10")


def rest() -> Iterator[Check]:
    """Change of the base pressure, over rho c_s^2, while a sphere lies on the floor of a closed box."""
    found = bouncing.base_pressure()
    yield _row("base pressure, drift at rest", "d 8, nu 0.02, 40 d/c_s", np.ptp(found), 0, 1e-6, _EXACT)
    yield _row("base pressure at rest", "d 8, nu 0.02", found[-1], 0, None, _EXACT)


def beads() -> Iterator[Check]:
    """Fastest fall of free beads at Re 370, which still gain speed when they meet the floor."""
    for s, speed in enumerate(bouncing.beads()):
        yield _row("free beads, top speed", f"d 10, Re 370, bead {s + 1}", speed, 1, None, "standard drag curve")


GROUPS: dict[str, Callable[[], Iterator[Check]]] = {
    "arrays": arrays,
    "arrays-central-linear": lambda: arrays("central-linear"),
    "wall-10": lambda: wall(10, width=4, height=3),
    "wall-10-wide": lambda: wall(10, width=6, height=4),
    "wall-10-central-linear": lambda: wall(10, "central-linear", width=4, height=3),
    "wall-16": lambda: wall(16, width=4, height=3),
    "wall-20": lambda: wall(20, width=4, height=3),
    "noise": noise,
    "noise-central-linear": lambda: noise("central-linear"),
    "mass": mass,
    "frames": frames,
    "shear": shear,
    **{
        f"settling-{case}-{d:g}": (lambda case=case, d=d: settling(case, d))
        for case in SETTLING
        for d in (7.5, 12, 15)
    },
    "contact": contact,
    "flight": flight,
    "rest": rest,
    "beads": beads,
}
"""What is measured together, by name."""


def main() -> None:
    """Measure what is missing, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=GROUPS, metavar="NAME", help=f"of {', '.join(GROUPS)}")
    parser.add_argument("--fresh", action="store_true", help="measure again what there is")
    parser.add_argument("--json", type=Path, default=Path("benchmarks/sphere.json"))
    arguments = parser.parse_args()
    console = Console(width=150)
    known = read_checks(arguments.json) if arguments.json.exists() else []
    wanted = arguments.only or list(GROUPS)
    if arguments.fresh:
        known = [check for check in known if check.group not in wanted]
    missing = [name for name in wanted if name not in {check.group for check in known}]
    version = physics.agreed_version()
    for name in track(missing, "measuring", console=console):
        known += [check.model_copy(update={"group": name, "physics": version}) for check in GROUPS[name]()]
        write_whole(arguments.json, text_of(known))
    _show([check for check in known if check.group in wanted], console)


def _show(checks: list[Check], console: Console) -> None:
    table = Table("what", "case", "measured", "reference", "error", "target", "source")
    for c in checks:
        mark = "[red]" if c.missed else ""
        table.add_row(
            c.name, c.case, f"{c.measured:.4g}", f"{c.reference:.4g}", f"{mark}{c.error:+.2%}",
            "" if c.target is None else f"{c.target:.1%}", c.source,
        )  # fmt: skip
    console.print(table)


if __name__ == "__main__":
    main()
