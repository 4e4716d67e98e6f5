"""What happens where a sphere touches a wall: one of three, none of which counts the viscous loss twice.

===================  =======================  ============================================
contact              loss in the solid        loss in the film
===================  =======================  ============================================
:class:`FilmRebound` in e_eff, both together  in e_eff: no normal force of a film may act
:class:`DryRebound`  e_dry                    the fluid's and the film's force, to its floor
:class:`SoftContact` dashpot of e_dry         the fluid's and the film's force, to its floor
===================  =======================  ============================================

Lattice units; speeds are positive.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from lbm import arguments
from lbm.errors import InputError
from lbm.spheres.sampling import sampled

SETTLED = 2.5
"""Time in d/c_s after which the lattice's fluid has answered to a sphere that is reversed at once.

The exact force of sound on a sphere that jumps to another velocity falls as exp(-c_s t/a) cos(c_s t/a): its
impulse is then within 1 % of its end. Beside a wall it takes longer.
"""
_SPEEDS = (1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1)
"""Speeds in cells a step at which a description samples a contact's law."""
_BOUNCES = range(6)
_OVERLAPS = (1e-4, 1e-3, 1e-2, 1e-1, 1.0)
"""Likewise, overlaps in cells."""


@dataclass(frozen=True)
class Impact:
    """One contact.

    Attributes
    ----------
    step : when, with the fraction of a step.
    speed_in, speed_out : in cells a step, before and after it, at the wall or carried to it; not negative.
    """

    step: float
    speed_in: float
    speed_out: float


@dataclass(frozen=True)
class FilmRebound:
    """Rebound by an effective law, as e_eff over the Stokes number.

    Parameters
    ----------
    rebound : ``rebound(approach_speed, count)`` gives the speed after impact ``count`` (from 0), in cells a step.
    edge : gap in cells outside which the law's speeds are those of the motion.
    free_fall : acceleration towards the wall within the edge, in cells a step^2, not negative.

    Raises
    ------
    InputError
        For an edge or free fall out of range.

    Notes
    -----
    Both speeds are those of the motion outside the film, gap >= ``edge``, carried to the wall by free fall. The
    law speaks of the whole film, so within it the sphere falls freely, inwards and outwards, and the fluid
    follows. What the fluid does to the sphere meanwhile, the reversal of the fluid around it included, is part
    of what the law was measured to sum up. A rebound that would be back within one step ends in rest, until the
    fluid lifts the sphere.
    """

    rebound: Callable[[float, int], float]
    edge: float
    free_fall: float

    def __post_init__(self) -> None:
        arguments.positive("edge", self.edge)
        if not self.free_fall >= 0:
            raise InputError(f"free_fall = {self.free_fall:g}: must not be negative")

    def describe(self) -> dict:
        """Every number of the contact; the law as it is at a few speeds, for the first bounces."""
        return {
            "kind": type(self).__name__,
            "edge": float(self.edge),
            "free_fall": float(self.free_fall),
            "rebound": sampled(self.rebound, [(speed, count) for speed in _SPEEDS for count in _BOUNCES]),
        }


@dataclass(frozen=True)
class DryRebound:
    """Instantaneous rebound at the floor of the film: ``v_out = e_dry v_in``.

    Parameters
    ----------
    e_dry : in (0, 1].
    added_mass : of the fluid around the touching sphere, in lattice units; see :func:`lattice_added_mass`.
    diameter : of the sphere, in cells.
    viscosity : kinematic, of the fluid.

    Raises
    ------
    InputError
        For numbers out of range.

    Notes
    -----
    The fluid around the sphere, ``added_mass``, is reversed with it. What that takes comes not from the sphere
    but from the wall, as for any body that carries other mass along. The lattice's fluid answers to the reversal
    with sound first; until that is gone, :attr:`settling` steps, the sphere has the force of a liquid's answer,

        F = -history dv/(2 sqrt(t)),   history = 12 sqrt(pi nu) a^2,

    Basset's of a jump dv of the velocity, in place of the lattice's; see :mod:`lbm.spheres.wall_motion`.
    """

    e_dry: float
    added_mass: float
    diameter: float
    viscosity: float

    def __post_init__(self) -> None:
        arguments.positive("e_dry", self.e_dry)
        if self.e_dry > 1:
            raise InputError(f"e_dry = {self.e_dry:g}: must not exceed 1")
        arguments.positive("diameter", self.diameter)
        for name in ("added_mass", "viscosity"):
            if not getattr(self, name) >= 0:
                raise InputError(f"{name} = {getattr(self, name):g}: must not be negative")

    @property
    def settling(self) -> float:
        """Steps after a reversal in which sound still decides the lattice's force."""
        return SETTLED * self.diameter / arguments.SPEED_OF_SOUND

    @property
    def history(self) -> float:
        """Impulse that the liquid takes, beside added mass, over the jump of velocity and the root of time."""
        return 3 * math.sqrt(math.pi * self.viscosity) * self.diameter**2

    def describe(self) -> dict:
        """Every number of the contact."""
        numbers = {name: float(getattr(self, name)) for name in ("e_dry", "added_mass", "settling", "history")}
        return {"kind": type(self).__name__, **numbers}


