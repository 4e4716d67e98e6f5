"""A case as the lattice solver is told it: scales, box, rates, sphere, drive, film and contact in lattice units.

Nothing of size is allocated here, so that what a kept run was told can be compared with what its case says now
(:mod:`restitution.runs.validity.told`) in a millisecond or two.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import lbm
from lbm.arguments import SPEED_OF_SOUND
from lbm.rates_by_place import PRESETS
from lbm.scales import FlowScales
from lbm.spheres import (
    SETTLED,
    Contact,
    DryRebound,
    Film,
    FilmRebound,
    SoftContact,
    Sphere,
    Spheres,
    lattice_added_mass,
    lost_to_grid,
)
from restitution.cases.case import Case
from restitution.errors import Defect, InputError
from restitution.runs.closures import Normal, Tangential, edge_of, normal_force, rebound, tangential_force

OUTPUT_D = 0.04
"""Way in diameters that the reference speed makes between two rows of a trajectory."""


@dataclass(frozen=True)
class Setup:
    """What decides a run, in lattice units; ``flow`` has the scales that lead back to SI."""

    flow: FlowScales
    shape: tuple[int, int, int]
    rates: lbm.Rates | lbm.RatesByPlace
    faces: dict[str, str]
    precision: str
    interpolation: str
    sphere: Sphere
    gravity: float
    drive: Callable | None
    film: Film | None
    contact: Contact | None
    mirrors: str = ""
    """Axes at whose low faces the box is half of the whole."""

    @property
    def rows_apart(self) -> int:
        """Steps between two rows of a trajectory."""
        return max(1, round(OUTPUT_D * self.flow.length / self.flow.speed))

    @property
    def edge_d(self) -> float:
        """Gap in diameters from which on film or contact act."""
        film = 0.0 if self.film is None else max(self.film.cut_off, self.film.floor)
        contact = self.contact.edge if isinstance(self.contact, FilmRebound) else 0.0
        return max(film, contact) / self.flow.length

    def describe(self) -> dict[str, Any]:
        """What is told, by name: numbers and words, functions by what they give at some arguments."""
        return {
            "box": self.shape,
            "faces": self.faces,
            "precision": self.precision,
            "rates": self.rates.diagonal().tolist(),
            "cell_m, step_s, density": [self.flow.scales.unit(q) for q in ("length", "time", "density")],
            "start": self.sphere.position,
            "sphere": self.spheres().describe(),
        }

    def spheres(self) -> Spheres:
        """The sphere with all that acts on it, where it starts."""
        return Spheres(
            [self.sphere],
            gravity=(0.0, 0.0, -self.gravity),
            film=self.film,
            contact=self.contact,
            drive=self.drive,
            interpolation=self.interpolation,
        )

    def build(self) -> tuple[lbm.Simulation, Spheres]:
        """The simulation with its sphere, ready to run."""
        spheres = self.spheres()
        simulation = lbm.Simulation(self.shape, self.rates, faces=self.faces, dtype=self.precision)
        simulation.add(spheres)
        return simulation, spheres


def set_up(case: Case, file: str = "") -> Setup:
    """What the solver is told of ``case``, which ``file`` has.

    Raises :class:`InputError` for numbers that it refuses; warns of those it doubts.
    """
    try:
        return _set_up(case)
    except lbm.InputError as error:
        raise InputError(Defect(str(error), file=file or case.name, field="numerics")) from None


def _set_up(case: Case) -> Setup:
    n, flow, quarter = case.numerics, _scales(case), case.quartered
    wide = round(n.width_d * flow.length / (2 if quarter else 1))
    high = round(n.height_d * flow.length)
    # Half-way between two images of the sphere lies a plane of symmetry, so periodic sides are mirrors too.
    far = "free-slip" if n.sides == "periodic" else n.sides
    sides = (
        {"x-": "free-slip", "x+": far, "y-": "free-slip", "y+": far} if quarter else {"x": n.sides, "y": n.sides}
    )
    radius, density = flow.length / 2, case.sphere.density / case.fluid.density
    middle = 0.0 if quarter else wide / 2
    position = (middle, middle, radius + case.release.gap_d * flow.length)
    return Setup(
        flow=flow,
        shape=(wide, wide, high),
        rates=PRESETS[case.rates](viscosity=flow.viscosity),
        faces={**sides, "z-": "no-slip", "z+": n.top},
        precision=n.precision,
        interpolation=n.interpolation,
        sphere=Sphere(radius, density, position),
        gravity=flow.scales.lattice(case.gravity, "acceleration"),
        drive=_drive(case, flow),
        film=_film(case, flow),
        contact=_contact(case, flow, density),
        mirrors="xy" if quarter else "",
    )


def check_edge(setup: Setup, file: str) -> None:
    """Refuse a film that a rebound leaves before sound has told the fluid of it.

    The fluid's answer to the reversal is part of e_eff as long as the sphere is within the edge, and is counted a
    second time after that: where the film lasts 2.9 d/c_s the gap 6 ms later is that of half the lattice speed to
    0.5 %, where it lasts 1.4, 4 % off. Raises :class:`InputError` naming what to change.
    """
    if not isinstance(setup.contact, FilmRebound):
        return
    speed, edge = setup.flow.speed, setup.contact.edge / setup.flow.length
    out = setup.contact.rebound(speed, 0)
    lasts = edge * SPEED_OF_SOUND / out if out > 0 else math.inf
    if lasts >= SETTLED:
        return
    wider = math.ceil(100 * edge * SETTLED / lasts) / 100
    rule = (
        f"lets the rebound leave the film of {edge:g} d within {lasts:.2f} d/c_s, c_s being the speed of sound, "
        f"before the fluid has answered to it: at least {SETTLED:g} are needed. Take "
        f"{_two_digits_down(speed * lasts / SETTLED):g}, or contact.edge_d = {wider:g}, at which measured values "
        "are others and a law needs its own law_edge_d"
    )
    raise InputError(Defect(rule, file=file, field="numerics.lattice_speed", value=f"{speed:g}"))


def _two_digits_down(value: float) -> float:
    """Rounded down, so that what is advised is not refused."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / digit) * digit


