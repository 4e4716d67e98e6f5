"""The point particle: energy, free fall in closed form, history force against an oscillating sphere."""

from __future__ import annotations

import math

import numpy as np

from restitution import datasets, laws
from restitution.bounce import Closures, Release, bounce, unbounded
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.stokes import StokesNumber
from restitution.validation.row import Kind, Reference, Row, Values, at_most, near

_RECORD = "gondret2002_st152"
_PHASES = ("with u", "with du/dt")


def energy() -> Values:
    """Energy that is created or lost over a whole bouncing trajectory, over the initial one."""
    conditions = datasets.resource(_RECORD).conditions
    found = {}
    for name, closures in (("film resolved", Closures()), ("law", Closures(rebound=laws.get("legendre_2005")))):
        path = bounce(conditions, Release(9e-3, 0.586), closures, end=0.2, tolerance=2e-10)
        found[name] = path.imbalance
    return found


def basset_fall() -> Values:
    """Greatest error of a fall from rest in creeping flow with history, over the final speed.

    M u' + S u + S r/sqrt(nu) [history] = W: its Laplace transform inverts to w(i a sqrt(t)), w being Faddeeva's.
    """
    from scipy.special import wofz

    c = Conditions(
        fluid=Fluid(density=935.0, viscosity=0.1), sphere=Sphere(diameter=3e-3, density=7800.0, e_dry=0.8)
    )
    r, rho, mu = c.sphere.radius, c.fluid.density, c.fluid.viscosity
    displaced = rho * math.pi * c.sphere.diameter**3 / 6
    mass = 7800.0 * math.pi * c.sphere.diameter**3 / 6
    S, M, W = 6 * math.pi * mu * r, mass + displaced / 2, (mass - displaced) * c.gravity
    a1, a2 = (-np.roots([M, S * r / math.sqrt(mu / rho), S])).astype(complex)
    t = np.geomspace(1e-3, 0.5, 30)
    w1, w2 = (wofz(1j * a * np.sqrt(t)) for a in (a1, a2))
    exact = np.real(W / M * ((1 - w1) / a1 - (1 - w2) / a2) / (a2 - a1))
    creeping = Closures(
        drag=laws.get("stokes_1851"), wall=None, added_mass="free", history=laws.get("basset_1888")
    )
    path = bounce(c, Release(1.0, developed=False), creeping, end=0.5, tolerance=1e-8)
    return {"error": float(np.abs(-path.velocity(t) - exact).max() / exact.max())}


def oscillation(reynolds: float, frequency: float) -> Values:
    """First harmonic of the coefficient of the force against the motion: in phase with u and with du/dt."""
    default = Closures()
    force = unbounded.oscillation(default.drag, default.history, unbounded.PHASES, reynolds, frequency)
    return dict(zip(_PHASES, unbounded.amplitudes(unbounded.PHASES, force), strict=True))


def oscillation_measured() -> tuple[Reference, ...]:
    """First harmonic of the published C_D by least squares with higher ones."""
    found = unbounded.amplitudes(*unbounded.reference_oscillation())
    return tuple(near(name, value, absolute=0.05) for name, value in zip(_PHASES, found, strict=True))


def stokes_numbers() -> Values:
    """St of records at the speed that they state, by the program."""
    found = {}
    for record in ("gondret2002_st152", "tencate2002_e3_gap"):
        r = datasets.resource(record)
        speed = r.quoted.get("approach_speed_m_s", r.quoted.get("terminal_speed_m_s"))
        found[record] = float(StokesNumber.from_speed(speed, r.conditions).value)
    return found


def rebound_by_law() -> Values:
    """e_eff of the first bounce of a particle that follows Legendre's law, from e_dry exp(-beta/St*)."""
    conditions = datasets.resource(_RECORD).conditions
    path = bounce(conditions, Release(9e-3, 0.586), Closures(rebound=laws.get("legendre_2005")), end=0.1)
    impact, c = path.impacts[0], conditions
    St_star = (
        (c.sphere.density + 0.5 * c.fluid.density) * impact.v_in * c.sphere.diameter / (9 * c.fluid.viscosity)
    )
    return {"e over e_dry exp(-35/St*)": impact.e / (0.97 * math.exp(-35 / St_star))}


ROWS: tuple[Row, ...] = (
    Row(
        "energy", "energy that appears or is lost over a whole trajectory", Kind.ANALYTICAL, "energy is conserved",
        (at_most("film resolved", 1e-8), at_most("law", 1e-8)), "the tolerance of the integration, 2e-10 a step",
        energy,
    ),
    Row(
        "basset-fall", "error of a fall from rest with Basset's force", Kind.ANALYTICAL,
        "Laplace transform in closed form", (at_most("error", 1e-5),),
        "the sum of exponentials is the kernel to 2e-6", basset_fall,
    ),
    Row(
        "oscillating-sphere", "C_D of a sphere that oscillates at Re 40, w d/U = 3.2: first harmonic",
        Kind.PUBLISHED,
        "Schneiders et al., J. Comput. Phys. 235 (2013) 786, Fig. 20 (a case of Mei 1994)", oscillation_measured,
        "four times the scatter of the digitised points about their harmonics, 0.012", oscillation,
        {"reynolds": unbounded.RE_OSCILLATING, "frequency": unbounded.FREQUENCY},
        known={"with u": "steady drag and a memory of finite Re are added up, which no theory at Re 40 says"},
    ),
    Row(
        "stokes-number", "St = rho_p v d/(9 mu) of records at their stated speeds", Kind.MEASURED,
        "Gondret et al. 2002: 152; ten Cate et al. 2002: 1.50",
        (near("gondret2002_st152", 152.0, relative=0.01), near("tencate2002_e3_gap", 1.5, relative=0.01)),
        "digits that are stated", stokes_numbers,
    ),
    Row(
        "law-delivered", "restitution of a particle that follows Legendre's law", Kind.ANALYTICAL,
        "Legendre et al. 2005: e = e_dry exp(-35/St*)", (near("e over e_dry exp(-35/St*)", 1.0, absolute=1e-9),),
        "round-off", rebound_by_law,
    ),
)  # fmt: skip