@dataclass(frozen=True)
class SoftContact:
    """Contact stretched over many steps of the fluid.

    Parameters
    ----------
    force : ``force(overlap, rate, impact_speed)`` pushes from the wall, in lattice units; overlap in cells.
    duration : of the contact, in steps: what the sub-steps are chosen by.

    Raises
    ------
    InputError
        For a duration that is not positive.

    Notes
    -----
    ``rate`` is the velocity away from the wall. The fluid's force acts all the while. It can follow the
    reversal only if the contact lasts longer than sound needs to pass the sphere, some d/c_s.
    """

    force: Callable[[float, float, float], float]
    duration: float

    def __post_init__(self) -> None:
        arguments.positive("duration", self.duration)

    @classmethod
    def linear(cls, e_dry: float, mass: float, duration: float) -> SoftContact:
        """Spring and dashpot that give ``mass``, with the fluid it carries, e_dry after ``duration`` steps.

        k = m (pi^2 + ln^2 e)/T^2, c = -2 m ln e/T, from the damped oscillator's half period.
        """
        _check(e_dry, mass, duration)
        stiffness = mass * (math.pi**2 + math.log(e_dry) ** 2) / duration**2
        damping = -2 * mass * math.log(e_dry) / duration
        return cls(lambda overlap, rate, _: max(0.0, stiffness * overlap - damping * rate), duration)

    @classmethod
    def hertz(cls, e_dry: float, mass: float, duration: float) -> SoftContact:
        """Hertz's spring with a dashpot, F = k s^(3/2) - c v, stretched to ``duration``.

        Coefficients of Ray, Kempe & Frohlich (2015) as printed by Biegert, Vowinckel & Meiburg,
        J. Comput. Phys. 340 (2017) 105, appendix B; they give e_dry to 1.3 % above e_dry = 0.7.
        """
        _check(e_dry, mass, duration)
        eta, alpha, tau = math.log(e_dry) ** 2, 1.111, 3.218
        scale = alpha**2 * tau**2
        damping = (-0.5 * 0.744 * eta + math.sqrt(0.25 * 0.744**2 * eta**2 + scale * eta)) / scale
        unit = duration / tau * (1 - 0.716 * damping - 0.830 * damping**2)

        def force(overlap: float, rate: float, impact_speed: float) -> float:
            stiffness = mass / math.sqrt(impact_speed * unit**5)
            return max(0.0, stiffness * overlap**1.5 - 2 * damping * mass / unit * rate)

        return cls(force, duration)

    def describe(self) -> dict:
        """Every number of the contact; its force as it is at a few overlaps and speeds, both ways."""
        states = [
            (overlap, sign * speed, impact_speed)
            for overlap in _OVERLAPS
            for sign in (-1, 1)
            for speed in (0.0, 1e-3, 1e-2)
            for impact_speed in (1e-3, 1e-1)
        ]
        return {
            "kind": type(self).__name__,
            "duration": float(self.duration),
            "force": sampled(self.force, states),
        }


Contact = FilmRebound | DryRebound | SoftContact


def lattice_added_mass(diameter: float) -> float:
    """Added mass that the lattice gives a sphere touching a wall, over the displaced mass.

    Parameters
    ----------
    diameter : float
        In cells.

    Raises
    ------
    InputError
        For a diameter that is not positive.

    Notes
    -----
    C = 0.8031 - 1.33/diameter^(3/4). Potential flow gives (3/2) zeta(3) - 1 = 0.8031; the rest is what
    ``benchmarks/added_mass.py`` measures on the lattice, 8 to 24 cells a diameter, within 0.03.
    """
    return 0.8030853547 - 1.33 / arguments.positive("diameter", diameter) ** 0.75


def _check(e_dry: float, mass: float, duration: float) -> None:
    for name, value in {"e_dry": e_dry, "mass": mass, "duration": duration}.items():
        arguments.positive(name, value)