def fall_time(case: Case) -> float:
    """Estimate of the time in s to the first contact."""
    gap, fall = case.release.gap_d * case.sphere.diameter, case.conditions.free_fall
    speed = case.reference_speed
    if case.release.kind == "drive":
        return gap / speed + case.release.ramp
    return gap / speed + 0.5 * speed / fall


def film_forces(case: Case, flow: FlowScales) -> tuple[Normal | None, Tangential | None]:
    """What the film does across and along the wall, in lattice units."""
    r, mu, tension = flow.length / 2, flow.viscosity, case.film.tension
    floor = flow.scales.lattice(case.floor, "length")
    tension = None if tension is None else flow.scales.lattice(tension, "pressure")
    across = normal_force(case.film, r=r, mu=mu, floor=floor, tension=tension, lost=lost_to_grid)
    return across, tangential_force(case.film, r=r, mu=mu)


def _scales(case: Case) -> FlowScales:
    n = case.numerics
    return FlowScales.from_conditions(
        length_m=case.sphere.diameter,
        speed_m_s=case.reference_speed,
        viscosity_m2_s=case.fluid.viscosity / case.fluid.density,
        density_kg_m3=case.fluid.density,
        cells=n.cells_per_diameter,
        lattice_speed=n.lattice_speed,
    )


def _drive(case: Case, flow: FlowScales) -> Callable | None:
    r = case.release
    if r.kind == "rest":
        return None
    down, along = (flow.scales.lattice(v, "velocity") for v in (r.speed, r.along))
    ramp, free_below = r.ramp / flow.scales.step_s, r.free_below_d * flow.length

    def drive(step: float, gap: float) -> tuple[float, float, float] | None:
        share = math.expm1(-step / ramp)
        return None if gap < free_below else (-along * share, 0.0, down * share)

    return drive


def _film(case: Case, flow: FlowScales) -> Film | None:
    black_box = case.contact is not None and case.contact.mode == "effective"
    if case.floor is None or (black_box and not case.film.tangential):
        return None
    return Film(case.film.cut_off, flow.scales.lattice(case.floor, "length"), *film_forces(case, flow))


def _contact(case: Case, flow: FlowScales, density: float) -> Contact | None:
    c, e = case.contact, case.sphere.e_dry
    if c is None:
        return None
    displaced = math.pi / 6 * flow.length**3
    carried = displaced * (lattice_added_mass(flow.length) if c.added_mass is None else c.added_mass)
    if c.mode == "dry":
        return DryRebound(e, carried, flow.length, flow.viscosity)
    if c.mode != "effective":
        make = SoftContact.linear if c.mode == "soft_linear" else SoftContact.hertz
        return make(e, density * displaced + carried, c.duration_steps)
    free_fall = flow.scales.lattice(case.conditions.free_fall, "acceleration")
    return FilmRebound(rebound(case, flow.scales.unit("velocity")), edge_of(case) * flow.length, free_fall)
